"""Libraries of models that one file asks little of."""

from __future__ import annotations

import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import generate
from fmu_src.kernel import Library
from fmu_src.system import Model


def quick_library(model: Model) -> Library:
    """A library whose equations are compiled as they stand, for two lanes at most: for those that run briefly.

    In a quarter of the time. More lanes have the same bits (tests/test_lanes.py).
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiling, "OPTIMISE_GENERATED", "-O0")
        flags = (*compiling.FLAGS, "-DLANES_WIDEST=2")
        return Library(compiling.library_of(generate(model), flags))
