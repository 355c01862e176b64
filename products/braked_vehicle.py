"""BrakedVehicle: a complete vehicle and the brake cylinders of its wheelsets as one FMU, without a coupling's error."""

from collections.abc import Sequence
from dataclasses import replace

from brake_controller.discs import axle_discs, treads_or_discs
from fmu_src.system import NONE, Model, System, Variable, choosing, model_of_choices
from products.machine import coach, coach_brake, composed, of_pads
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.levels.models import (
    CHOICE_ON_LINE,
    DEFAULT_TOLERANCE,
    EVERY,
    places_of,
    selectors,
    system_at,
)
from rbd_model.track.line_table import LINE
from rbd_model.vehicle.description import relations_of

#: Kinds of brake by their numbers.
TIMED, BY_FLOW, DISCS, TIMED_DISCS = 1, 2, 3, 4
BRAKES = {
    TIMED: "shoes on treads, cylinders by application and release time",
    BY_FLOW: "shoes on treads, cylinders by flow of air from a reservoir through magnet valves",
    DISCS: "pads on discs, cylinders by flow of air from a reservoir through magnet valves",
    TIMED_DISCS: "pads on discs, cylinders by application and release time",
}
BRAKE = Variable("brake_kind", "parameter", start=float(TIMED), **choosing("Brake of each wheelset", BRAKES))
#: Systems of the vehicle whose cylinders can also fill by flow of air: the planar ones. A 3D system would make the FMU
#: larger by half.
WITH_FLOW = places_of(level=2)
#: Number of the system for each choice, as in CHOICE_ON_LINE, with `brake_kind` last. Systems with flow of air have
#: numbers after EVERY.
CHOICE = tuple(
    place if brake in (TIMED, TIMED_DISCS) else len(EVERY) + WITH_FLOW.index(place) if place in WITH_FLOW else NONE
    for place in CHOICE_ON_LINE
    for brake in BRAKES
)
PLACES = tuple(sorted(set(CHOICE) - {NONE}))


def braked_vehicle(places: Sequence[int] = PLACES) -> Model:
    """Return the coach on treads or discs: inputs are pressure demands and valves.

    Outputs are speed, wheel speeds, pressures. places: the included systems of CHOICE; the others cannot be selected.
    """
    systems = tuple(_system(place) for place in places)
    text = "Four-axle railway vehicle with a brake cylinder on each wheelset: pressure in, speed and slip out"
    parameters = {name for system in systems for name in system.parameter_symbols}
    choice = tuple(places.index(place) if place in places else NONE for place in CHOICE)
    on_line = any(system.table_file for system in systems)
    return model_of_choices(
        "BrakedVehicle",
        text,
        systems,
        (*selectors(), BRAKE),
        choice if on_line else choice[: len(choice) // 2],
        DEFAULT_TOLERANCE,
        *([LINE.variable] if on_line else []),
        *([PAIR_FILE.variable] if any(system.record_file for system in systems) else []),
        relations=relations_of(coach().vehicle, parameters),
        stop_time=25.0,
    )


def _system(place: int) -> System:
    """The system of this number in CHOICE."""
    machine, brake, disc = coach(), coach_brake(), axle_discs()
    pads = of_pads(brake, disc) / brake.force_per_pressure
    if place in EVERY:
        rubbing = treads_or_discs(BRAKE, TIMED_DISCS, pads, disc)
        return composed(machine, system_at(machine.vehicle, place), rubbing)
    system = system_at(machine.vehicle, WITH_FLOW[place - len(EVERY)])
    whole = composed(replace(machine, by_flow=True), system, treads_or_discs(BRAKE, DISCS, pads, disc))
    return replace(whole, name=f"{system.name}_by_flow")
