"""The figure of a checked vehicle: its side view with sizes, its stopping distances, its modes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bogie_braking.hunting import FASTEST
from bogie_braking.reporting.plots import BOGIE, FOUR, LEADING, LINES, TRAILING, one_word, plt, titled
from bogie_braking.vehicle_files.check import KILOMETRES_PER_HOUR, OVERDAMPED, RAILS, SPEEDS, VehicleCheck
from rbd_model.vehicle.parameters import VehicleParameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Height of the drawn body above its lower edge [m]; nothing in a file gives it.
BODY = 2.6


def picture(check: VehicleCheck) -> Figure:
    """Return the figure of a check: the side view, and below it charts of stops and modes if they were computed."""
    charts = [draw for draw, known in ((stops, check.distances), (modes, check.modes)) if known is not None]
    figure = plt.figure(figsize=(10.0, 7.6 if charts else 3.6))
    grid = figure.add_gridspec(1 + bool(charts), max(len(charts), 1), height_ratios=(1.0, 1.25)[: 1 + bool(charts)])
    side_view(figure.add_subplot(grid[0, :]), check)
    for column, draw in enumerate(charts):
        draw(figure.add_subplot(grid[1, column]), check)
    return titled(figure, message(check))


def message(check: VehicleCheck) -> str:
    """Return the message: mass, and the dry stop from 120 km/h or the critical speed."""
    name, mass = one_word(check.sheet.name), f"{check.sheet.mass / 1e3:.1f} t"
    if check.distances is not None:
        at = SPEEDS.index(120.0)
        return f"{name}, {mass}: 120 km/h to rest in {check.distances[at, 0]:.0f} m (dry)"
    if check.hunting is not None:
        return f"{name}, {mass}, {hunting_words(check)}"
    return f"{name} has {mass} on {check.sheet.axles} axles"


def hunting_words(check: VehicleCheck) -> str:
    """Return the lower one of both critical speeds in words."""
    lowest = min(check.hunting.linear, check.hunting.large) if check.hunting else math.inf
    if math.isinf(lowest):
        return f"no hunting up to {FASTEST * KILOMETRES_PER_HOUR:.0f} km/h"
    return f"may hunt from {lowest * KILOMETRES_PER_HOUR:.0f} km/h"


def side_view(axis: Axes, check: VehicleCheck) -> None:
    """Draw the vehicle from the side, to scale but for the height of the body."""
    sheet, p = check.sheet, check.sheet.parameters
    radius = p.wheel_radius
    vehicle = sheet.vehicle
    places = [vehicle.number(wheelset.along) for wheelset in vehicle.wheelsets]
    length = p.coupler_distance if isinstance(p, VehicleParameters) else 1.4 * p.wheel_base
    length = max(length, 2 * max(places) + 2 * radius)
    floor = 2 * radius + 0.15
    axis.add_patch(plt.Rectangle((-length / 2, floor), length, BODY, facecolor="#e8eef4", edgecolor=BOGIE))
    axis.axhline(0.0, color=BOGIE, linewidth=2.5)
    for place, load in zip(places, check.loads, strict=True):
        axis.add_patch(plt.Circle((place, radius), radius, facecolor="white", edgecolor=BOGIE, linewidth=2.0))
        axis.annotate(f"{load / 1e3:.0f} kN", (place, -0.25), ha="center", va="top")
    height = p.body_height if isinstance(p, VehicleParameters) else p.frame_height
    axis.plot(0.0, height + radius, marker="x", markersize=11, color=TRAILING, markeredgewidth=2.5)
    axis.annotate(f"centre of mass {height + radius:.2f} m above the rail", (0.3, height + radius), va="center")
    sizes = f"{p.coupler_distance:.2f} m over the couplers, " if isinstance(p, VehicleParameters) else ""
    sizes += f"wheels {2e3 * radius:.0f} mm, axles {p.wheel_base:.2f} m apart"
    if isinstance(p, VehicleParameters):
        sizes += f", pivots {p.pivot_distance:.2f} m apart"
    axis.set(title=sizes, xlim=(-length / 2 - 1, length / 2 + 1), ylim=(-1.0, floor + BODY + 0.2), aspect="equal")
    axis.set_axis_off()
    axis.title.set_visible(True)


def stops(axis: Axes, check: VehicleCheck) -> None:
    """Draw stopping distances over the speed, a line for each rail."""
    axis.set(title="stopping distance [m], full brake, no protection", xlabel="speed [km/h]")
    assert check.distances is not None
    for rail, row, colour, dash in zip(RAILS, check.distances.T, FOUR, LINES, strict=True):
        axis.plot(SPEEDS, row, dash, color=colour, marker="o", label=rail)
    axis.set_ylim(bottom=0.0)
    axis.legend(title="rails")


def modes(axis: Axes, check: VehicleCheck) -> None:
    """Draw the damping of the modes over their frequency."""
    axis.set(title="modes at 10 m/s: share of critical damping", xlabel="frequency [Hz]")
    assert check.modes is not None
    shown = [mode for mode in check.modes if mode.damping_ratio < OVERDAMPED]
    axis.stem([one.frequency for one in shown], [one.damping_ratio for one in shown], linefmt=LEADING, basefmt=" ")
    axis.set_xscale("log")
    axis.set_xticks((0.5, 1, 2, 5, 10, 20, 50), labels=("0.5", "1", "2", "5", "10", "20", "50"))
    axis.set_ylim(bottom=min(0.0, *(one.damping_ratio for one in shown)))
    axis.annotate(hunting_words(check), (0.97, 0.95), xycoords="axes fraction", ha="right", va="top")
