"""BrakedVehicle: a complete vehicle and the brake cylinders of its wheelsets as one FMU, without a coupling's error."""

from collections.abc import Sequence

from fmu_src.system import Model, model_of_choices
from products.machine import coach, composed
from rbd_model.levels.models import CHOICE, DEFAULT_TOLERANCE, LEVELS, choice_of, selectors, system_at
from rbd_model.vehicle.description import relations_of

#: Numbers of its systems, those of a vehicle on level track.
PLACES = tuple(sorted(set(CHOICE)))


def braked_vehicle(places: Sequence[int] = PLACES) -> Model:
    """Pressure demands and valves in; speed, wheel speeds and pressures out; the coach, its brake timed.

    places: which of the systems it has; those that it lacks cannot be chosen.
    """
    machine = coach()
    systems = tuple(composed(machine, system_at(machine.vehicle, place)) for place in places)
    text = "Four-axle railway vehicle with a brake cylinder on each wheelset: pressure in, speed and slip out"
    parameters = {name for system in systems for name in system.parameter_symbols}
    return model_of_choices(
        "BrakedVehicle",
        text,
        systems,
        selectors(),
        choice_of(places, len(LEVELS), on_line=False),
        DEFAULT_TOLERANCE,
        relations=relations_of(machine.vehicle, parameters),
        stop_time=25.0,
    )
