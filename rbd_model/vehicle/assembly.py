"""The start of every level of detail: a System of a vehicle, whose symbols are declared at their first use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from fmu_src.chain import Chain
from fmu_src.symbols import ca
from fmu_src.system import System, Variable
from rbd_model.contact.depth import ONE_RIGID_CONTACT, Contact
from rbd_model.track.frame import TrackFrame, level
from rbd_model.track.friction import Rail, add_rail
from rbd_model.track.irregularity import ballasted_track
from rbd_model.vehicle import variables
from rbd_model.vehicle.description import Size, Vehicle, Wheelset, size_of, wheelset_name
from rbd_model.vehicle.scales import NOMINAL_DISTANCE, NOMINAL_SPEED
from rbd_model.vehicle.statics import Statics, statics

#: Start value of initial_speed [m/s], that of chapter 5.
INITIAL_SPEED = 25.0


class Declared(dict[str, Any]):
    """Symbols by name; a missing one is declared at its first use."""

    def __init__(self, declare: Callable[[str], ca.SX]) -> None:
        super().__init__()
        self.declare = declare

    def __missing__(self, name: str) -> ca.SX:
        self[name] = self.declare(name)
        return self[name]


class Sizes(Protocol):
    """Data for the laws of connections: sizes and preloads, and the chain for their links."""

    @property
    def chain(self) -> Chain:
        """The chain that holds parts and shared intermediate variables of the equations."""

    def value(self, size: Size) -> ca.SX:
        """Return a size of the vehicle's description."""

    def preload(self, side: str) -> ca.SX:
        """Return the static vertical force of a single spring [N]."""


@dataclass(frozen=True)
class Assembly:
    """The symbols of a vehicle while a level of detail writes its System. Additions of a level make a new object."""

    system: System
    vehicle: Vehicle
    parameter: Declared
    input: Declared
    outputs: dict[str, Variable]
    initial_speed: ca.SX
    drive_inertia: ca.SX
    rail: Rail
    at_rest: Statics
    #: States: distance [m] and speed [m/s] of the first body, to which all other places along the track are relative.
    distance: ca.SX
    speed: ca.SX
    #: True if the line comes from a file.
    on_line: bool = False
    #: Contact of wheels and rails at level 3.
    contact: Contact = ONE_RIGID_CONTACT
    #: Height of the wheelset axes in the coordinates of positions [m].
    axle_height: ca.SX = field(default_factory=lambda: ca.SX(0))
    #: The axes of the track at a body, by its distance [m].
    frame_at: Callable[[ca.SX], TrackFrame] = lambda distance: level()
    #: Travel of the first body per metre along the line [1].
    first_stretch: ca.SX = field(default_factory=lambda: ca.SX(1))

    def track_at(self, place: ca.SX) -> TrackFrame:
        """Return the axes of the track at a body's place, relative to the vehicle's [m]; section 3.2.1."""
        return self.frame_at(self.distance + place)

    @property
    def chain(self) -> Chain:
        """The system, as the chain of its links."""
        return self.system

    def value(self, size: Size) -> ca.SX:
        """Return a size of the vehicle's description."""
        return size_of(size, self.parameter)

    @property
    def total_mass(self) -> ca.SX:
        """Mass of all bodies and wheelsets [kg], computed once."""
        if "total_mass" not in self.system.derived_symbols:
            sizes = [part.mass for part in self.vehicle.parts]
            self.system.derived("total_mass", ca.SX(sum(self.value(size) for size in sizes)))
        return self.system.derived_symbols["total_mass"]

    def preload(self, side: str) -> ca.SX:
        """Return the static vertical force of a single spring [N], computed once."""
        name = f"{side}_preload"
        if name not in self.system.derived_symbols:
            self.system.derived(name, self.at_rest.preload[side])
        return self.system.derived_symbols[name]

    def resting_on(self, number: int) -> ca.SX:
        """Return the static load of a wheelset without its own weight [N], computed once."""
        name = f"carried_{number}"
        if name not in self.system.derived_symbols:
            self.system.derived(name, self.at_rest.on_wheelset[wheelset_name(number)])
        return self.system.derived_symbols[name]

    def radius(self, wheelset: Wheelset) -> ca.SX:
        """Return the nominal rolling radius of a wheelset [m]."""
        return self.value(wheelset.mean_radius)


def assemble(level: str, description: str, vehicle: Vehicle, moving: str, on_line: bool) -> Assembly:
    """Return a System with the parameters of the rail's friction and the states of motion along the track.

    Other parameters and inputs are declared at their first use. moving: prefix of the names of these states. on_line:
    with the line of the instance.
    """
    system = System(f"{level}_on_line" if on_line else level, description)
    initial = system.parameter(variables.initial_speed(INITIAL_SPEED))
    drive = system.parameter(variables.drive_inertia())
    rows = variables.inputs(vehicle)
    support = ballasted_track()
    others = {one.name: one for one in (*variables.initial_offsets(), *map(support.variable, support.values()))}
    parameter = Declared(lambda name: system.parameter(others.get(name) or vehicle.parameters.variable(name)))
    inputs = Declared(lambda name: system.input(rows[name]))
    rail = add_rail(system, len(vehicle.wheelsets))
    at_rest = statics(vehicle, lambda size: size_of(size, parameter), parameter["gravity"])
    distance = system.state(f"{moving}distance", "m", 0.0, NOMINAL_DISTANCE)
    return Assembly(
        system,
        vehicle,
        parameter,
        inputs,
        variables.outputs(vehicle),
        initial,
        drive,
        rail,
        at_rest,
        distance,
        system.state(f"{moving}speed", "m/s", initial, NOMINAL_SPEED),
        on_line,
    )
