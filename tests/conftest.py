"""Compiled kernels and built FMUs, shared by all tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from brake_controller.cylinder import brake_cylinder
from fmu_src.compile import build_library
from fmu_src.kernel import Library
from rbd_model.bogie import bogie_dynamics
from scenarios.fmus.building import KINDS, write_fmu
from scenarios.fmus.registry import FMUS


@pytest.fixture(scope="session")
def bogie() -> Library:
    return Library(build_library(bogie_dynamics()))


@pytest.fixture(scope="session")
def brake() -> Library:
    return Library(build_library(brake_cylinder()))


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], Path]:
    """All FMUs by (name, kind), built into a fresh folder."""
    out = tmp_path_factory.mktemp("fmus")
    return {(name, kind): write_fmu(name, kind, out) for name in FMUS for kind in KINDS}
