"""The numbers of a train: description, unit, limits and owner of each, in one place.

They determine the numbers that Python writes (`laid`), the places at which C reads them, the limits that it checks
(`layout_in_c.py`), arrays of the FMU (products/train/fmu.py), and tables in docs/variables.md. Fields of other
equations are defined with these.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brake_controller.brake_heat import BrakeHeat
from brake_controller.brake_pipe import CELL
from brake_controller.direct_brake import DirectBrake
from brake_controller.distributors import DISTRIBUTORS
from brake_controller.drivers_valve import POSITIONS, VALVE
from brake_controller.electric_brake import CLOSES, ElectricBrake
from brake_controller.main_reservoir import MainReservoir
from brake_controller.parking_brake import ParkingBrake
from brake_controller.track_brakes import TrackBrakes
from brake_controller.traction import Traction
from brake_controller.vehicle_brake import VehicleBrake
from brake_controller.vehicle_protection import VehicleProtection
from brake_controller.vigilance import VEHICLE, Vigilance
from fmu_src.system import ParameterSet
from fmu_src.variables import Field
from rbd_model.train.adhesion import ADHESION
from rbd_model.train.coupler import COUPLER
from rbd_model.train.vehicle import MOTION
from rbd_model.vehicle.variables import FASTEST

#: Largest number of vehicles, cells or points; largest number of driver's valves.
MOST, MOST_VALVES = float(1 << 20), 16
#: Brake models: air flow and full distributors; air flow and empirical valves; a delay and empirical valves.
BRAKE_MODELS = {"whole": 0, "empirical": 1, "delay": 2}
#: Strength of a coupler that does not break [N].
UNBREAKABLE = 1e12
#: Initial friction between wheels and rail.
START_FRICTION = 0.3
#: Lowest gauge pressure of a pipe that holds a vacuum at the start [Pa].
LOWEST_VACUUM = -95e3
#: Largest initial distance [m] and pressures [Pa].
FARTHEST, HIGHEST = 1e9, 800e3


@dataclass(frozen=True)
class Array(Field):
    """An input or output: its owner, its name in an FMU, the choices of an integer."""

    of: str = "one"
    called: str = ""
    choices: Sequence[str] = ()


def _chosen(name: str, text: str, of: str, choices: Sequence[str], called: str = "") -> Array:
    return Array(name, "1", 0.0, float(len(choices) - 1), text, True, of=of, called=called, choices=choices)


#: Initial values of a run.
INITIAL = (
    Array("speed", "m/s", -FASTEST, FASTEST, "Speed at the start", called="start_speed"),
    Array("distance", "m", -FARTHEST, FARTHEST, "Distance of the train's front at the start", called="start_distance"),
    Array(
        "pipe",
        "Pa",
        LOWEST_VACUUM,
        HIGHEST,
        "Gauge pressure in the pipe at the start; below 0 with vacuum brakes",
        called="start_pipe_pressure",
    ),
    Array(
        "cylinder", "Pa", 0.0, HIGHEST, "Gauge pressure in all cylinders at the start", called="start_cylinder_pressure"
    ),
)

_POSITIONS = (
    "Driver's valve: 0 shut off, or a second valve follows the head's; 1 running, 2 overcharge, 3 service, "
    "4 emergency, 5 hold, 6 continuous service"
)
_STEP = "Step of service: 0 the first, 1 full service"
_PULL = "Force of motors at the rim; below zero it drives backwards"
_COUPLED = "Coupling behind each vehicle: 1 coupled once they touch, 0 apart (1 m apart its hose parts)"
_LED = (
    "A vehicle computed in detail elsewhere: 1 its speed is held in a step, 2 corrected before a step, 0 neither."
    " Couplers limit the step: docs/train-couplers.md"
)
_TRACK = "Share of each vehicle's eddy-current brake; above 0 magnets are lowered; at 0 the pipe alone applies both"
_BAILED = "1: the distributor's air is let out of each vehicle's cylinders, if it has a direct brake or the interlock"
_PENALTY = "Brake in the driver's place, by valve, without traction: 0 none, 1 at least full service, 2 emergency"
#: Inputs; ends: forces at the head and at the end.
INPUTS = (
    _chosen("driver_position", _POSITIONS, "valves", [name.replace("-", "_") for name in POSITIONS]),
    Array("driver_step", "1", 0.0, 1.0, _STEP, of="valves"),
    Array("pull", "N", -1e7, 1e7, _PULL, of="vehicles"),
    Array("friction", "1", 0.0, 2.0, "Friction between wheels and rail, by vehicle", of="vehicles"),
    _chosen(
        "protection",
        "Wheel-slide protection by vehicle: 0 apply, 1 hold, 2 release",
        "vehicles",
        ("apply", "hold", "release"),
    ),
    _chosen("coupling_closed", _COUPLED, "couplings", ("apart", "together")),
    _chosen(
        "hose_state",
        "Pipe behind each vehicle: 0 joined, 1 cock shut, 2 hose parted",
        "couplings",
        ("whole", "shut", "parted"),
    ),
    Array("end_force", "N", -1e8, 1e8, "Pull forwards at the head, and backwards at the end", of="ends"),
    _chosen("external_vehicle", _LED, "vehicles", ("not", "held", "corrected")),
    Array(
        "external_vehicle_speed", "m/s", -300.0, 300.0, "Speed of a vehicle that is computed elsewhere", of="vehicles"
    ),
    Array("dynamic_brake", "1", 0.0, 1.0, "Share of each vehicle's electric brake, if it has one", of="vehicles"),
    Array("track_brake", "1", 0.0, 1.0, _TRACK, of="vehicles"),
    Array("parking_brake", "1", 0.0, 1.0, "Share of each vehicle's parking brake, if it has one", of="vehicles"),
    Array("traction", "1", 0.0, 1.0, "Share of the force that each vehicle's motors can give, forwards", of="vehicles"),
    Array("direct_brake", "1", 0.0, 1.0, "Share of each vehicle's direct brake, if it has one", of="vehicles"),
    _chosen("bail_off", _BAILED, "vehicles", ("off", "on")),
    _chosen("penalty", _PENALTY, "valves", ("none", "service", "emergency")),
    _chosen("vigilance", "The driver's acknowledgement by valve: each change of it counts", "valves", ("up", "down")),
)


def _found(name: str, unit: str, text: str, of: str = "one") -> Array:
    return Array(name, unit, -math.inf, math.inf, text, of=of)


_STATE = "Wheel-slide protection of each vehicle: 0 applies, 1 holds, 2 releases, 3 failed and applies"
_WORK = "Heat of each friction brake so far; 0 if the train has no warm brakes, electric brakes or traction"
_CYLINDER = "Gauge pressure in each vehicle's cylinders; of vacuum brakes, what presses beyond the pistons' weight"
#: Outputs, and numbers of the run.
OUTPUTS = (
    _found("distance", "m", "Distance of each vehicle's middle", "vehicles"),
    _found("speed", "m/s", "Speed of each vehicle", "vehicles"),
    _found("wheel_speed", "m/s", "Speed of each vehicle's wheels at the rim", "vehicles"),
    _found("pipe_pressure", "Pa", "Gauge pressure in the pipe at each vehicle's distributor", "vehicles"),
    _found("cylinder_pressure", "Pa", _CYLINDER, "vehicles"),
    _found("brake_force", "N", "What each vehicle's brake can hold at the rim", "vehicles"),
    _found("rail_force", "N", "What the rail gives to each vehicle's wheels, forwards above zero", "vehicles"),
    _found("coupler_force", "N", "Tension in the coupling behind each vehicle, compression below zero", "couplings"),
    _found("mean_coupler_force", "N", "Mean tension over the last step, which has its impulse", "couplings"),
    _found("brake_temperature", "K", "Temperature of each vehicle's braked wheels or discs", "vehicles"),
    _found("surface_temperature", "K", "Temperature of the surface that blocks or pads rub on", "vehicles"),
    _found("block_temperature", "K", "Temperature of each vehicle's blocks or pads", "vehicles"),
    _found("track_brake_force", "N", "What each vehicle's track brakes can hold, apart from its wheels", "vehicles"),
    _found("brake_heat", "J", _WORK, "vehicles"),
    _found("traction_force", "N", "Force of each vehicle's motors at the rims, without the input pull", "vehicles"),
    _found("traction_energy", "J", "Work of each vehicle's motors at the rims so far", "vehicles"),
    _found("electric_brake_energy", "J", "Work that each electric brake has taken at the rims so far", "vehicles"),
    _found("protection_state", "1", _STATE, "vehicles"),
    _found("protection_air", "kg", "Air that has filled each protected vehicle's cylinders so far", "vehicles"),
    _found("main_reservoir_pressure", "Pa", "Gauge pressure in each main reservoir; 0 without one", "vehicles"),
    _chosen("compressor_on", "Whether each vehicle's compressor runs", "vehicles", ("off", "on")),
    _found("compressor_air", "kg", "Air that each vehicle's compressor has delivered so far", "vehicles"),
    _chosen("vigilance_warning", "Whether the vigilance device at each driver's valve warns", "valves", ("off", "on")),
    _chosen("penalty_applied", "Penalty in force at each driver's valve", "valves", ("none", "service", "emergency")),
)
#: Outputs that follow from those, of an FMU and of recordings.
OF_WHEELS = (
    Array("locked", "1", 0.0, 1.0, "Whether a vehicle's wheels are locked while it moves", True, of="vehicles"),
    _found("slip", "1", "(v - w) over the larger of both, of each vehicle's wheels", "vehicles"),
)
SUMS = (
    _found("time", "s", "Time of the run"),
    _found("largest_tension", "N", "Largest tension in any coupling so far"),
    _found("largest_tension_at", "1", "The coupling where that was, from 1 on"),
    _found("largest_compression", "N", "Largest compression in any coupling so far"),
    _found("largest_compression_at", "1", "The coupling where that was, from 1 on"),
    _found("air_used", "kg", "Air that driver's valves have let in"),
)


@dataclass(frozen=True)
class Group:
    """A group of fields: a row for each, one after the other, with a number for each owner."""

    name: str
    of: str
    fields: Sequence[Field]


def _counted(name: str, text: str, most: float = MOST, least: float = 1.0) -> Field:
    return Field(name, "1", least, most, text, whole=True)


def _head() -> tuple[Field, ...]:
    return (
        _counted("vehicles", "its number of vehicles"),
        _counted("cells", "its number of cells"),
        _counted("valves", "its number of valves", MOST_VALVES),
        _counted("points", "its number of points of the line"),
        *(_counted(f"distributor_{name}", f"its number of distributors {name}", least=0.0) for name in DISTRIBUTORS),
        _counted("brake_model", "the model of its brake", len(BRAKE_MODELS) - 1.0, 0.0),
        Field("pace", "1/s", 1e-3, 1e6, "the pace of its vehicles"),
        Field("courant", "1", 1e-2, 1.0, "the step of its pipe"),
        Field("bound", "s", 1e-6, 1e9, "the step of its couplers"),
        Field("share", "1", 1e-5, 2.5, "the share of its couplers' step"),
        Field("propagation", "m/s", 1.0, 1e12, "its propagation"),
    )


def _place() -> tuple[Field, ...]:
    """Return the fields of the cell of each distributor, of the cell after a vehicle (0: none), and of its kind."""
    return (
        Field("cell", "1", 0.0, -1.0, "a vehicle's place at the pipe", whole=True, counts="cells"),
        Field("face", "1", 0.0, 0.0, "a vehicle's end at the pipe", whole=True, counts="cells"),
        _counted("distributor", "the distributor of a vehicle", len(DISTRIBUTORS) - 1.0, 0.0),
    )


_FRAME = (
    Field("centre", "m", -1e7, 1e7, "the place of a vehicle"),
    Field("length", "m", 0.1, 1e4, "the length of a vehicle"),
)
_POINT = (
    Field("distance", "m", -1e9, 1e9, "a distance of the line", rises=True),
    Field("gradient", "1", -10.0, 10.0, "a gradient of the line"),
    Field("curvature", "1/m", -10.0, 10.0, "a curvature of the line"),
    Field("friction", "1", 0.0, 10.0, "a factor of the line on friction"),
)


def _of(parameters: type[ParameterSet], most: float) -> tuple[Field, ...]:
    """Return the fields of a parameter set; if it has no limit, C has one of this size."""
    found = []
    for field in fields(parameters):
        least, up_to = (max(min(field.metadata[name], most), -most) for name in ("minimum", "maximum"))
        text = field.metadata["description"].partition(";")[0]
        text = text[0].lower() + text[1:]
        found.append(Field(field.name, field.metadata["unit"], least, up_to, text, field.metadata["kind"] == "integer"))
    return tuple(found)


def layout() -> tuple[Group, ...]:
    """Return the groups in their order."""
    kinds = DISTRIBUTORS.items()
    of_kinds = [(f"distributor_{name}", _of(kind.parameters, 1e9)) for name, kind in kinds]
    return (
        Group("head", "one", _head()),
        Group("cell", "cells", CELL),
        Group("place", "vehicles", _place()),
        *(Group(name, name, own) for name, own in of_kinds),
        Group("brake", "vehicles", _of(VehicleBrake, 1e12)),
        Group("electric", "vehicles", _of(ElectricBrake, 1e12)),
        Group("heat", "vehicles", _of(BrakeHeat, 1e12)),
        Group("track", "vehicles", _of(TrackBrakes, 1e12)),
        Group("parking", "vehicles", _of(ParkingBrake, 1e12)),
        Group("traction", "vehicles", _of(Traction, 1e12)),
        Group("adhesion", "vehicles", ADHESION),
        Group("motion", "vehicles", MOTION),
        Group("frame", "vehicles", _FRAME),
        Group("coupler", "couplings", COUPLER),
        Group("strength", "couplings", (Field("strength", "N", 1.0, UNBREAKABLE, "the strength of a coupler"),)),
        Group("valve", "valves", VALVE),
        Group("point", "points", _POINT),
        Group("slide", "vehicles", _of(VehicleProtection, 1e12)),
        Group("direct", "vehicles", _of(DirectBrake, 1e12)),
        Group("main", "vehicles", _of(MainReservoir, 1e12)),
        Group("vigilance", "valves", (VEHICLE, *_of(Vigilance, 1e12))),
    )


#: Values of a group: columns by name, with a number for each owner; or a row by name for each owner.
Rows = Mapping[str, ArrayLike] | Sequence[Mapping[str, float]]


def laid(groups: Mapping[str, Rows]) -> NDArray[np.float64]:
    """Return the numbers of a train of all groups by name. Raises KeyError if one is missing."""

    def column(given: Rows, name: str) -> NDArray[np.float64]:
        values = given[name] if isinstance(given, Mapping) else [row[name] for row in given]
        return np.ravel(np.asarray(values, float))

    return np.concatenate([column(groups[one.name], field.name) for one in layout() for field in one.fields])


@dataclass(frozen=True)
class Equipment:
    """Equipment of a vehicle: its name in messages; a vehicle has it if a field, as GROUP.NAME, exceeds its value."""

    text: str
    above: Mapping[str, float]


#: Equipment by the name of the input that has no effect on vehicles without it.
EQUIPMENT = {
    "traction": Equipment("motors", {"traction.traction_force": 0.0}),
    "dynamic_brake": Equipment("an electric brake", {"electric.dynamic_force": 0.0}),
    "track_brake": Equipment("track brakes", {"track.magnetic_attraction": 0.0, "track.eddy_force": 0.0}),
    "parking_brake": Equipment("a parking brake", {"parking.parking_force": 0.0}),
    "direct_brake": Equipment("a direct brake", {"direct.direct_pressure": 0.0}),
    "bail_off": Equipment(
        "a direct brake or the interlock", {"direct.direct_pressure": 0.0, "electric.blending": float(CLOSES)}
    ),
    "vigilance": Equipment("a vigilance device", {"vigilance.vigilance_time": 0.0}),
}
