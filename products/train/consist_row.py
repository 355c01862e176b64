"""A row of a consist: read, checked, solved and packed into a vehicle; and the row that states a vehicle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from brake_controller.air import DISCHARGE
from brake_controller.distributors import distributors
from brake_controller.distributors.vacuum import VacuumBrake
from brake_controller.drivers_valve import DriversValve, drivers_valve
from brake_controller.vacuum_valve import VacuumValve
from products.train.brake_columns import brake_of, distributor_of, row_of_brake, row_of_distributor
from products.train.cab_columns import direct_brake_of, main_reservoir_of, row_of_cab, vigilance_of
from products.train.consist import EMPTY, KINDS, TrainVehicle, braked_with
from products.train.consist_columns import COUPLING, FORCE, si, values_of
from products.train.consist_rules import check_rules
from products.train.detail_columns import DETERMINED, detail_of, row_of_detail
from products.train.drive_columns import electric_of, row_of_electric, row_of_traction, traction_of
from products.train.heat_columns import heat_of, row_of_heat
from products.train.row_statements import FILLED_AS, cut_out, load_of, resolved
from products.train.slide_columns import NOTHING, protection_of, row_of_protection, vented_of
from products.train.track_columns import parking_of, row_of_track, track_of
from products.train.vacuum_trains import row_of_valve
from rbd_model.train.coupler import COUPLERS, Coupler, with_numbers

Row = dict[str, Any]
#: Columns with which the brake is not that of the kind: those that state it, or resize it.
OF_BRAKE = {
    *(*FORCE, "friction", "friction_table", "brake", "full_pressure", "fill_time", "release_time", "auxiliary"),
    *("cylinder", "rotating", "resistance_a", "resistance_b", "resistance_c", "blending"),
}
#: Note on wheel brakes below the least percentage that a row may state.
MAGNETS_ALONE = (
    "magnets of a vehicle with position = R+Mg have nearly all of its {:.3g} %, so its wheel brakes have almost none. "
    "Increase brake_weight, or decrease magnetic_attraction"
)


def vehicle_of(
    row: Mapping[str, Any], couplers: Mapping[str, Coupler], notes: dict[str, None]
) -> tuple[TrainVehicle, dict[str, Any]]:
    """Return the vehicle of a row and its values; couplers: those of the tables of its file. Raises ValueError.

    notes: get messages about names and words that are read as others, and about assumed forces.
    """
    values = cut_out(values_of(row, couplers, notes))
    detail = detail_of(values)
    if detail:
        values = values | detail.columns()
        notes |= dict.fromkeys([detail.unused[:-1]] if detail.unused else [])
    check_rules(values, values.get("coupler") in couplers)
    values = resolved(values, notes)
    one = replace(_body_of(values), coupler=_coupler_of(values, couplers))
    one = replace(one, track=track_of(values, one.mass), parking=parking_of(values, one.mass))
    one = replace(one, distributor=vented_of(values, distributor_of(values, one.distributor)))
    if values.get("brake") == "none":
        one = replace(one, brake=braked_with(0.0))
    elif OF_BRAKE & set(values) or isinstance(one.distributor, VacuumBrake):  # not sized for the pressure of air
        one = replace(one, brake=brake_of(values, one))
    if values.get("position") == "R+Mg" and "lambda" in values and one.percentage < FORCE["lambda"].least:
        notes[MAGNETS_ALONE.format(values["lambda"])] = None
    one = replace(one, electric=electric_of(values, one.distributor), heat=heat_of(values, one.brake))
    one = replace(one, traction=traction_of(values), adhesion=values.get("adhesion", "input"))
    controller = values.get("protection", NOTHING)
    one = replace(one, protection=protection_of(values, one.distributor), controller=controller, detail=detail)
    one = replace(one, handle=values.get("handle", ""))
    main = main_reservoir_of(values)
    direct = direct_brake_of(values, one.distributor, main)
    one = replace(one, main_reservoir=main, direct=direct, vigilance=vigilance_of(values))
    return _with_valve(values, one), values


def row_of(train_vehicle: TrainVehicle) -> Row:
    """Return the row that states a vehicle, as near as columns can."""
    a, b, c = train_vehicle.resistance
    row: Row = {"kind": train_vehicle.kind} | ({"name": train_vehicle.name} if train_vehicle.name else {})
    row |= {
        "mass": 1e-3 * train_vehicle.mass,
        "length": train_vehicle.length,
        "rotating": 1e2 * train_vehicle.rotating_share,
    }
    row |= {"resistance_a": a, "resistance_b": b, "resistance_c": c}
    row |= row_of_brake(train_vehicle) | row_of_distributor(train_vehicle)
    row |= row_of_electric(train_vehicle.electric) | row_of_traction(train_vehicle.traction)
    row |= row_of_heat(train_vehicle.heat) | row_of_track(train_vehicle.track, train_vehicle.parking)
    row |= row_of_protection(train_vehicle.protection, train_vehicle.controller, train_vehicle.distributor)
    row |= row_of_cab(train_vehicle.direct, train_vehicle.main_reservoir, train_vehicle.vigilance)
    row |= {} if train_vehicle.adhesion == "input" else {"adhesion": train_vehicle.adhesion}
    if train_vehicle.friction_ratio != 1.0:
        row |= {"friction_ratio": train_vehicle.friction_ratio, "friction_decay": train_vehicle.friction_decay}
    row |= {"pipe_diameter": 1e3 * train_vehicle.pipe_diameter, "at": train_vehicle.distributor_at}
    if train_vehicle.leak:
        row["leak"] = 1e3 * (4 / math.pi * train_vehicle.leak / DISCHARGE) ** 0.5
    if train_vehicle.branch:
        row["branch"] = 1e3 * train_vehicle.branch
    row |= _row_of_coupler(train_vehicle.coupler) | _row_of_valve(train_vehicle)
    own = {*DETERMINED, *train_vehicle.detail.columns()} if train_vehicle.detail else ()
    return {name: value for name, value in row.items() if name not in own} | row_of_detail(train_vehicle.detail)


def _body_of(values: Mapping[str, Any]) -> TrainVehicle:
    """Return a vehicle with its masses, resistance, distributor and pipe."""
    kind, position = values["kind"], values.get("position", "P")
    position = FILLED_AS.get(position, position)
    load = values["mass"] - 1e-3 * EMPTY[kind] if "mass" in values else load_of(values)
    more = {"weighing": values["weighing"]} if "weighing" in values else {}
    more |= {"weighing": "none"} if "empty_load" in values and kind == "wagon" else {}
    one = KINDS[kind](1e3 * load, position, **more)
    if "distributor" in values:
        one = replace(one, distributor=distributors()[values["distributor"]].ready(position))
    names = ("resistance_a", "resistance_b", "resistance_c")
    a, b, c = (values.get(name, 0.0) for name in names)  # Davis 1926
    return replace(
        one,
        name=values.get("name", ""),
        length=values.get("length", one.length),
        resistance=(a, b, c) if set(names) & set(values) else one.formula.of(one.mass),
        friction_ratio=values.get("friction_ratio", one.friction_ratio),
        friction_decay=values.get("friction_decay", one.friction_decay),
        rotating_share=si(values, "rotating", one.rotating_share),
        distributor_at=values.get("at", 0.5),
        pipe_diameter=si(values, "pipe_diameter", one.pipe_diameter),
        branch=si(values, "branch"),
        leak=DISCHARGE * math.pi / 4 * si(values, "leak") ** 2,
    )


def _coupler_of(values: Mapping[str, Any], couplers: Mapping[str, Coupler]) -> Coupler:
    """Return the coupler behind a vehicle: of a table, or built-in with numbers of the row instead of its own."""
    name = values.get("coupler", "screw")
    if name in couplers:
        return couplers[name]
    one = COUPLERS[name]()
    numbers = {column.removeprefix("coupler_"): si(values, column) for column in COUPLING if column in values}
    if not numbers:
        return one
    found = with_numbers(one, **numbers)
    if values.get("coupler_damping", 0.0) > 0.0 and not found.dissipates:
        most = 1e-6 * one.sticking_stiffness
        raise ValueError(
            f"coupler_damping must come with a coupler_stiffness below {most:g} MN/m, at which the friction of a "
            f"{one.name} coupler sticks. Decrease coupler_stiffness, or leave coupler_damping out."
        )
    return found


def _row_of_coupler(coupler: Coupler) -> Row:
    """Return the columns of a coupler: a built-in one, one with a stiffness of its own, or the name of a table."""
    strength = {} if math.isinf(coupler.strength) else {"coupler_strength": 1e-3 * coupler.strength}
    if coupler.name not in COUPLERS:
        return {"coupler": coupler.name}
    if replace(coupler, strength=math.inf) == COUPLERS[coupler.name]():
        return {"coupler": coupler.name} | strength
    loading, unloading = coupler.compression
    ways, forces = loading.ways, loading.forces
    slack = max(way for way, force in zip(ways, forces, strict=True) if force == 0.0) if forces[0] == 0.0 else 0.0
    stiffness = (forces[-1] - forces[-2]) / (ways[-1] - ways[-2])
    row: Row = {"coupler": coupler.name, "coupler_stiffness": 1e-6 * stiffness, "coupler_preload": 1e-3 * forces[-2]}
    row["coupler_slack"] = 1e3 * slack
    damping = round(1.0 - unloading.forces[-1] / forces[-1], 12)
    return row | ({"coupler_damping": damping} if coupler.dissipates or not damping else {}) | strength


def _with_valve(values: Mapping[str, Any], train_vehicle: TrainVehicle) -> TrainVehicle:
    """Return a vehicle with its driver's valve, with the rate and the exhaust of a row."""
    name = values.get("valve")
    if name == "none":
        return replace(train_vehicle, valve=None)
    if name is not None:
        delay = values.get("delay", 0.0) if name == "second" else -1.0
        train_vehicle = replace(train_vehicle, valve=drivers_valve(), valve_delay=delay, leads=name == "head")
    if train_vehicle.valve is None:
        return train_vehicle
    assert isinstance(train_vehicle.valve, DriversValve)
    rate = si(values, "service_rate", train_vehicle.valve.service_rate)
    exhaust = math.pi / 4 * si(values, "exhaust") ** 2 if "exhaust" in values else train_vehicle.valve.exhaust_area
    return replace(train_vehicle, valve=replace(train_vehicle.valve, service_rate=rate, exhaust_area=exhaust))


def _row_of_valve(train_vehicle: TrainVehicle) -> Row:
    if train_vehicle.valve is None:
        return {"valve": "none"} if train_vehicle.kind == "locomotive" else {}
    row: Row = (
        {"valve": "head"}
        if train_vehicle.valve_delay < 0.0
        else {"valve": "second", "delay": train_vehicle.valve_delay}
    )
    row |= {"handle": train_vehicle.handle} if train_vehicle.handle else {}
    if isinstance(train_vehicle.valve, VacuumValve):
        return row | row_of_valve(train_vehicle.valve)
    usual = drivers_valve()
    if train_vehicle.valve.service_rate != usual.service_rate:
        row["service_rate"] = 1e-5 * train_vehicle.valve.service_rate
    if train_vehicle.valve.exhaust_area != usual.exhaust_area:
        row["exhaust"] = 1e3 * (4 / math.pi * train_vehicle.valve.exhaust_area) ** 0.5
    return row
