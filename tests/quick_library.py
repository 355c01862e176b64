"""Libraries of models that one file asks little of."""

from __future__ import annotations

import pytest

from fmu_src import compile as compiling
from fmu_src.kernel import Library
from fmu_src.system import Model


def quick_library(model: Model) -> Library:
    """A library whose equations are compiled as they stand, in a quarter of the time: for those that run briefly."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiling, "OPTIMISE_GENERATED", "-O0")
        return Library(compiling.build_library(model))
