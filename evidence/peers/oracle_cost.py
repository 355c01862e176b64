"""Cost of the thesis's chapter 3 on the smooth stop: one point for the plot of speed against accuracy."""

import time as clock

import numpy as np

from evidence.chapter3.kinematic_analysis import rolling
from evidence.chapter3.mechanism import FIRST_WHEELSET, Inputs, Mechanism
from evidence.chapter3.program import run as run_program
from evidence.measuring.scenes import FULL, SMOOTH
from evidence.peers.work_precision import Point
from rbd_model.contact.geometry import thesis_pair
from rbd_model.track.irregularity import derivatives_along, section_5_3
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_5_1_and_5_2

#: Integrated time and step [s]; Runge-Kutta is unstable above 0.8 ms at 25 m/s.
SHOWN, STEP = 0.1, 5e-4


def oracle_point() -> Point:
    """Return the relative error of distance and speed after `SHOWN`; the time is extrapolated to the whole case."""
    mechanism = Mechanism(as_printed(tables_5_1_and_5_2()), thesis_pair(), 2, derivatives_along(section_5_3()))
    inputs, state = Inputs(brake_torque=(FULL, FULL)), rolling(mechanism, 25.0)
    begin = clock.perf_counter()
    *_, state = run_program(mechanism, state, SHOWN, STEP, lambda time: inputs)
    seconds = clock.perf_counter() - begin
    bodies = [mechanism.body(FIRST_WHEELSET + number) for number in range(2)]
    speed = float(np.mean([state.q_rate[body][0] for body in bodies]))
    distance = float(np.mean([state.q[body][0] for body in bodies]))
    kernel = SMOOTH.kernel(tolerance=1e-10, **AS_PRINTED)
    start = float(np.mean([rolling(mechanism, 25.0).q[body][0] for body in bodies]))
    kernel.advance(SHOWN)
    error = max(abs(speed / kernel["speed"] - 1.0), abs((distance - start) / kernel["distance"] - 1.0))
    steps = round(SMOOTH.duration / STEP)
    return Point("chapter 3 as printed", STEP, error, seconds * SMOOTH.duration / SHOWN, 4 * steps)
