"""Contact of wheel and rail profiles over the lateral shift, section 4.3 (Figs 4.7, 4.8), and equivalent conicity.

Profiles may come from files, and may differ from side to side (EN 15302).
"""

from typing import TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmu_src.cosimulation.recording import Recording
from rbd_model.contact.geometry import (
    ON_FLANGE,
    ContactAtShift,
    Pair,
    Side,
    Sides,
    centred_shift,
    contact_at,
    equivalent_conicity,
    european_pair,
    flange_contact_shift,
    last_tread_contact,
    thesis_pair,
)
from scenarios.bench.profile_files import gauge_of, sides_from_files
from scenarios.reporting.plots import LEADING, THESIS, TRAILING, mark, plt, titled
from scenarios.reporting.progress import counting
from scenarios.reporting.report import Report, Row, measured, rounding
from scenarios.scenario import BadInputError, Options, Scenario

SHIFTS = np.linspace(0.0, 9.0e-3, 91)
AMPLITUDES = np.linspace(1.0e-3, 9.0e-3, 33)
#: Amplitude at which the conicity is compared; the thesis's waves are of a few millimetres [m].
COMPARED = 3.0e-3
WORDS = ("left", "right")
Places = TypeVar("Places", float, np.ndarray)


def run(options: Options) -> Report:
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


def add_contacts(series: Recording, contacts: list[ContactAtShift]) -> None:
    for side, name in enumerate(WORDS):
        series.add(f"rolling_radius_{name}", "m", np.array([c.radius[side] for c in contacts]))
        series.add(f"contact_angle_{name}", "rad", np.array([c.angle[side] for c in contacts]))
        series.add(f"position_on_wheel_{name}", "m", np.array([c.position[side] for c in contacts]))


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

#: Shifts of the tables, to the left, and amplitudes at which annex E of EN 15302 gives the conicity [m].
FILE_SHIFTS = np.linspace(-8.0e-3, 8.0e-3, 161)
FILE_AMPLITUDES = np.linspace(1.0e-3, 7.5e-3, 66)
#: A contact closer to the end of a profile than this is on its end [m].
LEAST_MARGIN = 1e-3
#: Amplitudes in the printed table [m]; limits are set for 3 mm.
PRINTED = (1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3)


def run_files(sides: Sides) -> Report:
    """Return the report of the level wheelset of EN 15302 on its track; no row has a limit: the standard sets none."""
    centre = centred_shift(sides, rolls=False)
    there = contact_at(sides, centre, rolls=False)
    if not fits(sides, there):
        raise BadInputError(
            f"Running centred, {1e3 * centre:.3g} mm to the left, a wheel stands on its flange or an end of a profile,"
            " and the wheelset does not fit the track. Change --gauge, --flange-back or where the profiles have y = 0."
        )
    contacts = [contact_at(sides, shift, rolls=False) for shift in FILE_SHIFTS]
    conicity = Recording({"amplitude": "m"}, [[amplitude] for amplitude in FILE_AMPLITUDES])
    conicity.add("equivalent_conicity", "1", equivalent_conicity(sides, FILE_AMPLITUDES, rolls=False))
    series = Recording({"shift": "m"}, [[shift] for shift in FILE_SHIFTS])
    add_contacts(series, contacts)
    series.add("radius_difference", "m", np.array([contact.radius_difference for contact in contacts]))
    for one, word, sign in ((sides.left, "left", 1), (sides.right, "right", -1)):
        on_wheel = series[f"position_on_wheel_{word}"]
        series.add(f"position_on_rail_{word}", "m", on_rail(one, on_wheel, sign * FILE_SHIFTS))
    flanges = [flange_contact_shift(one, rolls=False) for one in (sides, sides.mirrored)]
    parameters = {
        word: f"{one.wheel.source} on {one.rail.source}, rolling radius {1e3 * rolling(one):.6g} mm, y = 0 of the wheel"
        f" {1e3 * one.wheel_half_distance:.6g} mm and of the rail {1e3 * one.rail_half_distance:.6g} mm from the"
        f" middle, gauge side in the files: of the wheel {one.wheel.gauge_side}, of the rail {one.rail.gauge_side}"
        for word, one in zip(WORDS, sides.both, strict=True)
    }
    gauge = gauge_of(sides)
    measured = "not in the files of the rails" if gauge is None else f"{1e3 * gauge:.2f} mm"
    parameters["gauge, 14 mm below the tops"] = f"{measured} (EN 13848-1); --gauge lays the rails by it"
    return Report(
        rows_of_files(there, flanges, conicity),
        series,
        lambda: draw_files(sides, series, conicity, centre, flanges),
        parameters,
        0.0,
        [f"{name.capitalize()}: {text}." for name, text in parameters.items()],
        other_series={"conicity": conicity},
    )


def on_rail(side: Side, on_wheel: Places, outwards: Places) -> Places:
    """Return the place on the rail [m] that a level wheel touches after a displacement `outwards`."""
    return on_wheel + side.wheel_half_distance - side.rail_half_distance + outwards


def fits(sides: Sides, contact: ContactAtShift) -> bool:
    """Return whether both wheels rest on their treads and on the rails' heads, and not on an end of a profile."""
    ends = []
    for one, position, sign in zip(sides.both, contact.position, (1, -1), strict=True):
        for profile, place in ((one.wheel, position), (one.rail, on_rail(one, position, sign * contact.shift))):
            ends += [place - profile.limits[0], profile.limits[1] - place]
    return max(contact.angle) < ON_FLANGE and min(ends) > LEAST_MARGIN


def rolling(side: Side) -> float:
    """Return the radius at the tape circle [m]."""
    return side.radius - float(side.wheel.height(np.array(0.0)))


def rows_of_files(centred: ContactAtShift, flanges: list[float], conicity: Recording) -> list[Row]:
    source = "EN 15302, level wheelset"

    def row(quantity: str, unit: str, value: float, note: str = "") -> Row:
        return measured(quantity, unit, value if np.isfinite(value) else None, source, None, note)

    rows = [row("shift of equal rolling radii", "mm", 1e3 * centred.shift, "to the left; the wheelset runs about it")]
    for word, flange, angle in zip(WORDS, flanges, centred.angle, strict=True):
        rows.append(row(f"shift to the {word} at flange contact", "mm", 1e3 * flange))
        rows.append(row(f"contact angle {word}, running centred", "deg", float(np.degrees(angle))))
    for amplitude in PRINTED:
        value = float(np.interp(amplitude, conicity["amplitude"], conicity["equivalent_conicity"]))
        rows.append(row(f"equivalent conicity at {1e3 * amplitude:g} mm", "1", value))
    return rows


def draw_files(sides: Sides, series: Recording, conicity: Recording, centre: float, flanges: list[float]) -> Figure:
    figure, grid = plt.subplots(3, 2, figsize=(9.5, 8.6), height_ratios=(0.55, 1.0, 1.0))
    draw_contacts(grid[0, 0], sides.left, series, "left")
    draw_contacts(grid[0, 1], sides.right, series, "right")
    shift = 1e3 * series["shift"]
    inside = (series["shift"] > -flanges[1]) & (series["shift"] < flanges[0])
    difference = 1e3 * series["radius_difference"]
    grid[1, 0].plot(shift, difference, color=LEADING)
    limit = max(0.1, 1.3 * np.max(np.abs(difference[inside])))
    grid[1, 0].set_ylim(-limit, limit)
    grid[1, 0].axhline(0.0, color="#999999", linewidth=0.8)
    mark(grid[1, 0], 1e3 * centre, "equal radii")
    grid[1, 0].set_title("rolling radius difference, left less right [mm]")
    for side, colour in zip(WORDS, (LEADING, TRAILING), strict=True):
        grid[1, 1].plot(shift, np.degrees(series[f"contact_angle_{side}"]), color=colour, label=side)
        grid[2, 1].plot(shift, 1e3 * series[f"position_on_wheel_{side}"], color=colour, label=f"on the {side} wheel")
        grid[2, 1].plot(shift, 1e3 * series[f"position_on_rail_{side}"], ":", color=colour, label=f"on the {side} rail")
    grid[1, 1].set_title("contact angle [deg]")
    grid[2, 1].set_title("contact point, to the field side of y = 0 [mm]")
    grid[2, 0].plot(1e3 * conicity["amplitude"], conicity["equivalent_conicity"], color=LEADING)
    grid[2, 0].set_ylim(min(0.0, 1.1 * np.min(conicity["equivalent_conicity"])), None)
    grid[2, 0].set(title="equivalent conicity [1] over amplitude", xlabel="amplitude [mm]")
    for axis in (grid[1, 0], grid[1, 1], grid[2, 1]):
        axis.set_xlabel("shift to the left [mm]")
    for axis in (grid[1, 1], grid[2, 1]):
        axis.legend()
    at_compared = float(np.interp(COMPARED, conicity["amplitude"], conicity["equivalent_conicity"]))
    return titled(figure, f"The profiles have a conicity of {at_compared:.3f} at {1e3 * COMPARED:g} mm")


#: Height at which the wheels are drawn above the rails [mm], and number of shifts between drawn contacts.
RAISED, EVERY = 12.0, 10


def draw_contacts(axis: Axes, side: Side, series: Recording, word: str) -> None:
    """Draw a wheel above its rail, from the rear, and lines between the contact points at integer millimetres."""
    outwards = -1.0 if word == "left" else 1.0
    wheel_zero, rail_zero = (float(profile.height(np.array(0.0))) for profile in (side.wheel, side.rail))
    apart = side.rail_half_distance - side.wheel_half_distance
    for profile, colour, zero, raised, moved in (
        (side.wheel, LEADING, wheel_zero, RAISED, 0.0),
        (side.rail, TRAILING, rail_zero, 0.0, apart),
    ):
        y = np.linspace(*profile.limits, 1500)
        axis.plot(1e3 * outwards * (y + moved), 1e3 * (profile.height(y) - zero) + raised, color=colour)
    on_wheel = series[f"position_on_wheel_{word}"][::EVERY]
    below = series[f"position_on_rail_{word}"][::EVERY]
    ends = np.array([on_wheel, below + apart]) * 1e3 * outwards
    on_top = 1e3 * (side.wheel.height(on_wheel) - wheel_zero) + RAISED
    heights = np.array([on_top, 1e3 * (side.rail.height(below) - rail_zero)])
    axis.plot(ends, heights, color="#999999", linewidth=0.8)
    axis.set(aspect="equal", ylim=(-20, 22))
    axis.set_title(f"{word} wheel raised over its rail [mm], contacts every mm of shift", fontsize=9)


SCENARIO = Scenario(
    "contact-geometry",
    "Rolling radius difference, contact angles, conicity and the fold (section 4.3)",
    run,
    frozenset({"wheel", "rail", "diameter", "gauge", "flange_back", "inclination", "gauge_side"}),
)
