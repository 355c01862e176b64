"""Kalker's coefficients of a contact ellipse: those of all creep laws."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker import kalker_coefficients


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return c11, c22 and c23 [1]."""
    found = kalker_coefficients(ca.SX(inputs["along"] / inputs["across"]), inputs["poisson_ratio"])
    return {name: float(getattr(found, name)) for name in ("c11", "c22", "c23")}
