"""S1002 on UIC60 over the lateral shift, where contact jumps and splits: contact models against exact theory."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

from bogie_braking.reporting.plots import BOGIE, FOUR, LEADING, THESIS, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, value_of
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from fmu_src.symbols import ca
from fmu_src.system import System
from rbd_model.body.kinematics import direction_cosines, turned_by
from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.kalker import smooth_kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins
from rbd_model.contact.creep_of_wheel import creep_of_wheel
from rbd_model.contact.depth import Contact
from rbd_model.contact.distance import LEFT, RIGHT, Stand, Strips, stand_of, strips_at, touching
from rbd_model.contact.geometry import STANDARD_GAUGE, Pair
from rbd_model.contact.hertz import POISSON_RATIO, moving_ellipse
from rbd_model.contact.normal import Steel, patches
from rbd_model.contact.pair_table import patch_record
from rbd_model.contact.patches import WheelPart, patches_of
from rbd_model.contact.profiles import from_points, wheel_s1002
from rbd_model.contact.strips import WheelVelocity, creepages_of, place_of, rolling, total, under_load
from rbd_model.wheelset.pressing_patch import PatchConstants, PatchState, TurningTrack, find_patch, press
from rbd_model.wheelset.touch import Wheel
from rbd_model.wheelset.touching_patch import InNumbers, part_of_patch
from scenarios.bench.wheel_on_strips import CONSTANT_FRICTION, NO_SPEED, wheel_under_load
from scenarios.benchmark.case_file import CASES, read_case

#: The benchmark: load of each wheel [N], speed [m/s], friction, steel.
LOAD, SPEED, FRICTION, STEEL = 10e3, 2.0, 0.3, Steel(82e9, 0.28)
#: y of the rail's gauge face, 14 mm below the top, half distance of the wheels' origins, and radius there [m].
GAUGE_FACE, WHEEL_HALF_DISTANCE, RADIUS = -43.0315e-3, 0.750, 0.460
SIDES = {"left": LEFT, "right": RIGHT}
#: Exact theory of the benchmark.
EXAMPLE = read_case(CASES / "manchester-contact.toml")
#: An approach at which any contact carries more than the load [m].
MOST_APPROACH = 0.3e-3
#: Contact model 2 with the default law of the level `spatial`, and with others.
ON_PATCHES = Contact(2)
OTHER_LAWS = {
    "Polach's law": Contact(2, polach, polach),
    "Shen, Hedrick and Elkins on the flange": Contact(2, flange_law=shen_hedrick_elkins),
    "FASTSIM 5 x 5 on the flange": Contact(2, flange_law=fastsim(5)),
    f"the same law at a Poisson's ratio of {STEEL.poisson_ratio:g}": Contact(2, poisson_ratio=STEEL.poisson_ratio),
}


@lru_cache
def manchester_pair() -> Pair:
    """Return S1002 on UIC60 of the Manchester benchmark, gauge 1435 mm; y = 0 of this rail is its top.

    The rail is read from its points. Arcs of 60E1 are within 2 um of it, but change the share of a second patch by a
    tenth.
    """
    rail = from_points("UIC60, 1:40", "Manchester contact benchmark", *(np.array(list(table("rail").values())) / 1e3))
    return Pair(wheel_s1002(), rail, RADIUS, WHEEL_HALF_DISTANCE, STANDARD_GAUGE / 2 - GAUGE_FACE)


def table(name: str) -> dict[str, np.ndarray]:
    """Return the columns of numbers of manchester_NAME.csv."""
    text = (Path(__file__).parent / f"manchester_{name}.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    return {head: np.array([float(row[head]) for row in rows]) for head in rows[0] if head != "wheel"}


@dataclass(frozen=True)
class ContactResult:
    """Results of a method on one wheel: position on the rail [m], contact angle [rad], forces on the rail ahead and
    outwards of the track [N], largest pressure [Pa].
    """

    place: float
    angle: float
    ahead: float
    outwards: float
    pressure: float


def exact(name: str) -> dict[float, ContactResult]:
    """Return the exact theory by shift [mm] for the wheel of this name, in the axes of that wheel."""
    outwards = -SIDES[name]
    points = [point for point in EXAMPLE.points if point.inputs["wheel"] == name]
    answers = ("place", "angle", "force_along", "force_across", "pressure")
    rows = [[one.published[answer] for answer in answers] for one in points]
    shifts = [round(1e3 * float(np.asarray(one.inputs["lateral"])), 9) for one in points]
    return {
        shift: ContactResult(outwards * place, -outwards * angle, ahead, outwards * aside, pressure)
        for shift, (place, angle, ahead, aside, pressure) in zip(shifts, rows, strict=True)
    }


def case(name: str, shift: float) -> tuple[Stand, WheelVelocity]:
    """Return position and velocity of the wheelset at a shift [mm], in the axes of the named wheel; linear between
    rows.
    """
    course = table("course")
    roll, yaw, pitch_rate = (
        float(np.interp(shift, course["y_ws_mm"], course[head])) for head in ("roll_rad", "yaw_rad", "pitch_rate_rad_s")
    )
    # The benchmark's y and z point to the right and down.
    stand = stand_of(SIDES[name], -shift / 1e3, 0.0, roll, -yaw)
    return stand, rolling(stand, SPEED, -pitch_rate)


def depth_1(stand: Stand, motion: WheelVelocity) -> ContactResult:
    """Return one ellipse where the rigid profiles touch, Hertz and Polach: the contact of the level `spatial`."""
    pair = manchester_pair()
    _, place = touching(pair, stand)
    strip = strips_at(pair, stand, np.array([place]))
    angle, creepages = float(strip.angle[0]), creepages_of(strip, motion)
    sliding = (creepages.ahead[0], creepages.aside[0], creepages.spin[0])
    curvatures = float(strip.curvature[0]), curvature_across(pair, strip)

    def up(load: float) -> float:
        return load * math.cos(angle) + float(one_ellipse()(load, *curvatures, *sliding)[1]) * math.sin(angle) - LOAD

    load = float(brentq(up, 0.1 * LOAD, 10 * LOAD))
    ahead, aside, pressure = (float(value) for value in one_ellipse()(load, *curvatures, *sliding))
    outwards = aside * math.cos(angle) - load * math.sin(angle)
    return ContactResult(float(strip.on_rail[0]), angle, -ahead, -outwards, pressure)


def curvature_across(pair: Pair, strip: Strips) -> float:
    """Return B of eq. (3.83), half the difference of the contours' curvatures [1/m]."""
    bends = [
        profile.height(place, 2)[0] / (1 + profile.height(place, 1)[0] ** 2) ** 1.5
        for profile, place in ((pair.wheel, strip.on_wheel), (pair.rail, strip.on_rail))
    ]
    return float(bends[0] - bends[1]) / 2


@lru_cache
def one_ellipse() -> ca.Function:
    """Return a function of load, A, B and creepages: creep forces on the wheel and largest pressure; Hertz, Polach."""
    load, along, across, *creepages = (ca.SX.sym(name) for name in ("load", "along", "across", "x", "y", "spin"))
    logarithm, size = moving_ellipse(along, across, load, ca.SX(STEEL.shear_modulus))
    axes = (size * ca.exp(logarithm / 2), size * ca.exp(-logarithm / 2))
    kalker = smooth_kalker_coefficients(logarithm)
    patch = ContactPatch(
        (creepages[0], creepages[1], creepages[2]), load, ca.SX(FRICTION), axes, ca.SX(STEEL.shear_modulus), kalker
    )
    pressure = 1.5 * load / (ca.pi * axes[0] * axes[1])
    return ca.Function("one_ellipse", [load, along, across, *creepages], [*polach(patch), pressure])


@dataclass(frozen=True)
class Elastic:
    """A patch of model 2 by CasADi: `Bearing` of how a wheel stands and moves."""

    bearing: ca.Function

    def at(self, given: np.ndarray) -> PatchContact:
        """Return the contact for one position and velocity of the wheel."""
        return PatchContact(*self.bearing(given).full().ravel().tolist())


@dataclass(frozen=True)
class PatchContact:
    """Contact of one patch of model 2: forces on the wheel, ahead, outwards and up [N], normal force [N], largest
    pressure [Pa], position on wheel and rail [m], contact angle [rad].
    """

    ahead: float
    outwards: float
    up: float
    load: float
    pressure: float
    on_wheel: float
    on_rail: float
    angle: float


@lru_cache
def elastic_patches(contact: Contact) -> list[Elastic]:
    """Return the patches of the level `spatial` at contact model 2, on the left wheel."""
    return [elastic_patch(patch, contact) for patch in patches_of(manchester_pair().left)]


def elastic_patch(part: WheelPart, contact: Contact) -> Elastic:
    """Return one patch as a function of lateral position, height, yaw, roll, speed and rates of rotation in the
    wheelset's axes.
    """
    pair, system, modulus = manchester_pair(), System("patch", "one patch"), ca.SX(STEEL.shear_modulus)
    given = ca.SX.sym("given", 8)
    lateral, height, yaw, roll, forward, roll_rate, pitch_rate, yaw_rate = ca.vertsplit(given)
    cosines = direction_cosines(yaw, roll)
    wheel = Wheel(*map(ca.SX, (LEFT, pair.radius, pair.wheel_half_distance, pair.rail_half_distance)))
    still, rates, place = ca.SX(0), (roll_rate, pitch_rate, yaw_rate), (lateral, height, yaw, roll)
    state = PatchState(forward, still, still, *rates, *place, ca.SX.zeros(2), ca.SX(FRICTION))
    steel = ca.SX(NO_SPEED), modulus, ca.SX(CONSTANT_FRICTION)
    fixed = PatchConstants(cosines, wheel.vector, *steel, still, gauge_face=ca.SX(1))
    touching = part_of_patch("manchester", InNumbers(patch_record(pair.left, part)))
    found = find_patch(system, state, fixed, touching, contact.poisson_ratio)
    creeping = creep_of_wheel(contact.law_of(part.flange), "flange" if part.flange else "tread")
    pressed = press(system, state, TurningTrack.straight(), fixed, found, creeping)
    shape = found.curvature_along, found.curvature_across
    pressure = 1.5 * found.load / (ca.pi * moving_ellipse(*shape, found.load, modulus, contact.poisson_ratio)[1] ** 2)
    on_rail = lateral + (turned_by(cosines) @ found.arm)[1] - pair.rail_half_distance
    angle = ca.atan2(-found.across[0], found.across[1])
    results = system.expand(ca.vertcat(pressed.force, found.load, pressure, found.position, on_rail, angle))
    return Elastic(ca.Function("bearing", [given], [results]))


def bearings(stand: Stand, motion: WheelVelocity, contact: Contact = ON_PATCHES) -> list[PatchContact]:
    """Return all patches of a wheel at the height at which they carry the load.

    The axes make every wheel a left one.
    """
    top, _ = touching(manchester_pair(), stand)
    axes = turned_by(direction_cosines(ca.SX(stand.yaw), ca.SX(stand.roll)))
    own_rate = ca.evalf(axes.T @ ca.SX(motion.rotation)).full().ravel()

    def at(approach: float) -> list[PatchContact]:
        given = [stand.lateral, top - approach, stand.yaw, stand.roll, motion.velocity[0], *own_rate]
        return [patch.at(np.array(given)) for patch in elastic_patches(contact)]

    approach = brentq(lambda approach: sum(one.up for one in at(approach)) - LOAD, 0.0, MOST_APPROACH, xtol=1e-12)
    return at(float(approach))


def depth_2(stand: Stand, motion: WheelVelocity, contact: Contact = ON_PATCHES) -> ContactResult:
    """Return the elastic ellipses of contact model 2 at the level `spatial`, with its laws; they part where contact
    jumps.

    Positions are weighted with the square of the normal force. For ellipses this is close to the squared overlap that
    exact theory uses as weight (`place_of`).
    """
    found = bearings(stand, motion, contact)
    ahead, outwards = (sum(getattr(one, name) for one in found) for name in ("ahead", "outwards"))
    weights = [one.load**2 for one in found]
    place, angle = (
        float(np.average([getattr(x, name) for x in found], weights=weights)) for name in ("on_rail", "angle")
    )
    return ContactResult(place, angle, -ahead, -outwards, max(one.pressure for one in found if one.load > 0.0))


def depth_3(stand: Stand, motion: WheelVelocity) -> ContactResult:
    """Return strips with their own creep forces, some 8 in each part of the wheel: `spatial` at contact model 3."""
    wheel = wheel_under_load(manchester_pair(), STEEL, FRICTION, stand, motion, LOAD)
    return ContactResult(wheel.place, wheel.angle, -float(wheel.force[0]), -float(wheel.force[1]), wheel.pressure)


def strips_of_patches(stand: Stand, motion: WheelVelocity) -> ContactResult:
    """Return the finer study model of the strips: patches of any shape from the undeformed distance, by 24 strips."""
    _, contacts = under_load(
        manchester_pair(), stand, STEEL, FRICTION, lambda strips: creepages_of(strips, motion), LOAD
    )
    place, force = place_of(contacts), total(contacts)
    pressure = max(float(np.max(contact.patch.pressure)) for contact in contacts)
    return ContactResult(place.on_rail, place.angle, -float(force[0]), -float(force[1]), pressure)


@dataclass(frozen=True)
class Method:
    """A contact model: its name, its results, its limit, its line in the figure."""

    name: str
    find: Callable[[Stand, WheelVelocity], ContactResult]
    limit: str
    colour: str


#: Tolerances for all contact models alike: errors of position [mm], angle [rad], forces ahead and sideways [% of mu N].
PLACE_BAND, ANGLE_BAND, FORCE_BAND = 0.5, 0.02, 5.0
METHODS = (
    Method(
        "model 1, one ellipse",
        depth_1,
        "no ellipse where contact is long or double, and Polach's law with strong spin",
        TRAILING,
    ),
    Method(
        "model 2, ellipses that part",
        depth_2,
        "its place is 1 mm off at 0 mm, where contact has a shoulder, which is no ellipse, and 0.3 mm "
        "elsewhere; rows that are not judged have it with other laws",
        THESIS,
    ),
    Method(
        "model 3, patches by strips",
        depth_3,
        "largest ahead at 0 mm, on a patch 16 mm wide, and sideways on the right at 5 mm, on two patches 0.16 rad "
        "apart: there the benchmark has all in one plane; with the slip and normal of each place it is 1 % off",
        LEADING,
    ),
    Method(
        "study tool, 24 strips a patch",
        strips_of_patches,
        "the method of model 3 in NumPy, finer, and patch by patch where that goes part by part of the wheel",
        FOUR[2],
    ),
)
#: Shifts of the lines [mm], among them all integer ones.
SHIFTS = np.linspace(0.0, 10.0, 41)
#: Tolerance of the smaller and larger share of two patches.
SHARE_BAND = 0.10
#: Right wheel at 5 mm with patches kept apart, exact theory: y on the rail [m] and normal force [N].
APART_SHIFT, APART = 5.0, ((-33.93e-3, 8244.0), (-23.76e-3, 1536.0))
SOURCE = "exact theory (CONTACT v25), Manchester benchmark A-2.2"
FORCES: dict[str, Callable[[ContactResult], float]] = {
    "the force ahead": lambda found: found.ahead,
    "the force sideways": lambda found: found.outwards,
}


def largest_miss(
    pairs: Sequence[tuple[ContactResult, ContactResult]],
    of: Callable[[ContactResult], float],
    scale: float = 100 / (FRICTION * LOAD),
) -> float:
    """Return the largest distance from exact theory over pairs (found, exact); by default in % of mu N."""
    return max(abs(of(found) - of(truth)) for found, truth in pairs) * scale


def with_other_laws() -> list[Row]:
    """Return the rows of model 2 with the creep laws of OTHER_LAWS, over both wheels at integer millimetres."""
    rows = []
    for words, contact in counting(OTHER_LAWS.items(), "contact-manchester"):
        pairs = [
            (depth_2(*case(name, shift), contact), truth) for name in SIDES for shift, truth in exact(name).items()
        ]
        for quantity, of in FORCES.items():
            name = f"model 2, {words}: largest miss of {quantity}"
            rows.append(measured(name, "% of mu N", largest_miss(pairs, of), SOURCE))
    return rows


def misses(method: Method, lines: dict[tuple[str, str], list[ContactResult]]) -> list[Row]:
    """Return the largest distances from exact theory over both wheels at integer millimetres."""
    pairs = [
        (found, truth)
        for name in SIDES
        for shift, truth in exact(name).items()
        for found in [lines[method.name, name][int(np.argmin(np.abs(SHIFTS - shift)))]]
    ]

    def largest(quantity: str, unit: str, of: Callable[[ContactResult], float], scale: float, band: float) -> Row:
        worst = largest_miss(pairs, of, scale)
        name = f"{method.name}: largest miss of {quantity}"
        return measured(name, unit, worst, SOURCE, at_most(band), method.limit)

    percent = 100 / (FRICTION * LOAD)
    return [
        largest("the place on the rail", "mm", lambda x: x.place, 1e3, PLACE_BAND),
        largest("the contact angle", "rad", lambda x: x.angle, 1.0, ANGLE_BAND),
        *(largest(quantity, "% of mu N", of, percent, FORCE_BAND) for quantity, of in FORCES.items()),
    ]


def apart() -> list[Row]:
    """Return the rows of the load split if patches are independent, as in some programs: none lowers the rail under
    another.
    """
    pair = manchester_pair()
    stand, motion = case("right", APART_SHIFT)
    held, _ = under_load(pair, stand, STEEL, FRICTION, lambda s: creepages_of(s, motion), LOAD, apart=True)
    rows = []
    for (place, load), patch in zip(APART, patches(pair, held, STEEL, apart=True), strict=True):
        off = patch.centre(patch.strips.on_rail) - place
        note = f"{patch.load:.0f} N, exact {load:.0f} N; {1e3 * off:+.2f} mm from its place"
        quantity = f"model 3 at 5 mm, kept apart: miss of the load at y = {1e3 * place:.2f} mm"
        miss = 100 * abs(patch.load / load - 1)
        rows.append(measured(quantity, "%", miss, SOURCE, at_most(100 * SHARE_BAND), note))
    return rows


def run(options: Options, quick: bool = False) -> Report:
    lines: dict[tuple[str, str], list[ContactResult]] = {}
    for method in METHODS:
        for name in counting(SIDES, "contact-manchester"):
            lines[method.name, name] = [method.find(*case(name, float(shift))) for shift in SHIFTS]
    rows = [row for method in METHODS for row in misses(method, lines)] + apart() + with_other_laws()
    series = Recording({"shift": "m"}, [[shift / 1e3] for shift in SHIFTS])
    for (method_name, name), found in lines.items():
        for quantity, unit in UNITS.items():
            label = f"{quantity}_{name}_{method_name.split(',')[0].replace(' ', '_')}"
            series.add(label, unit, np.array([getattr(one, quantity) for one in found]))
    ratios = {
        "poisson_ratio": STEEL.poisson_ratio,
        "poisson_ratio_of_depths_1_and_2": POISSON_RATIO,
    }
    parameters = {"load": LOAD, "speed": SPEED, "friction": FRICTION, "shear_modulus": STEEL.shear_modulus}
    return Report(rows, series, lambda: draw(lines, rows), parameters | ratios, 0.0)


#: Line widths of the methods: where lines coincide, the rear ones are visible at both sides of the front ones.
WIDTHS = (5.0, 3.0, 1.6, 0.7)
UNITS = {"place": "m", "angle": "rad", "ahead": "N", "outwards": "N", "pressure": "Pa"}
PANELS = {
    "place": ("place on the rail, from its top outwards [mm]", 1e3),
    "angle": ("contact angle [rad]", 1.0),
    "ahead": ("force on the rail ahead [kN]", 1e-3),
    "outwards": ("force on the rail outwards [kN]", 1e-3),
}


def draw(lines: dict[tuple[str, str], list[ContactResult]], rows: Sequence[Row]) -> Figure:
    figure, grid = plt.subplots(len(PANELS), 2, figsize=(9.5, 10.0), sharex=True)
    for column, name in enumerate(SIDES):
        for row, (quantity, (title, scale)) in enumerate(PANELS.items()):
            axis = grid[row, column]
            draw_panel(axis, lines, name, quantity, scale)
            axis.set_title(f"{name} wheel: {title}", fontsize=10)
        grid[-1, column].set_xlabel("lateral shift to the right [mm]")
    grid[0, 0].legend()
    one, strips = (
        value_of(rows, f"{METHODS[number].name}: largest miss of the place on the rail") for number in (0, 2)
    )
    return titled(figure, f"Strips miss the contact's place by {strips:.2f} mm, one ellipse {one:.1f} mm")


def draw_panel(
    axis: Axes, lines: dict[tuple[str, str], list[ContactResult]], name: str, quantity: str, scale: float
) -> None:
    """Draw one quantity of one wheel: lines of the methods, points of exact theory."""
    for method, width in zip(METHODS, WIDTHS, strict=True):
        values = np.array([getattr(line, quantity) for line in lines[method.name, name]])
        axis.plot(SHIFTS, scale * values, color=method.colour, linewidth=width, label=method.name)
    points = exact(name)
    values = np.array([getattr(point, quantity) for point in points.values()])
    axis.plot(list(points), scale * values, "o", color=BOGIE, markersize=4, label="exact theory")


SCENARIO = Scenario(
    "contact-manchester",
    "Contact that jumps and splits, S1002 on UIC60: one ellipse, several ellipses and strips against exact theory",
    run,
)
