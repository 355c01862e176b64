"""The bogie's FMU as objects, shared by the tests that link programs in C to it."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmu_src.codegen import generate
from rbd_model.levels.models import bogie_dynamics
from tests.fmu.sanitized import plain, sanitized


@pytest.fixture(scope="session")
def objects() -> dict[str, list[str | Path]]:
    """Plain and with sanitizers: what links a driver to them."""
    sources = generate(bogie_dynamics())
    return {"plain": plain(sources), "sanitized": sanitized(sources)}
