"""The wheelset of chapter 4 under traction, rolling and braking: speed, rotation and slip are results (section 4.5)."""

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, mark, single, write_at
from bogie_braking.reporting.report import Report, Row, rounding
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import play, prepare
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_4_1_and_4_2

TORQUE, LOW, HIGH = 5e3, 10.0, 25.0
BRAKE = (21.0, 31.0)
DURATION, INTERVAL = 35.0, 0.01
RECORDED = ("speed", "distance", "rotation_1", "angular_velocity_1", "acceleration")


def time_to_high_speed() -> float | None:
    """Return the time from 10 to 25 m/s with constant torque [s]."""
    kernel = prepare("wheelset", initial_speed=LOW, **AS_PRINTED)
    series = play("wheelset", kernel, 20.0, 1e-3, ["speed"], {"traction_torque_1": [(0.0, TORQUE)]})
    return series.first_time(series["speed"] >= HIGH)


def run(options: Options, quick: bool = False) -> Report:
    reached = time_to_high_speed()
    end = reached or 15.0
    inputs = {
        "traction_torque_1": [(0.0, TORQUE), (end, TORQUE), (end, 0.0)],
        "brake_torque_1": [(0.0, 0.0), (BRAKE[0], 0.0), (BRAKE[0], TORQUE), (BRAKE[1], TORQUE), (BRAKE[1], 0.0)],
    }
    kernel = prepare("wheelset", initial_speed=LOW, **AS_PRINTED)
    series = play("wheelset", kernel, DURATION, INTERVAL, RECORDED, inputs)
    turned, travelled = (
        float(np.diff(np.interp(BRAKE, series["time"], series[name]))[0]) for name in ("rotation_1", "distance")
    )
    slip = travelled - tables_4_1_and_4_2().wheel_radius * turned
    source = "section 4.5"
    assumed = "not judged: hangs on the end of the traction, which is not printed; here at 25 m/s"
    rows = [
        Row("time from 10 to 25 m/s at 5 kN.m", "s", 15.0, reached, rounding("15"), source, "'about 15 seconds'"),
        Row("rotation while braking, 21 to 31 s", "rad", 469.52, turned, None, source, assumed),
        Row("distance while braking", "m", 199.65, travelled, None, source, assumed),
        Row("distance slipped while braking", "m", 0.10, slip, rounding("0.10"), source, "0.425 m times the rotation"),
    ]
    return Report(rows, series, lambda: draw(series, reached), as_printed(tables_4_1_and_4_2()).values(), DURATION)


def draw(series: Recording, reached: float | None) -> Figure:
    took = f"do not reach {HIGH:g} m/s" if reached is None else f"take {reached:.1f} s from {LOW:g} to {HIGH:g} m/s"
    figure, axis = single(f"{1e-3 * TORQUE:g} kN.m {took}", "time [s]", "speed [m/s]")
    axis.plot(series["time"], series["speed"], color=BOGIE, linewidth=2.5)
    axis.axvspan(*BRAKE, color="#eeeeee", zorder=0)
    axis.set_ylim(LOW - 1.0, HIGH + 2.0)
    mark(axis, reached, "traction ends")
    write_at(axis, (sum(BRAKE) / 2, LOW), "braking", BOGIE, ha="center")
    return figure


SCENARIO = Scenario("wheelset-torque", "Traction, rolling, braking with 5 kN.m (section 4.5)", run)
