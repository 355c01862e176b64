"""Traction and braking torque in sequence, section 5.4.1, Figs 5.24-5.28."""

from dataclasses import dataclass, field

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, THESIS, mark, panels
from bogie_braking.reporting.report import Report, Row, measured, near, number, rounding
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.master import cosimulate
from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import FmuInstance
from rbd_model.levels.models import recommend_level
from rbd_model.vehicle.parameters import BogieParameters, as_printed, tables_5_1_and_5_2
from scenarios.bench.open_fmus import open_bogie

DURATION = 40.0
FULL_TORQUE = 15e3
RAMP = 5.0
COAST = 5.0
INITIAL_SPEED, HIGH_SPEED, LOW_SPEED = 0.01, 20.0, 10.0
#: Share of the load transfer that residual rocking may hide.
MOMENT_BAND = 5e-3


@dataclass
class TorqueSequence:
    """Fig. 5.24: traction to 20 m/s, 5 s of rolling, braking to 10 m/s, rolling; the speed triggers each change."""

    bogie: FmuInstance
    switches: list[float] = field(default_factory=list)
    torque: list[float] = field(default_factory=list)

    def __call__(self, time: float) -> None:
        speed = self.bogie["speed"]
        if (len(self.switches) == 0 and speed >= HIGH_SPEED) or (len(self.switches) == 2 and speed <= LOW_SPEED):
            self.switches.append(time)
        if len(self.switches) == 1 and time >= self.switches[0] + COAST - 1e-9:
            self.switches.append(time)
        traction = FULL_TORQUE * min(time / RAMP, 1.0) if not self.switches else 0.0
        brake = 0.0
        if len(self.switches) == 2:
            brake = FULL_TORQUE * min((time - self.switches[1]) / RAMP, 1.0)
        self.torque.append(traction - brake)
        self.bogie.set(
            traction_torque_1=traction, traction_torque_2=traction, brake_torque_1=brake, brake_torque_2=brake
        )


def expected_acceleration(p: BogieParameters, torque: float) -> float:
    """Return 2 T/r / (M + 2 J/r^2) [m/s2]: both wheelsets driven or braked with `torque` [N.m], rolling."""
    mass = p.frame_mass + 2 * p.wheelset_mass
    return 2 * torque / p.wheel_radius / (mass + 2 * p.wheelset_pitch_inertia / p.wheel_radius**2)


def load_transfer(p: BogieParameters, deceleration: float, pitch: float) -> float:
    """Return the load [N] on the leading wheelset that balances all moments about the rail, for any internal reaction.

    Inertia forces of sprung mass and wheelsets act at their heights, and the wheels decelerate. The sprung mass is
    displaced ahead of its wheelsets by its pitch [rad]. Its springs add the deflection due to its inertia force and, as
    they pitch with it, due to its weight.
    """
    push = p.frame_mass * (p.wheel_radius + p.frame_height) + 2 * p.wheelset_mass * p.wheel_radius
    push += 2 * p.wheelset_pitch_inertia / p.wheel_radius
    along = p.frame_mass * (deceleration + p.gravity * pitch)
    ahead = p.frame_height * pitch + along / (4 * p.longitudinal_stiffness)
    return (push * deceleration + p.frame_mass * p.gravity * ahead) / p.wheel_base


def mean_where(values: np.ndarray, where: np.ndarray) -> float | None:
    """Return the mean of the chosen values; None if none is chosen."""
    return float(np.mean(values[where])) if where.any() else None


RECORDED = (
    "speed",
    "distance",
    "acceleration",
    "angular_velocity_1",
    "angular_velocity_2",
    "axle_load_1",
    "axle_load_2",
    "pitch",
)


def drive(options: Options, level: int, reaction: float) -> tuple[Recording, TorqueSequence, dict[str, str]]:
    """Run the sequence, with torque in the recording; reaction: the share of it that reacts on the frame."""
    with open_bogie(options, level=level, initial_speed=INITIAL_SPEED, torque_reaction=reaction) as bogie:
        bogie.start()
        sequence = TorqueSequence(bogie)
        record = [(bogie, name) for name in RECORDED]
        series = cosimulate(
            [bogie], [], DURATION, options.macro_step(), record, sequence, label="bogie-traction-braking"
        )
        guids = {bogie.name: bogie.guid}
    series.add("torque", "N.m", np.array([*sequence.torque, sequence.torque[-1]]))
    return series, sequence, guids


def settled_braking(series: Recording) -> np.ndarray:
    """Return the mask of the instants at which the brake has been full for 2 s."""
    full = series["torque"] <= -FULL_TORQUE
    begin = series.first_time(full)
    return full & (series["time"] > (DURATION if begin is None else begin + 2.0))


def load_row(words: str, series: Recording, judged: bool) -> Row:
    """Return the load that moves forward during braking, against the balance of moments."""
    braking = settled_braking(series)
    first, second, pitch, acceleration = (
        mean_where(series[name], braking) for name in ("axle_load_1", "axle_load_2", "pitch", "acceleration")
    )
    asked = moved = None
    if first is not None and second is not None and pitch is not None and acceleration is not None:
        asked = load_transfer(tables_5_1_and_5_2(), -acceleration, pitch) / 1e3
        moved = (first - second) / 2e3
    band = near(asked, MOMENT_BAND * asked) if judged and asked is not None else None
    lacking = (
        ""
        if judged or asked is None
        else f"not judged: moments ask for {asked:.1f} kN, torques that react on nothing do not"
    )
    return measured(f"braking, {words}: load that moves forward", "kN", moved, "moments about the rail", band, lacking)


def run(options: Options, quick: bool = False) -> Report:
    parameters = as_printed(tables_5_1_and_5_2())
    choice = recommend_level(("traction_torque_1", "brake_torque_1"), RECORDED)
    series, sequence, guids = drive(options, choice.level, parameters.torque_reaction)
    hung, *_ = drive(options, choice.level, tables_5_1_and_5_2().torque_reaction)
    # Times of 20 m/s reached, brake applied, 10 m/s reached; None if the event is missing.
    switches = [sequence.switches[i] if i < len(sequence.switches) else None for i in range(3)]
    time, torque = series["time"], series["torque"]
    pulling = (time > 10.0) & (torque >= FULL_TORQUE)
    expected = expected_acceleration(parameters, FULL_TORQUE)
    source = "section 5.4.1"
    settled = "mean while the torque is constant and the suspension has settled"
    pulled = mean_where(series["acceleration"], pulling)
    braked = mean_where(series["acceleration"], settled_braking(series))
    rows = [
        Row("acceleration at 15 kN.m traction", "m/s2", 1.109, pulled, rounding("1.109"), source, settled),
        Row("acceleration at 15 kN.m braking", "m/s2", -1.109, braked, rounding("1.109"), source, settled),
        Row("time at which 20 m/s is reached", "s", 20.5, switches[0], rounding("20.5"), source),
        Row("distance after 40 s", "m", 496.0, float(series["distance"][-1]), rounding("496"), source),
        Row("time at which 10 m/s is reached", "s", 37.0, switches[2], rounding("37"), source),
        load_row("torques on the wheelsets alone as in (3.36)", series, judged=False),
        load_row("brakes hung in the frame", hung, judged=True),
    ]
    remark = f"Rolling without slip, 2T/r / (M + 2J/r2) = {expected:.4f} m/s2."
    used = parameters.values() | {"level": choice.level}
    return Report(
        rows, series, lambda: draw(series, switches, pulled), used, 2 * DURATION, [remark, choice.reason], guids
    )


def draw(series: Recording, switches: list[float | None], pulled: float | None) -> Figure:
    labels = ("torque on each wheelset [kN.m], traction positive", "speed [m/s]", "acceleration [m/s2]")
    message = f"{1e-3 * FULL_TORQUE:g} kN.m on each wheelset accelerate the bogie by {number(pulled)} m/s2"
    figure, axes = panels(message, labels, 2.2)
    time = series["time"]
    axes[0].plot(time, series["torque"] / 1e3, color=BOGIE)
    axes[1].plot(time, series["speed"], color=BOGIE)
    axes[2].plot(time, series["acceleration"], color=BOGIE, linewidth=0.8)
    axes[2].axhline(1.109, color=THESIS, linestyle="--", linewidth=1.0, label="thesis, 1.109 m/s2")
    axes[2].axhline(-1.109, color=THESIS, linestyle="--", linewidth=1.0)
    axes[2].set_ylim(-2.2, 2.2)  # the axles jerk for milliseconds if a torque vanishes at once; see timeseries.csv
    axes[2].legend(loc="upper right")
    for axis in axes:
        for moment in switches:
            mark(axis, moment, "")
    return figure


SCENARIO = Scenario(
    "bogie-traction-braking",
    "Traction to 20 m/s, rolling, braking to 10 m/s (section 5.4)",
    run,
    frozenset({"kind", "step"}),
)
