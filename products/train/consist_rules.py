"""Columns of a consist that need or exclude each other: a rule a line, and one function that applies all to a row."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from brake_controller.distributors import DISTRIBUTORS, distributors
from brake_controller.distributors.aar import OF_AAR
from brake_controller.distributors.registered import ADJUSTED
from brake_controller.distributors.uic import UIC
from brake_controller.distributors.vacuum import OF_VACUUM
from brake_controller.vehicle_brake import FORCELESS, FRICTIONS
from products.train.cell_tables import points_in
from products.train.consist import EMPTY, EMPTY_UP_TO, PERCENTAGE
from products.train.consist_columns import CAB, COUPLING, DETAIL, FORCE, HEAT, SLIDE, TRACK, TRACTION
from products.train.row_statements import STATEMENTS, check_mass, check_statements, is_american

Row = Mapping[str, Any]
Rule = Callable[[Row], None]
#: Statements of the force at the rims, in which friction is included; the last are those of kinds without a statement.
AT_RIMS = ("lambda", "deceleration", "brake_force", "brake_weight", *(f"the lambda of a {kind}" for kind in PERCENTAGE))
_BY_PIPE = ("distributor", "position", "auxiliary", "cylinder", *OF_AAR, *OF_VACUUM)
_OF_BRAKE = ("full_pressure", "fill_time", "release_time", *FORCE, *HEAT, "fade_table", "friction", "weighing")
#: Messages: of columns that need others, and of columns that exclude others.
WITH, WITHOUT = "{name} must come with {others}", "{name} must be left out with {other}"
NEEDED, ADD = f"{WITH}. Add it, or leave {{name}} out.", f"{WITH}. Add it."
ONE_OF, LEAVE_ONE = f"{WITH}. Add one of them, or leave", "Leave one of them out."
IDLE = "{name} has no effect with {other}. Leave it out."


def facts_of(values: Row, own_coupler: bool) -> dict[str, Any]:
    """Return the values of a row, and facts that follow from them; own_coupler: it has one of a table."""
    kind, found = values["kind"], {"brake": "pneumatic"} | dict(values)
    facts = {
        f"the lambda of a {kind}": kind in PERCENTAGE and not set(STATEMENTS) & set(values),
        "friction of a wagon": kind == "wagon" and "friction" not in values and not set(AT_RIMS) & set(values),
        "a [[coupler]]": own_coupler,
        "by wire": DISTRIBUTORS.get(values.get("distributor", UIC.name), UIC).wired,
        "both times": {"fill_time", "release_time"} <= set(values),
        "a constant value": values.get("friction") == "constant" and "friction_value" in values,
        "several": values.get("count", 1) > 1,
        "a valve": values.get("valve", "head" if kind == "locomotive" else "none") != "none",
        "no rotating mass": values.get("rotating") == 0.0,
        "an American car": is_american(values),
        "a protection": values.get("protection", "none") != "none",
    }
    return found | {fact: True for fact, holds in facts.items() if holds}


def _holding(statements: Iterable[str], row: Row) -> list[str]:
    """Return the statements that a row makes: a column or fact, or a column with a word, as "friction = speed"."""
    parts = ((statement, *statement.partition(" = ")) for statement in statements)
    return [one for one, name, equals, word in parts if (row.get(name) == word if equals else name in row)]


def needs(names: Iterable[str], others: Iterable[str], text: str = NEEDED) -> Rule:
    """Return the rule that each statement needs one of the others. Its text may name values of the row."""

    def check(row: Row) -> None:
        for name in _holding(names, row):
            if not _holding(others, row):
                raise ValueError(text.format(name=name, others=" or ".join(others), row=row))

    return check


def excludes(names: Iterable[str], others: Iterable[str], text: str) -> Rule:
    """Return the rule that each statement excludes each of the others. Its text may name values of the row."""

    def check(row: Row) -> None:
        for name in _holding(names, row):
            for other in _holding(others, row):
                raise ValueError(text.format(name=name, other=other, row=row))

    return check


def _check_resistance(row: Row) -> None:
    names = ("resistance_a", "resistance_b", "resistance_c")
    stated = _holding(names, row)
    if stated not in ([], ["resistance_a"], list(names)):
        got = ", ".join(stated)
        raise ValueError(f"resistance_a must come alone, or all of {', '.join(names)}; got {got}. Add 0s.")


def _check_distributor(row: Row) -> None:
    """Check that a row has only columns with an effect on its distributor. Raises ValueError."""
    kinds = distributors()
    kind = kinds[row.get("distributor", UIC.name)]
    for name in (one for one in ADJUSTED if one in row and row["brake"] == "pneumatic"):
        if name not in kind.adjustable:
            *first, last = [one.name for one in kinds.values() if name in one.adjustable]
            takers = f"{', '.join(first)} or {last}" if first else last
            raise ValueError(f"{name} must be of the distributor {takers}; got {kind.name}. Leave {name} out.")
    idle = {"dead_time": not (kind.wired or kind.assisted), "position": kind.ready("P") == kind.ready("G")}
    for name in (one for one in idle if one in row and idle[one] and row["brake"] == "pneumatic"):
        raise ValueError(f"{name} has no effect with distributor = {kind.name}. Leave it out.")


def _check_empty(row: Row) -> None:
    """Check that a car with an empty/load device is empty. Raises ValueError."""
    mass = row.get("mass", 1e-3 * EMPTY[row["kind"]] + row.get("load", math.nan))
    if "empty_load" in row and not mass <= 1e-3 * EMPTY_UP_TO:
        got = "none" if math.isnan(mass) else f"{mass:g} t"
        raise ValueError(
            f"empty_load must come with the load or mass of an empty car, at most {1e-3 * EMPTY_UP_TO:g} t in all; got "
            f"{got}. Set load to 0, or leave empty_load out: a loaded car has its whole force."
        )


def _check_table(name: str) -> Rule:
    """Return the rule that a table can be read; that of friction must be there with friction = table."""

    def check(row: Row) -> None:
        if name in row or (name, row.get("friction")) == ("friction_table", "table"):
            points_in(name, row.get(name, ""))

    return check


_DYNAMIC, _TRACTION = ("dynamic_force", "dynamic_table"), ("traction_force", "traction_table")
_MASSES, _PARKING = ("wheel_mass", "disc_mass"), ("parking_force", "parking_gradient")
_RAPID = ("position = R", "position = R+Mg")
_DIRECT = tuple(name for name in CAB if name.startswith("direct_"))
_RIGGING = ("cylinders", "rigging_ratio", "rigging_efficiency", "return_force")
_VALUED = ("friction = constant", "friction = speed")
_LAWS, _AT_SPEED = tuple(f"friction = {friction}" for friction in FRICTIONS), ("friction = speed",)
_OTHER_LAWS = tuple(f"friction = {one}" for one in (*FRICTIONS, *FORCELESS) if one != "constant")
_MAGNETS = "the attraction of all magnets: four of 40 kN have 160 kN, and 35 to 70 kN each are reported"
_TWICE = f"{WITHOUT}, which has the forces. {LEAVE_ONE}"
_TOGETHER = "friction_ratio and friction_decay must come together: one alone has no effect. Give both."
_NO_PIPE = "{name} must be of a brake that the pipe controls; got {other}. Leave blending out, or take another."
_CLOSES = "blending_speed must come with blending = closes, and that with it. Add both, or neither."
_SHOES = f"a friction that depends on the force of a shoe, one of {', '.join(FRICTIONS)}. Add friction, or leave"
#: Rules in their order; the message is that of the first rule that a row breaks.
RULES: tuple[Rule, ...] = (
    check_mass,
    needs(["friction_ratio"], ["friction_decay"], _TOGETHER),
    needs(["friction_decay"], ["friction_ratio"], _TOGETHER),
    needs(["weighing"], ["kind = wagon"], "{name} must be of a wagon; the vehicle is a {row[kind]}. Leave it out."),
    _check_resistance,
    *(
        excludes([one], ["a [[coupler]]"], f"{WITHOUT}, which has its own {one[len('coupler_') :]}. Leave it out.")
        for one in COUPLING
    ),
    needs(["coupler_preload"], ["coupler_stiffness"]),
    excludes(_BY_PIPE, ["brake = ep-direct"], IDLE),
    excludes(["dead_time", *_BY_PIPE, *_OF_BRAKE, *_DIRECT], ["brake = none"], IDLE),
    _check_distributor,
    excludes(["position"], ["both times"], f"{{name}} has no effect with fill_time and release_time. {LEAVE_ONE}"),
    check_statements,
    needs(_RIGGING, ["cylinder_diameter"], f"{WITH}. Add {{others}}, or leave {{name}} out."),
    needs(["cylinder_diameter"], ["rigging_ratio"], ADD),
    needs(_RAPID, STATEMENTS, "{name} must come with its force: it fills as P. Add brake_weight or lambda."),
    needs(["position = R+Mg"], ["magnetic_attraction"], f"{WITH}, {_MAGNETS}. Add it, or write R."),
    excludes(["weighing"], STATEMENTS, f"{WITHOUT}, which is that of the load. Leave it out."),
    excludes(
        _OTHER_LAWS,
        ["deceleration"],
        "friction must be constant with {other}; got {row[friction]}. State brake_force instead.",
    ),
    needs(["friction_value"], _VALUED, NEEDED.replace("{others}", "friction = constant or speed")),
    needs(["friction_fast", "friction_speed"], _AT_SPEED),
    needs(_AT_SPEED, ["friction_fast"], ADD),
    needs(_AT_SPEED, ["friction_speed"], ADD),
    needs(["friction_table"], ["friction = table"]),
    _check_table("friction_table"),
    excludes(
        ["a constant value"],
        AT_RIMS,
        "friction_value must be left out with {other}, a force at the rims. Leave it out.",
    ),
    needs(["friction_radius"], ["friction = pads"]),
    needs(["shoes"], [*_LAWS, "friction of a wagon"], f"{{name}} must come with {_SHOES} {{name}} out."),
    needs(
        ["shoe_force", "net_braking_ratio", "cylinder_diameter"],
        ["friction", "kind = wagon"],
        "friction must come with {name} of a {row[kind]}. Add friction.",
    ),
    needs(_AT_SPEED, ["friction_value"], ADD),
    needs(["friction = constant"], ["friction_value", *AT_RIMS], "{name} must come with friction_value. Add it."),
    excludes(["weighing"], ["empty_load"], f"{WITHOUT}, which is in its place. {LEAVE_ONE}"),
    excludes(
        ["weighing"],
        ["an American car"],
        "{name} must be left out with distributor = {row[distributor]}: its cars have a net braking ratio. State "
        "net_braking_ratio, or empty_load of aar.",
    ),
    excludes(
        ["empty_load"],
        [*AT_RIMS[:3], "shoe_force", "net_braking_ratio", *AT_RIMS[3:]],
        f"{WITHOUT}, the force of this load. Leave it out, or state the brake by cylinder_diameter.",
    ),
    _check_empty,
    excludes(["dynamic_force"], ["dynamic_table"], _TWICE),
    needs(["dynamic_power", "dynamic_fade", "dynamic_rise"], _DYNAMIC, f"{ONE_OF} {{name}} out."),
    _check_table("dynamic_table"),
    excludes(["traction_force"], ["traction_table"], _TWICE),
    needs(["traction_power", "traction_rise", "traction_cut_out"], _TRACTION, f"{ONE_OF} {{name}} out."),
    _check_table("traction_table"),
    needs(["blending"], _DYNAMIC, f"{ONE_OF} it out."),
    needs(
        ["blending = fills", "blending = adds", "blending = closes"],
        ["brake = ep-direct", "by wire"],
        "blending must be of brake = ep-direct, or of a distributor by wire; other brakes add, or have the interlock. "
        "Leave it out, or take interlock.",
    ),
    excludes(["blending = interlock"], ["brake = ep-direct", "brake = none", "by wire"], _NO_PIPE),
    needs(["blending_speed"], ["blending = closes"], _CLOSES),
    needs(["blending = closes"], ["blending_speed"], _CLOSES),
    needs(["traction_force"], ["traction_power"], f"{WITH}, or slipping wheels would spin up without a limit. Add it."),
    excludes(
        ["no rotating mass"],
        [*TRACTION, "traction_table"],
        "rotating must be above 0 % on a vehicle with motors; got 0. Raise it, or leave it out.",
    ),
    excludes(["wheel_mass"], ["disc_mass"], f"{WITHOUT}: one body takes the heat. Leave one out."),
    needs(["wheels"], ["wheel_mass"]),
    needs(["discs"], ["disc_mass"]),
    needs([*HEAT, "fade_table"], _MASSES),
    needs(["rubbed_area"], ["thickness"]),
    needs([name for name in HEAT if name.startswith("block_")], ["block_mass"]),
    needs([name for name in TRACK if name.startswith("magnetic")], ["magnetic_attraction"]),
    needs([name for name in TRACK if name.startswith("eddy")], ["eddy_force"]),
    needs(["track_brake_pressure"], ["magnetic_attraction", "eddy_force"]),
    needs(["parking_time", "parking_compounding"], _PARKING),
    excludes(_PARKING[:1], _PARKING[1:], "a parking brake must be stated once; got {name} and {other}. Leave one out."),
    excludes(["release_time"], ["retainer = slow-direct"], f"{{name}} has no effect with {{other}}. {LEAVE_ONE}"),
    needs(
        [name for name in SLIDE if name != "vent_time"],
        ["a protection"],
        "{name} must come with protection = built-in or a file. Add it, or leave {name} out.",
    ),
    excludes(["a protection"], ["brake = none"], "protection has no effect with brake = none. Leave it out."),
    excludes(["vent_time"], ["brake = none"], IDLE),
    excludes(
        ["no rotating mass"],
        ["a protection"],
        "rotating must be above 0 % on a vehicle with a protection; got 0. Raise it, or leave it out.",
    ),
    needs(
        ["delay"],
        ["valve = second"],
        "{name} must be of a valve that follows by radio. Set valve to second, or leave it out.",
    ),
    excludes(
        ["several"],
        ["valve = head", "valve = second"],
        "count must be 1 with a {row[valve]} valve; got {row[count]:.0f}. Give that vehicle a row of its own.",
    ),
    needs(_DIRECT, ["direct_pressure"]),
    needs(["compressor", "cut_in", "cut_out", "start_pressure"], ["main_reservoir"]),
    needs(
        ["main_reservoir"],
        ["a valve", "direct_pressure"],
        "{name} must supply a driver's valve or a direct brake. Set valve to head, or add direct_pressure.",
    ),
    needs(["warning_time", "vigilance_penalty"], ["vigilance_time"]),
    excludes(
        ["direct_pressure", "main_reservoir", "blending = interlock"],
        ["distributor = vacuum"],
        "{name} must be of a brake by compressed air; got {other}. Leave it out.",
    ),
    needs(
        ["distributor = vacuum"],
        [*STATEMENTS, "kind = locomotive", "kind = coach"],
        f"{{name}} of a wagon must come with {' or '.join(STATEMENTS)}. Add one of them.",
    ),
    needs(
        ["service_rate", "exhaust", "exhauster", "ejector", "handle", "vigilance_time"],
        ["a valve"],
        "{name} must be of a vehicle with a driver's valve. Set valve to head, or leave it out.",
    ),
    needs([*DETAIL], ["detail"]),
    excludes(
        [*TRACK],
        ["detail"],
        "{name} must be left out with detail: the forces of track brakes do not act on such a vehicle. Leave it out.",
    ),
)


def check_rules(values: Row, own_coupler: bool = False) -> None:
    """Check that a row has what its values need, and nothing without an effect. Raises ValueError."""
    facts = facts_of(values, own_coupler)
    for rule in RULES:
        rule(facts)
