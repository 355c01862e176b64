"""Quantities of imported trains agree with the formulas of their programs, in docs/consists.md by name.

Each program has a file here. A quantity that deviates by more than 1 % needs a reason.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from products.train.consist import Consist
from products.train.imported_consist import imported_consist
from products.train.summary import brake_force

#: Largest deviation without a reason, gravity of the importers [m/s2], and a speed [m/s].
CLOSE, G, FAST = 0.01, 9.80665, 30.0
#: Gravity of ALTRIOS (uc.rs), and air of OpenBVE at 20 degC (Atmosphere.cs) [kg/m3].
G_ALTRIOS, AIR_BVE = 9.80154849496314, 101325 * 0.0289644 / (8.31447 * 293.15)

SPRING = "Coupling ( Type ( Automatic ) Spring ( Stiffness ( 1e6N/m 5e6N/m ) r0 ( 0 2cm ) ) )"
WAGON = f"""Wagon ( one Type ( Freight ) Size ( 3m 4m 14m ) Mass ( 80t ) MaxBrakeForce ( 60kN ) {SPRING}
MaxHandbrakeForce ( 20kN ) ORTSDavis_A ( 1200N ) ORTSDavis_B ( 30N/m/s ) ORTSDavis_C ( 5.8N/m/s^2 ) )"""
STOCK = {
    "name": "unit",
    "length": 400.0,
    "mass": 900e3,
    "const_gamma": 0.5,
    "inertia_coefficient": 1.05,
    "rolling_resistance": {"type": "davis", "A": 5400.0, "B": 200.0, "C": 12.0},
}
PER_MASS = STOCK | {"rolling_resistance": {"type": "davis", "A": 5400 / 9e5, "B": 200 / 9e5, "C": 12 / 9e5}}
CAR = (Path(__file__).parents[1] / "data" / "altrios_car.yaml").read_text(encoding="utf-8")
BVE = """OPENBVE
#PERFORMANCE\n3.6\n0.35\n0\n0.0025\n1.2
#BRAKE\n2\n0\n0
#CAR\n35\n2\n25\n2\n20\n1\n3\n4\n1.5\n6\n2
"""
RAILML = """<railML><rollingstock><vehicles><vehicle id="a" bruttoWeight="50" length="20" rotatingMassFactor="1.06">
<vehicleBrakes meanDeceleration="0.9"/><drivingResistance>
<info airDragCoefficient="0.5" crossSectionArea="10" rollingResistance="2"/></drivingResistance>
</vehicle></vehicles></rollingstock></railML>"""
FILES = {
    "Open Rails": ("one.wag", WAGON),
    "OSRD": ("unit.json", json.dumps(STOCK)),
    "OSRD, per kg": ("unit.json", json.dumps(PER_MASS)),
    "ALTRIOS": ("car.yaml", CAR),
    "OpenBVE": ("train.dat", BVE),
    "railML": ("one.xml", RAILML),
}


@dataclass(frozen=True)
class Quantity:
    """A quantity of a program: its value here and there, where that formula is, and the reason of a difference."""

    program: str
    name: str
    unit: str
    here: Callable[[Consist], float]
    there: float
    source: str
    reason: str = ""


def mass(consist: Consist) -> float:
    """Return the mass [t]."""
    return 1e-3 * sum(one.mass for one in consist.vehicles)


def length(consist: Consist) -> float:
    """Return the length [m]."""
    return sum(one.length for one in consist.vehicles)


def rotating(consist: Consist) -> float:
    """Return the rotating mass [t]."""
    return 1e-3 * sum(one.rotating_share * one.mass for one in consist.vehicles)


def resistance(speed: float) -> Callable[[Consist], float]:
    """Return a function for the running resistance at a speed [N]."""
    return lambda consist: sum(a + b * speed + c * speed**2 for a, b, c in (one.resistance for one in consist.vehicles))


def braking(speed: float) -> Callable[[Consist], float]:
    """Return a function for the brake force at a speed [kN]."""
    return lambda consist: 1e-3 * sum(brake_force(one, speed) for one in consist.vehicles)


def stiffness(consist: Consist) -> float:
    """Return the stiffness of the first coupler in tension, beyond its slack [MN/m]."""
    curve = consist.vehicles[0].coupler.tension[0]
    return 1e-6 * (curve.forces[-1] - curve.forces[-2]) / (curve.ways[-1] - curve.ways[-2])


def slack(consist: Consist) -> float:
    """Return the travel of the first coupler without a force in tension [mm]."""
    curve = consist.vehicles[0].coupler.tension[0]
    return 1e3 * max((way for way, force in zip(curve.ways, curve.forces, strict=True) if force == 0.0), default=0.0)


def parking(consist: Consist) -> float:
    """Return the force of the hand brakes [kN]."""
    return 1e-3 * sum(one.parking.parking_force for one in consist.vehicles)


def quantities() -> list[Quantity]:
    """Return the quantities of all programs."""
    return [*of_open_rails(), *of_osrd(), *of_altrios(), *of_openbve(), *of_railml()]


def of_open_rails() -> list[Quantity]:
    """Return those of Open Rails, a wagon."""
    iron = (7.6 / (3.6 * FAST + 17.5) + 0.07) / 0.2
    bearing = 80 / 0.90718474 * (10 + (80 / 0.90718474 - 10) / 90 * 10) * 4.4482216
    rows = [
        ("mass", "t", mass, 80.0, "MSTSWagon.cs", ""),
        ("length", "m", length, 14.0, "MSTSWagon.cs", ""),
        (
            *("resistance at 0 km/h", "N", resistance(0.0), bearing, "MSTSWagon.cs: UpdateTrainBaseResistance"),
            "below 5 mph bearings have a starting resistance, which has no column",
        ),
        ("resistance at 108 km/h", "N", resistance(FAST), 1200 + 30 * FAST + 5.8 * FAST**2, "the same", ""),
        ("brake force at 0 km/h", "kN", braking(0.0), 60.0, "TrainCar.cs", ""),
        ("brake force at 108 km/h", "kN", braking(FAST), 60 * iron, "TrainCar.cs", ""),
        ("hand brake", "kN", parking, 20.0, "AirSinglePipe.cs", ""),
        ("stiffness of the coupler", "MN/m", stiffness, 7 * (1 + 5), "MSTSWagon.cs: GetSimpleCouplerStiffnessNpM", ""),
        ("slack of the coupler", "mm", slack, 20 / 2 * 5 / 6, "MSTSWagon.cs: SetSimpleR0", ""),
    ]
    return [Quantity("Open Rails", *row) for row in rows]


def of_osrd() -> list[Quantity]:
    """Return those of OSRD, a train that states its resistance in N, or in N/kg."""
    source = "TrainPhysicsIntegrator.java"
    rows = [
        ("mass", "t", mass, 900.0, source, ""),
        ("length", "m", length, 400.0, source, ""),
        ("rotating mass", "t", rotating, 45.0, "RollingStock.java: getInertia", ""),
        (
            "resistance at 108 km/h",
            "N",
            resistance(FAST),
            5400 + 200 * FAST + 12 * FAST**2,
            "rolling_resistance.rs",
            "",
        ),
        ("brake force", "kN", braking(FAST), 0.5 * 1.05 * 900, f"{source}: computeAcceleration", ""),
    ]
    kilogram = [row for row in rows if row[0].startswith("resistance")]
    return [Quantity("OSRD", *row) for row in rows] + [Quantity("OSRD, per kg", *row) for row in kilogram]


def of_altrios() -> list[Quantity]:
    """Return those of ALTRIOS, a loaded car; tests compare a train with a run of altrios 1.1.0."""
    weight = 130e3 * G_ALTRIOS
    still = 4 * 40.26 + 0.001546 * weight
    rows = [
        ("mass", "t", mass, 130.0, "rail_vehicle.rs", ""),
        ("length", "m", length, 18.0, "train_config.rs", ""),
        ("rotating mass", "t", rotating, 3.0, "train_config.rs", ""),
        ("resistance at 0 km/h", "N", resistance(0.0), still, "bearing.rs, rolling.rs", ""),
        (
            *("resistance at 108 km/h", "N", resistance(FAST)),
            *(still + 1e-5 * weight * FAST + 1.225 * 4.087 * FAST**2, "davis_b.rs, aerodynamic.rs", ""),
        ),
        (
            *("brake force", "kN", braking(FAST), 1e-3 * 0.11 * weight, "train_config.rs: max_fric_braking"),
            "`braking_ratio` is read as a force of shoes; set `friction_value = 1`",
        ),
    ]
    return [Quantity("ALTRIOS", *row) for row in rows]


def of_openbve() -> list[Quantity]:
    """Return those of OpenBVE, two motor cars and two trailers."""
    drag = 0.5 * AIR_BVE * 1.2 * (6 + 3 * 2)
    rows = [
        ("mass", "t", mass, 120.0, "TrainDatParser.cs", ""),
        ("length", "m", length, 80.0, "TrainDatParser.cs", ""),
        ("resistance at 0 km/h", "N", resistance(0.0), 0.0025 * 120e3 * G, "BVEAxle.cs", ""),
        ("resistance at 108 km/h", "N", resistance(FAST), 0.0025 * 120e3 * G + drag * FAST**2, "BVEAxle.cs", ""),
        ("brake force", "kN", braking(FAST), 120.0, "AutomaticAirBrake.cs", ""),
    ]
    return [Quantity("OpenBVE", *row) for row in rows]


def of_railml() -> list[Quantity]:
    """Return those of railML, a format: a vehicle by the units of its attributes."""
    source = "wiki2.railml.org, RS"
    rows = [
        ("mass", "t", mass, 50.0, source, ""),
        ("length", "m", length, 20.0, source, ""),
        ("rotating mass", "t", rotating, 3.0, source, ""),
        ("resistance at 0 km/h", "N", resistance(0.0), 2.0 * 50 * G, source, ""),
        ("resistance at 108 km/h", "N", resistance(FAST), 2.0 * 50 * G + 0.5 * 1.225 * 5 * FAST**2, source, ""),
        ("brake force", "kN", braking(FAST), 0.9 * 53.0, source, ""),
    ]
    return [Quantity("railML", *row) for row in rows]


@pytest.mark.parametrize("one", quantities(), ids=lambda one: f"{one.program}: {one.name}")
def test_an_imported_quantity_is_that_of_the_programs_formula_but_for_a_reason(one: Quantity, tmp_path: Path) -> None:
    name, text = FILES[one.program]
    (tmp_path / name).write_text(text, encoding="utf-8")
    off = one.here(imported_consist(tmp_path / name)[0]) / one.there - 1.0
    assert (abs(off) > CLOSE) is bool(one.reason), f"{100 * off:.1f} %"
    assert math.isfinite(off)
