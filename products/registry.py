"""All FMUs. A new one is a function that returns a `Model` and a line in FMUS, or an object in C and one in IN_C."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from typing import Any

from brake_controller.cylinder import brake_cylinder
from fmu_src.arrays_fmu import ArraysFmu
from fmu_src.chain import ONE_WRITES
from fmu_src.system import Model
from products.braked_vehicle import BRAKE, braked_vehicle
from products.braked_vehicle import CHOICE as CHOICE_OF_BRAKES
from products.driven_wheelset import driven_wheelset_dynamics
from rbd_model.levels.models import (
    CHOICE_ON_LINE,
    bogie_dynamics,
    coal_wagon_dynamics,
    vehicle_dynamics,
    wheelset_dynamics,
)
from rbd_model.track.recovery import rail_adhesion
from rbd_model.vehicle.description import Vehicle
from rbd_model.vehicle.ready import loaded_coal_wagon, passenger_coach, two_axle_bogie

#: Parameters that select the equations of a vehicle.
SELECTORS = ("level", "contact_model")


@dataclass(frozen=True)
class Fmu:
    """The source of an FMU, and the figure of its page, a file in pictures/ in this folder.

    vehicle: its vehicle at all levels; `model` takes the `places` of the required systems. selectors, choice: of all
    its systems, as in `Model`, by the numbers in `places`.
    """

    summary: str
    model: Callable[..., Model]
    picture: str | None = None
    vehicle: Callable[[], Vehicle] | None = None
    selectors: tuple[str, ...] = SELECTORS
    choice: tuple[int, ...] = CHOICE_ON_LINE


#: FMUs by their names on the command line and in scenarios.
FMUS: dict[str, Fmu] = {
    "bogie": Fmu("two-axle bogie under brake and traction torque", bogie_dynamics, "qr30-180kpa.png", two_axle_bogie),
    "vehicle": Fmu("four-axle coach", vehicle_dynamics, vehicle=passenger_coach),
    "coal-wagon": Fmu("four-axle coal wagon", coal_wagon_dynamics, vehicle=loaded_coal_wagon),
    "braked-vehicle": Fmu(
        "coach with a brake cylinder on each wheelset",
        braked_vehicle,
        vehicle=passenger_coach,
        selectors=(*SELECTORS, BRAKE.name),
        choice=CHOICE_OF_BRAKES,
    ),
    "wheelset": Fmu("one wheelset in a frame, in 3D", wheelset_dynamics, "wheelset-hunting.png"),
    "brake": Fmu("pneumatic brake cylinder of a wheelset", brake_cylinder, "qr30-180kpa.png"),
    "rail": Fmu("friction of a rail that recovers with sliding energy", rail_adhesion),
    "driven-wheelset": Fmu("motor, gear and two wheels on elastic shafts", driven_wheelset_dynamics),
}


@dataclass(frozen=True)
class FmuInC:
    """An FMU around an object in C: the function of its content, and the options that this takes.

    module: that of the function, in this package; it is imported when the FMU is built.
    """

    summary: str
    module: str
    content: str
    options: tuple[str, ...]


#: FMUs without equations in a `Model`, by their names on the command line.
IN_C: dict[str, FmuInC] = {
    "train": FmuInC(
        "train of a consist: brake pipe, distributors, couplers",
        "train.fmu",
        "train_of_files_fmu",
        ("consist", "line", "brake_model", "cells"),
    ),
    "coupler": FmuInC("one coupler between two vehicles", "train.coupler_fmu", "named_coupler_fmu", ("coupler",)),
    "sensor": FmuInC("measured wheel speeds, for a controller", "protection.sensor_fmu", "sensor_fmu", ("wheelsets",)),
    "curves": FmuInC(
        "supervision by the braking curves of ETCS",
        "braking_curves.fmu",
        "curves_of_files_fmu",
        ("line", "train", "national"),
    ),
    "driver": FmuInC("driver of a train under these curves", "train.driver_fmu", "driver_fmu", ()),
}

#: Names that people type for FMUs of the list.
ALIASES = {"coach": "vehicle"}


def fmu_named(name: str) -> str:
    """Return the name in the list for an alias; another name unchanged."""
    return ALIASES.get(name, name) if isinstance(name, str) else name


#: FMUs with the equations and variables of another one, and other numbers.
ALIKE = {"coal-wagon": "vehicle"}
#: Those with equations of their own.
DIFFERENT = [name for name in FMUS if name not in ALIKE]


def model_of(name: str) -> Model:
    """The model behind an FMU of the list, written once in a process, whichever threads ask."""
    with ONE_WRITES:
        return _written(name)


@lru_cache
def _written(name: str) -> Model:
    return FMUS[name].model()


def content_in_c(name: str, options: Mapping[str, Any]) -> ArraysFmu:
    """Return the content of an FMU of IN_C; `options`: by name, its own and others. Raises ValueError, OSError."""
    fmu = IN_C[name]
    make = getattr(import_module(f"{__package__}.{fmu.module}"), fmu.content)
    return make(**{option: options[option] for option in fmu.options if option in options})
