"""Compiled kernels and built FMUs, shared by all tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from brake_controller.cylinder import brake_cylinder
from build_fmu import BUILDERS, MODELS, fmu_path
from fmu_src.compile import build_library
from fmu_src.kernel import Library
from rbd_model.bogie import bogie_dynamics


@pytest.fixture(scope="session")
def bogie() -> Library:
    return Library(build_library(bogie_dynamics()))


@pytest.fixture(scope="session")
def brake() -> Library:
    return Library(build_library(brake_cylinder()))


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], Path]:
    """All four FMUs by (model, kind), built into a fresh folder."""
    out = tmp_path_factory.mktemp("fmus")
    built = {}
    for name, make in MODELS.items():
        model = make()
        for kind, build in BUILDERS.items():
            built[name, kind] = fmu_path(model, kind, out)
            build(model, built[name, kind])
    return built
