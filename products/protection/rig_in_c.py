"""The rig's C as Python calls it: its structures and its functions (brake_controller/rig/), in one library."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from brake_controller.protection_fmu import MOST_WHEELSETS
from brake_controller.slide_protection import RIG, guarded
from fmu_src.compile import library_suffix, loaded, plain_library
from fmu_src.native_fmu import binary_for
from products.controller_kinds import FunctionsInC, InC
from products.prebuilt import prebuilt_from_these


class SensorSettings(ctypes.Structure):
    """An `encoder_settings` of encoder.h."""

    _fields_ = (
        ("pulses", ctypes.c_int),
        *((name, ctypes.c_double) for name in ("gate", "timer", "lowest_frequency")),
    )


class RigSettings(ctypes.Structure):
    """A `rig_settings`."""

    _fields_ = (
        ("wheelsets", ctypes.c_int),
        *((name, ctypes.c_double) for name in ("radius", "period", "brake_start", "demand", "longest")),
        *((name, ctypes.c_double) for name in ("lock_above", "jerk_time", "band", "check_above")),
        *((name, ctypes.c_int) for name in ("reservoir", "driven")),
        ("encoder", SensorSettings),
    )


class RigWheelset(ctypes.Structure):
    """A `rig_wheelset`."""

    _fields_ = (
        *((name, ctypes.c_double) for name in ("radius", "sensor_from", "valve_from", "phase")),
        *((name, ctypes.c_int) for name in ("sensor", "valve_sticks")),
    )


class RigNotes(ctypes.Structure):
    """A `rig_notes`."""

    _fields_ = (
        *((name, ctypes.c_longlong) for name in ("every", "room")),
        *((name, ctypes.c_void_p) for name in ("sample", "count")),
    )


class Desk(ctypes.Structure):
    """A `rig_desk`."""

    _fields_ = (("time", ctypes.c_void_p), ("wheel_speed", ctypes.c_void_p), ("valve", ctypes.c_void_p))


#: A `rig_score` of rig.h.
SCORE = np.dtype(
    [
        *((name, float) for name in ("distance", "speed", "time", "longest_lock", "longest_skid")),
        *((name, float) for name in ("band", "checked", "filled", "jerk", "taken", "reservoir")),
        ("sliding", float, MOST_WHEELSETS),
        *((name, float) for name in ("commands", "longest_vent", "failed_at")),
        *((name, np.int32) for name in ("state", "answer", "valve")),
    ],
    align=True,
)
RUNS, DONE, TOO_LONG, LOST = range(4)
#: Instead of the number of a valve: RIG_BEYOND.
BEYOND = -1


#: The library in the folder of a release's compiled files.
SHIPPED = "rig/rig"


def sources() -> dict[str, str]:
    """Return the C of the rig with its sensors and the built-in protection, by file name."""
    return {name: (RIG / name).read_text(encoding="utf-8") for name in ("rig.c", "rig.h")} | guarded()


def binary_of_rig(targets: Sequence[str]) -> bytes:
    """Return the library for targets of zig, one file for two. Raises CompilerError."""
    return binary_for(targets, lambda target: plain_library(sources(), target=target))


@lru_cache
def library() -> Path:
    """Return the library that a wheel brings, if no source has changed, or one compiled here. Raises CompilerError."""
    return prebuilt_from_these(f"{SHIPPED}{library_suffix()}") or plain_library(sources())


@lru_cache
def slide_protection() -> InC:
    """Return the built-in protection with its default thresholds. Raises CompilerError."""
    return InC(library())


@lru_cache
def functions() -> ctypes.CDLL:
    """Return the functions of the library. Raises CompilerError."""
    found = loaded(library())
    pointer, count = ctypes.c_void_p, ctypes.c_longlong
    signatures: dict[str, tuple[Any, list[Any]]] = {
        "rig_create": (pointer, [count, *map(ctypes.POINTER, (RigSettings, FunctionsInC, Desk))]),
        "rig_free": (None, [pointer]),
        "rig_begin": (None, [pointer, count, ctypes.c_double, pointer, pointer]),
        "rig_scores": (pointer, [pointer]),
        "rig_write_down": (None, [pointer, ctypes.POINTER(RigNotes)]),
        "rig_sample": (None, [pointer, count, ctypes.c_int, pointer]),
        "rig_give_up": (None, [pointer, count]),
        "encoder_size": (ctypes.c_size_t, []),
        "encoder_begin": (None, [pointer, pointer, ctypes.c_double]),
        "encoder_read": (ctypes.c_double, [pointer, ctypes.POINTER(SensorSettings), *[ctypes.c_double] * 2]),
        "slide_set_thresholds": (None, [pointer, pointer]),
        "slide_reference": (ctypes.c_double, [pointer]),
        "slide_believes": (ctypes.c_int, [pointer, ctypes.c_int]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(found, name)
        function.restype, function.argtypes = result, arguments
    return found
