"""The rig's C as Python calls it: its structures and its functions (brake_controller/rig/rig.h)."""

from __future__ import annotations

import ctypes
from functools import lru_cache
from typing import Any

import numpy as np

from brake_controller.protection_fmu import MOST_WHEELSETS
from fmu_src.compile import loaded, plain_library
from products.protection.forms import FOLDER, FunctionsInC


class SensorSettings(ctypes.Structure):
    """An `encoder_settings` of encoder.h."""

    _fields_ = (
        ("pulses", ctypes.c_int),
        *((name, ctypes.c_double) for name in ("gate", "timer", "lowest_frequency")),
    )


class Settings(ctypes.Structure):
    """A `rig_settings`."""

    _fields_ = (
        ("wheelsets", ctypes.c_int),
        *((name, ctypes.c_double) for name in ("radius", "period", "brake_start", "demand", "longest")),
        *((name, ctypes.c_double) for name in ("lock_above", "band", "look_above")),
        *((name, ctypes.c_int) for name in ("reservoir", "driven")),
        ("encoder", SensorSettings),
    )


class Wheelset(ctypes.Structure):
    """A `rig_wheelset`."""

    _fields_ = (
        *((name, ctypes.c_double) for name in ("radius", "sensor_from", "valve_from", "phase")),
        *((name, ctypes.c_int) for name in ("sensor", "valve_sticks")),
    )


class Notes(ctypes.Structure):
    """A `rig_notes`."""

    _fields_ = (
        *((name, ctypes.c_longlong) for name in ("every", "room")),
        *((name, ctypes.c_void_p) for name in ("look", "count")),
    )


class Desk(ctypes.Structure):
    """A `rig_desk`."""

    _fields_ = (("time", ctypes.c_void_p), ("wheel_speed", ctypes.c_void_p), ("valve", ctypes.c_void_p))


#: A `rig_score` of rig.h.
SCORE = np.dtype(
    [
        *((name, float) for name in ("distance", "speed", "time", "longest_lock", "longest_skid")),
        *((name, float) for name in ("band", "looked", "filled", "taken", "reservoir")),
        ("sliding", float, MOST_WHEELSETS),
        *((name, float) for name in ("commands", "failed_at")),
        *((name, np.int32) for name in ("state", "answer", "valve")),
    ],
    align=True,
)
RUNS, DONE, TOO_LONG, LOST = range(4)
#: In place of a valve: RIG_BEYOND.
BEYOND = -1


@lru_cache
def functions() -> ctypes.CDLL:
    """The rig's own C, compiled once."""
    names = ("rig.c", "encoder.c", "rig.h", "encoder.h", "wheel_slide.h")
    library = loaded(plain_library({name: (FOLDER / name).read_text(encoding="utf-8") for name in names}))
    pointer, count = ctypes.c_void_p, ctypes.c_longlong
    signatures: dict[str, tuple[Any, list[Any]]] = {
        "rig_create": (pointer, [count, *map(ctypes.POINTER, (Settings, FunctionsInC, Desk))]),
        "rig_free": (None, [pointer]),
        "rig_begin": (None, [pointer, count, ctypes.c_double, pointer, pointer]),
        "rig_scores": (pointer, [pointer]),
        "rig_write_down": (None, [pointer, ctypes.POINTER(Notes)]),
        "rig_look": (None, [pointer, count, ctypes.c_int, pointer]),
        "rig_give_up": (None, [pointer, count]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
