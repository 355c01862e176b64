"""The kernel of a vehicle in detail, and how the train's C calls it: products/train/c/detail.h.

The train gives the kernel its line, friction, running resistance (W. J. Davis (1926)), brake and coupler forces.
"""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.system import Model, Variable
from products.building import kernel_at, variables_of, whole_kernel
from products.train.detail import MOST_WHEELSETS, Detail
from products.train.detail_columns import DAVIS
from products.vehicle_sheet import WITH_EFFECT
from rbd_model.contact.pair_file import PAIR_FILE, joined
from rbd_model.levels.models import DEPTH_ON_LINE, LEVELS, model_of_levels, places_of
from rbd_model.track.line import Line
from rbd_model.track.line_table import LINE

#: Axle-box resistance of a vehicle's parameters, which is a part of the running resistance of a train.
AXLE_BOXES = "rolling_resistance_torque"


@dataclass(frozen=True)
class Compiled:
    """The kernel of a detail: its library, and its variables by name."""

    library: Library
    variables: Mapping[str, Variable]


def compiled(detail: Detail, on_line: bool) -> Compiled:
    """Return the kernel of a detail, compiled if missing. Raises ValueError, CompilerError, MissingExtraError."""
    place = place_in_fmu(detail, on_line)
    if detail.fmu is None:
        model = own_model(detail, on_line)
        return Compiled(Library(build_library(model)), {one.name: one for one in model.variables})
    return Compiled(_library(detail.fmu, place), variables_of(detail.fmu))


def place_in_fmu(detail: Detail, on_line: bool) -> int:
    """Return the number of the detail's system in its FMU. Raises ValueError if it does not exist on a line."""
    if on_line and detail.level == max(LEVELS) and detail.contact_model != DEPTH_ON_LINE:
        raise ValueError(f"contact_model must be {DEPTH_ON_LINE} on a line; got {detail.contact_model}. Change it.")
    (place,) = places_of(detail.level, detail.contact_model, on_line)
    return place


def own_model(detail: Detail, on_line: bool) -> Model:
    """Return the model of a vehicle whose equations are its own."""
    place = place_in_fmu(detail, on_line)
    return model_of_levels(detail.vehicle.name, f"{detail.vehicle.name} in a train", detail.vehicle, (place,))


@lru_cache
def _library(name: str, place: int) -> Library:
    return Library(whole_kernel(name) or kernel_at(name, place))


def start_values(detail: Detail, motion: Mapping[str, float], speed: float, on_line: bool) -> dict[str, float]:
    """Return start values of a kernel; motion: constants of the train's row (MOTION); speed [m/s]."""
    in_space = detail.level == max(LEVELS)
    own = WITH_EFFECT.get(detail.level, detail.parameters.keys())
    values = {name: value for name, value in detail.parameters.items() if name in own} if detail.fmu else {}
    values |= {"level": detail.level, "contact_model": detail.contact_model} if detail.fmu else {}
    if detail.resistance is None:
        values[AXLE_BOXES] = 0.0
    values |= dict(zip(DAVIS, (motion[name] for name in ("constant", "linear", "square")), strict=True))
    values |= {name: motion[name] for name in ("friction_ratio", "friction_decay")}
    curves = {"curve_resistance": 1.0} if on_line and not in_space else {}
    return values | curves | {"initial_speed": speed}


def reads_profiles(detail: Detail) -> bool:
    """Return whether a kernel reads contact tables."""
    return bool(detail.profile_files) and detail.level == max(LEVELS)


def moved(line: Line, way: float) -> Line:
    """Return a line whose distances are smaller by a displacement [m]."""
    return Line.of_any_size({**line.rows, "distance": np.asarray(line.rows["distance"], float) - way})


def kernel_of(detail: Detail, motion: Mapping[str, float], speed: float, line: Line | None, middle: float) -> Kernel:
    """Return the initialised kernel of a vehicle of a train; middle: place of its middle on the line [m]."""
    made = compiled(detail, line is not None)
    values = start_values(detail, motion, speed, line is not None)
    kernel = Kernel(made.library, **{name: value for name, value in values.items() if name in made.variables})
    if reads_profiles(detail):
        kernel.set(**{PAIR_FILE.variable.name: joined(detail.profile_files)})
    if line is not None:
        with tempfile.TemporaryDirectory() as folder:
            kernel.set(**{LINE.variable.name: str(moved(line, middle).write(Path(folder) / "line.csv"))})
    kernel.initialise()
    return kernel


# ---- as the train's C calls it ---------------------------------------------------------------------------------------


class VariablesInC(ctypes.Structure):
    """`detail_variables` of detail.h."""

    _fields_ = (
        *((name, ctypes.c_int) for name in ("wheelsets", "front", "rear", "place", "speed", "pitch", "pitch_rate")),
        ("axle_speed", ctypes.c_int),
        *((name, ctypes.c_int * MOST_WHEELSETS) for name in ("brake", "traction", "friction", "turning", "creep")),
        ("radius", ctypes.c_double),
        ("height", ctypes.c_double),
    )


#: Functions of a kernel in the order of `detail_functions`.
CALLED = ("set", "get", "step", "time", "state_size", "save", "restore")
#: Names of the variables of `detail_variables`: at level 1, and from level 2 on; of each wheelset.
AT_POINT = {"place": "state_distance", "speed": "state_speed", "pitch": "", "pitch_rate": ""}
OF_EACH = {
    "brake": "brake_torque",
    "traction": "traction_torque",
    "friction": "friction",
    "turning": "angular_velocity",
    "creep": "creep_force",
}


class FunctionsInC(ctypes.Structure):
    """`detail_functions` of detail.h."""

    _fields_ = tuple((name, ctypes.c_void_p) for name in CALLED)


def functions_of(library: Library) -> FunctionsInC:
    """Return the functions of a kernel's library."""
    found = (getattr(library.functions, f"kernel_{name}") for name in CALLED)
    return FunctionsInC(*(ctypes.cast(one, ctypes.c_void_p) for one in found))


def variables_in_c(detail: Detail, names: Sequence[str]) -> VariablesInC:
    """Return the numbers of a kernel's variables; names: of all of them."""
    number = {name: place for place, name in enumerate(names)} | {"": -1}
    body = detail.vehicle.bodies[0]
    in_plane = {
        "place": f"state_{body.name}_distance",
        "speed": f"state_{body.name}_speed",
        "pitch": f"state_{body.variable('pitch')}",
        "pitch_rate": f"state_{body.variable('pitch')}_rate",
    }
    found = VariablesInC(len(detail.vehicle.wheelsets), radius=detail.radius, height=detail.coupler_height)
    front, rear = (pull.name for pull in detail.vehicle.pulls)
    states = AT_POINT if detail.level == 1 else in_plane
    for field_name, name in {"front": front, "rear": rear, "axle_speed": "speed", **states}.items():
        setattr(found, field_name, number[name])
    for field_name, name in OF_EACH.items():
        for n in range(found.wheelsets):
            getattr(found, field_name)[n] = number[f"{name}_{n + 1}"]
    return found


def outputs_of(made: Compiled) -> list[Variable]:
    """Return the outputs of a kernel."""
    return [variable for variable in made.variables.values() if variable.causality == "output"]
