"""All FMUs. A new one is a function that returns a `Model`, and one line in FMUS."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from brake_controller.cylinder import brake_cylinder
from fmu_src.chain import ONE_WRITES
from fmu_src.system import Model, Variable
from products.braked_vehicle import BRAKE, braked_vehicle
from products.braked_vehicle import CHOICE as CHOICE_OF_BRAKES
from products.driven_wheelset import driven_wheelset_dynamics
from rbd_model.levels.models import (
    CHOICE_ON_LINE,
    EVERY,
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

    alike: the FMU with the same equations and variables and other parameters. vehicle: its vehicle at all levels;
    `model` takes the `places` of the required systems. named_by: numbers of the systems that have all of its variables.
    selectors, choice: of all its systems, as in `Model`, by the numbers in `places`.
    """

    model: Callable[..., Model]
    picture: str | None = None
    alike: str | None = None
    vehicle: Callable[[], Vehicle] | None = None
    named_by: tuple[int, ...] = ()
    selectors: tuple[str, ...] = SELECTORS
    choice: tuple[int, ...] = CHOICE_ON_LINE


#: Systems that together have all variables of a vehicle, in their order: strips include those of patches, the highest
#: level on a line those of lower ones. Then the system with brakes by flow of air, on level track.
ON_LINES, BY_FLOW_OF_AIR = (0, 1, 2, 3, 7), len(EVERY)

#: FMUs by their names on the command line and in scenarios.
FMUS: dict[str, Fmu] = {
    "bogie": Fmu(bogie_dynamics, "qr30-180kpa.png", vehicle=two_axle_bogie, named_by=ON_LINES),
    "vehicle": Fmu(vehicle_dynamics, vehicle=passenger_coach, named_by=ON_LINES),
    "coal-wagon": Fmu(coal_wagon_dynamics, alike="vehicle", vehicle=loaded_coal_wagon, named_by=ON_LINES),
    "braked-vehicle": Fmu(
        braked_vehicle,
        vehicle=passenger_coach,
        named_by=(*ON_LINES, BY_FLOW_OF_AIR),
        selectors=(*SELECTORS, BRAKE.name),
        choice=CHOICE_OF_BRAKES,
    ),
    "wheelset": Fmu(wheelset_dynamics, "wheelset-hunting.png"),
    "brake": Fmu(brake_cylinder, "qr30-180kpa.png"),
    "rail": Fmu(rail_adhesion),
    "driven-wheelset": Fmu(driven_wheelset_dynamics),
}

#: Names that people type for FMUs of the list.
ALIASES = {"coach": "vehicle"}


def fmu_named(name: str) -> str:
    """Return the name in the list for an alias; another name unchanged."""
    return ALIASES.get(name, name) if isinstance(name, str) else name


#: Those with equations of their own; the others have the same ones with other numbers.
DIFFERENT = [name for name, fmu in FMUS.items() if fmu.alike is None]


def model_of(name: str) -> Model:
    """The model behind an FMU of the list, written once in a process, whichever threads ask."""
    with ONE_WRITES:
        return _written(name)


@lru_cache
def _written(name: str) -> Model:
    return FMUS[name].model()


def variables_of(name: str) -> tuple[Variable, ...]:
    """The variables of an FMU of the list, of no more equations than have them."""
    with ONE_WRITES:
        fmu = FMUS[name]
        return (fmu.model(places=fmu.named_by) if fmu.named_by else model_of(name)).variables
