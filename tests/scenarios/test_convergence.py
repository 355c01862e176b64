"""Every number of a study in space is converged: ten times tighter tolerance moves it by less than 1 %."""

from __future__ import annotations

import math

import pytest

from fmu_src.kernel import Kernel, Library
from rbd_model.bogie import DEFAULT_TOLERANCE
from scenarios.__main__ import find
from scenarios.bench import drive as scene
from scenarios.scenario import Options

IN_SPACE = (
    *("wheelset-constant-speed", "wheelset-torque", "wheelset-variable-speed", "wheelset-skid", "critical-speed"),
    *("bogie-lateral", "bogie-vertical", "bogie-crosslevel", "bogie-pitch", "bogie-lateral-under-torque", "bogie-skid"),
    "asymmetric-braking",
)
#: Behind flange impacts (peaks beyond the clearance) the motion is chaotic; the spread found is up to 5 %.
BAND, CHAOTIC_BAND, FLANGE = 0.01, 0.06, 9.5


def tighter(library: Library, **values: float) -> Kernel:
    return Kernel(library, **values | {"tolerance": values.get("tolerance", DEFAULT_TOLERANCE) / 10})


@pytest.mark.parametrize("name", IN_SPACE)
def test_numbers_are_converged(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = find(name)
    found = scenario.run(Options()).rows
    monkeypatch.setattr(scene, "Kernel", tighter)
    for row, other in zip(found, scenario.run(Options()).rows, strict=True):
        assert (row.simulated is None) == (other.simulated is None), row.quantity
        if row.simulated is None or other.simulated is None:
            continue
        chaotic = name == "asymmetric-braking" and row.unit == "mm" and row.simulated > FLANGE
        low, high = row.limits or (0.0, 0.0)
        band = (high - low) / 2 if math.isfinite(high - low) else abs(high if math.isfinite(high) else low)
        floor = 0.01 * band
        allowed = max((CHAOTIC_BAND if chaotic else BAND) * abs(other.simulated), floor)
        assert abs(row.simulated - other.simulated) <= allowed, row.quantity
