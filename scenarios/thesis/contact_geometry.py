"""Contact of wheel and rail profiles over the lateral shift, section 4.3 (Figs 4.7, 4.8), and equivalent conicity."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from tqdm import tqdm

from rbd_model.contact.geometry import (
    Pair,
    contact_at,
    equivalent_conicity,
    european_pair,
    flange_contact_shift,
    last_tread_contact,
    thesis_pair,
)
from scenarios.cosimulation.recording import Recording
from scenarios.reporting.plots import LEADING, THESIS, TRAILING, mark, plt
from scenarios.reporting.report import Result, Row
from scenarios.scenario import Options, Scenario

SHIFTS = np.linspace(0.0, 9.0e-3, 91)
AMPLITUDES = np.linspace(1.0e-3, 9.0e-3, 33)
#: Amplitude at which the conicity is compared; the thesis's waves are of a few millimetres [m].
COMPARED = 3.0e-3


def run(options: Options) -> Result:
    pairs = {"thesis": thesis_pair(), "european": european_pair()}
    pair = pairs["thesis"]
    contacts = [contact_at(pair, shift) for shift in tqdm(SHIFTS, desc="contact-geometry", leave=False, delay=2.0)]
    conicity = {name: equivalent_conicity(one, AMPLITUDES, rolls=name == "thesis") for name, one in pairs.items()}
    flange, lost = flange_contact_shift(pair), last_tread_contact(pair).shift
    fitted = "the wheel is synthetic and fitted to this value: LW2 is not public"
    rows = [
        Row("lateral shift at flange contact", "mm", 9.5, 1e3 * flange, 0.1, "section 4.3, approximately", fitted),
        Row("lateral shift at loss of tread contact", "mm", 11.5, 1e3 * lost, 0.1, "section 9.4.1, around", fitted),
        Row(
            "equivalent conicity at 3 mm",
            "1",
            0.054,
            float(np.interp(COMPARED, AMPLITUDES, conicity["thesis"])),
            0.005,
            "section 4.4, from the wavelength (VAMPIRE 0.049)",
            "cone 1:20; R gamma / b more because the wheelset rolls on crowns of R = 300 mm",
        ),
    ]
    series = Recording({"shift": "m"}, [[shift] for shift in SHIFTS])
    for side, name in enumerate(("left", "right")):
        series.add(f"rolling_radius_{name}", "m", np.array([c.radius[side] for c in contacts]))
        series.add(f"contact_angle_{name}", "rad", np.array([c.angle[side] for c in contacts]))
        series.add(f"position_on_wheel_{name}", "m", np.array([c.position[side] for c in contacts]))
    series.add("roll", "rad", np.array([c.roll for c in contacts]))
    for name, values in conicity.items():
        series.add(f"equivalent_conicity_{name}", "1", np.interp(SHIFTS, AMPLITUDES, values))
    parameters = {name: f"{one.wheel.name} on {one.rail.name}, r0 {one.radius} m" for name, one in pairs.items()}
    remark = f"S1002 on 60E1: flange contact at {1e3 * flange_contact_shift(pairs['european']):.1f} mm."
    return Result(rows, series, lambda: draw(pair, series, flange), parameters, 0.0, [remark])


def draw(pair: Pair, series: Recording, flange: float) -> Figure:
    figure, grid = plt.subplots(2, 2, figsize=(9.5, 6.6))
    draw_profiles(grid[0, 0], pair)
    shift = 1e3 * series["shift"]
    difference = 1e3 * (series["rolling_radius_left"] - series["rolling_radius_right"])
    grid[0, 1].plot(shift, difference, color=LEADING)
    grid[0, 1].plot(shift, 2 * 0.05 * shift, ":", color=THESIS, label="cone 1:20, no roll")
    grid[0, 1].set_title("rolling radius difference [mm] (Fig. 4.8)")
    mark(grid[0, 1], 1e3 * flange, "flange")
    grid[0, 1].legend(loc="upper left")
    for side, colour in (("left", LEADING), ("right", TRAILING)):
        grid[1, 0].plot(shift, np.degrees(series[f"contact_angle_{side}"]), color=colour, label=side)
    grid[1, 0].set_title("contact angle [deg]")
    grid[1, 0].legend()
    low = series["shift"] >= AMPLITUDES[0]
    for name, colour, label in (
        ("thesis", LEADING, "synthetic wheel, 60 kg rail"),
        ("european", TRAILING, "S1002, 60E1 1:40, no roll"),
    ):
        grid[1, 1].plot(shift[low], series[f"equivalent_conicity_{name}"][low], color=colour, label=label)
    grid[1, 1].set_title("equivalent conicity [1] over amplitude")
    grid[1, 1].set_ylim(0.0, 0.6)
    grid[1, 1].legend()
    for axis in grid.flat[1:]:
        axis.set_xlabel("lateral shift or amplitude [mm]")
    figure.suptitle("Contact geometry of the profiles that stand for those of the thesis", x=0.02, ha="left")
    figure.set_layout_engine("constrained")
    return figure


def draw_profiles(axis: Axes, pair: Pair) -> None:
    """Wheel on rail at the centre, left side seen from behind, gauge corner to the right."""
    for profile, colour, label in ((pair.wheel, LEADING, "wheel"), (pair.rail, TRAILING, "rail")):
        y = np.linspace(*profile.limits, 1500)
        axis.plot(-1e3 * y, 1e3 * profile.height(y), color=colour, label=label)
    axis.set_aspect("equal")
    axis.set_ylim(-32, 8)
    axis.set_title("profiles at the centre [mm]")
    axis.legend(loc="lower left")


SCENARIO = Scenario(
    "contact-geometry",
    "Rolling radius difference, contact angles, conicity and the fold (section 4.3)",
    run,
    frozenset(),
)
