"""Contact of wheel and rail profiles over the lateral shift, section 4.3 (Figs 4.7, 4.8), and equivalent conicity.

Profiles may come from files, and may differ from side to side (EN 15302).
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.profiles.pair_picture import draw_pair
from bogie_braking.profiles.pair_running import (
    COMPARED,
    FILE_AMPLITUDES,
    FILE_SHIFTS,
    PRINTED,
    WORDS,
    Running,
    add_contacts,
    running_of,
)
from bogie_braking.profiles.profile_files import sides_from_files
from bogie_braking.reporting.plots import LEADING, THESIS, TRAILING, mark, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, measured, rounding
from bogie_braking.reporting.scenario import BadInputError, Options, Scenario
from fmu_src.cosimulation.recording import Recording
from rbd_model.contact.geometry import (
    Pair,
    Side,
    Sides,
    contact_at,
    equivalent_conicity,
    european_pair,
    flange_contact_shift,
    last_tread_contact,
    thesis_pair,
)
from rbd_model.contact.measured_pair import gauge_of

SHIFTS = np.linspace(0.0, 9.0e-3, 91)
AMPLITUDES = np.linspace(1.0e-3, 9.0e-3, 33)


def run(options: Options, quick: bool = False) -> Report:
    if options.given:
        try:
            return run_files(sides_from_files(options))
        except ValueError as error:
            raise BadInputError(str(error)) from error
    pairs = {"thesis": thesis_pair(), "european": european_pair()}
    pair = pairs["thesis"]
    contacts = [contact_at(pair, shift) for shift in counting(SHIFTS, "contact-geometry")]
    conicity = {name: equivalent_conicity(one, AMPLITUDES, rolls=name == "thesis") for name, one in pairs.items()}
    flange, lost = flange_contact_shift(pair), last_tread_contact(pair).shift
    fitted = "not judged: the wheel is synthetic and fitted to this value, as LW2 is not public"
    at_compared = float(np.interp(COMPARED, AMPLITUDES, conicity["thesis"]))
    wavelength = "section 4.4, from the wavelength"
    crowns = "cone 1:20; R gamma / b more because the wheelset rolls on crowns of R = 300 mm"
    rows = [
        Row("lateral shift at flange contact", "mm", 9.5, 1e3 * flange, None, "section 4.3, approximately", fitted),
        Row("lateral shift at loss of tread contact", "mm", 11.5, 1e3 * lost, None, "section 9.4.1, around", fitted),
        Row(
            "equivalent conicity at 3 mm", "1", 0.054, at_compared, rounding("0.054"), wavelength, crowns, vampire=0.049
        ),
    ]
    series = Recording({"shift": "m"}, [[shift] for shift in SHIFTS])
    add_contacts(series, contacts)
    series.add("roll", "rad", np.array([c.roll for c in contacts]))
    for name, values in conicity.items():
        series.add(f"equivalent_conicity_{name}", "1", np.interp(SHIFTS, AMPLITUDES, values))
    parameters = {name: f"{one.wheel.name} on {one.rail.name}, r0 {one.radius} m" for name, one in pairs.items()}
    remark = f"S1002 on 60E1: flange contact at {1e3 * flange_contact_shift(pairs['european']):.1f} mm."
    return Report(rows, series, lambda: draw(pair, series, flange), parameters, 0.0, [remark])


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
    for name, line, colour, label in (
        ("thesis", "-", LEADING, "synthetic wheel, 60 kg rail"),
        ("european", "--", TRAILING, "S1002, 60E1 1:40, no roll"),
    ):
        grid[1, 1].plot(shift[low], series[f"equivalent_conicity_{name}"][low], line, color=colour, label=label)
    grid[1, 1].set(title="equivalent conicity [1] over amplitude", ylim=(0.0, 0.6))
    grid[1, 1].legend()
    for axis in grid.flat[1:]:
        axis.set_xlabel("lateral shift or amplitude [mm]")
    conicity = float(np.interp(COMPARED, series["shift"], series["equivalent_conicity_thesis"]))
    return titled(figure, f"The synthetic wheel has a conicity of {conicity:.3f} at {1e3 * COMPARED:g} mm")


def draw_profiles(axis: Axes, pair: Pair) -> None:
    """Draw wheel on rail at the centre, left side viewed from the rear, gauge corner to the right."""
    for profile, colour, label in ((pair.wheel, LEADING, "wheel"), (pair.rail, TRAILING, "rail")):
        y = np.linspace(*profile.limits, 1500)
        axis.plot(-1e3 * y, 1e3 * profile.height(y), color=colour, label=label)
    axis.set(aspect="equal", ylim=(-32, 8), title="profiles at the centre [mm]")
    axis.legend(loc="lower left")


# -- profiles from files -------------------------------------------------------------------------------------------


def run_files(sides: Sides) -> Report:
    """Return the report of the level wheelset of EN 15302 on its track; no row has a limit: the standard sets none."""
    found = running_of(sides, FILE_SHIFTS, FILE_AMPLITUDES)
    parameters = {
        word: f"{one.wheel.source} on {one.rail.source}, rolling radius {1e3 * rolling(one):.6g} mm, y = 0 of the wheel"
        f" {1e3 * one.wheel_half_distance:.6g} mm and of the rail {1e3 * one.rail_half_distance:.6g} mm from the"
        f" middle, gauge side in the files: of the wheel {one.wheel.gauge_side}, of the rail {one.rail.gauge_side}"
        for word, one in zip(WORDS, sides.both, strict=True)
    }
    gauge = gauge_of(sides)
    measured = "not in the files of the rails" if gauge is None else f"{1e3 * gauge:.2f} mm"
    parameters["gauge, 14 mm below the tops"] = f"{measured} (EN 13848-1); --gauge lays the rails by it"
    texts = [f"{name.capitalize()}: {text}." for name, text in parameters.items()]
    return Report(
        rows_of_files(found),
        found.series,
        lambda: draw_pair(found),
        parameters,
        0.0,
        texts + [f"{note[0].upper()}{note[1:]}." for note in sides.notes],
        other_series={"conicity": found.conicity},
    )


def rolling(side: Side) -> float:
    """Return the radius at the tape circle [m]."""
    return side.radius - float(side.wheel.height(np.array(0.0)))


def rows_of_files(found: Running) -> list[Row]:
    source = "EN 15302, level wheelset"

    def row(quantity: str, unit: str, value: float, note: str = "") -> Row:
        return measured(quantity, unit, value if np.isfinite(value) else None, source, None, note)

    rows = [row("shift of equal rolling radii", "mm", 1e3 * found.centre, "to the left; the wheelset runs about it")]
    for word, flange, angle in zip(WORDS, found.flanges, found.centred.angle, strict=True):
        rows.append(row(f"shift to the {word} at flange contact", "mm", 1e3 * flange))
        rows.append(row(f"contact angle {word}, running centred", "deg", float(np.degrees(angle))))
    for amplitude in PRINTED:
        touched = "; ".join(found.notes_at(amplitude))
        rows.append(row(f"equivalent conicity at {1e3 * amplitude:g} mm", "1", found.conicity_at(amplitude), touched))
    return rows


SCENARIO = Scenario(
    "contact-geometry",
    "Rolling radius difference, contact angles, conicity and the fold (section 4.3)",
    run,
    frozenset(
        {
            "wheel",
            "rail",
            "diameter",
            "gauge",
            "flange_back",
            "inclination",
            "gauge_side",
            "tape_circle",
            "drop_outliers",
        }
    ),
)
