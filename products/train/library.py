"""The C of trains: what is written in c/, what is generated for each cell, vehicle and coupler, and both compiled."""

from __future__ import annotations

import ctypes
import json
import re
from functools import lru_cache
from pathlib import Path
from typing import Any

from brake_controller.brake_heat import fading, heating, surfacing
from brake_controller.brake_pipe import (
    dragging,
    ending,
    leaking,
    passing,
    rates,
    sides,
    tapped,
    tapping,
    walled,
    warmed,
)
from brake_controller.direct_brake import direct_braking
from brake_controller.distributors import BUILT_IN, distributors
from brake_controller.distributors.distributor import Distributor
from brake_controller.electric_brake import blending
from brake_controller.main_reservoir import pumping
from brake_controller.parking_brake import parking
from brake_controller.slide_protection import guarded
from brake_controller.track_brakes import track_braking
from brake_controller.traction import driving
from brake_controller.vehicle_brake import braking
from fmu_src.compile import library_suffix, loaded, plain_library
from fmu_src.equations_in_c import WIDTHS, function_of_cells
from products.prebuilt import prebuilt_from_these
from products.train import c as folder
from products.train.layout_in_c import fields_in_c, layout_in_c
from rbd_model.train.adhesion import adhering
from rbd_model.train.coupler import coupling, coupling_of_few
from rbd_model.train.vehicle import rolling, sliding

FOLDER = Path(folder.__file__ or "").parent
#: Functions of cells by the C file whose loops call them.
FUNCTIONS = {
    "pipe": (sides, passing, rates, dragging, leaking, warmed, ending, walled, tapping, tapped),
    "motion": (coupling, coupling_of_few, rolling, sliding),
    "train": (
        *(braking, blending, heating, surfacing, fading, track_braking, parking, driving, adhering),
        *(direct_braking, pumping),
    ),
    "coupler": (coupling,),
}
#: Files of a release: the generated functions, and the compiled library without its suffix.
CELLS, SHIPPED = "train/cells.json", "train/functions"


def cells() -> dict[str, str]:
    """Return the generated functions by the keys of FUNCTIONS."""
    return dict(_cells(tuple(distributors().values())))


@lru_cache
def _cells(kinds: tuple[Distributor, ...]) -> dict[str, str]:
    """Return those that a wheel brings, or new ones if a source has changed or a kind of distributor is added."""
    if path := prebuilt_from_these(CELLS) if kinds == BUILT_IN else None:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    made = {name: [function() for function in functions_of] for name, functions_of in FUNCTIONS.items()}
    made["pipe"] += [kind.function(form) for kind in kinds for form in dict.fromkeys(kind.brake_models())]
    made["pipe"] += [kind.pressing_function() for kind in kinds if kind.pressing]
    return {name: "\n".join(_arguments_used(function_of_cells(one)) for one in own) for name, own in made.items()}


def sources() -> dict[str, str]:
    """C files by name; those of the distributors that there are now."""
    return dict(_sources(tuple(distributors().values())))


@lru_cache
def _sources(kinds: tuple[Distributor, ...]) -> dict[str, str]:
    files = [path for path in sorted(FOLDER.glob("*.[ch]")) if not path.name.endswith("_fmu.c")]
    texts = {path.name: path.read_text(encoding="utf-8") for path in files}
    texts |= {"train_layout.h": layout_in_c(), "train_fields.h": fields_in_c()} | guarded()
    texts["own_controllers.h"] = own_controllers_in_c(0)
    for name, text in _cells(kinds).items():
        if name == "coupler":  # an FMU of its own
            continue
        texts[f"{name}_cells.h"] = text
        for lanes in (1, *WIDTHS):
            loops = f'#define LANES {lanes}\n#include "{name}_loops.h"\n'
            texts[f"{name}_{lanes}.c"] = (
                f'#include "lanes_widest.h"\n#include "{name}_inside.h"\n#if LANES_WIDEST >= {lanes}\n{loops}#endif\n'
            )
    return texts


def own_controllers_in_c(count: int) -> str:
    """Return own_controllers.h: the functions of users' controllers by their prefixes own_1, own_2, ..."""
    names = [f"own_{number + 1}" for number in range(count)]
    declared = [
        f"size_t {name}_size(int wheelsets);\nvoid {name}_start(void *memory, int wheelsets, double period);\n"
        f"void {name}_step(void *memory, double time, const double *wheel_speed, int *valve);\n"
        for name in names
    ]
    rows = ", ".join(f"{{{name}_size, {name}_start, {name}_step}}" for name in names)
    return f"/* Written by products/train/library.py. */\n{''.join(declared)}#define OWN_CONTROLLERS {rows}\n"


def _arguments_used(text: str) -> str:
    """Return a function in C that refers to all its arguments: a distributor without a pipe has no use for its air."""
    head, _, body = text.partition(") {\n")
    unused = "".join(
        f" (void){name};" for name in re.findall(r"const double \*(\w+)", head) if not re.search(rf"\b{name}\b", body)
    )
    return f"{head}) {{\n   {unused}\n{body}" if unused else text


class OutsideInC(ctypes.Structure):
    """`pipe_outside` of pipe.h."""

    _fields_ = tuple((name, ctypes.c_double) for name in ("opening", "area", "pressure", "temperature"))


class PassedInC(ctypes.Structure):
    """`pipe_passed` of pipe.h."""

    _fields_ = (
        *((name, ctypes.c_double * 2) for name in ("end_mass", "end_energy")),
        *((name, ctypes.c_double) for name in ("leak_mass", "leak_energy", "vehicle_mass", "vehicle_energy", "heat")),
        *((name, ctypes.c_double) for name in ("cylinder_mass", "valve_mass", "valve_energy", "let_in")),
    )


def functions() -> ctypes.CDLL:
    """The functions of pipe.h and train.h, compiled once for the distributors that there are now."""
    return _functions(tuple(distributors().values()))


@lru_cache
def _functions(kinds: tuple[Distributor, ...]) -> ctypes.CDLL:
    shipped = prebuilt_from_these(f"{SHIPPED}{library_suffix()}") if kinds == BUILT_IN else None
    library = loaded(shipped or plain_library(_sources(kinds)))
    pointer, count, number = ctypes.c_void_p, ctypes.c_longlong, ctypes.c_double
    block, told = ctypes.POINTER(number), ctypes.POINTER(count)
    signatures: dict[str, tuple[Any, list[Any]]] = {
        "pipe_create": (pointer, [count, pointer, pointer]),
        "pipe_free": (None, [pointer]),
        "pipe_vehicles": (ctypes.c_int, [pointer, count, *[pointer] * 4, ctypes.c_int, number]),
        "pipe_charge": (None, [pointer, number, number, number]),
        "pipe_vehicle_states": (None, [pointer, ctypes.c_int, pointer]),
        "pipe_end": (None, [pointer, ctypes.c_int, ctypes.POINTER(OutsideInC)]),
        "pipe_state": (None, [pointer, pointer]),
        "pipe_has_passed": (ctypes.POINTER(PassedInC), [pointer]),
        "pipe_advance": (count, [pointer, number, number]),
        "train_wrong": (ctypes.c_char_p, [pointer, count]),
        "train_create": (pointer, [pointer, count]),
        "train_free": (None, [pointer]),
        "train_begin": (None, [pointer, *[number] * 5]),
        "train_input": (block, [pointer, ctypes.c_int, told]),
        "train_output": (block, [pointer, ctypes.c_int, told]),
        "train_go": (ctypes.c_int, [pointer, number]),
        "train_input_wrong": (ctypes.c_int, [pointer, told]),
        "train_numbers": (count, [pointer]),
        "train_locked_at": (block, [pointer]),
        "train_broken_at": (block, [pointer]),
        "train_parted_at": (block, [pointer]),
        "train_save": (None, [pointer, pointer]),
        "train_load": (None, [pointer, pointer]),
        "train_steps": (None, [pointer, pointer]),
        "train_motion": (None, [pointer, pointer]),
        "train_set_motion": (None, [pointer, pointer]),
        "train_air": (pointer, [pointer]),
        "train_control": (ctypes.c_int, [pointer, count, pointer, pointer, ctypes.c_size_t]),
        "train_lacks_controller": (count, [pointer]),
        "train_detail": (ctypes.c_int, [pointer, count, *[pointer] * 3]),
        "train_detail_begin": (None, [pointer]),
        "train_detail_step": (None, [pointer, number]),
        "train_detail_failed": (count, [pointer]),
        "train_detail_brake": (block, [pointer, count]),
        "train_detail_turning": (block, [pointer, count]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
