"""The FMUs of this package: BogieDynamics, all levels of detail behind one table of variables, and WheelsetDynamics."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import compress, product

from fmu_src.chain import ONE_WRITES
from fmu_src.system import NONE, Model, System, Variable, choosing, integration_variables
from rbd_model.contact.creep.laws import DEFAULT_LAW, LAWS
from rbd_model.contact.depth import DEPTHS, Contact
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import ballasted_track, irregular_track, section_5_3
from rbd_model.track.line_table import LINE
from rbd_model.vehicle import variables
from rbd_model.vehicle.description import Vehicle, relations_of
from rbd_model.vehicle.parameters import BogieParameters
from rbd_model.vehicle.ready import loaded_coal_wagon, passenger_coach, two_axle_bogie, wheelset_under_frame

#: Local error per step in nominal values, chosen from the pictures of `speed-accuracy`: docs/choosing.md.
DEFAULT_TOLERANCE = 1e-6
#: Start value of `contact_model`: model 1 misleads where a flange bears (scenario `contact-model`), which a run only
#: tells when it is over.
DEFAULT_DEPTH = 2.0
#: Start value of `level`: load transfer decides what a braked vehicle does.
DEFAULT_LEVEL = 2.0

#: Levels of detail by their numbers: what the parameter level chooses.
LEVELS = {
    1: "point (speed, wheel speeds, static loads)",
    2: "planar (also bounce, pitch and load transfer)",
    3: "spatial (also lateral, yaw and roll motion, profiles of wheels and rails)",
}

#: Which system of a vehicle serves, by level and, the last number running first, by contact model; and behind them
#: which of those on a line. NONE: there is no such system.
CHOICE = (0, 0, 0, 1, 1, 1, 2, 3, 4)
CHOICE_ON_LINE = (*CHOICE, 5, 5, 5, 6, 6, 6, NONE, 7, NONE)
#: What the places in it stand for: whether on a line, level, contact model.
COMBINATIONS = tuple(product((False, True), LEVELS, DEPTHS))
#: The numbers of all systems.
EVERY = tuple(range(8))
#: The number of that whose strips have a creep law of their own.
STRIPS = CHOICE[-1]
#: Contact model in space on a line: that of the start value, in which a flange has its own place. Each further one
#: would make every FMU half as large again.
DEPTH_ON_LINE = 2


def system_at(vehicle: Vehicle, place: int) -> System:
    """The system with this number in CHOICE_ON_LINE."""
    on_line = place > max(CHOICE)
    number = place - max(CHOICE) - 1 if on_line else place
    if number < 2:
        return (point_vehicle, planar_vehicle)[number](vehicle, on_line)
    depth = DEPTH_ON_LINE if on_line else list(DEPTHS)[number - 2]
    law = LAWS[vehicle.creep_law]
    return spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(depth, law), on_line)


def levels(vehicle: Vehicle) -> tuple[System, ...]:
    """The systems in the order of the parameter `level`, the least first; the last one by contact model."""
    return tuple(system_at(vehicle, place) for place in sorted(set(CHOICE)))


def places_of(level: int | None = None, depth: int | None = None, on_line: bool | None = None) -> tuple[int, ...]:
    """Numbers in CHOICE_ON_LINE of the systems of a level, of a contact model, with or without a line; None: all."""
    asked = (on_line, level, depth)
    good = [all(one in (None, own) for one, own in zip(asked, each, strict=True)) for each in COMBINATIONS]
    return tuple(sorted({*compress(CHOICE_ON_LINE, good)} - {NONE}))


def model_of_levels(name: str, text: str, vehicle: Vehicle, places: Sequence[int] = EVERY) -> Model:
    """A vehicle at all levels as one FMU: inputs, outputs, level, parameters in the order of their set.

    places: which of the systems it has, as `places_of` gives them. Those that it lacks cannot be chosen; without
    one on a line it has no name of a line's file. Of several, strips are left out where they would not follow the
    vehicle's creep law.
    """
    if vehicle.creep_law != DEFAULT_LAW and len(places) > 1:
        places = [place for place in places if place != STRIPS]
    systems = tuple(system_at(vehicle, place) for place in places)
    on_line = max(places) > max(CHOICE)
    chosen_by = selectors(places)
    parameters = parameters_of(vehicle, systems)
    table = (
        *variables.inputs(vehicle).values(),
        *variables.outputs(vehicle).values(),
        *chosen_by,
        *parameters,
        *([LINE.variable] if on_line else []),
        *integration_variables(DEFAULT_TOLERANCE),
    )
    relations = relations_of(vehicle, [one.name for one in parameters])
    names = tuple(one.name for one in chosen_by)
    choice = choice_of(places, int(chosen_by[0].maximum), on_line)
    return Model(name, text, table, systems, names, choice, stop_time=25.0, relations=relations)


def choice_of(places: Sequence[int], highest: int, on_line: bool) -> tuple[int, ...]:
    """`Model.choice` of the systems of `places`, where `level` goes up to the highest and lines are read or not."""
    each = [choice[: highest * len(DEPTHS)] for choice in (CHOICE, CHOICE_ON_LINE[len(CHOICE) :])]
    kept = (*each[0], *(each[1] if on_line else ()))
    return tuple(places.index(place) if place in places else NONE for place in kept)


def selectors(places: Sequence[int] = EVERY) -> tuple[Variable, Variable]:
    """The parameters that choose the level of detail and, in space, the contact model; of a model with `places`.

    They start with the default, or what is nearest to it, and take no level that the model does not have.
    """
    found = [each for each, place in zip(COMBINATIONS, CHOICE_ON_LINE, strict=True) if place in places]
    levels_there = {level: text for level, text in LEVELS.items() if level in {own for _, own, _ in found}}
    level = min(levels_there, key=lambda one: abs(one - DEFAULT_LEVEL))
    depths = [depth for _, own, depth in found if own == level]
    depth = min(depths, key=lambda one: abs(one - DEFAULT_DEPTH))
    return (
        Variable("level", "parameter", start=float(level), **choosing("Level of detail", levels_there)),
        Variable("contact_model", "parameter", start=float(depth), **choosing("Contact model at level 3", DEPTHS)),
    )


def parameters_of(vehicle: Vehicle, systems: Iterable[System]) -> list[Variable]:
    """Parameters of all systems: those of the vehicle in the order of their set, after the speed at the start."""
    found = {v.name: v for system in systems for v in system.variables if v.causality == "parameter"}
    first = [variables.initial_speed(0.0).name, *vehicle.parameters.values()]
    return [found[name] for name in sorted(found, key=lambda name: first.index(name) if name in first else len(first))]


def bogie_dynamics(defaults: BogieParameters | None = None, places: Sequence[int] = EVERY) -> Model:
    """The bogie as one FMU, that of chapter 5 by default: brake torque capacity in; speed, rotation and slip out.

    places: as `model_of_levels` takes them.
    """
    text = "Two-axle railway bogie under brake and traction torque, after Handoko (2006)"
    return model_of_levels("BogieDynamics", text, two_axle_bogie(defaults), places)


def vehicle_dynamics(vehicle: Vehicle | None = None, places: Sequence[int] = EVERY) -> Model:
    """A complete vehicle as one FMU, vehicle 1 of the Manchester benchmarks by default; places: as above."""
    whole = vehicle or passenger_coach()
    text = "Four-axle railway vehicle under brake and traction torque: car body, two bogies, four wheelsets"
    return model_of_levels(whole.name, text, whole, places)


def coal_wagon_dynamics(places: Sequence[int] = EVERY) -> Model:
    """The coal wagon of two bogies of chapter 5 as an FMU; places: as above."""
    return vehicle_dynamics(loaded_coal_wagon(), places)


#: Share of the adhesion that the brakes of the chapter 5 bogie may ask for while static loads give speed, distance and
#: rotation to 0.2 %; from 0.70 on load transfer locks the trailing wheelset (scenario `levels`, friction 0.3).
STATIC_LOADS_UP_TO = 0.6
#: Outputs that the point level has, but that load transfer decides: slip and axle load at any torque, lock and creep
#: force near the adhesion limit.
DECIDED_BY_LOAD_TRANSFER = ("locked", "slip", "slip_ratio", "creep_force", "axle_load")
#: Outputs that a flange with its own place, force and creep decides.
DECIDED_BY_FLANGE = ("flange_force", "derailment_quotient", "wheel_rise")


@dataclass(frozen=True)
class Choice:
    """One bogie or, `whole`, the complete vehicle; a level of detail and, in space, a contact model; and why.

    depth: the least that answers; `contact_model` starts at 2, so that 1 must be asked for.
    """

    level: int
    reason: str
    whole: bool = False
    depth: int = 1


def recommend_level(driven: Iterable[str], read: Iterable[str]) -> Choice:
    """The least model that answers a scene: `driven` are the inputs and parameters that it changes, `read` the outputs.

    One bogie (BogieDynamics, of a vehicle with `one_bogie_of`) where it has all names, else the complete vehicle.
    Raises ValueError for a name that no level has.
    """
    needed = [*driven, *read]
    of_one_bogie: set[str] = set().union(*names_of_levels(False).values())
    beyond = [name for name in needed if name not in of_one_bogie]
    names = names_of_levels(bool(beyond))
    for name in needed:
        if name not in set().union(*names.values()):
            asked = "" if name == beyond[0] else f", which {beyond[0]} asks for,"
            raise ValueError(f"VehicleDynamics{asked} has no variable {name}; bogie-braking build --describe has all.")
    reason = (
        "speed and rotation far from the adhesion limit need no more than static loads "
        f"(up to {STATIC_LOADS_UP_TO} of it for the bogie of chapter 5)."
    )
    level = depth = 1
    for name in needed:
        family = family_of(name)
        own = next(min(number, 3) for number, (_, known) in enumerate(names.items(), 1) if name in known)
        own = max(own, 2) if family in DECIDED_BY_LOAD_TRANSFER else own
        if own > level:
            why = {2: "load transfer decides it, or a motion in the plane", 3: "it belongs to motions out of the plane"}
            level, reason = own, f"{name} asks for level {own}, {list(names)[own - 1]}: {why[own]}."
        if depth == 1 and (family in DECIDED_BY_FLANGE or name not in set().union(*list(names.values())[:3])):
            depth, reason = (
                2,
                f"{reason} {name} asks for contact model 2: the flange has its own place, force and creep.",
            )
    on_line = [name for name in needed if name in (LINE.variable.name, *ballasted_track().values())]
    if level == 3 and depth < DEPTH_ON_LINE and on_line:
        depth, reason = (
            DEPTH_ON_LINE,
            f"{reason} {on_line[0]} asks for contact model {DEPTH_ON_LINE}: no other knows a line.",
        )
    if level == 3 and depth == 1:
        reason = f"{reason} No flange is asked about: contact_model 1 serves, which must be asked for."
    if beyond:
        return Choice(level, f"{beyond[0]} belongs to the complete vehicle; {reason}", True, depth)
    return Choice(level, reason, depth=depth)


def family_of(name: str) -> str:
    """What a variable is, without the number of its wheelset and the side of its wheel."""
    return name.removesuffix("_left").removesuffix("_right").rstrip("1234").removesuffix("_")


def names_of_levels(whole: bool) -> dict[str, set[str]]:
    """Names of the variables of each level of one bogie or the vehicle, least first; all have tolerance and line.

    Those of rails that yield are in space only, where there is a line.
    """
    with ONE_WRITES:
        return _names_of_levels(whole)


@lru_cache
def _names_of_levels(whole: bool) -> dict[str, set[str]]:
    systems = levels(passenger_coach() if whole else two_axle_bogie())
    common = {variable.name for variable in integration_variables(DEFAULT_TOLERANCE)} | {LINE.variable.name}
    names = {system.name: common | {variable.name for variable in system.variables} for system in systems}
    return {
        name: known | set(ballasted_track().values() if number > 2 else ())
        for number, (name, known) in enumerate(names.items(), 1)
    }


def wheelset_in_frame(defaults: BogieParameters | None = None) -> System:
    """The single wheelset in a frame of chapter 4, spatial, with the variables of wheelset 1."""
    system = spatial_vehicle(wheelset_under_frame(defaults), irregular_track(section_5_3()))
    system.name = "WheelsetDynamics"
    system.description = "Railway wheelset in a frame under brake and traction torque, after Handoko (2006), chapter 4"
    return system


def wheelset_dynamics() -> Model:
    """The wheelset of chapter 4 as an FMU."""
    system, vehicle = wheelset_in_frame(), wheelset_under_frame()
    own = {variable.name for variable in system.variables}
    faces = (*variables.inputs(vehicle).values(), *variables.outputs(vehicle).values())
    table = (
        *(variable for variable in faces if variable.name in own),
        *parameters_of(vehicle, [system]),
        *integration_variables(DEFAULT_TOLERANCE),
    )
    return Model(system.name, system.description, table, (system,))
