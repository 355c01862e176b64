"""Hunting of a vehicle: its body at middle speeds without the dampers, its bogies at high speeds."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from scipy.linalg import eig

from bogie_braking.reporting.plots import LEADING, THESIS, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.coach import AS_PUBLISHED, COACH, NUMBERS
from products.kernel_runs import DRAG, RIGID, SETTLED, prepare, system_of
from rbd_model.linear import Mode, critical_speed, oscillations, reduced_jacobian

#: Speeds of the plot, and of that of a quick run [m/s].
SPEEDS, QUICK_SPEEDS = np.arange(5.0, 111.0, 3.0), np.arange(10.0, 111.0, 10.0)
#: Least part of its energy across the track of a mode that moves body or wheelsets laterally.
ACROSS = 0.5
#: Disturbance, small against the flange clearance, so that the motion is linear [m]. The run that shows its growth, and
#: its samples, begin when the vehicle has passed the wave [s].
DISTURBANCE, BEGIN, LENGTH, INTERVAL = 1e-5, 6.0, 8.0, 0.05
TOLERANCE = 1e-9
#: Relative tolerance of the speed of two methods on the same equations.
BAND = 2e-3


@dataclass(frozen=True)
class HuntingVehicle:
    """A vehicle, its expected critical speed [m/s], and whether its body hunts or its bogies."""

    name: str
    values: Mapping[str, float]
    between: tuple[float, float]
    body: bool


CASES = (
    HuntingVehicle("as published", {}, (70.0, 110.0), body=False),
    HuntingVehicle("lateral dampers failed", {"secondary_lateral_damping": 0.0}, (22.0, 32.0), body=True),
)


def run_at(case: HuntingVehicle, speed: float, **more: float) -> Kernel:
    """Return the vehicle at a constant speed; small motions on the treads need no flange."""
    values = {**RIGID, **AS_PUBLISHED, **case.values, **more, "tolerance": TOLERANCE}
    values["rolling_resistance_torque"] = DRAG
    return prepare("vehicle", **values, initial_speed=speed, constant_speed=1)


def energies(mode: Mode) -> dict[str, float]:
    """Return the parts of a mode's kinetic energy, up to one factor: of the body, frames and wheelsets across the
    track.
    """
    p, shape = COACH, mode.shape

    def of(mass: float, roll: float, yaw: float, names: tuple[str, str, str]) -> float:
        sizes = zip((mass, roll, yaw), names, strict=True)
        return sum(size * abs(shape.get(name, 0.0)) ** 2 for size, name in sizes)

    def moving(body: str) -> tuple[str, str, str]:
        return f"{body}_lateral", f"{body}_roll", f"{body}_yaw"

    frames = (
        of(p.frame_mass, p.frame_roll_inertia, p.frame_yaw_inertia, moving(f"{b}_frame")) for b in ("front", "rear")
    )
    wheelsets = (of(p.wheelset_mass, 0.0, p.wheelset_yaw_inertia, (f"lateral_{n}", "", f"yaw_{n}")) for n in NUMBERS)
    along = sum(
        mass * (abs(shape.get(f"{name}_shift", 0.0)) ** 2 + abs(shape.get(f"{name}_bounce", 0.0)) ** 2)
        + inertia * abs(shape.get(f"{name}_pitch", 0.0)) ** 2
        for name, mass, inertia in (
            ("body", p.body_mass, p.body_pitch_inertia),
            ("front_frame", p.frame_mass, p.frame_pitch_inertia),
            ("rear_frame", p.frame_mass, p.frame_pitch_inertia),
        )
    )
    body = of(p.body_mass, p.body_roll_inertia, p.body_yaw_inertia, moving("body"))
    return {"body": body, "frames": sum(frames), "wheelsets": sum(wheelsets), "along": along}


def body_share(mode: Mode) -> float | None:
    """Return the body's share of the energy of a motion across the track; None for motions in the vehicle's plane."""
    parts = energies(mode)
    across = parts["body"] + parts["frames"] + parts["wheelsets"]
    return float(parts["body"] / across) if across > ACROSS * (across + parts["along"]) else None


def hunting(case: HuntingVehicle, speed: float, body: bool) -> Mode | None:
    """Return the least stable motion across the track in which the body has more than half of the energy, or less."""
    kernel = run_at(case, speed)
    kernel.advance(SETTLED)
    found = oscillations(system_of("vehicle", **RIGID), np.array(kernel.linearise().jacobian))
    shares = [(mode, body_share(mode)) for mode in found]
    chosen = [mode for mode, share in shares if share is not None and (share > 0.5) == body]
    return max(chosen, key=lambda mode: mode.growth, default=None)


def growth(case: HuntingVehicle, speed: float) -> float:
    """Return the growth of the motion that is expected to hunt [1/s]."""
    mode = hunting(case, speed, case.body)
    return mode.growth if mode else -np.inf


def growth_in_time(case: HuntingVehicle, speed: float) -> float:
    """Return the growth of the same motion in a run after a small wave of the track [1/s].

    Its amplitude is the projection of the state on the left eigenvector, to which all other motions are orthogonal.
    """
    mode = hunting(case, speed, case.body)
    assert mode is not None
    system = system_of("vehicle", **RIGID)
    steady, kernel = (
        run_at(case, speed, lateral_irregularity=size, lateral_wave_number=mode.frequency / speed)
        for size in (0.0, DISTURBANCE)
    )
    for one in (steady, kernel):
        one.advance(BEGIN)
    names, matrix = reduced_jacobian(system, np.array(steady.linearise().jacobian))
    values, left, _ = eig(matrix, left=True)
    seen = left[:, np.argmin(np.abs(values - mode.eigenvalue))].conj()
    places = [list(system.states).index(name) for name in names]
    sizes = []
    for _ in range(round(LENGTH / INTERVAL)):
        states = []
        for one in (steady, kernel):
            one.advance(INTERVAL)
            states.append(np.array(one.linearise().state)[places])
        sizes.append(abs(seen @ (states[1] - states[0])))
    return float(np.polyfit(INTERVAL * np.arange(len(sizes)), np.log(sizes), 1)[0])


@dataclass(frozen=True)
class Onset:
    """Critical speed by eigenvalues and in time [m/s], and the motion there."""

    by_eigenvalues: float
    in_time: float
    mode: Mode


def onset(case: HuntingVehicle) -> Onset:
    speed = critical_speed(lambda v: growth(case, v), *case.between)
    around = np.array([0.995, 1.005]) * speed
    slopes = [growth_in_time(case, float(v)) for v in around]
    in_time = float(around[0] - slopes[0] * (around[1] - around[0]) / (slopes[1] - slopes[0]))
    mode = hunting(case, speed, case.body)
    assert mode is not None
    return Onset(speed, in_time, mode)


def rows_of(onsets: Mapping[str, Onset]) -> list[Row]:
    rows = []
    for case in CASES:
        found = onsets[case.name]
        share = body_share(found.mode)
        what = "body" if case.body else "bogie"
        ratio = found.in_time / found.by_eigenvalues
        rows += [
            measured(f"{case.name}: {what} hunting from, by eigenvalues", "m/s", found.by_eigenvalues),
            measured(f"{case.name}: the same in time", "m/s", found.in_time, "growth just below and above it"),
            measured(f"{case.name}: in time over eigenvalues", "1", ratio, "two methods", near(1.0, BAND)),
            measured(f"{case.name}: frequency", "Hz", found.mode.frequency),
            measured(f"{case.name}: wavelength", "m", found.by_eigenvalues / found.mode.frequency),
            measured(f"{case.name}: share of the body in the energy", "1", share, "tells which of both it is"),
        ]
    return rows


def run(options: Options, quick: bool = False) -> Report:
    speeds = QUICK_SPEEDS if quick else SPEEDS
    onsets = {case.name: onset(case) for case in counting(CASES, unit="case")}
    series = Recording({"speed": "m/s"}, [[float(speed)] for speed in speeds])
    points = [(case, body, speed) for case in CASES for body in (True, False) for speed in speeds]
    growths: dict[tuple[str, bool], list[float]] = {}
    for case, body, speed in counting(points, unit="speed"):
        mode = hunting(case, float(speed), body)
        growths.setdefault((case.name, body), []).append(mode.growth if mode else np.nan)
    for (name, body), values in growths.items():
        series.add(f"growth, {'body' if body else 'bogies'}, {name}", "1/s", np.array(values))
    remarks = [
        "Body hunting: guidance by conical wheels shakes the body where its frequency meets one of the body's own, and "
        "only dampers keep it down. Bogie hunting: frames and wheelsets, several times as fast. On the "
        "synthetic profiles (conicity about 0.05); worn wheels hunt earlier.",
        f"With a rolling resistance of {DRAG:g} N.m a wheelset: without any creep Polach's law has no unique slope.",
    ]
    return Report(rows_of(onsets), series, lambda: draw(onsets, series), COACH.values(), 0.0, remarks)


def draw(onsets: Mapping[str, Onset], series: Recording) -> Figure:
    figure, axes = plt.subplots(1, 2, figsize=(11.0, 4.6), sharey=True)
    for axis, case in zip(axes, CASES, strict=True):
        for word, line, colour in (("body", "--", TRAILING), ("bogies", "-", LEADING)):
            axis.plot(series["speed"], series[f"growth, {word}, {case.name}"], line, color=colour, label=word)
        axis.axhline(0.0, color="#999999", linewidth=0.8)
        found = onsets[case.name]
        label = f"critical: {found.by_eigenvalues:.1f} m/s, in time {found.in_time:.1f} m/s"
        axis.axvline(found.by_eigenvalues, color=THESIS, linestyle=":", label=label)
        axis.set(title=case.name, xlabel="speed [m/s]", ylim=(-1.6, 1.2))
        axis.legend(fontsize=8, loc="lower left")
    axes[0].set_ylabel("growth of the least stable motion [1/s]")
    sound, failed = (onsets[case.name].by_eigenvalues for case in CASES)
    return titled(figure, f"Failed lateral dampers lower the critical speed from {sound:.1f} to {failed:.1f} m/s")


SCENARIO = Scenario("vehicle-hunting", "Critical speeds of a vehicle: hunting of its body and of its bogies", run)
