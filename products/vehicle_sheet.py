"""Vehicles from data sheets: a TOML file of a user becomes start values of a built-in FMU, or a vehicle as data.

A number that the file lacks is taken from a named built-in vehicle and listed as assumed. `vehicle_file.py` adds the
brake of the file.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from products.vehicle_connections import SHORT
from products.vehicle_entries import (
    ENTRIES,
    HEAVIEST,
    HEIGHTS,
    LIKE,
    PARAMETER_OF,
    RESISTANCE,
    check_names,
    choice_of,
    number_of,
    parameter_entry,
)
from products.vehicle_parts import ENTRY, ROWS, OwnParts, own_parts
from rbd_model.contact.geometry import synthetic_pair
from rbd_model.contact.pair_file import read_pairs
from rbd_model.train.vehicle import GRAVITY
from rbd_model.vehicle.description import Vehicle, parameters_in
from rbd_model.vehicle.parameters import BogieParameters, VehicleParameters
from rbd_model.vehicle.ready import four_axle_vehicle, six_axle_vehicle, two_axle_bogie
from readers.column_words import with_columns
from readers.text import FileError, shown
from readers.toml_files import toml_of
from readers.usual import likely_unit

#: FMUs that exist for a number of axles; six axles have none.
FMU_OF_AXLES = {2: "bogie", 4: "vehicle"}
BRAKED_FMU = "braked-vehicle"
#: Parameters that a data sheet does not have: switches of the model, contact and rails. They are not listed as assumed.
SETTINGS = frozenset(
    {
        *("torque_reaction", "constant_speed", "yaw_torque_rotates", "wheel_lift_ends", "running_safety_warnings"),
        *("flange_clearance", "flange_stiffness", "flange_at_rail", "wheel_profile_curvature", "rail_head_radius"),
        *("left_rail_friction", "right_rail_friction", "gauge_face_friction", "creepage_speed"),
        *("shear_modulus", "contact_damping", "gravity"),
    }
)
#: Parameters of a set with an effect at level 1, and the further ones at level 2; at level 3 all have one.
AT_POINT = frozenset(
    {
        *("body_mass", "frame_mass", "wheelset_mass", "wheelset_pitch_inertia", "wheel_radius", "wheel_base"),
        *("pivot_distance", "rolling_resistance_torque", "creepage_speed", "gravity", "shear_modulus"),
        *("rail_head_radius", "wheel_profile_curvature"),
    }
)
IN_PLANE = frozenset(
    {
        *("body_height", "body_pitch_inertia", "frame_height", "frame_pitch_inertia", "coupler_distance"),
        *("coupler_height", "longitudinal_stiffness", "longitudinal_damping", "vertical_stiffness", "vertical_damping"),
        *("secondary_height", "secondary_half_spacing", "secondary_bending_stiffness", "torque_reaction"),
        *("secondary_longitudinal_stiffness", "secondary_longitudinal_damping", "secondary_vertical_stiffness"),
        *("secondary_vertical_damping", "traction_rod_stiffness", "traction_rod_damping"),
    }
)
WITH_EFFECT = {1: AT_POINT, 2: AT_POINT | IN_PLANE}
#: Longest name of a vehicle.
LONGEST_NAME = 60
#: Tables of a file beside the entries at its top.
TABLES = ("resistance", "brake", *SHORT, "parameters")


@dataclass(frozen=True)
class SheetBrake:
    """The brake of a vehicle file.

    `values`: parameters of BrakedVehicle [SI].
    `full_pressure` [Pa]; `full_torque` [N.m]: of one wheelset at the mean friction.
    `application_time` [s]: from 0 to 95 %.
    `assumed`: how each value was found that the file does not give.
    `entries`: as the file has them.
    """

    acts_on: str
    values: Mapping[str, float]
    full_pressure: float
    full_torque: float
    application_time: float
    assumed: Mapping[str, str]
    entries: Mapping[str, Any]


@dataclass(frozen=True)
class DataSheet:
    """A vehicle from a file.

    Parameters
    ----------
    name, like : str
        Its name, and the built-in vehicle whose values are assumed.
    axles : int
        Number of wheelsets: 2, 4 or 6.
    parameters : BogieParameters
        Masses, sizes, springs; a VehicleParameters with 4 and 6 axles.
    resistance : mapping of str to float
        Running resistance, by the names of the FMU's parameters [SI].
    brake : SheetBrake or None
        Brake of each wheelset; None if the file has no [brake].
    assumed : mapping of str to str
        How each value was found that the file does not give, by the parameter's name.
    profile_files : tuple of Path
        Contact tables for level 3, of all wheelsets or of each; empty: the synthetic pair.
    parts : OwnParts
        Bodies and connections of the file.

    Attributes
    ----------
    path : Path or None
        The file; None if values were changed since it was read.
    digest : str
        Digest of it and of its contact tables.
    """

    name: str
    like: str
    axles: int
    parameters: BogieParameters
    resistance: Mapping[str, float] = field(default_factory=dict)
    brake: SheetBrake | None = None
    assumed: Mapping[str, str] = field(default_factory=dict)
    profile_files: tuple[Path, ...] = ()
    parts: OwnParts = field(default_factory=OwnParts)
    path: Path | None = field(default=None, init=False, compare=False, repr=False)  # `replace` leaves it out
    digest: str = field(default="", init=False, compare=False, repr=False)

    @property
    def fmu(self) -> str | None:
        """Name of the built-in FMU that the values suit; None if its equations have to be compiled.

        Bodies and connections are part of the equations.
        """
        if self.parts.first:
            return None
        return BRAKED_FMU if self.brake and self.axles == 4 else FMU_OF_AXLES.get(self.axles)

    @property
    def values(self) -> dict[str, float]:
        """Start values of that FMU [SI]."""
        brake = self.brake.values if self.brake and self.fmu == BRAKED_FMU else {}
        return self.parameters.values() | dict(self.resistance) | dict(brake)

    def values_at(self, level: object) -> dict[str, float]:
        """Return those of the values that have an effect at a level [SI]."""
        own = self.parameters.values()
        used = next((names for one, names in WITH_EFFECT.items() if one == level), None)
        return {name: one for name, one in self.values.items() if used is None or name in used or name not in own}

    @property
    def built_in(self) -> Vehicle:
        """The built-in vehicle with the parameters of the file, and the synthetic profiles on standard gauge."""
        if self.axles == 2:
            found = two_axle_bogie(self.parameters)
            pair = synthetic_pair()
            wheelsets = tuple(replace(wheelset, pair=pair) for wheelset in found.wheelsets)
            return replace(found, name=self.name, wheelsets=wheelsets)
        assert isinstance(self.parameters, VehicleParameters)
        make = four_axle_vehicle if self.axles == 4 else six_axle_vehicle
        return make(self.name, self.parameters, synthetic_pair(), self.like == "coach")

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle as data: the built-in one with the bodies and connections of the file."""
        return self.parts.added_to(self.built_in)

    @property
    def idle(self) -> set[str]:
        """Parameters that only those built-in connections use which the file replaces."""
        return parameters_in(self.built_in) - parameters_in(self.vehicle) if self.parts.first else set()

    @property
    def mass(self) -> float:
        """Mass on the rails [kg]."""
        wheelsets = self.axles * self.parameters.wheelset_mass
        frames = self.parameters.frame_mass * (1 if self.axles == 2 else 2)
        body = self.parameters.body_mass if isinstance(self.parameters, VehicleParameters) else 0.0
        return wheelsets + frames + body + self.parts.mass


def read_sheet(path: str | Path, made: Callable[[Mapping[str, Any], str], DataSheet]) -> DataSheet:
    """Return the vehicle in a TOML file; made: from its content and name. Raises FileError as `read_vehicle`."""
    try:
        read = toml_of(path)
    except OSError as error:
        raise FileError(str(error)) from None
    try:
        sheet = made(read, Path(path).stem)
        tables = contact_tables([Path(path).parent / table for table in sheet.profile_files], sheet.axles)
    except ValueError as error:
        raise FileError(f"{path}: {error}") from None
    found = replace(sheet, profile_files=tables)
    content = b"".join(one.read_bytes() for one in (Path(path), *tables))
    object.__setattr__(found, "path", Path(path))
    object.__setattr__(found, "digest", hashlib.sha256(content).hexdigest()[:24])
    return found


def contact_tables(paths: Sequence[Path], wheelsets: int) -> tuple[Path, ...]:
    """Return the paths of contact tables if they can be read and suit the number of wheelsets. Raises ValueError."""
    try:
        count = sum(len(read_pairs(path)) for path in paths)
    except (OSError, ValueError) as error:
        raise ValueError(f"profile_file must be a contact table of 'bogie-braking profile'. {error}") from None
    if count not in (0, 1, wheelsets):
        raise ValueError(
            f"profile_file must name one contact table for all wheelsets or one for each, {wheelsets}; got {count}. "
            "Correct it."
        )
    return tuple(path.absolute() for path in paths)


def unbraked(read: Mapping[str, Any], name: str = "vehicle") -> tuple[DataSheet, Mapping[str, Any]]:
    """Return the vehicle of a file's content without its brake, and the table of that. Raises ValueError."""
    names = [*ENTRIES, "name", "like", "profile_file", ENTRY, *TABLES, *ROWS]
    read = with_columns(read, names)
    check_names(read, names, "")
    tables = {table: _table(read, table) for table in TABLES}
    title, like, axles = read.get("name", name), _like(read), _axles(read)
    if not isinstance(title, str) or not title.isprintable() or not 0 < len(title) <= LONGEST_NAME:
        limit = f"name must be a printable text of at most {LONGEST_NAME} characters"
        raise ValueError(f"{limit}; got {shown(title)}. Put it in quotes, or shorten it.")
    parts = own_parts(read, axles)
    profiles = _profile_files(read.get("profile_file", []))
    given = {key: number_of(ENTRIES[key], value, key) for key, value in read.items() if key in ENTRIES}
    given.pop("axles", None)
    base = _base(like, axles)
    own = _own_parameters(tables["parameters"], base)
    parameters, assumed = _sized(base, like, axles, given, own, parts.mass)
    resistance = _resistance(tables["resistance"])
    if "length" in given and "pivot_distance" in {**given, **tables["parameters"]}:
        check_length(parameters, given["length"])
    sheet = DataSheet(title, like, axles, parameters, resistance, None, assumed, profiles, parts)
    return _without_idle(sheet, given, own), tables["brake"]


def _base(like: str, axles: int) -> BogieParameters:
    """Return the parameters of the built-in vehicle, with the gravity of consists.

    The thesis and the benchmarks have 9.81 m/s2.
    """
    base = replace(LIKE[like][1](), gravity=GRAVITY)
    if axles == 2 and isinstance(base, VehicleParameters):
        raise ValueError(f"like must be bogie for 2 axles; got {like}. A coach and a wagon have 4 or 6.")
    if axles != 2 and not isinstance(base, VehicleParameters):
        raise ValueError(f"like must be {' or '.join(k for k in LIKE if k != 'bogie')} for {axles} axles; got {like}.")
    return base


def _without_idle(sheet: DataSheet, given: Mapping[str, float], own: Mapping[str, float]) -> DataSheet:
    """Return a vehicle without assumed values that have no effect. Raises ValueError if the file states one."""
    idle = sheet.idle
    for key, value in {**given, **own}.items():
        if PARAMETER_OF.get(key, key) in idle:
            where = "[parameters] " if key in own else ""
            raise ValueError(
                f"{where}{key} must be left out, as only built-in connections use it, which the file replaces; got"
                f" {value:g}. Remove it."
            )
    return replace(sheet, assumed={key: text for key, text in sheet.assumed.items() if key not in idle})


def _profile_files(given: object) -> tuple[Path, ...]:
    """Return the paths of contact tables: a list, or a text with semicolons between them. Raises ValueError."""
    paths = [one.strip() for one in given.split(";")] if isinstance(given, str) else given
    if not isinstance(paths, list) or not all(isinstance(path, str) for path in paths):
        raise ValueError(
            f"profile_file must be the path of a contact table, or a list of paths; got {shown(given)}. Put paths in "
            "quotes."
        )
    return tuple(map(Path, paths))


def check_length(parameters: BogieParameters, length: float) -> None:
    """Raise ValueError if the pivots of the bogies lie outside of a vehicle of this length [m]."""
    if isinstance(parameters, VehicleParameters) and parameters.pivot_distance > length:
        raise ValueError(
            f"length must be at least the pivot_distance of {parameters.pivot_distance:g} m; got {length:g} m."
            " Check both."
        )


def _table(read: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = read.get(name, {})
    if not isinstance(found, Mapping):
        raise ValueError(f"{name} must be a table; got {shown(found)}. Write [{name}] and its entries below it.")
    return found


def _like(read: Mapping[str, Any]) -> str:
    default = "bogie" if read.get("axles") == 2 else "coach"
    return choice_of(LIKE, read.get("like", default), "like", "Name the most similar one.")


def _axles(read: Mapping[str, Any]) -> int:
    axles = read.get("axles", 2 if read.get("like") == "bogie" else 4)
    if isinstance(axles, bool) or axles not in (2, 4, 6):
        raise ValueError(
            f"axles must be 2, 4 or 6; got {shown(axles)}. Define other vehicles in Python, docs/vehicles.md."
        )
    return int(axles)


def _own_parameters(table: Mapping[str, Any], base: BogieParameters) -> dict[str, float]:
    known = {item.name: item for item in fields(base)}
    check_names(table, list(known), "[parameters] ")
    return {key: number_of(parameter_entry(known[key]), value, f"[parameters] {key}") for key, value in table.items()}


def _resistance(table: Mapping[str, Any]) -> dict[str, float]:
    check_names(table, list(RESISTANCE), "[resistance] ")
    return {
        RESISTANCE[key][0]: number_of(RESISTANCE[key][1], value, f"[resistance] {key}") for key, value in table.items()
    }


def _sized(
    base: BogieParameters,
    like: str,
    axles: int,
    given: Mapping[str, float],
    own: Mapping[str, float],
    bodies: float,
) -> tuple[BogieParameters, dict[str, str]]:
    """Return the parameter set, and how the values were found that neither entries nor [parameters] give.

    Takes bodies [kg]: mass of the file's own bodies.
    """
    entries = _without_twice(_from_entries(base, given), own)
    values = base.values() | entries | dict(own)
    stated = entries | dict(own)
    derived = _masses(base, values, axles, given, stated, bodies)
    for key, (value, _) in derived.items():
        if key in own:
            raise ValueError(f"[parameters] {key} must be left out beside tare; got both. State one of them.")
        values[key] = value
    assumed = {key: text for key, (_, text) in derived.items() if text}
    inertias = _inertias(base, values, stated)
    values |= {key: value for key, (value, _) in inertias.items()}
    assumed |= {key: text for key, (_, text) in inertias.items()}
    for key in base.values():
        if key not in (stated.keys() | derived.keys() | inertias.keys() | SETTINGS):
            assumed[key] = f"as the {like}"
    return type(base)(**values), assumed


def _without_twice(entries: dict[str, float], own: Mapping[str, float]) -> dict[str, float]:
    for key in entries:
        if key in own:
            raise ValueError(
                f"[parameters] {key} must be stated once; the entries at the top give it too. Leave one out."
            )
    return entries


def _from_entries(base: BogieParameters, given: Mapping[str, float]) -> dict[str, float]:
    """Return parameters that an entry alone gives; heights of a file are above the rail, those of the set the axles."""
    radius = given.get("wheel_diameter", 2 * base.wheel_radius) / 2
    found: dict[str, float] = {}
    for key, value in given.items():
        parameter = PARAMETER_OF.get(key)
        if parameter is None:
            continue
        if parameter not in base.values():
            raise ValueError(f"{key} must be left out for a vehicle like the bogie; got {value:g}. It has one body.")
        found[parameter] = value / 2 if key == "wheel_diameter" else value - (radius if key in HEIGHTS else 0.0)
    return found


def _masses(
    base: BogieParameters,
    values: Mapping[str, float],
    axles: int,
    given: Mapping[str, float],
    stated: Mapping[str, float],
    bodies: float,
) -> dict[str, tuple[float, str]]:
    """Return the mass of the body from that on the rails, and the inertia of wheelsets from their rotating mass."""
    found: dict[str, tuple[float, str]] = {}
    body = "body_mass" if "body_mass" in values else "frame_mass"
    if "tare" in given:
        rest = bodies + axles * values["wheelset_mass"] + (2 * values["frame_mass"] if body == "body_mass" else 0.0)
        mass = given["tare"] + given.get("load", 0.0) - rest
        if not mass > 0.0:
            hint = likely_unit(mass + rest, "kg", rest, HEAVIEST) or " Give wheelset_mass and bogie_frame_mass too."
            raise ValueError(
                f"tare and load must be above {rest:g} kg, the mass of wheelsets and frames; got {mass + rest:g} kg."
                f"{hint}"
            )
        found[body] = mass, ""
    elif "load" in given:
        if body in stated:
            raise ValueError(f"load must come with tare; got it with {body}. Give tare.")
        found[body] = (
            values[body] + given["load"],
            f"that of the built-in vehicle plus the load of {given['load']:g} kg",
        )
    if "rotating_mass" in given:
        found["wheelset_pitch_inertia"] = given["rotating_mass"] / axles * values["wheel_radius"] ** 2, ""
    return found


def _inertias(
    base: BogieParameters, values: Mapping[str, float], stated: Mapping[str, float]
) -> dict[str, tuple[float, str]]:
    """Return moments of inertia in proportion to the mass, those about y and z also to the square of the length."""
    found: dict[str, tuple[float, str]] = {}
    parts = [("wheelset", 1.0), ("frame", 1.0)]
    if isinstance(base, VehicleParameters):
        parts = [*parts, ("body", values["coupler_distance"] / base.coupler_distance)]
    for part, longer in parts:
        heavier = values[f"{part}_mass"] / base.values()[f"{part}_mass"]
        for axis, lengths in (("roll", 0), ("pitch", 2), ("yaw", 2)):
            key = f"{part}_{axis}_inertia"
            if key in stated or (heavier == 1.0 and (lengths == 0 or longer == 1.0)) or key == "wheelset_pitch_inertia":
                continue
            rule = "in proportion to the mass" + (
                " and to the square of the length" if longer != 1.0 and lengths else ""
            )
            found[key] = base.values()[key] * heavier * longer**lengths, rule
    return found
