"""Compiled kernels and built FMUs, shared by all tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from brake_controller.cylinder import brake_cylinder
from fmu_src.compile import build_library
from fmu_src.kernel import Library
from rbd_model.bogie import bogie_dynamics
from scenarios.fmus.building import KINDS, up_to_date
from scenarios.fmus.registry import DIFFERENT


@pytest.fixture(scope="session")
def bogie() -> Library:
    return Library(build_library(bogie_dynamics()))


@pytest.fixture(scope="session")
def brake() -> Library:
    return Library(build_library(brake_cylinder()))


@pytest.fixture(scope="session")
def fmus() -> dict[tuple[str, str], Path]:
    """FMUs by (name, kind), all whose equations differ; built now unless this content was built before."""
    return {(name, kind): up_to_date(name, kind) for name in DIFFERENT for kind in KINDS}
