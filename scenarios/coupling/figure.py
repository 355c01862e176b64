"""The figure of the study of the macro step: error, chatter in time, its size, and the boundary of the feedback."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE as GREY
from bogie_braking.reporting.plots import LEADING, THESIS, TRAILING, plt, titled
from fmu_src.cosimulation.master import GAUSS_SEIDEL, JACOBI
from products.bogie import BOGIE
from scenarios.coupling import signed_torque
from scenarios.coupling.error import MASTERS, error_on_paper, order
from scenarios.coupling.feedback_boundary import SPEED, boundary_on_paper, pressure_per_slip
from scenarios.coupling.findings import Findings

COLOUR = {JACOBI: LEADING, GAUSS_SEIDEL: TRAILING}
#: Jacobi larger and hollow, Gauss-Seidel smaller and filled: coinciding points remain visible.
POINT: dict[str, dict[str, Any]] = {
    JACOBI: {"markersize": 8.0, "markerfacecolor": "none", "linestyle": "none"},
    GAUSS_SEIDEL: {"markersize": 4.0, "linestyle": "none"},
}
#: Shown part of the stop [s], and macro step of the chatter there [s].
WINDOW, SHOWN = (0.25, 0.85), 1e-2
#: Number of macro steps of the theoretical boundaries.
FINE = 120


def draw(f: Findings) -> Figure:
    figure, grid = plt.subplots(2, 2, figsize=(12.0, 9.0))
    draw_errors(grid[0, 0], f)
    draw_chatter(grid[0, 1], f)
    draw_jumps(grid[1, 0], f)
    draw_boundaries(grid[1, 1], f)
    for axis in (grid[0, 0], grid[1, 0], grid[1, 1]):
        axis.set(xscale="log", yscale="log")
        axis.xaxis.set_major_formatter("{x:g}")
        axis.yaxis.set_major_formatter("{x:g}")
        axis.set_xlabel("macro step [ms]")
    held, lines = (
        order(list(steps), [step.distance for step in steps.values()])
        for steps in (dict(sorted(f.errors[f"Jacobi, {inputs}"].items())) for inputs in ("held", "lines"))
    )
    return titled(figure, f"Held inputs converge with order {held:.1f}, lines with order {lines:.1f}")


def draw_errors(axis: Axes, f: Findings) -> None:
    for name, master in MASTERS.items():
        steps = np.array(sorted(f.errors[name]))
        colour, marker = COLOUR[master.method], "s" if master.extrapolated else "o"
        errors = [abs(f.errors[name][step].distance) for step in steps]
        paper = [abs(error_on_paper(master, step, f.stop).distance) for step in steps]
        axis.plot(1e3 * steps, 1e3 * np.array(paper), color=colour, linewidth=1.0)
        axis.plot(1e3 * steps, 1e3 * np.array(errors), marker, color=colour, label=name, **POINT[master.method])
    axis.set_title("Torque as a capacity: error of the stop distance [mm],\nstop from 3 m/s in 3.6 m")
    axis.annotate("order 1", (4.0, 8.0), ha="right", fontsize=8)
    axis.annotate("order 2", (4.0, 0.05), ha="right", fontsize=8)
    axis.legend(loc="upper left")


def draw_chatter(axis: Axes, f: Findings) -> None:
    for chatter, colour, label in (
        (f.stops[SHOWN], TRAILING, f"torque with sign, from the last macro step of {1e3 * SHOWN:g} ms"),
        (f.capacity, LEADING, "torque as a capacity"),
    ):
        time = chatter.series["time"]
        kept = (time >= WINDOW[0]) & (time <= WINDOW[1])
        rim = BOGIE.wheel_radius * chatter.series["angular_velocity_2"][kept]
        axis.plot(time[kept], 1e3 * rim, color=colour, label=label)
    axis.set(title="The end of a stop:\nspeed of the trailing wheels' rim [mm/s]", xlabel="time [s]")
    axis.legend(loc="upper right")
    axis.margins(y=0.15)


def draw_jumps(axis: Axes, f: Findings) -> None:
    steps = np.array(sorted(f.stops))
    fine = np.geomspace(steps[0], steps[-1], 2)
    lines = (
        (signed_torque.jump_in_skid, "-", GREY, r"free wheelset: $h\,T\,r/J$"),
        (signed_torque.jump_at_rest, "-", THESIS, r"rolling wheelset: $h\,T\,r/(J + m\,r^2)$"),
        (signed_torque.jump_of_whole_bogie, "--", THESIS, "whole bogie: h times its deceleration"),
    )
    for paper, style, colour, label in lines:
        axis.plot(1e3 * fine, [1e3 * paper(step) for step in fine], style, color=colour, linewidth=1.0, label=label)
    for chatters, marker, colour, label in (
        (f.skids, "s", GREY, "found: wheels in a skid, adhesion 0.1"),
        (f.stops, "o", THESIS, "found: bogie that should stand"),
    ):
        jumps = [1e3 * chatters[step].jump for step in steps]
        axis.plot(1e3 * steps, jumps, marker, color=colour, markersize=5.0, label=label)
    axis.set_title("Torque with sign:\njump of the rim speed in each macro step [mm/s]")
    axis.legend(loc="upper left", fontsize=8)


def draw_boundaries(axis: Axes, f: Findings) -> None:
    steps = np.array(sorted(f.found[JACOBI]))
    fine = np.geomspace(steps[0], steps[-1], FINE)
    for method in (GAUSS_SEIDEL, JACOBI):
        label = {JACOBI: "Jacobi", GAUSS_SEIDEL: "Gauss-Seidel"}[method]
        paper = [boundary_on_paper(f.plant, method, step) for step in fine]
        axis.plot(1e3 * fine, paper, color=COLOUR[method], linewidth=1.0)
        found = [f.found[method][step] for step in steps]
        axis.plot(1e3 * steps, found, "o", color=COLOUR[method], label=label, **POINT[method])
    axis.set_title("Slip fed back to the pressure:\nloop gain [1] above which errors grow")
    axis.set_ylabel(f"1 is {pressure_per_slip(f.plant) / 1e5:.0f} kPa per % of slip, at {SPEED:g} m/s")
    axis.annotate(
        "pitching grows",
        (66.0, 4.0),
        xytext=(-10, -22),
        textcoords="offset points",
        ha="right",
        fontsize=8,
        arrowprops={"arrowstyle": "-", "color": GREY, "linewidth": 0.6},
    )
    axis.annotate("grows", (0.75, 0.75), xycoords="axes fraction")
    axis.annotate("decays", (0.2, 0.2), xycoords="axes fraction")
    axis.legend(loc="upper right")
