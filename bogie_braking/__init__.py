"""Brake a railway vehicle in simulation: torque goes in; speed, wheel rotation, slip and lock-up come out.

The page *Python API* of the documentation describes the names and their compatibility. All other modules of this
package may change.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fmu_src import __name__ as _place_of_a_room
from fmu_src import __version__ as __version__

if TYPE_CHECKING:
    from bogie_braking import adhesion as adhesion
    from bogie_braking import brakes as brakes
    from bogie_braking import equations as equations
    from bogie_braking import etcs as etcs
    from bogie_braking import gym as gym
    from bogie_braking import logs as logs
    from bogie_braking import parts as parts
    from bogie_braking import running as running
    from bogie_braking.batches import batch as batch
    from bogie_braking.batches import instances as instances
    from bogie_braking.calibration import fit as fit
    from bogie_braking.creep_curves import creep_curve as creep_curve
    from bogie_braking.fitting import Fit as Fit
    from bogie_braking.fmus import fmu as fmu
    from bogie_braking.fmus import write_fmu as write_fmu
    from bogie_braking.hunting import critical_speed as critical_speed
    from bogie_braking.hunting import modes as modes
    from bogie_braking.machines import vehicle as vehicle
    from bogie_braking.measured_data import measured_from as measured_from
    from bogie_braking.pairs import pair as pair
    from bogie_braking.pairs import profile as profile
    from bogie_braking.protection import protected_stop as protected_stop
    from bogie_braking.protection import protected_stops as protected_stops
    from bogie_braking.rare_events import rare as rare
    from bogie_braking.repeating import repeat as repeat
    from bogie_braking.simulation import Simulation as Simulation
    from bogie_braking.simulation import run as run
    from bogie_braking.sweeping import sweep as sweep
    from bogie_braking.trains import train as train
    from fmu_src.cosimulation.master import Connection as Connection
    from fmu_src.cosimulation.master import cosimulate as cosimulate
    from fmu_src.cosimulation.recording import Recording as Recording
    from fmu_src.cosimulation.slave import CosimulationError as CosimulationError
    from fmu_src.cosimulation.slave import FmuInstance as FmuInstance
    from fmu_src.kernel import SimulationError as SimulationError
    from fmu_src.system import Model as Model
    from fmu_src.system import System as System
    from fmu_src.variables import Variable as Variable
    from products.train.cleaning import CleanedRail as CleanedRail
    from products.train.driver import HoldingDriver as HoldingDriver
    from products.train.stations import StationStop as StationStop
    from products.train.timetable import TimetableDriver as TimetableDriver
    from products.vehicle_file import read_vehicle as read_vehicle
    from rbd_model.track.line import Line as Line
    from rbd_model.track.line import arc as arc
    from rbd_model.track.line import clothoid as clothoid
    from rbd_model.track.line import line_of as line_of
    from rbd_model.track.line import straight as straight
    from rbd_model.track.line_elements import line_from_elements as line_from_elements
    from rbd_model.track.line_files import line_from_file as line_from_file
    from rbd_model.track.line_points import line_from_points as line_from_points
    from rbd_model.track.spectra import Spectrum as Spectrum
    from rbd_model.track.spectra import irregular as irregular

#: Module of each public name; it is imported on first use.
_HOMES = {
    "bogie_braking": ("adhesion", "brakes", "equations", "etcs", "gym", "logs", "parts", "running"),
    "bogie_braking.batches": ("batch", "instances"),
    "bogie_braking.calibration": ("fit",),
    "bogie_braking.creep_curves": ("creep_curve",),
    "bogie_braking.fitting": ("Fit",),
    "bogie_braking.fmus": ("fmu", "write_fmu"),
    "bogie_braking.hunting": ("critical_speed", "modes"),
    "bogie_braking.machines": ("vehicle",),
    "bogie_braking.measured_data": ("measured_from",),
    "bogie_braking.pairs": ("pair", "profile"),
    "bogie_braking.protection": ("protected_stop", "protected_stops"),
    "bogie_braking.rare_events": ("rare",),
    "bogie_braking.repeating": ("repeat",),
    "bogie_braking.simulation": ("Simulation", "run"),
    "bogie_braking.sweeping": ("sweep",),
    "bogie_braking.trains": ("train",),
    "fmu_src.cosimulation.master": ("Connection", "cosimulate"),
    "fmu_src.cosimulation.recording": ("Recording",),
    "fmu_src.cosimulation.slave": ("CosimulationError", "FmuInstance"),
    "fmu_src.kernel": ("SimulationError",),
    "fmu_src.system": ("Model", "System"),
    "fmu_src.variables": ("Variable",),
    "products.train.cleaning": ("CleanedRail",),
    "products.train.driver": ("HoldingDriver",),
    "products.train.stations": ("StationStop",),
    "products.train.timetable": ("TimetableDriver",),
    "products.vehicle_file": ("read_vehicle",),
    "rbd_model.track.line": ("Line", "arc", "clothoid", "line_of", "straight"),
    "rbd_model.track.line_elements": ("line_from_elements",),
    "rbd_model.track.line_files": ("line_from_file",),
    "rbd_model.track.line_points": ("line_from_points",),
    "rbd_model.track.spectra": ("Spectrum", "irregular"),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}
#: Prefix of a package's name: empty in a checkout, this package in a wheel.
_BELOW = _place_of_a_room.removesuffix("fmu_src")
__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    """Import a public name with its dependencies. Raises AttributeError, or MissingExtraError."""
    if name not in _HOME:
        there = import_module(f"{_BELOW}fmu_src.suggestion").suggestion(name, __all__, f"it has {', '.join(__all__)}.")
        raise AttributeError(f"bogie_braking has no public name {name}; {there}")
    home = _HOME[name]
    if home == __name__:
        return import_module(f"{home}.{name}")
    with import_module(f"{_BELOW}readers.extras").named_extras():
        return getattr(import_module(home if home.startswith(__name__) else _BELOW + home), name)


def __dir__() -> list[str]:
    return __all__
