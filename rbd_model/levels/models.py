"""The FMUs of this package: BogieDynamics, all levels of detail with one table of variables, and WheelsetDynamics."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import compress, product

from fmu_src.chain import ONE_WRITES
from fmu_src.system import NONE, Model, System, Variable, choosing
from fmu_src.variables import integration_variables
from rbd_model.contact.creep.laws import DEFAULT_LAW, LAWS
from rbd_model.contact.depth import DEPTHS, Contact
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import ballasted_track, irregular_track, section_5_3
from rbd_model.track.line_table import LINE
from rbd_model.vehicle import variables
from rbd_model.vehicle.description import Vehicle, relations_of
from rbd_model.vehicle.parameters import BogieParameters
from rbd_model.vehicle.ready import loaded_coal_wagon, passenger_coach, two_axle_bogie, wheelset_under_frame

#: Local error per step in nominal values, chosen from the figures of `speed-accuracy`: docs/choosing.md.
DEFAULT_TOLERANCE = 1e-6
#: Start value of `contact_model`. Model 1 misleads if a flange bears (scenario `contact-model`), which is detected only
#: at the end of a run.
DEFAULT_DEPTH = 2.0
#: Start value of `level`: load transfer determines the motion of a braked vehicle.
DEFAULT_LEVEL = 2.0

#: Levels of detail by their numbers: what the parameter level chooses.
LEVELS = {
    1: "point (speed, wheel speeds, static loads)",
    2: "planar (also bounce, pitch and load transfer)",
    3: "spatial (also lateral, yaw and roll motion, profiles of wheels and rails)",
}

#: Number of the system of a vehicle by level and contact model, which varies fastest. The second table continues with
#: the systems on a line. NONE: no such system exists.
CHOICE = (0, 0, 0, 1, 1, 1, 2, 3, 4)
CHOICE_ON_LINE = (*CHOICE, 5, 5, 5, 6, 6, 6, NONE, 7, NONE)
#: Meaning of the indices in these tables: whether on a line, level, contact model.
COMBINATIONS = tuple(product((False, True), LEVELS, DEPTHS))
#: The numbers of all systems.
EVERY = tuple(range(8))
#: The number of the system whose strips have a creep law of their own.
STRIPS = CHOICE[-1]
#: Contact model at level 3 on a line: that of the start value, in which a flange has its own contact. Each further one
#: would make every FMU larger by half.
DEPTH_ON_LINE = 2


def system_at(vehicle: Vehicle, place: int) -> System:
    """Return the system with this number in CHOICE_ON_LINE."""
    on_line = place > max(CHOICE)
    number = place - max(CHOICE) - 1 if on_line else place
    if number < 2:
        return (point_vehicle, planar_vehicle)[number](vehicle, on_line)
    depth = DEPTH_ON_LINE if on_line else list(DEPTHS)[number - 2]
    contact = Contact(depth, LAWS.get(vehicle.creep_law), poisson_ratio=vehicle.poisson_ratio)
    return spatial_vehicle(vehicle, irregular_track(section_5_3()), contact, on_line)


def levels(vehicle: Vehicle) -> tuple[System, ...]:
    """Return the systems in the order of the parameter `level`, the least first; the last one by contact model."""
    return tuple(system_at(vehicle, place) for place in sorted(set(CHOICE)))


def places_of(level: int | None = None, depth: int | None = None, on_line: bool | None = None) -> tuple[int, ...]:
    """Return the numbers in CHOICE_ON_LINE of a level, of a contact model, with or without a line; None: of all."""
    asked = (on_line, level, depth)
    good = [all(one in (None, own) for one, own in zip(asked, each, strict=True)) for each in COMBINATIONS]
    return tuple(sorted({*compress(CHOICE_ON_LINE, good)} - {NONE}))


def model_of_levels(name: str, text: str, vehicle: Vehicle, places: Sequence[int] = EVERY) -> Model:
    """Return a vehicle at all levels as one FMU: inputs, outputs, level, parameters in the order of their set.

    places: the systems that it has, from `places_of`. Systems that it lacks cannot be chosen. Without a system on a
    line, it has no variable for the name of a line's file. Strips are omitted if other systems exist and the vehicle
    has a creep law that strips do not follow.
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
        *([PAIR_FILE.variable] if any(system.record_file for system in systems) else []),
        *integration_variables(DEFAULT_TOLERANCE),
    )
    relations = relations_of(vehicle, [parameter.name for parameter in parameters])
    names = tuple(one.name for one in chosen_by)
    choice = choice_of(places, int(chosen_by[0].maximum), on_line)
    return Model(name, text, table, systems, names, choice, stop_time=25.0, relations=relations)


def choice_of(places: Sequence[int], highest: int, on_line: bool) -> tuple[int, ...]:
    """Return `Model.choice` of the systems of `places`, for levels up to the highest, with or without lines."""
    each = [choice[: highest * len(DEPTHS)] for choice in (CHOICE, CHOICE_ON_LINE[len(CHOICE) :])]
    kept = (*each[0], *(each[1] if on_line else ()))
    return tuple(places.index(place) if place in places else NONE for place in kept)


def selectors(places: Sequence[int] = EVERY) -> tuple[Variable, Variable]:
    """Return the parameters for the level of detail and the contact model of a model with `places`.

    They start with the default, or the nearest value to it, and accept only levels that the model has.
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
    """Return the parameters of all systems: the speed at the start, then those of the vehicle in the order of their
    set.
    """
    found = {v.name: v for system in systems for v in system.variables if v.causality == "parameter"}
    first = [variables.initial_speed(0.0).name, *vehicle.parameters.values()]
    return [found[name] for name in sorted(found, key=lambda name: first.index(name) if name in first else len(first))]


def bogie_dynamics(defaults: BogieParameters | None = None, places: Sequence[int] = EVERY) -> Model:
    """Return the bogie as one FMU, by default that of chapter 5.

    The input is the brake torque capacity; outputs are speed, rotation and slip.

    places: as in `model_of_levels`.
    """
    text = "Two-axle railway bogie under brake and traction torque, after Handoko (2006)"
    return model_of_levels("BogieDynamics", text, two_axle_bogie(defaults), places)


def vehicle_dynamics(vehicle: Vehicle | None = None, places: Sequence[int] = EVERY) -> Model:
    """Return a complete vehicle as one FMU, by default vehicle 1 of the Manchester benchmarks; places: as above."""
    whole = vehicle or passenger_coach()
    text = "Four-axle railway vehicle under brake and traction torque: car body, two bogies, four wheelsets"
    return model_of_levels(whole.name, text, whole, places)


def coal_wagon_dynamics(places: Sequence[int] = EVERY) -> Model:
    """Return the coal wagon on two bogies of chapter 5 as an FMU; places: as above."""
    return vehicle_dynamics(loaded_coal_wagon(), places)


#: Largest share of the adhesion used by the brakes of the chapter 5 bogie for which static loads give speed, distance
#: and rotation to 0.2 %. At 0.70 and above, load transfer locks the trailing wheelset (scenario `levels`, friction
#: 0.3).
STATIC_LOADS_UP_TO = 0.6
#: Outputs of the point level that depend on load transfer: slip and axle load at any torque, lock and creep force near
#: the adhesion limit.
DECIDED_BY_LOAD_TRANSFER = ("locked", "slip", "slip_ratio", "creep_force", "axle_load")
#: Outputs that depend on a flange with its own place, force and creep.
DECIDED_BY_FLANGE = ("flange_force", "derailment_quotient", "wheel_rise")


@dataclass(frozen=True)
class Choice:
    """A model: one bogie or, `whole`, the complete vehicle; a level of detail; at level 3 a contact model; the reason.

    contact_model: the least one that suffices. The parameter of this name starts at 2, so that 1 must be set.
    """

    level: int
    reason: str
    whole: bool = False
    contact_model: int = 1


def recommend_level(driven: Iterable[str], read: Iterable[str]) -> Choice:
    """Return the least model that computes a case."""
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
    level = contact_model = 1
    for name in needed:
        family = family_of(name)
        own = next(min(number, 3) for number, (_, known) in enumerate(names.items(), 1) if name in known)
        own = max(own, 2) if family in DECIDED_BY_LOAD_TRANSFER else own
        if own > level:
            why = {2: "load transfer decides it, or a motion in the plane", 3: "it belongs to motions out of the plane"}
            level, reason = own, f"{name} asks for level {own}, {list(names)[own - 1]}: {why[own]}."
        if contact_model == 1 and (family in DECIDED_BY_FLANGE or name not in set().union(*list(names.values())[:3])):
            contact_model, reason = (
                2,
                f"{reason} {name} asks for contact model 2: the flange has its own place, force and creep.",
            )
    on_line = [name for name in needed if name in (LINE.variable.name, *ballasted_track().values())]
    if level == 3 and contact_model < DEPTH_ON_LINE and on_line:
        contact_model, reason = (
            DEPTH_ON_LINE,
            f"{reason} {on_line[0]} asks for contact model {DEPTH_ON_LINE}: no other knows a line.",
        )
    if level == 3 and contact_model == 1:
        reason = f"{reason} No flange is asked about: contact_model 1 serves, which must be asked for."
    if beyond:
        return Choice(level, f"{beyond[0]} belongs to the complete vehicle; {reason}", True, contact_model)
    return Choice(level, reason, contact_model=contact_model)


def family_of(name: str) -> str:
    """Return a variable's name without the number of its wheelset and the side of its wheel."""
    return name.removesuffix("_left").removesuffix("_right").rstrip("1234").removesuffix("_")


def names_of_levels(whole: bool) -> dict[str, set[str]]:
    """Return the variables of each level of one bogie or the vehicle, least first; all have tolerance and line.

    Those of flexible rails exist only in 3D on a line.
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
    """Return the single wheelset in a frame of chapter 4, at the spatial level, with the variables of wheelset 1."""
    system = spatial_vehicle(wheelset_under_frame(defaults), irregular_track(section_5_3()))
    system.name = "WheelsetDynamics"
    system.description = "Railway wheelset in a frame under brake and traction torque, after Handoko (2006), chapter 4"
    return system


def wheelset_dynamics() -> Model:
    """Return the wheelset of chapter 4 as an FMU."""
    system, vehicle = wheelset_in_frame(), wheelset_under_frame()
    own = {variable.name for variable in system.variables}
    faces = (*variables.inputs(vehicle).values(), *variables.outputs(vehicle).values())
    table = (
        *(variable for variable in faces if variable.name in own),
        *parameters_of(vehicle, [system]),
        *integration_variables(DEFAULT_TOLERANCE),
    )
    return Model(system.name, system.description, table, (system,))
