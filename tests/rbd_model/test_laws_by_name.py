"""Test that a vehicle's creep law is chosen by name, at every level, and that a law of the user is one more line."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import casadi as ca
import pytest

import bogie_braking as bb
from bogie_braking.machines import model_from, vehicle
from fmu_src.kernel import Kernel, SimulationError
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.laws import DEFAULT_LAW, LAWS
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins
from rbd_model.contact.depth import Contact
from rbd_model.contact.hertz import POISSON_RATIO, ellipse_shape
from rbd_model.levels.models import STRIPS, places_of
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from rbd_model.wheelset.pressing_patch import pressing_patch
from tests.fmu_src.quick_library import quick_library

#: Torques of a wheelset [N.m]: one at which every law with Kalker's slope is linear, and a third of that which locks
#: it.
SMALL, LARGE = 10.0, 6e3
BOGIE = tables_5_1_and_5_2()
#: Tolerance between the fits of the ellipse and of Kalker's table, used by other laws, and exact values: 1.03e-3.
FITS = 2e-3


def slip_ratio(law: str, torque: float, level: int) -> float:
    bogie = replace(vehicle("bogie"), creep_law=law)
    kernel = Kernel(quick_library(model_from(bogie, places_of(level, 2, on_line=False))))
    kernel.set(brake_torque_1=torque, brake_torque_2=torque, initial_speed=20.0)
    kernel.advance(1.0)
    return kernel["slip_ratio_1"]


@pytest.mark.study
@pytest.mark.parametrize("level", [1, 2])
def test_a_wheelset_creeps_by_the_law_that_its_vehicle_names(level: int) -> None:
    small, large = (slip_ratio("kalker-linear", torque, level) for torque in (SMALL, LARGE))
    assert large / small == pytest.approx(LARGE / SMALL, rel=2e-2)  # linear except for the load transfer
    saturates = slip_ratio("shen-hedrick-elkins", LARGE, level)
    assert saturates > 1.05 * large
    assert slip_ratio(DEFAULT_LAW, SMALL, level) == pytest.approx(small, rel=FITS)


@pytest.mark.study
@pytest.mark.parametrize("law", [DEFAULT_LAW, "kalker-linear"])
def test_no_law_answers_where_the_ellipse_is_longer_than_its_tables(law: str) -> None:
    """A rail head of 50 m radius under a wheel of 0.46 m has an ellipse beyond 1:10."""
    bogie = replace(vehicle("bogie"), creep_law=law)
    kernel = Kernel(quick_library(model_from(bogie, places_of(1, 2, on_line=False))))
    kernel.set(brake_torque_1=LARGE, initial_speed=20.0, rail_head_radius=50.0)
    with pytest.raises(SimulationError, match="The output acceleration is not a finite number at the start"):
        kernel.advance(0.1)


@pytest.mark.study
def test_strips_are_left_out_where_a_law_would_not_act_on_them() -> None:
    bogie = replace(vehicle("bogie"), creep_law="fastrip")
    assert [one.name for one in model_from(bogie, (0, STRIPS)).systems] == ["point"]
    with pytest.raises(ValueError, match="Contact model 3 does not use a creep_law"):
        model_from(bogie, (STRIPS,))


def test_a_law_of_a_script_is_one_line_and_a_wrong_name_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match="creep_law must be one of default, polach"):
        replace(vehicle("bogie"), creep_law="mine")
    monkeypatch.setitem(LAWS, "mine", shen_hedrick_elkins)
    assert slip_ratio("mine", LARGE, 1) == slip_ratio("shen-hedrick-elkins", LARGE, 1)


@pytest.mark.study
def test_a_run_takes_a_law_by_its_name_or_a_function() -> None:
    """The default law keeps the FMU; others are those of the vehicle as data, in runs, fits, batches and sweeps."""
    braked = {"level": 1, "brake_torque_1": LARGE, "initial_speed": 20.0}

    def slip(what: object = "bogie", **values: object) -> float:
        return float(bb.run(what, 1.0, None, ["slip_ratio_1"], 1.0, **braked, **values)["slip_ratio_1"][-1])

    plain, law = slip(), {"creep_law": "shen-hedrick-elkins"}
    assert slip(creep_law=DEFAULT_LAW) == plain
    named = slip(**law)
    assert abs(named / plain - 1) > 1e-3
    assert named == slip(replace(vehicle("bogie"), **law)) == slip(vehicle("bogie"), **law)

    def halved(patch: ContactPatch) -> tuple:
        x, y = shen_hedrick_elkins(patch)
        return x / 2, y / 2

    assert slip(creep_law=halved) == pytest.approx(2 * named, rel=0.2)
    both = {"brake_torque_1": [LARGE, LARGE], "level": 1, "initial_speed": 20.0}
    assert bb.batch("bogie", 1.0, ["slip_ratio_1"], **both, **law)["slip_ratio_1"] == pytest.approx(named, rel=1e-6)
    rows = bb.sweep("bogie", 1.0, ["slip_ratio_1"], {"brake_torque_1": [LARGE]}, level=1, initial_speed=20.0, **law)
    assert rows["slip_ratio_1"][0] == pytest.approx(named, rel=1e-6)


@pytest.mark.study
def test_poissons_ratio_is_that_of_a_run_and_one_beyond_its_limits_is_refused() -> None:
    """Far below friction slip grows with 1 / (c11 a b), a b with (1 - nu)^(2/3), Kalker (1990) and (3.84)."""
    braked = {"level": 1, "brake_torque_1": SMALL, "brake_torque_2": SMALL, "initial_speed": 20.0}
    shape = ellipse_shape(*map(ca.SX, (BOGIE.wheel_radius, 0.0, BOGIE.rail_head_radius, BOGIE.shear_modulus)))

    def product(nu: float) -> float:
        run = bb.run("bogie", 1.0, None, ["slip_ratio_1"], 1.0, **braked, poisson_ratio=nu)
        stiffness = float(kalker_coefficients(shape.axis_ratio, nu).c11) * (1 - nu) ** (2 / 3)
        return float(run["slip_ratio_1"][-1]) * stiffness

    assert product(0.28) == pytest.approx(product(POISSON_RATIO), rel=1e-4)
    words = [pressing_patch(False, Contact(2, poisson_ratio=nu)).name for nu in (POISSON_RATIO, 0.28)]
    assert words[0] != words[1]
    with pytest.raises(ValueError, match=r"poisson_ratio must be 0 to 0\.5; got 0\.6"):
        bb.run("bogie", 1.0, level=1, poisson_ratio=0.6)


def test_a_creep_law_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    for wrong in ("fast", 3, None):
        with pytest.raises(
            ValueError, match=r"creep_law must be one of default, polach, .*, or a function of a ContactPatch; got"
        ):
            bb.run("bogie", 1.0, level=1, creep_law=wrong)
    vary = {"friction_1": [0.1, 0.2]}
    with pytest.raises(TypeError, match="got equations or a function"):
        bb.sweep("bogie", 1.0, ["speed"], vary, level=1, folder=tmp_path / "sweep", creep_law=shen_hedrick_elkins)


REFUSED = [
    (lambda patch: (patch.load * patch.creepages[0], patch.creepages[1]), "must oppose the creepage"),
    (lambda patch: -patch.load * patch.creepages[0], "must return two"),
    (lambda patch: (-patch.creepages[0],) * 3, "must return two forces, ahead and to the left; <lambda> returned 3"),
    (lambda patch: (0.0, 0.0) if patch.creepages[0] > 0 else (1.0, 1.0), "Write ca.if_else"),
    (lambda patch: (-patch.creepages[0] / ca.fabs(patch.creepages[0]), 0.0), "must be finite without creepage"),
    (lambda patch: (-patch.mu * patch.creepages[0], 0.0), "no attribute 'mu'"),
]


@pytest.mark.parametrize(("law", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_a_law_that_cannot_be_friction_is_refused(law: object, words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        bb.run("bogie", 1.0, level=1, creep_law=law)
