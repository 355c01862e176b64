"""Coupler.fmu: a coupler alone, from the displacement of a coupling to its tension; for FMI 2.0 and FMI 3.0."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fmu_src.arrays_fmu import ArraysFmu, ArraysInC, ArrayVariable
from fmu_src.c_literals import c_array, c_number
from fmu_src.codegen import RUNTIME
from products.train.coupler_tables import coupler_named
from products.train.layout_in_c import layout_in_c
from products.train.library import FOLDER, cells
from rbd_model.train.coupler import COUPLER, Coupler

NAME = "Coupler"
WAY = "Way of the coupling from where it is neither long nor short: of the vehicle ahead less that behind"
ARRAYS = (
    ArrayVariable("way", "input", "m", WAY, -10.0, 10.0),
    ArrayVariable("coupling_closed", "input", "1", "1 coupled, once the vehicles touch; 0 only pushed", 0, 1, True),
    ArrayVariable("force", "output", "N", "Tension at the end of the step, compression below zero"),
    ArrayVariable("mean_force", "output", "N", "Mean tension on the way of the step"),
    ArrayVariable("work", "output", "J", "Work that the coupler has taken since the start"),
)


@lru_cache
def coupler_in_c() -> ArraysInC:
    """Return the C object of a coupler with its arrays."""
    places = f"enum {{ {', '.join(array.name.upper() for array in ARRAYS)}, ARRAYS_MOST }};\n"
    limits = [f"{{{c_number(one.least)}, {c_number(one.most)}}}" for one in COUPLER]
    places += "typedef struct {\n    double least, most;\n} coupler_limits;\n"
    places += c_array("coupler_limits", "COUPLER_LIMITS", limits)
    own = {
        "coupler_arrays.h": places,
        "coupler_cells.h": cells()["coupler"],
        "train_layout.h": layout_in_c(),
    }
    own["coupler_fmu.c"] = (FOLDER / "coupler_fmu.c").read_text(encoding="utf-8")
    own |= {path.name: path.read_text(encoding="utf-8") for path in sorted(RUNTIME.glob("lanes*.h"))}
    return ArraysInC(NAME, "A coupler with friction that sticks, between two vehicles of a train", ARRAYS, own)


def coupler_fmu(coupler: Coupler) -> ArraysFmu:
    """Return the FMU of a coupler."""
    data = {"coupler.bin": np.array(coupler.constants(), "<f8").tobytes()}
    return ArraysFmu(coupler_in_c(), [1] * len(ARRAYS), [[0.0], [1.0], [0.0], [0.0], [0.0]], 0.001, 10.0, data)


def named_coupler_fmu(coupler: str = "screw") -> ArraysFmu:
    """Return the FMU of a coupler by `coupler_named`. Raises ValueError, OSError."""
    return coupler_fmu(coupler_named(coupler))
