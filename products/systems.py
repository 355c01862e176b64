"""FMUs connected: the systems that are written beside them as .ssp. A new one is a function and a line in SYSTEMS."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from brake_controller.parameters import qr30
from brake_controller.protection_fmu import wheel_slide_protection
from fmu_src.idle_parameters import without_effect
from fmu_src.ssp import Component, Wire, write_ssp
from products.building import build_protection, fmu_path
from products.coach import NUMBERS
from products.machine import FULL_PRESSURE
from products.parameter_sets import PARAMETER_SETS, values_for
from products.registry import model_of
from rbd_model.vehicle.parameters import tables_8_1_and_8_2

#: At this friction the full brake slides; it does not fall. Assumed.
SLIDING_FRICTION = 0.08
#: Outputs of a vehicle that are shown in addition to the connected ones.
SHOWN = ("speed", "distance", "cylinder_pressure_1", "cylinder_pressure_4")


def heard(name: str, values: Mapping[str, float]) -> dict[str, float]:
    """Return these values without parameters that have no effect at their `level`; name: of a registered FMU.

    An FMU warns about them at its initialisation, and strict hosts treat a warning as an error.
    """
    model = model_of(name)
    unheard = without_effect(model, model.systems[int(values["level"]) - 1])
    return {one: value for one, value in values.items() if one not in unheard}


def bogie_braking(path: Path, out: Path, _: bool) -> None:
    """The QR30 bogie of the experiment, its trailing wheelset braked by a cylinder at 180 kPa from the start."""
    scene = {"level": 2, "initial_speed": 2.9, "friction_1": 0.18, "friction_2": 0.18}
    bogie = heard("bogie", values_for("bogie", tables_8_1_and_8_2().values()) | scene)
    brake = qr30(180).values() | {"pressure_demand": 180e3}
    write_ssp(
        path,
        path.stem,
        [
            Component("brake", fmu_path("brake", "native", out), brake, ["cylinder_pressure"]),
            Component("bogie", fmu_path("bogie", "native", out), bogie, ["speed", "distance"]),
        ],
        [
            Wire(("brake", "brake_torque"), ("bogie", "brake_torque_2")),
            Wire(("bogie", "angular_velocity_2"), ("brake", "angular_velocity")),
        ],
        (5.0, 1e-3),
    )


def braked_coach(out: Path, **scene: float) -> Component:
    """The coach and its brake cylinders in one FMU, fully braked from 25 m/s."""
    values = PARAMETER_SETS["braked-coach"].values()
    values |= {"level": 2, "initial_speed": 25.0}
    values |= {f"pressure_demand_{number}": FULL_PRESSURE for number in NUMBERS}
    used = heard("braked-vehicle", values | scene)
    return Component("vehicle", fmu_path("braked-vehicle", "native", out), used, SHOWN)


def vehicle_braking(path: Path, out: Path, _: bool) -> None:
    """The braked coach alone, its only FMU; all wheels roll."""
    write_ssp(path, path.stem, [braked_coach(out)], [], (25.0, 1e-2))


def vehicle_protection(path: Path, out: Path, all_platforms: bool) -> None:
    """The braked coach at a friction of 0.08 with its wheel-slide protection."""
    step = wheel_slide_protection(len(NUMBERS))
    controller = Component("controller", build_protection(out, step, all_platforms), {})
    vehicle = braked_coach(out, **{f"friction_{number}": SLIDING_FRICTION for number in NUMBERS})
    wires = []
    for number in NUMBERS:
        wires.append(Wire(("vehicle", f"wheel_speed_{number}"), ("controller", f"wheel_speed_{number}")))
        wires.append(Wire(("controller", f"valve_{number}"), ("vehicle", f"valve_{number}")))
    write_ssp(path, path.stem, [vehicle, controller], wires, (25.0, step.period))


#: Names of the systems, with the native FMUs that they are made of and the function that writes them.
SYSTEMS: Mapping[str, tuple[frozenset[str], Callable[[Path, Path, bool], None]]] = {
    "BogieBraking": (frozenset({"bogie", "brake"}), bogie_braking),
    "VehicleBraking": (frozenset({"braked-vehicle"}), vehicle_braking),
    "VehicleProtection": (frozenset({"braked-vehicle"}), vehicle_protection),
}


def build_system(name: str, out: Path, all_platforms: bool = False) -> Path:
    """Writes OUT/NAME.ssp of the FMUs that are built there; all_platforms: of a controller's FMU."""
    path = out / f"{name}.ssp"
    SYSTEMS[name][1](path, out, all_platforms)
    return path


def build_systems(names: Sequence[str], out: Path, all_platforms: bool = False) -> None:
    """Writes the systems that are made of the named FMUs, a line each."""
    for system, (needed, _) in SYSTEMS.items():
        if needed <= set(names):
            say_system(build_system(system, out, all_platforms))


def say_system(path: Path) -> None:
    """Print the line of a system that was written."""
    print(f"{path}  {path.stat().st_size / 1000:.0f} kB")
