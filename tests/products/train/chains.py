"""Trains for tests: vehicles without brakes or resistance, and couplers with few parameters."""

from __future__ import annotations

from dataclasses import replace

import pytest

from brake_controller.distributors import DISTRIBUTORS
from products.train.consist import Consist, locomotive, wagon
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.coupler import Coupler, Curve

MASS = 80e3
#: Kinds of distributors of the project.
KINDS = ("uic", "aar", "ecp", "ep_uic", "twin_pipe", "ep_direct", "piped", "vacuum")


def without_added_kinds(monkeypatch: pytest.MonkeyPatch, *others: str) -> None:
    """Leave the distributors of the project and these, so that messages list the same kinds wherever one was added."""
    for kind in set(DISTRIBUTORS) - {*KINDS, *others}:
        monkeypatch.delitem(DISTRIBUTORS, kind)


def spring(stiffness: float, unloading: float = 1.0, sticking: float | None = None) -> Coupler:
    """Return a symmetric coupler; unloading: ratio of the unloading stiffness to the stiffness."""
    load, back = Curve((0.0, 5.0), (0.0, 5.0 * stiffness)), Curve((0.0, 5.0), (0.0, 5.0 * stiffness * unloading))
    return Coupler("spring", sticking or stiffness, (load, back), (load, back))


def chain(masses: list[float], coupler: Coupler, *, braked: bool = False, **settings: object) -> Train:
    """Return a train at rest. Unless `braked`, it has no brakes and wheels of negligible inertia."""
    vehicles = []
    for number, mass in enumerate(masses):
        one = locomotive() if number == 0 else wagon()
        brake = replace(wagon().brake, friction_law=0, constant_friction=0.2 if braked else 0.0)
        own = {"mass": mass, "length": 15.0, "coupler": coupler, "brake": brake, "resistance": (0.0, 0.0, 0.0)}
        vehicles.append(replace(one, rotating_share=0.04 if braked else 1e-9, **own))  # type: ignore[arg-type]
    return Train(Consist(tuple(vehicles)), settings=Settings(**settings))  # type: ignore[arg-type]
