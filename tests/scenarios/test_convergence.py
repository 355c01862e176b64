"""All numbers of a 3D study are converged: a ten times tighter tolerance changes them by less than 1 %."""

from __future__ import annotations

import math

import pytest

from bogie_braking.reporting.report import Row
from bogie_braking.reporting.scenario import Options
from fmu_src.kernel import Kernel, Library
from products import kernel_runs as scene
from rbd_model.levels.models import DEFAULT_TOLERANCE
from scenarios.bench.asymmetric_shoes import FASTEST
from scenarios.catalogue import find
from scenarios.thesis import asymmetric_braking

IN_SPACE = (
    *("wheelset-constant-speed", "wheelset-torque", "wheelset-variable-speed", "wheelset-skid", "critical-speed"),
    *("bogie-lateral", "bogie-vertical", "bogie-crosslevel", "bogie-pitch", "bogie-lateral-under-torque", "bogie-skid"),
    "asymmetric-braking",
)
#: After flange impacts (peaks beyond the clearance) the motion is chaotic, with a spread of up to 5 %. On elastic
#: patches it is chaotic only where wheels lift off, with a spread of 9 %.
BAND, CHAOTIC_BAND, LIFTING_BAND, FLANGE = 0.01, 0.06, 0.12, 9.5
ON_PATCHES, LIFTING = "contact model 2", "rotating axis, contact model 2, trailing, 75 %"


def tighter(library: Library, **values: float) -> Kernel:
    return Kernel(library, **values | {"tolerance": values.get("tolerance", DEFAULT_TOLERANCE) / 10})


def band_of(row: Row) -> float:
    """Return the largest change of a row of asymmetric braking at a ten times tighter tolerance, as a share."""
    if row.unit != "mm" or row.simulated is None or row.simulated <= FLANGE:
        return BAND
    if LIFTING in row.quantity:
        return LIFTING_BAND
    return BAND if ON_PATCHES in row.quantity else CHAOTIC_BAND


@pytest.fixture
def fastest_application(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep the hardest-braked cases of chapter 9; the others reach the same flanges more slowly."""
    for name in ("CASES", "FURTHER_CASES"):
        cases = [case for case in getattr(asymmetric_braking, name) if case.application == FASTEST]
        monkeypatch.setattr(asymmetric_braking, name, cases)


@pytest.mark.study
@pytest.mark.usefixtures("fastest_application")
@pytest.mark.parametrize("name", IN_SPACE)
def test_numbers_are_converged(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = find(name)
    found = scenario.run(Options()).rows
    monkeypatch.setattr(scene, "Kernel", tighter)
    for row, other in zip(found, scenario.run(Options()).rows, strict=True):
        assert (row.simulated is None) == (other.simulated is None), row.quantity
        if row.simulated is None or other.simulated is None:
            continue
        share = band_of(row) if name == "asymmetric-braking" else BAND
        low, high = row.limits or (0.0, 0.0)
        band = (high - low) / 2 if math.isfinite(high - low) else abs(high if math.isfinite(high) else low)
        floor = 0.01 * band
        allowed = max(share * abs(other.simulated), floor)
        assert abs(row.simulated - other.simulated) <= allowed, row.quantity
