"""Test friction by contact angle: head and gauge face of the rail, at each contact model."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from rbd_model.contact.depth import Contact
from rbd_model.contact.distance import Stand, touching
from rbd_model.contact.friction import friction_over_angle
from rbd_model.contact.normal import patches
from rbd_model.contact.strips import WheelVelocity
from scenarios.bench.climbing_wheelset import climbing_wheelset, push
from scenarios.bench.wheel_on_strips import press_wheel
from scenarios.contact import contact_manchester as manchester
from scenarios.contact.flange_climb import ATTACK, BAND, CURVE_ANGLE, ONSET

PAIR, STEEL = manchester.manchester_pair(), manchester.STEEL
#: Friction of the head in a lubricated curve, and ratio of the gauge face's friction to it.
HEAD, LUBRICATED = 0.35, 0.15 / 0.35
#: Tolerance of two numbers that differ only in the order of a sum.
ROUND_OFF = 1e-9


def nadal(angle: float, friction: float) -> float:
    """Return Y/Q at which a flange [deg] slides down: normal force and friction resolved, Nadal (1896)."""
    sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
    return (sine - friction * cosine) / (cosine + friction * sine)


def test_friction_goes_over_from_head_to_gauge_face_between_20_and_40_degrees() -> None:
    """On the field side the friction remains that of the head."""
    factor = {
        angle: float(friction_over_angle(ca.SX(math.sin(math.radians(angle))), ca.SX(0.4)))
        for angle in (-70, -5, 0, 19.9, 20, 30, 40, 40.1, 70)
    }
    assert [factor[angle] for angle in (-70, -5, 0, 19.9, 20)] == [1.0] * 5
    assert [factor[angle] for angle in (40, 40.1, 70)] == pytest.approx([0.4] * 3, rel=ROUND_OFF)
    assert 0.4 < factor[30] < 1.0


@pytest.mark.parametrize("depth", [2, pytest.param(3, marks=pytest.mark.long)])
def test_wheel_climbs_at_nadals_limit_for_the_friction_of_the_gauge_face(depth: int) -> None:
    wheelset = climbing_wheelset(math.radians(CURVE_ANGLE), Contact(depth))
    found = push(wheelset, HEAD, ATTACK, LUBRICATED).limit(*ONSET)
    assert found == pytest.approx(nadal(CURVE_ANGLE, HEAD * LUBRICATED), rel=BAND)
    assert found > 1.4 * nadal(CURVE_ANGLE, HEAD)


def creep(stand: Stand, motion: WheelVelocity, friction: float, gauge_face: float) -> np.ndarray:
    """Return the friction part of the force on a wheel by strips [N]."""
    smooth = press_wheel(PAIR, STEEL, 0.0, stand, motion).force
    return press_wheel(PAIR, STEEL, friction, stand, motion, gauge_face).force - smooth


@pytest.mark.study
@pytest.mark.parametrize(("shift", "on_face"), [(3.0, False), (8.0, True)])
def test_strips_on_the_gauge_face_creep_with_its_friction_and_others_with_that_of_the_head(
    shift: float, on_face: bool
) -> None:
    """A patch entirely on one of them creeps as on a rail with this friction everywhere."""
    stand, motion = manchester.case("right", shift)
    stand = replace(stand, height=touching(PAIR, stand)[0] - 40e-6)
    angles = np.degrees(np.concatenate([one.strips.angle for one in patches(PAIR, stand, STEEL)]))
    assert np.all(angles > 40.0) if on_face else np.all(angles < 20.0)
    both = creep(stand, motion, HEAD, LUBRICATED)
    of_face, of_head = creep(stand, motion, HEAD * LUBRICATED, 1.0), creep(stand, motion, HEAD, 1.0)
    mine, other = (of_face, of_head) if on_face else (of_head, of_face)
    assert both == pytest.approx(mine, rel=ROUND_OFF, abs=1e-6)
    assert np.linalg.norm(other - mine) > 0.3 * np.linalg.norm(mine)
