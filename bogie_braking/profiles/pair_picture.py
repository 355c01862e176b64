"""The picture of a pair of profiles as it runs: contacts, patches, radius difference, angles, conicity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from bogie_braking.profiles.pair_running import COMPARED, WORDS, Running
from bogie_braking.reporting.plots import LEADING, THREE, TRAILING, mark, plt, titled, widen
from rbd_model.contact.geometry import Side

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Limits of a wheel's patches in its profile [m], by side.
Patches = Mapping[str, Sequence[tuple[float, float]]]
#: Height at which the wheels are drawn above the rails [mm], and number of shifts between drawn contacts.
RAISED, EVERY = 12.0, 10
GREY = "#999999"
#: Least range of the axes of contact angles [deg], contact points [mm] and conicity [1].
LEAST_ANGLE, LEAST_SHIFT, LEAST_CONICITY = 0.1, 0.1, 1e-3


def draw_pair(found: Running, patches: Patches | None = None, title: str = "") -> Figure:
    """Draw a pair as it runs."""
    figure, grid = plt.subplots(3, 2, figsize=(9.5, 8.6), height_ratios=(0.55, 1.0, 1.0))
    for axis, one, word in zip(grid[0], found.sides.both, WORDS, strict=True):
        draw_contacts(axis, one, found, word, (patches or {}).get(word, ()))
    _draw_difference(grid[1, 0], found)
    series, shift = found.series, 1e3 * found.series["shift"]
    for side, colour in zip(WORDS, (LEADING, TRAILING), strict=True):
        grid[1, 1].plot(shift, np.degrees(series[f"contact_angle_{side}"]), color=colour, label=side)
        grid[2, 1].plot(shift, 1e3 * series[f"position_on_wheel_{side}"], color=colour, label=f"on the {side} wheel")
        grid[2, 1].plot(shift, 1e3 * series[f"position_on_rail_{side}"], ":", color=colour, label=f"on the {side} rail")
    grid[1, 1].set_title("contact angle [deg]")
    grid[2, 1].set_title("contact point, to the field side of y = 0 [mm]")
    conicity = found.conicity["equivalent_conicity"]
    grid[2, 0].plot(1e3 * found.conicity["amplitude"], conicity, color=LEADING)
    grid[2, 0].set_ylim(min(0.0, 1.1 * np.min(conicity)), None)
    grid[2, 0].set(title="equivalent conicity [1] over amplitude", xlabel="amplitude [mm]")
    for axis, least in ((grid[1, 1], LEAST_ANGLE), (grid[2, 1], LEAST_SHIFT), (grid[2, 0], LEAST_CONICITY)):
        widen(axis, least)
    for axis in (grid[1, 0], grid[1, 1], grid[2, 1]):
        axis.set_xlabel("shift to the left [mm]")
    grid[1, 1].legend()
    grid[2, 1].legend(ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.2))  # below the chart, which data may fill
    at_compared = found.conicity_at(COMPARED)
    return titled(figure, title or f"The profiles have a conicity of {at_compared:.3f} at {1e3 * COMPARED:g} mm")


def _draw_difference(axis: Axes, found: Running) -> None:
    """Draw the radius difference over the shift; between the flange contacts it fills the axis."""
    shift = found.series["shift"]
    inside = (shift > -found.flanges[1]) & (shift < found.flanges[0])
    difference = 1e3 * found.series["radius_difference"]
    axis.plot(1e3 * shift, difference, color=LEADING)
    limit = max(0.1, 1.3 * np.max(np.abs(difference[inside]), initial=0.0))
    axis.set_ylim(-limit, limit)
    axis.axhline(0.0, color=GREY, linewidth=0.8)
    mark(axis, 1e3 * found.centre, "equal radii")
    axis.set_title("rolling radius difference, left less right [mm]")


def draw_contacts(
    axis: Axes, side: Side, found: Running, word: str, patches: Sequence[tuple[float, float]] = ()
) -> None:
    """Draw a wheel above its rail, from the rear, and lines between the contact points at integer millimetres."""
    outwards = -1.0 if word == "left" else 1.0
    wheel_zero, rail_zero = (float(profile.height(np.array(0.0))) for profile in (side.wheel, side.rail))
    rail_zero = 0.0 if np.isnan(rail_zero) else rail_zero
    apart = side.rail_half_distance - side.wheel_half_distance
    for profile, colour, zero, raised, moved in (
        (side.wheel, LEADING, wheel_zero, RAISED, 0.0),
        (side.rail, TRAILING, rail_zero, 0.0, apart),
    ):
        y = np.linspace(*profile.limits, 1500)
        axis.plot(1e3 * outwards * (y + moved), 1e3 * (profile.height(y) - zero) + raised, color=colour)
    for number, limits in enumerate(patches):
        y = np.linspace(*limits, 200)
        height = 1e3 * (side.wheel.height(y) - wheel_zero) + RAISED
        axis.plot(1e3 * outwards * y, height, color=THREE[number % len(THREE)], linewidth=4.0)
    on_wheel = found.series[f"position_on_wheel_{word}"][::EVERY]
    below = found.series[f"position_on_rail_{word}"][::EVERY]
    ends = np.array([on_wheel, below + apart]) * 1e3 * outwards
    on_top = 1e3 * (side.wheel.height(on_wheel) - wheel_zero) + RAISED
    heights = np.array([on_top, 1e3 * (side.rail.height(below) - rail_zero)])
    axis.plot(ends, heights, color=GREY, linewidth=0.8)
    axis.set(aspect="equal", ylim=(-20, 22))
    text = f"{word} wheel raised over its rail [mm], contacts every mm of shift"
    if patches:
        text = f"{word}: {len(patches)} patch{'es' * (len(patches) > 1)}, contacts every mm of shift [mm]"
    axis.set_title(text, fontsize=9)
