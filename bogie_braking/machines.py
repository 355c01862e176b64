"""Inputs of `run`: a built-in FMU by its name, or your own vehicle, system of equations or model."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

from bogie_braking.checks import known, shown
from fmu_src.batch import BatchLibrary, compiled_batch
from fmu_src.chain import ONE_WRITES
from fmu_src.chosen import alone
from fmu_src.codegen import generate, guid_of
from fmu_src.compile import library_of
from fmu_src.kernel import Library
from fmu_src.system import Model, System, Variable, model_of
from products.building import kernel_at, kernel_of, variables_of, whole_kernel
from products.one_level import model_at, place_of
from products.registry import FMUS, SELECTORS, fmu_named
from products.registry import model_of as model_of_fmu
from products.vehicle_sheet import DataSheet
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.laws import DEFAULT_LAW, LAWS
from rbd_model.contact.creep.own_law import check_own_law
from rbd_model.contact.pair_file import PAIR_FILE, joined
from rbd_model.levels.models import (
    DEFAULT_DEPTH,
    DEPTH_ON_LINE,
    EVERY,
    model_of_levels,
    places_of,
)
from rbd_model.track.line_table import LINE
from rbd_model.vehicle.description import Vehicle
from rbd_model.vehicle.ready import loaded_coal_wagon, passenger_coach, two_axle_bogie, wheelset_under_frame
from rbd_model.wheelset.rigid import check_one_contact

#: Accepted by `run`, `Simulation`, `sweep` and `fit`.
Runnable = str | Model | System | Vehicle
#: Key of a compiled vehicle.
Key = tuple[bytes, CreepLaw | None]
#: Error of an integration step in nominal values of the states, unless a model sets its own.
TOLERANCE = 1e-6
#: The default level of detail, and all levels.
LEVEL, LEVELS = 2, (1, 2, 3)
#: Time to compile the equations of a level, for each wheelset, on two processors [s].
COMPILING = {1: 2.0, 2: 2.0, 3: 4.0}
#: Values that choose the creep law of a vehicle's treads, the Poisson's ratio of its wheels and rails, and outputs of
#: its contacts.
CREEP_LAW, STEEL, CONTACTS = OF_VEHICLE = "creep_law", "poisson_ratio", "contact_outputs"
#: Vehicles as data, by the names of their FMUs.
VEHICLES: Mapping[str, Callable[[], Vehicle]] = {
    "bogie": two_axle_bogie,
    "vehicle": passenger_coach,
    "coal-wagon": loaded_coal_wagon,
    "wheelset": wheelset_under_frame,
}


@dataclass(frozen=True)
class CompiledMachine:
    """Compiled equations with their variables.

    fixed: parameters that selected the compiled equations. place: number of the compiled system among those that the
    variables of an FMU select; None: all systems are compiled. identity: GUID of equations of a user's own.
    """

    name: str
    variables: Mapping[str, Variable]
    library: Library
    fixed: frozenset[str] = frozenset()
    place: int | None = None
    identity: str = ""


def vehicle(name: str) -> Vehicle:
    """Return a built-in vehicle as data, to be changed with `dataclasses.replace`.

    Parameters
    ----------
    name : str
        "bogie", "coach" (also "vehicle"), "coal-wagon" or "wheelset", as in `fmu`.

    Returns
    -------
    Vehicle
        Bodies, wheelsets, connections, parameters and the name of the creep law of its treads:
        `replace(vehicle("coach"), creep_law="fastsim")`.

    Raises
    ------
    KeyError
        If the name is unknown.
    """
    return VEHICLES[known(name, VEHICLES, "vehicle")]()


def described(what: str | DataSheet | Vehicle) -> Vehicle:
    """Return the description of a built-in vehicle, of one from a file or of your own. Raises KeyError, TypeError."""
    if isinstance(what, DataSheet):
        return what.vehicle
    if isinstance(what, Vehicle):
        return what
    return vehicle(what)


def unfolded(what: Runnable | DataSheet, values: Mapping[str, Any]) -> tuple[Runnable, dict[str, Any]]:
    """Return what runs and its values, without a vehicle from a file and without values of OF_VEHICLE.

    A vehicle from a file becomes its FMU or its description, with its values, which those of the caller replace. An
    empty path does not replace its contact tables. A vehicle with another creep law, ratio or outputs than its own
    becomes its description with these.
    """
    if not isinstance(what, DataSheet):
        return _with_contact(what, dict(values))
    in_space = values.get("level", LEVEL) == LEVELS[-1]
    table = {PAIR_FILE.variable.name: joined(what.profile_files)} if what.profile_files and in_space else {}
    given = {name: value for name, value in values.items() if name not in table or value != ""}
    if what.fmu is None or {*OF_VEHICLE} & {*values}:
        # Equations of its own: they have its masses and springs, and not the parameters of other levels.
        return _with_contact(what.vehicle, dict(what.resistance) | table | given)
    return _with_contact(what.fmu, what.values_at(values.get("level", LEVEL)) | table | given)


def _with_contact(what: Runnable, values: dict[str, Any]) -> tuple[Runnable, dict[str, Any]]:
    """Return a vehicle with the values of OF_VEHICLE, and the other values; what is not one, as it is."""
    name = fmu_named(what) if isinstance(what, str) else ""
    if not {*OF_VEHICLE} & {*values} or not (isinstance(what, Vehicle) or name in VEHICLES):
        return what, values
    own = what if isinstance(what, Vehicle) else VEHICLES[name]()
    mine = {one: values[one] for one in OF_VEHICLE if one in values}
    if CREEP_LAW in mine:
        mine[CREEP_LAW] = law_named(mine[CREEP_LAW])
    changed = replace(own, **mine)
    rest = {one: value for one, value in values.items() if one not in OF_VEHICLE}
    return what if changed == own else changed, rest


def law_named(law: object) -> str:
    """Return the name of a creep law, a function of the user among them, which gets a name of its own in LAWS."""
    if callable(law):
        check_own_law(law, getattr(law, "__name__", "law"))
        name = f"{getattr(law, '__name__', 'law')} (own)"
        LAWS[name] = law
        return name
    if not isinstance(law, str) or law not in (DEFAULT_LAW, *LAWS):
        those = ", ".join(one for one in (DEFAULT_LAW, *LAWS) if not one.endswith("(own)"))
        raise ValueError(f"creep_law must be one of {those}, or a function of a ContactPatch; got {shown(law)}.")
    return law


def machine_of(what: Runnable, values: Mapping[str, Any], on_line: bool) -> CompiledMachine:
    """Return compiled equations; for a vehicle only the level and the contact model that `values` select.

    A vehicle by its name has the variables of all levels; other values may select another system of that FMU.
    """
    if isinstance(what, str):
        what = known(what, FMUS, "FMU")
        variables = variables_of(what)
        return machine_at(what, place_of(what, variables, values, on_line))
    with ONE_WRITES:
        if isinstance(what, Vehicle):
            return _of_a_vehicle(_key(what), _places(what, values, on_line or LINE.variable.name in values))
        return _of_a_model(what) if isinstance(what, Model) else _compiled(model_from(what))


def batch_machine_of(what: Runnable, values: Mapping[str, Any], on_line: bool) -> BatchLibrary:
    """Return the one system that `values` select, compiled in vector lanes."""
    with ONE_WRITES:
        if isinstance(what, str):
            what = known(what, FMUS, "FMU")
            fmu = FMUS[what]
            selected = fmu.selectors if fmu.vehicle else model_of_fmu(what).selectors
            return _batch_of_the_list(what, tuple((name, values[name]) for name in selected if name in values), on_line)
        if isinstance(what, Vehicle):
            return _batch_of_a_vehicle(_key(what), _places(what, values, on_line))
        model = model_from(what)
        return _batch_of_a_model(alone(model, values, on_line))


@lru_cache
def _batch_of_the_list(name: str, selected: tuple[tuple[str, float], ...], on_line: bool) -> BatchLibrary:
    """Compile one system of a built-in FMU.

    A vehicle keeps the variables of all levels, so that its runs give the same messages.
    """
    values = dict(selected)
    if name in VEHICLES and FMUS[name].vehicle:
        _places(VEHICLES[name](), values, on_line)
    place = place_of(name, variables_of(name), values, on_line)
    model = model_of_fmu(name) if place is None else model_at(name, variables_of(name), place)
    return _batch_of_a_model(alone(model, values, on_line))


@lru_cache
def _batch_of_a_vehicle(key: Key, places: tuple[int, ...]) -> BatchLibrary:
    return _batch_of_a_model(model_from(pickle.loads(key[0]), places))


def _batch_of_a_model(model: Model) -> BatchLibrary:
    return compiled_batch(model, model.systems[0])


def _places(what: Vehicle, values: Mapping[str, Any], on_line: bool) -> tuple[int, ...]:
    """Return the systems of a vehicle that `values` select.

    Raises ValueError if they do not exist, or if their contact does not suit the profiles.
    """
    level, depth = _chosen("level", values, LEVEL), _chosen("contact_model", values, int(DEFAULT_DEPTH))
    places = places_of(level, depth, on_line)
    if not places:
        raise ValueError(f"contact_model must be {DEPTH_ON_LINE} on a line; got {depth}.")
    if what.contact_outputs and (level, depth) != (LEVELS[-1], DEPTH_ON_LINE):
        raise ValueError(
            f"{CONTACTS} must come with level {LEVELS[-1]} and contact_model {DEPTH_ON_LINE}; got level {level} and "
            f"contact_model {depth}. No other model computes these contacts."
        )
    for pair in {wheelset.equal_sides for wheelset in what.wheelsets} if (level, depth) == (3, 1) else ():
        check_one_contact(pair)
    return places


def model_from(what: Model | System | Vehicle, places: Sequence[int] = EVERY) -> Model:
    """Return the model of a system, or of a vehicle with the systems of `places`."""
    if isinstance(what, Vehicle):
        text = f"Railway vehicle of {len(what.wheelsets)} wheelsets under brake and traction torque"
        return model_of_levels(what.name, text, what, places)
    if isinstance(what, System):
        if not what.outputs:
            raise ValueError(f"The system {what.name} has no output; give it one.")
        return model_of(what, TOLERANCE)
    if isinstance(what, Model):
        return what
    raise TypeError(f"What runs must be the name of an FMU, a Vehicle, a System or a Model; got {shown(what)}.")


def _chosen(name: str, values: Mapping[str, Any], start: int) -> int:
    value = values.get(name, start)
    if value not in LEVELS:
        raise ValueError(f"{name} must be {', '.join(map(str, LEVELS[:-1]))} or {LEVELS[-1]}; got {value!r}.")
    return int(value)


@lru_cache
def machine_at(name: str, place: int | None) -> CompiledMachine:
    """Return a compiled FMU of the list: one of its systems by its number, or all.

    All systems are returned too if a release includes them compiled. None: an FMU without levels.
    """
    whole = whole_kernel(name)
    if whole or place is None:
        return CompiledMachine(name, variables_of(name), Library(whole or kernel_of(name)))
    return CompiledMachine(
        name, variables_of(name), Library(kernel_at(name, place, partial(announce, name, place))), place=place
    )


def announce(name: str, place: int) -> None:
    """Say which equations of an FMU are compiled, and about how long that takes, if standard error is a terminal."""
    if not (sys.stderr and sys.stderr.isatty()):
        return
    both = ((level, contact) for level in LEVELS for contact in LEVELS)
    found = next((one for one in both if any(place in places_of(*one, line) for line in (False, True))), None)
    level, contact = found or (2, 0)
    vehicle = FMUS[name].vehicle
    wheelsets = len(vehicle().wheelsets) if vehicle else 1
    seconds = wheelsets * COMPILING[level]
    which = f"level {level}" + (f" with contact model {contact}" if level == LEVELS[-1] else "")
    which += "" if found else " with cylinders by flow of air"
    words = (
        f"Compiling the {name} at {which}: about {seconds:g} s on two processors. Later runs take it from the cache."
    )
    print(words, file=sys.stderr, flush=True)


def _key(what: Vehicle) -> Key:
    """Return the bytes of a vehicle, as its parts may be lists, which have no hash, and its creep law."""
    return pickle.dumps(what), LAWS.get(what.creep_law)


@lru_cache
def _of_a_vehicle(key: Key, places: tuple[int, ...]) -> CompiledMachine:
    return _compiled(model_from(pickle.loads(key[0]), places), frozenset(SELECTORS))


@lru_cache
def _of_a_model(model: Model) -> CompiledMachine:
    return _compiled(model)


def _compiled(model: Model, fixed: frozenset[str] = frozenset()) -> CompiledMachine:
    variables = {variable.name: variable for variable in model.variables}
    sources = generate(model)
    return CompiledMachine(model.name, variables, Library(library_of(sources)), fixed, identity=guid_of(sources))
