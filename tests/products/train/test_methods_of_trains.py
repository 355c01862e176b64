"""Reference methods of train dynamics: the rate form of a coupler, orders of implicit steps, the default's error."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from evidence.peers.train_couplers import braked_train, rates
from products.train.numbers import SHARE
from rbd_model.train.coupler import Coupler, coupling, draft_gear, screw_coupler
from tests.products.train.chains import spring

#: Tolerances: forces of the rate form, relative to the largest; force and distance of the default, as in the scenario.
RATE, FORCE, DISTANCE = 1e-9, 0.01, 1e-4
#: Number of pieces of a displacement, and halvings of a piece to locate a corner.
PIECES, HALVINGS = 200, 50


def yields(coupler: Coupler, way: float, rest: float, sense: float) -> float:
    return float(rates(coupler, np.array([way]), np.array([rest]), np.array([sense]))[1][0])


def same(coupler: Coupler, way: float, rest: float, piece: float) -> float:
    """Return the part of a displacement up to just beyond the next corner, or all of it without a corner."""
    sense, low, high = np.sign(piece), 0.0, abs(piece)
    share = yields(coupler, way, rest, sense)

    def is_same(far: float) -> bool:
        return yields(coupler, way + sense * far, rest + share * sense * far, sense) == share

    for _ in range(0 if is_same(high) else HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if is_same(middle) else (low, middle)
    return sense * high


def go(coupler: Coupler, way: float, rest: float, end: float) -> float:
    """Return the friction state after a monotonic displacement: z' = yields s', from corner to corner."""
    piece = (end - way) / PIECES
    while way != end:
        left = end - way
        gone = same(coupler, way, rest, piece if abs(piece) < abs(left) else left)
        rest += yields(coupler, way, rest, piece) * gone
        way = end if gone == left else way + gone
    return rest


@pytest.mark.study
@pytest.mark.parametrize("coupler", [draft_gear(), screw_coupler()], ids=lambda one: one.name)
def test_the_rate_of_a_coupler_gives_its_play_operator(coupler: Coupler) -> None:
    """The forces are compared at the turns of random displacements."""
    draw = np.random.default_rng(41)
    turns = [0.0, *draw.uniform(-0.05, 0.05, 12)]
    play, given = coupling(), coupler.constants()
    rest, kept, errors, forces = 0.0, 0.0, [], []
    for way, end in pairwise(turns):
        rest = go(coupler, way, rest, end)
        force, kept = (float(one) for one in np.array(play(end, 0.0, kept, given)).ravel())
        found = float(rates(coupler, np.array([end]), np.array([rest]), np.array([0.0]))[0][0])
        errors.append(abs(found - force))
        forces.append(abs(force))
    assert max(errors) < RATE * max(forces)


def test_implicit_steps_have_their_errors() -> None:
    """Euler's error of the largest force halves with the step. The midpoint rule's error is below 1 % of it."""
    train = braked_train(
        60e3, wagons=8, long=3.0, coupler=spring(2e6)
    )  # one coupler has the largest force at both steps
    true = train.implicit(5e-5, 0.5).compression
    euler, midpoint = (
        [abs(train.implicit(size, share).compression / true - 1.0) for size in (2e-3, 1e-3)] for share in (1.0, 0.5)
    )
    assert np.log2(euler[0] / euler[1]) == pytest.approx(1.0, abs=0.1)
    assert midpoint[0] < euler[0] / 100


def test_the_default_is_within_its_bands() -> None:
    """Reference: an independent method. Loaded wagons only: slack makes short empty trains chaotic."""
    train = braked_train(60e3, wagons=10, long=8.0)
    true, found = train.implicit(1e-4, 0.5), train.explicit(SHARE)
    assert true.compression > 50e3
    assert found.compression == pytest.approx(true.compression, rel=FORCE)
    assert found.distance == pytest.approx(true.distance, rel=DISTANCE)
