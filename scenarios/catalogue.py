"""All scenarios. A new one is a file and one entry here."""

from __future__ import annotations

from scenarios import contact_geometry, creep_forces, heavy_braking, lock_boundary, qr30, speed, traction_braking
from scenarios.scenario import Scenario

SCENARIOS: list[Scenario] = [
    *qr30.SCENARIOS,
    lock_boundary.SCENARIO,
    traction_braking.SCENARIO,
    heavy_braking.SCENARIO,
    contact_geometry.SCENARIO,
    creep_forces.SCENARIO,
    speed.SCENARIO,
]
