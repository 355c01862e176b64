"""Natural modes of a complete vehicle: published frequencies on vertical springs, then all connections; mode shapes."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmu_src.cosimulation.recording import Recording
from products.coach import AS_PUBLISHED, COACH, NUMBERS
from rbd_model.linear import Mode, oscillations
from scenarios.bench.drive import RIGID, prepare, system_of
from scenarios.reporting.plots import BOGIE, LEADING, TRAILING, plt, titled
from scenarios.reporting.report import Report, Row, near
from scenarios.scenario import Options, Scenario

PLANAR, SPATIAL = 2, 3
#: Of the vertical springs alone [Hz], from the masses and stiffnesses of Iwnicki (1998).
PUBLISHED = {
    "bounce of the body": 1.0739,
    "bounce of the frames": 7.4705,
    "pitch of the body": 1.2991,
    "frames against each other": 7.4772,
    "pitch of a frame": 11.714,
}
BAND = 1e-3
DIRECTIONS = ("longitudinal", "lateral", "vertical")
#: No damping, level springs as good as absent, all centres and springs at one height, so that no weight leans on them.
VERTICAL_ALONE = {
    **{f"{kind}{direction}_stiffness": 1.0 for kind in ("", "secondary_") for direction in DIRECTIONS[:2]},
    **{f"{kind}{direction}_damping": 0.0 for kind in ("", "secondary_") for direction in DIRECTIONS},
    **{f"{name}_height": 0.0 for name in ("frame", "body", "secondary")},
    **{"secondary_bending_stiffness": 0.0, "anti_roll_stiffness": 0.0},
}
#: Speed of the vehicle in space [m/s]: slow, so that the wheels guide and do not hunt.
SPEED = 10.0
#: Modes with less of critical damping than this, above the slowest frequency [Hz], are shown.
OVERDAMPED, SLOWEST = 0.9, 0.2
BODIES = ("body", "front_frame", "rear_frame")
MOTIONS = ("shift", "lateral", "bounce", "roll", "pitch", "yaw")


def modes(level: int, **values: float) -> list[Mode]:
    """Oscillations of the vehicle at a level, the slowest first; on rigid contacts, without their own vibrations."""
    place = RIGID | AS_PUBLISHED | {"level": level}
    kernel = prepare("vehicle", tolerance=1e-10, **place, **values)
    kernel.initialise()
    found = oscillations(system_of("vehicle", **place), np.array(kernel.linearise().jacobian))
    return sorted(found, key=lambda mode: mode.frequency)


def amplitude(mode: Mode, body: str, motion: str) -> complex:
    """Of a body's motion at the reach of the body, so that angles and displacements compare [m]."""
    reach = (COACH.pivot_distance if body == "body" else COACH.wheel_base) / 2
    return mode.shape.get(f"{body}_{motion}", 0.0) * (reach if motion in ("pitch", "yaw") else 1.0)


def name_of(mode: Mode) -> str:
    """The body and the motion that are largest in a mode; hunting, where a wheelset moves most to the side."""
    sizes = {(body, motion): abs(amplitude(mode, body, motion)) for body in BODIES for motion in MOTIONS}
    body, motion = max(sizes, key=lambda key: sizes[key])
    wheels = {number: abs(mode.shape.get(f"lateral_{number}", 0.0)) for number in NUMBERS}
    leader = max(wheels, key=lambda number: wheels[number])
    if wheels[leader] > sizes[body, motion]:
        return f"hunting of the {'front' if leader < 3 else 'rear'} bogie"
    word = "swing along the track" if motion == "shift" else motion
    return f"{word} of the {body.replace('_', ' ')}"


def shown(found: list[Mode]) -> list[Mode]:
    return [mode for mode in found if mode.damping_ratio < OVERDAMPED and mode.frequency > SLOWEST]


def run(options: Options) -> Report:
    vertical = np.array([mode.frequency for mode in modes(PLANAR, initial_speed=0.0, **VERTICAL_ALONE)])
    rows = []
    for name, expected in PUBLISHED.items():
        found = float(vertical[np.argmin(np.abs(vertical - expected))])
        source = "closed form of the published data"
        rows.append(Row(f"{name}, vertical springs alone", "Hz", None, found, near(expected, BAND * expected), source))
    whole = shown(modes(SPATIAL, initial_speed=SPEED))
    for mode in whole:
        remark = f"{100 * mode.damping_ratio:.0f} % of critical damping"
        rows.append(Row(f"{name_of(mode)}, complete, {SPEED:g} m/s", "Hz", None, mode.frequency, None, remark))
    series = Recording({"frequency": "Hz"}, [[mode.frequency] for mode in whole])
    series.add("damping_ratio", "1", np.array([mode.damping_ratio for mode in whole]))
    remarks = [
        "Complete: weight leans on springs that stand below the centres of mass, dampers act, lateral and yaw motions "
        "couple with roll; bounce stays within the damping's shift, pitch gains what moves along the track with it."
    ]
    return Report(rows, series, lambda: draw(whole), {"initial_speed": SPEED}, 0.0, remarks)


def draw(found: list[Mode]) -> Figure:
    columns = 4
    lines = -(-len(found) // columns)
    figure, grid = plt.subplots(lines, columns, figsize=(12.0, 2.1 * lines + 0.6), squeeze=False)
    for axis in grid.ravel():
        axis.set_axis_off()
    for axis, mode in zip(grid.ravel(), found, strict=False):
        sketch(axis, mode)
    return titled(figure, "Modes of the Manchester vehicle 1: from the side (above), from above (below)")


def sketch(axis: Axes, mode: Mode) -> None:
    """Body and frames displaced as in a mode, from the side and from above, over their places at rest."""
    largest = max(abs(amplitude(mode, body, motion)) for body in BODIES for motion in MOTIONS) or 1.0
    pivot = COACH.pivot_distance / 2
    places = {"body": (0.0, 11.0, BOGIE), "front_frame": (pivot, 2.0, LEADING), "rear_frame": (-pivot, 2.0, TRAILING)}
    for body, (centre, half, colour) in places.items():
        along = np.array([-half, half])
        level = 4.0 if body == "body" else 1.5
        shape = {motion: mode.shape.get(f"{body}_{motion}", 0.0) / largest for motion in MOTIONS}
        side = np.real(shape["bounce"] - shape["pitch"] * along)
        above = np.real(shape["lateral"] + shape["yaw"] * along)
        roll = np.real(shape["roll"])
        for height, moved in ((level, side), (level - 6.0, above)):
            axis.plot(centre + along, [height, height], color=colour, linewidth=0.6, linestyle=":")
            axis.plot(centre + 2 * np.real(shape["shift"]) + along, height + moved, color=colour, linewidth=2.2)
        if abs(roll) > 0.05:
            axis.annotate(f"roll {roll:+.1f}", (centre, level + 0.5), ha="center", fontsize=7, color=colour)
    axis.set(xlim=(-13, 13), ylim=(-6.5, 6.0))
    text = f"{name_of(mode)}\n{mode.frequency:.2f} Hz, damping {100 * mode.damping_ratio:.0f} %"
    axis.set_title(text, fontsize=8)


SCENARIO = Scenario("vehicle-modes", "Natural modes of a complete vehicle and their shapes", run)
