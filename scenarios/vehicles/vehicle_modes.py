"""Natural modes of a complete vehicle: published frequencies on vertical springs, then all connections; mode shapes."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, plt, titled
from bogie_braking.reporting.report import Report, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.coach import AS_PUBLISHED, COACH, NUMBERS
from products.kernel_runs import DRAG, RIGID, SETTLED, prepare, settled, system_of
from rbd_model.linear import Mode, oscillations

PLANAR, SPATIAL = 2, 3
#: Frequencies of the vertical springs alone [Hz], from the masses and stiffnesses of Iwnicki (1998).
PUBLISHED = {
    "bounce of the body": 1.0739,
    "bounce of the frames": 7.4705,
    "pitch of the body": 1.2991,
    "frames against each other": 7.4772,
    "pitch of a frame": 11.714,
}
BAND = 1e-3
DIRECTIONS = ("longitudinal", "lateral", "vertical")
#: No damping, horizontal springs of negligible stiffness, all centres and springs at one height, without effects of
#: weight.
VERTICAL_ALONE = {
    **{f"{kind}{direction}_stiffness": 1.0 for kind in ("", "secondary_") for direction in DIRECTIONS[:2]},
    **{f"{kind}{direction}_damping": 0.0 for kind in ("", "secondary_") for direction in DIRECTIONS},
    **{f"{name}_height": 0.0 for name in ("frame", "body", "secondary")},
    **{"secondary_bending_stiffness": 0.0, "anti_roll_stiffness": 0.0},
}
#: Speed of the vehicle in 3D [m/s]: low, so that the wheels guide and do not hunt.
SPEED = 10.0
#: Modes with less of critical damping than this, above the slowest frequency [Hz], are shown.
OVERDAMPED, SLOWEST = 0.9, 0.2
BODIES = ("body", "front_frame", "rear_frame")
MOTIONS = ("shift", "lateral", "bounce", "roll", "pitch", "yaw")
#: Number of drawn modes, size of their largest displacement [m], width and height of the frame [m].
DRAWN, LARGEST, WIDTH, HEIGHT = 8, 1.2, 26.0, 7.2
#: Centres of bodies and half their drawn sizes, ahead, to the left and up [m]; only the pivots are the vehicle's.
PIVOT = COACH.pivot_distance / 2
BOXES = {
    "body": ((0.0, 0.0, 3.2), (11.0, 1.4, 1.3)),
    "front_frame": ((PIVOT, 0.0, 0.7), (2.0, 1.0, 0.4)),
    "rear_frame": ((-PIVOT, 0.0, 0.7), (2.0, 1.0, 0.4)),
}
#: Axes to the right and up in each view (0 ahead, 1 to the left, 2 up), sign of the first, and height of the middle
#: [m].
VIEWS = {"from the side": (0, 2, 1.0, 2.4), "from above": (0, 1, 1.0, 0.0), "from behind": (1, 2, -1.0, 2.4)}


def modes(level: int, **values: float) -> list[Mode]:
    """Return the oscillations of the vehicle at a level, the slowest first; on rigid contacts, without their own
    vibrations. In 3D the contacts have settled.
    """
    place = RIGID | AS_PUBLISHED | {"level": level, "tolerance": 1e-10} | values
    kernel = settled("vehicle", **place) if level == SPATIAL else prepare("vehicle", **place)
    if level == PLANAR:
        kernel.initialise()
    found = oscillations(system_of("vehicle", **RIGID | {"level": level}), np.array(kernel.linearise().jacobian))
    return sorted(found, key=lambda mode: mode.frequency)


def amplitude(mode: Mode, body: str, motion: str) -> complex:
    """Return the amplitude of a body's motion at the reach of the body, so that angles compare with shifts [m]."""
    reach = (COACH.pivot_distance if body == "body" else COACH.wheel_base) / 2
    return mode.shape.get(f"{body}_{motion}", 0.0) * (reach if motion in ("pitch", "yaw") else 1.0)


def name_of(mode: Mode) -> str:
    """Return the body and the motion that are largest in a mode; "hunting" if a wheelset has the largest lateral
    motion.
    """
    sizes = {(body, motion): abs(amplitude(mode, body, motion)) for body in BODIES for motion in MOTIONS}
    body, motion = max(sizes, key=lambda key: sizes[key])
    wheels = {number: abs(mode.shape.get(f"lateral_{number}", 0.0)) for number in NUMBERS}
    leader = max(wheels, key=lambda number: wheels[number])
    if wheels[leader] > sizes[body, motion]:
        return f"hunting of the {'front' if leader < 3 else 'rear'} bogie"
    word = "swing along the track" if motion == "shift" else motion
    return f"{word} of the {body.replace('_', ' ')}"


def phase(one: complex, other: complex) -> str:
    """Return the phase between two motions of a mode in words."""
    turn = abs(float(np.angle(one * np.conj(other), deg=True)))
    return "in phase" if turn < 45.0 else "in antiphase" if turn > 135.0 else f"{turn:.0f}° apart"


def shown(found: list[Mode]) -> list[Mode]:
    return [mode for mode in found if mode.damping_ratio < OVERDAMPED and mode.frequency > SLOWEST]


def run(options: Options, quick: bool = False) -> Report:
    vertical = np.array([mode.frequency for mode in modes(PLANAR, initial_speed=0.0, **VERTICAL_ALONE)])
    rows = []
    for name, expected in PUBLISHED.items():
        found = float(vertical[np.argmin(np.abs(vertical - expected))])
        source = "closed form of the published data"
        rows.append(measured(f"{name}, vertical springs alone", "Hz", found, source, near(expected, BAND * expected)))
    whole = shown(modes(SPATIAL, initial_speed=SPEED))
    for mode in whole:
        remark = f"{100 * mode.damping_ratio:.0f} % of critical damping"
        rows.append(measured(f"{name_of(mode)}, complete, {SPEED:g} m/s", "Hz", mode.frequency, remark))
    series = Recording({"frequency": "Hz"}, [[mode.frequency] for mode in whole])
    series.add("damping_ratio", "1", np.array([mode.damping_ratio for mode in whole]))
    remarks = [
        "Complete: weight leans on springs that stand below the centres of mass, dampers act, lateral and yaw motions "
        "couple with roll; bounce stays within the damping's shift, pitch gains what moves along the track with it.",
        f"Linearised after {SETTLED:g} s, with a rolling resistance of {DRAG:g} N.m a wheelset: without any creep "
        "Polach's law has no unique slope.",
        f"The picture has the {DRAWN} slowest modes, without those in which frames swing along the track: body and "
        "frames (filled) where they move furthest, and at rest (dotted); the vehicle runs to the right.",
    ]
    return Report(rows, series, lambda: draw(whole), {"initial_speed": SPEED}, 0.0, remarks)


def draw(found: list[Mode]) -> Figure:
    chosen = [mode for mode in found if "swing" not in name_of(mode)][:DRAWN]
    figure, grid = plt.subplots(DRAWN // 2, 2, figsize=(10.5, 8.4))
    for axis in grid.ravel():
        axis.set_axis_off()
    for axis, mode in zip(grid.ravel(), chosen, strict=False):
        sketch(axis, mode)
    return titled(figure, message(chosen))


def message(found: list[Mode]) -> str:
    """Return the title: frequencies of the bounce of body and frames, and the phase between these."""
    bounces = [mode for mode in found if name_of(mode).startswith("bounce of")]
    body, frames = (next(mode for mode in bounces if name_of(mode).endswith(word)) for word in ("body", "frame"))
    return f"The body bounces at {body.frequency:.1f} Hz, frames {phases(frames)[0]} at {frames.frequency:.1f} Hz"


def view_of(mode: Mode) -> str:
    """Return the view of a mode: from the side for bounce and pitch, from behind if more rolls than yaws, else from
    above.
    """
    sizes = {motion: max(abs(amplitude(mode, body, motion)) for body in BODIES) for motion in MOTIONS}
    if max(sizes["bounce"], sizes["pitch"]) > max(sizes["lateral"], sizes["yaw"], sizes["roll"]):
        return "from the side"
    return "from behind" if sizes["roll"] > sizes["yaw"] else "from above"


def displaced(mode: Mode, body: str, points: np.ndarray) -> np.ndarray:
    """Return the displacements of points of a body in a mode, ahead, to the left and up; each a row."""
    ahead, left, up, *turns = (mode.shape.get(f"{body}_{motion}", 0.0) for motion in MOTIONS)
    return np.array([ahead, left, up]) + np.cross(turns, points - BOXES[body][0])


def phases(mode: Mode) -> tuple[str, str]:
    """Return the phases between front and rear frame, and body and front frame: roll if viewed from behind, else at a
    pivot.
    """
    view = view_of(mode)
    if view == "from behind":
        front, rear, body = (mode.shape.get(f"{name}_roll", 0.0) for name in ("front_frame", "rear_frame", "body"))
    else:
        places = (("front_frame", PIVOT), ("rear_frame", -PIVOT), ("body", PIVOT))
        across = VIEWS[view][1]
        front, rear, body = (
            displaced(mode, name, np.array([[place, 0.0, BOXES[name][0][2]]]))[0, across] for name, place in places
        )
    return phase(front, rear), phase(body, front)


def sketch(axis: Axes, mode: Mode) -> None:
    """Draw body and frames at their largest displacement, over their places at rest, in one view."""
    view = view_of(mode)
    right, up, sign, middle = VIEWS[view]
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)])
    rest, moved = {}, {}
    for body, (centre, half) in BOXES.items():
        points = np.tile(np.array(centre), (5, 1))
        points[:, [right, up]] += corners * np.array(half)[[right, up]]
        rest[body], moved[body] = points, displaced(mode, body, points)
    largest = max((moved[body][:, axis] for body in BODIES for axis in (right, up)), key=lambda row: np.abs(row).max())
    scale = LARGEST / largest[np.argmax(np.abs(largest))]
    for body in BODIES:
        places = rest[body] + np.real(scale * moved[body])
        axis.plot(sign * rest[body][:, right], rest[body][:, up], ":", color=BOGIE, linewidth=1.0)
        fill = "none" if body == "body" else LEADING
        axis.fill(sign * places[:, right], places[:, up], edgecolor=BOGIE, facecolor=fill, linewidth=2.5)
    axis.set(xlim=(-WIDTH / 2, WIDTH / 2), ylim=(middle - HEIGHT / 2, middle + HEIGHT / 2), aspect="equal")
    frames, body = phases(mode)
    words = f"{mode.frequency:.2f} Hz: {name_of(mode)}, {view}\nframes {frames}, body and front one {body}"
    axis.set_title(words, fontsize=13)


SCENARIO = Scenario("vehicle-modes", "Natural modes of a complete vehicle and their shapes", run)
