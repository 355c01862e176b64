"""Braking curves of ETCS a second and core, arrays in and arrays out, for the rows of `speed`."""

import time

import numpy as np

from bogie_braking.reporting.report import Row, measured
from products.supervision import Gradients, Steps, SupervisedTrain, supervise

#: Trains of a call, and calls of which the fastest counts; those of a quick run.
MEASURED, QUICK = (20_000, 3), (500, 1)
#: Speeds of a curve, and curves a second to reach.
SPEEDS, WANTED = 40, 1e5
#: Curves of a train that a call computes for an end of authority; each is an array of its own.
CURVES = ("EBD", "EBI", "SBD", "SBI1", "SBI2", "W", "P", "I")
LINES = {
    "a level line": Gradients.level(),
    "three gradients": Gradients(np.array([0.0, 1000.0, 3000.0]), np.array([0.0, 5.0, -8.0])),
}


def trains(count: int) -> SupervisedTrain:
    """Return random trains with five steps of deceleration, and factors of a confidence level."""
    rng = np.random.default_rng(1)
    boundaries = np.sort(rng.uniform(5.0, 70.0, (count, 4)), axis=-1)
    brake = Steps(boundaries, rng.uniform(0.5, 1.3, (count, 5)))
    return SupervisedTrain(
        rng.uniform(50.0, 700.0, count),
        brake,
        Steps(boundaries, 0.8 * brake.values),
        rng.uniform(1.0, 6.0, count),
        rng.uniform(1.0, 6.0, count),
        Kdry_rst=Steps.constant(0.8),
        service_command=True,
    )


def curves_a_second(gradients: Gradients, count: int, repeats: int) -> float:
    """Return curves of 40 points a second of processor time [1/s]."""
    many, speeds, best = trains(count), np.linspace(1.0, 80.0, SPEEDS), np.inf
    for _ in range(repeats):
        begin = time.process_time()
        found = supervise(many, 5000.0, speeds, gradients=gradients)
        best = min(best, time.process_time() - begin)
    number = sum(getattr(found, name) is not None for name in CURVES)
    return number * count / best


def supervision_rows(quick: bool = False) -> list[Row]:
    """Return the rows of lines with and without gradients."""
    rows, (count, repeats) = [], QUICK if quick else MEASURED
    for name, gradients in LINES.items():
        what = f"braking curves of ETCS, {SPEEDS} points each, a second and core: {count} trains on {name}"
        rate = curves_a_second(gradients, count, repeats)
        rows.append(measured(what, "1/s", rate, f"measured now; to reach {WANTED:g}"))
    return rows
