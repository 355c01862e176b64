"""One driven wheelset with rigid or elastic shafts: torsional frequencies, onset of growing torsion, errors and cost.

Closed forms are those of [a driven wheelset](drive.md). All parameters of the drive are assumed.
"""

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, charts, write_at
from bogie_braking.reporting.report import Report, Row, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.motors import traction_inverter
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.driven_wheelset import BOTH_ELASTIC, ELASTIC_AXLE, ELASTIC_DRIVE, RIGID, SHAFTS
from products.kernel_runs import prepare
from rbd_model.wheelset.driven import electric_locomotive
from scenarios.bench.ringing import modes_in

NAME, P, MOTOR = "driven-wheelset", electric_locomotive(), traction_inverter()
#: Friction of the comparisons, with the fall of a dry rail; start speed [m/s], duration and interval [s].
FRICTION, SPEED, DURATION, INTERVAL = 0.35, 5.0, 3.0, 1e-3
#: Demanded torques of the motor [N.m]: carried by the rail, and beyond it; time of the ramp [s].
CARRIED, BEYOND, RAMP = 7e3, 9e3, 2.0
CASES = {
    "ramp that the rail carries": (CARRIED, True),
    "step that the rail carries": (CARRIED, False),
    "step beyond adhesion": (BEYOND, False),
}
OUTPUTS = {"speed": "m/s", "wheel_speed_2": "m/s", "axle_torque": "N.m", "drive_torque": "N.m"}
#: Runs on both sides of the onset, as shares of its slip; their difference of friction left and right.
SIDES, UNEQUAL = (0.97, 1.03), 1e-5
#: Allowed errors: the frequency and the speed of spinning wheels, and the slip at the onset.
CLOSED, ONSET = 1e-3, 0.02


@dataclass(frozen=True)
class TorsionRun:
    """The outputs of one run over time, its steps, and its largest values."""

    table: dict[str, np.ndarray]
    steps: int

    def largest(self, name: str) -> float:
        """Return the largest size of an output."""
        return float(np.abs(self.table[name]).max())


def pull(shafts: int, torque: float, ramp: bool) -> TorsionRun:
    """Pull by a step of torque or by a ramp."""
    kernel = prepare(NAME, shafts=shafts, initial_speed=SPEED, friction_1=FRICTION, friction_2=FRICTION)
    kernel.initialise()
    if not ramp:
        kernel.set(torque_demand=torque)
        parts = [kernel.record(DURATION, INTERVAL, list(OUTPUTS))]
    else:
        kernel.set_rate(torque_demand=torque / RAMP)
        parts = [kernel.record(RAMP, INTERVAL, list(OUTPUTS))]
        kernel.set_rate(torque_demand=0.0)
        kernel.set(torque_demand=torque)
        parts.append(kernel.record(DURATION - RAMP, INTERVAL, list(OUTPUTS)))
    table = {name: np.concatenate([np.array(part[name]) for part in parts]) for name in ("time", *OUTPUTS)}
    return TorsionRun(table, kernel.counts["steps"])


def frequency(shafts: int) -> float:
    """Return the frequency of the fastest torsion of twisted shafts without friction, by a run [Hz]."""
    free = {"friction_1": 0.0, "friction_2": 0.0, "torque_time_constant": 1e-4, "tolerance": 1e-10}
    kernel = prepare(NAME, shafts=shafts, initial_torque=3e3, **free)
    kernel.advance(0.02)
    name = "drive_twist" if shafts == ELASTIC_DRIVE else "axle_twist"
    signal = np.array(kernel.record(0.5, 2e-3, [name])[name])
    return float(abs(modes_in(signal, 2e-3, 4 if shafts == BOTH_ELASTIC else 2)[-1])) / (2 * math.pi)


def two_inertias(stiffness: float, first: float, second: float) -> float:
    """Return the frequency of two inertias on a spring [Hz], sqrt(k (1/J_1 + 1/J_2)) / (2 pi)."""
    return math.sqrt(stiffness * (1 / first + 1 / second)) / (2 * math.pi)


def in_slip(slip: float, **values: float) -> Kernel:
    """Return a kernel that begins in a steady slip [m/s] on a dry rail."""
    first = prepare(NAME, initial_slip=-slip)
    first.initialise()
    force = first["creep_force_1"] + first["creep_force_2"]
    torque = force * P.wheel_radius / P.gear_ratio
    large = {"motor_torque": 1e6, "motor_power": 1e9, "resistance": force, "torque_demand": torque}
    return prepare(NAME, initial_slip=-slip, initial_torque=torque, **large, **values)


def slope(slip: float) -> float:
    """Return the slope of the creep force of one wheel by its slip [N.s/m]."""
    low, high = (in_slip(slip + change) for change in (-1e-4, 1e-4))
    for kernel in (low, high):
        kernel.initialise()
    return (high["creep_force_1"] - low["creep_force_1"]) / 2e-4


def limit_of_slope() -> float:
    """Return the slope at which the fastest torsion has no damping: sum c dphi^2 = -s r^2 (phi_1^2 + phi_2^2)."""
    inertia = np.diag([P.gear_ratio**2 * P.rotor_inertia, P.wheel_inertia_1, P.wheel_inertia_2])
    ends = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]])
    stiffness = ends.T @ np.diag([P.drive_stiffness, P.axle_stiffness]) @ ends
    values, shapes = np.linalg.eig(np.linalg.solve(inertia, stiffness))
    shape = shapes[:, np.argmax(values.real)].real
    damped = P.drive_damping * (shape[0] - shape[1]) ** 2 + P.axle_damping * (shape[1] - shape[2]) ** 2
    return float(-damped / (P.wheel_radius**2 * (shape[1] ** 2 + shape[2] ** 2)))


def onset_by_slope() -> float:
    """Return the slip at which the falling curve has the slope of the limit, beyond its peak [m/s]."""
    limit, low, high = limit_of_slope(), 0.05, 1.0
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if slope(middle) > limit else (low, middle)
    return low


def growth(slip: float) -> float:
    """Return the growth of the fastest torsion in a run [1/s], begun by unequal friction."""
    dry = in_slip(slip)["friction_1"]
    unequal = {"friction_1": dry * (1 + UNEQUAL), "friction_2": dry * (1 - UNEQUAL)}
    kernel = in_slip(slip, tolerance=1e-11, **unequal)
    twist = np.array(kernel.record(0.25, 2e-3, ["axle_twist"])["axle_twist"])
    found = modes_in(np.diff(twist), 2e-3, 6)
    return float(found[np.argmin(np.abs(found.imag / (2 * math.pi) - frequency(BOTH_ELASTIC)))].real)


def onset_in_time(about: float) -> float:
    """Return the slip at which runs neither grow nor decay, from one run on each side [m/s]."""
    slips = [side * about for side in SIDES]
    rates = [growth(slip) for slip in slips]
    if not rates[0] < 0.0 < rates[1]:
        return math.nan
    return slips[0] - rates[0] * (slips[1] - slips[0]) / (rates[1] - rates[0])


def spinning() -> float:
    """Return the wheel speed at which a motor beyond adhesion ends, on constant friction of 0.2 [m/s]."""
    even = {"friction_1": 0.2, "friction_2": 0.2, "friction_ratio": 1.0, "slip_reduction": 1.0}
    force = 0.2 * P.carried_mass * 9.81
    kernel = prepare(NAME, initial_speed=SPEED, torque_demand=1e6, resistance=force, **even)
    kernel.advance(30.0)
    return kernel["wheel_speed_1"]


def closed_forms() -> list[Row]:
    """Return the rows with closed forms beside them."""
    rotor, wheels = P.gear_ratio**2 * P.rotor_inertia, P.wheel_inertia_1 + P.wheel_inertia_2
    by_hand = {
        ELASTIC_DRIVE: ("rotor against wheelset", two_inertias(P.drive_stiffness, rotor, wheels)),
        ELASTIC_AXLE: (
            "wheel against wheel and rotor",
            two_inertias(P.axle_stiffness, P.wheel_inertia_1 + rotor, P.wheel_inertia_2),
        ),
    }
    rows = [
        measured(f"frequency, {what}", "Hz", frequency(shafts), "two inertias on a spring", near(hand, CLOSED * hand))
        for shafts, (what, hand) in by_hand.items()
    ]
    by_slope, ends = onset_by_slope(), MOTOR.motor_power / (0.2 * P.carried_mass * 9.81)
    text = "falling slope against the damping of the mode"
    return [
        *rows,
        measured("slip at which torsion grows", "m/s", onset_in_time(by_slope), text, near(by_slope, ONSET * by_slope)),
        measured("slope there", "N.s/m", limit_of_slope(), "closed form"),
        measured("spinning wheels end at", "m/s", spinning(), "power over sliding force", near(ends, 2e-3 * ends)),
    ]


def errors(runs: dict[int, TorsionRun]) -> dict[int, dict[str, float]]:
    """Return the errors of each choice of shafts against elastic ones [%]."""
    best = runs[BOTH_ELASTIC]
    return {
        shafts: {
            "speed at the end": 100 * (run.table["speed"][-1] / best.table["speed"][-1] - 1),
            "largest wheel speed": 100 * (run.largest("wheel_speed_2") / best.largest("wheel_speed_2") - 1),
            "largest torque of the axle": 100 * (run.largest("axle_torque") / best.largest("axle_torque") - 1),
            "largest torque of the drive": 100 * (run.largest("drive_torque") / best.largest("drive_torque") - 1),
        }
        for shafts, run in runs.items()
    }


def run(options: Options, quick: bool = False) -> Report:
    runs = {case: {shafts: pull(shafts, *how) for shafts in SHAFTS} for case, how in CASES.items()}
    rows = closed_forms()
    for case, found in runs.items():
        for shafts, of in errors(found).items():
            text = SHAFTS[shafts][1]
            if shafts != BOTH_ELASTIC:
                rows += [measured(f"{case}, {text}: error of {what}", "%", error) for what, error in of.items()]
            rows.append(measured(f"{case}, {text}: steps for a second", "1", found[shafts].steps / DURATION))
    shown = runs["step beyond adhesion"]
    units = {"time": "s"} | {f"{name}, {SHAFTS[n][1]}": OUTPUTS[name] for n in shown for name in OUTPUTS}
    columns = [shown[RIGID].table["time"], *(shown[n].table[name] for n in shown for name in OUTPUTS)]
    remark = "Errors are those against both shafts elastic, whose parameters are assumed."
    parameters = P.values() | MOTOR.values()
    seconds = DURATION * len(CASES) * len(SHAFTS)
    return Report(rows, Recording(units, np.array(columns).T), lambda: draw(runs), parameters, seconds, [remark])


def draw(runs: dict[str, dict[int, TorsionRun]]) -> Figure:
    """Draw torque and wheel speed beyond adhesion, and the error of the axle's torque over the cost."""
    slow, _, fast = (errors(of)[RIGID]["largest torque of the axle"] for of in runs.values())
    message = f"Rigid shafts: error {abs(slow):.1f} % on a ramp, {abs(fast):.0f} % beyond adhesion"
    titles = {
        "torque of the axle, step beyond adhesion [kN.m]": "time [s]",
        "speed of wheel 2, the same [m/s]": "time [s]",
        "error of the axle's largest torque [%]": "steps for a simulated second",
    }
    figure, axes = charts(message, titles, (14.0, 4.6), columns=3)
    shown = runs["step beyond adhesion"]
    for shafts, colour, text in ((BOTH_ELASTIC, LEADING, "elastic"), (RIGID, TRAILING, "rigid")):
        table = shown[shafts].table
        axes[0].plot(table["time"], table["axle_torque"] / 1e3, color=colour, label=text, linewidth=1.0)
        axes[1].plot(table["time"], table["wheel_speed_2"], color=colour, label=text)
    axes[1].plot(shown[RIGID].table["time"], shown[RIGID].table["speed"], "--", color=BOGIE, label="vehicle, rigid")
    for axis in axes[:2]:
        axis.legend()
    for (case, found), marker in zip(runs.items(), "osD", strict=True):
        points = [(found[n].steps / DURATION, abs(errors(found)[n]["largest torque of the axle"])) for n in SHAFTS]
        axes[2].plot(*np.array(points).T, marker, label=case, markersize=8)
    axes[2].set_xscale("log")
    axes[2].set_ylim(-3.0, 100.0)
    axes[2].legend()
    for shafts, (_, text, _) in SHAFTS.items():
        place = runs["step beyond adhesion"][shafts].steps / DURATION
        height = abs(errors(runs["step beyond adhesion"])[shafts]["largest torque of the axle"])
        side = "right" if shafts == RIGID else "center"
        write_at(axes[2], (place, height + 5.0), text, BOGIE, ha=side, fontsize="small")
    return figure


SCENARIO = Scenario("drive-torsion", "A driven wheelset with rigid or elastic shafts, and when torsion is needed", run)
