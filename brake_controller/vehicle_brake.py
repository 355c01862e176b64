"""Brake force at the rim of a train's vehicle by its cylinder pressure: rigging, shoes, load weighing."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from brake_controller.air import AMBIENT
from brake_controller.rigging import shoe_force
from brake_controller.shoe_friction import COMPOSITE, CONSTANT, KARWATZKI, LAWS, composite, karwatzki
from fmu_src.chain import function_of
from fmu_src.system import ParameterSet, choice, quantity


@dataclass(frozen=True)
class VehicleBrake(ParameterSet):
    """All shoes or discs of one vehicle."""

    force_per_pressure: float = quantity("N/Pa", "Force of all shoes over the cylinder's pressure, without losses", 0.0)
    counter_force: float = quantity("N", "Force of springs at the shoes that draw them back", 0.0)
    efficiency: float = quantity("1", "Efficiency of the rigging", 0.0, 1.0)
    shoes: float = quantity("1", "Number of shoes", 1.0)
    friction_law: float = choice("Shoe friction", {law: LAWS[law] for law in (CONSTANT, KARWATZKI, COMPOSITE)})
    constant_friction: float = quantity("1", "Friction with law 0; of discs, times their radius over the wheel's", 0.0)


def braking() -> ca.Function:
    """Return the function for the brake force at the rim of a vehicle [N], eqs (2.4), (2.6) and (2.7).

    Arguments: cylinder pressure [Pa], speed of the wheels at the rim [m/s], and the brake. Friction is by the laws of
    `shoe_friction`.
    """
    fields = list(VehicleBrake.__dataclass_fields__)
    cylinder, wheel, given = ca.SX.sym("cylinder"), ca.SX.sym("wheel"), ca.SX.sym("given", len(fields))
    p = dict(zip(fields, ca.vertsplit(given), strict=True))
    over = ca.fmax(cylinder - AMBIENT, 0)
    pressed = shoe_force(over, p["force_per_pressure"], p["counter_force"], p["efficiency"])
    fast, one = ca.fabs(wheel), pressed / p["shoes"]
    friction = ca.if_else(p["friction_law"] == KARWATZKI, karwatzki(one, fast), p["constant_friction"])
    friction = ca.if_else(p["friction_law"] == COMPOSITE, composite(fast), friction)
    return function_of("braking", [cylinder, wheel, given], friction * pressed)
