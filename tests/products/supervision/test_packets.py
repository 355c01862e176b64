"""Train data and national values in the resolution of their variables: on the safe side, in every limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from products.supervision import (
    BRAKE_POSITIONS,
    Curves,
    Gradients,
    NationalValues,
    Steps,
    SupervisedTrain,
    rounded_national,
    rounded_train,
    supervise,
)
from readers.text import BadInputError
from tests.products.supervision.random_trains import one_of, trains

LIMITS = ("EBD", "EBI", "SBD", "SBI1", "SBI2", "W", "P", "I", "GUI")
LINE = Gradients([0.0, 700.0, 1600.0], [4.0, -9.0, 6.0])
SPEEDS = np.linspace(0.5, 45.0, 30)
#: Speed of EBD above that of a moving target, at the target [m/s]. Below it the curve continues behind the target,
#: where a weaker brake lies further.
FOOT = 7.5 / 3.6
#: Rounding of doubles in places of kilometres [m].
DOUBLES = 1e-6


GIVEN = {"length": 200.0, "A_brake_emergency": Steps.constant(1.0), "A_brake_service": Steps.constant(0.8)}
GIVEN |= {"T_brake_emergency": 3.0, "T_brake_service": 3.0}


def nearer(one: Curves, other: Curves) -> float:
    """Return by how much a limit of `one` lies nearer to the target than that of `other` [m]."""
    both = [(getattr(one, name), getattr(other, name)) for name in LIMITS]
    return max(float(np.nanmax(a - b)) for a, b in both if a is not None and b is not None)


def factors(rng: np.random.Generator) -> Steps:
    return Steps(np.sort(rng.uniform(5.0, 60.0, 1)), rng.uniform(0.4, 1.3, 2))


def country(rng: np.random.Generator) -> NationalValues:
    """Return national values of which none fits its variable."""
    low = rng.uniform(0.5, 0.8, 3)
    return NationalValues(
        M_NVAVADH=rng.uniform(0.0, 1.0),
        Kv_int=Steps(np.sort(rng.uniform(3.0, 60.0, 2)), low),
        Kv_int_b=Steps(np.sort(rng.uniform(3.0, 60.0, 2)), low.max() + rng.uniform(0.0, 0.3, 3)),
        A_NVP12=rng.uniform(0.3, 0.8),
        A_NVP23=rng.uniform(0.8, 1.4),
        Kr_int=Steps(np.sort(rng.uniform(30.0, 900.0, 2)), np.sort(rng.uniform(0.5, 1.2, 3))[::-1]),
        Kt_int=rng.uniform(1.0, 1.5),
        reduced_adhesion=tuple(rng.uniform(0.3, 1.5, 3)),
        guidance=True,
    )


@pytest.mark.study
@pytest.mark.parametrize("kind", ["EOA", "MRSP"])
def test_no_limit_of_a_rounded_train_lies_nearer_to_the_target(kind: str) -> None:
    rng = np.random.default_rng(7)
    many, most, speeds = trains(rng, 90), 0.0, SPEEDS + (0.0 if kind == "EOA" else 8.0 + FOOT)
    for n in range(90):
        commands = {"traction_command": bool(n % 2), "service_command": bool(n % 3)}
        others = {"rotating": (None, 4.7, 11.0)[n % 3], "Kdry_rst": factors(rng), "Kwet_rst": factors(rng)}
        train = one_of(many, n, **commands, **others, A_brake_normal_service=Steps.constant(0.4))
        train = replace(train, A_brake_emergency=merged(train.A_brake_emergency))
        set_up = {"kind": kind, "target_speed": 0.0 if kind == "EOA" else 8.0, "gradients": LINE}
        set_up |= {"national": NationalValues(guidance=kind == "EOA"), "A_est": 0.9 * (n % 2), "slippery": n % 5 == 0}
        found = rounded_train(train).train
        before, after = (supervise(one, 2000.0, speeds, **set_up) for one in (train, found))  # type: ignore[arg-type]
        most = max(most, nearer(after, before))
    assert most <= DOUBLES


def merged(steps: Steps) -> Steps:
    """Return the first three steps, so that deceleration and factors together have at most 7 sections."""
    return Steps(steps.boundaries[:2], steps.values[:3])


@pytest.mark.study
@pytest.mark.parametrize("position", BRAKE_POSITIONS)
def test_no_limit_of_a_rounded_percentage_or_country_lies_nearer_to_the_target(position: str) -> None:
    rng, most = np.random.default_rng(11), 0.0
    for n in range(24):
        commands = {"traction_command": bool(n % 2), "service_command": bool(n % 3)}
        length, cut_off = rng.uniform(50.0, 899.0), rng.uniform(0.0, 15.0)
        train = SupervisedTrain.of_percentage(
            rng.uniform(31.0, 249.0), position, length, T_traction_cut_off=cut_off, **commands
        )
        land, set_up = country(rng), {"gradients": LINE, "A_est": 1.5 * (n % 2), "slippery": n % 4 == 0}
        kind = {"kind": "LOA", "target_speed": 12.0} if n % 2 else {}
        speeds = SPEEDS + (12.0 + FOOT if kind else 0.0)
        before = supervise(train, 2000.0, speeds, national=land, **set_up, **kind)  # type: ignore[arg-type]
        for one, other in ((rounded_train(train).train, land), (train, rounded_national(land).national)):
            after = supervise(one, 2000.0, speeds, national=other, **set_up, **kind)  # type: ignore[arg-type]
            most = max(most, nearer(after, before))
    assert most <= DOUBLES


def test_a_longer_build_up_of_the_service_brake_does_not_shorten_traction() -> None:
    """Traction is cut off T_bs2 before the emergency brake, so T_bs2 rounded up alone moves EBI to the target."""
    commands = {"traction_command": True, "service_command": True, "T_traction_cut_off": 20.0}
    lambda_train = SupervisedTrain.of_percentage(90.0, "freight P", 403.6, **commands)  # type: ignore[arg-type]
    for train in (SupervisedTrain(**(GIVEN | commands | {"T_brake_service": 3.01})), lambda_train):  # type: ignore[arg-type]
        for kind in ({}, {"kind": "LOA", "target_speed": 10.0}):
            before, after = (
                supervise(one, 2000.0, [40.0], **kind)  # type: ignore[arg-type]
                for one in (train, rounded_train(train).train)
            )
            assert after.EBI[0] <= before.EBI[0] + DOUBLES


def test_a_moved_boundary_is_no_change_of_a_value() -> None:
    """Values move by 0.004 and 0.002 m/s2; a step within one km/h takes the value of its neighbour."""
    steps = Steps(np.array([50.4, 60.0]) / 3.6, [1.104, 0.902, 0.9])
    narrow = Steps(np.array([50.2, 50.4]) / 3.6, [0.8, 1.1, 0.9])
    for one, most in ((steps, 0.004), (narrow, 0.3)):
        moves = rounded_train(SupervisedTrain(**(GIVEN | {"A_brake_service": one}))).moves  # type: ignore[arg-type]
        assert {move.name: move.most for move in moves}["A_brake_service"] == pytest.approx(most)


def test_bounds_between_the_sets_of_a_country_move_towards_the_lower_set() -> None:
    low, high = Steps.constant(0.7), Steps.constant(0.9)
    for one, other, bounds in ((low, high, (0.55, 1.0)), (high, low, (0.5, 0.95))):
        land = NationalValues(Kv_int=one, Kv_int_b=other, A_NVP12=0.52, A_NVP23=0.98)
        found = rounded_national(land)
        assert pytest.approx(bounds) == [found.national.A_NVP12, found.national.A_NVP23]
        assert {move.name: move.most for move in found.moves}["A_NVP12"] == pytest.approx(abs(bounds[0] - 0.52))
    with pytest.raises(BadInputError, match="M_NVKRINT must have its last boundary at 2700 or below; got 3000"):
        rounded_national(NationalValues(Kr_int=Steps([3000.0], [1.0, 0.9])))
    crossing = Steps(np.array([20.0]), np.array([0.6, 1.0]))
    with pytest.raises(BadInputError, match="A_NVP12 and A_NVP23 must be multiples"):
        rounded_national(NationalValues(Kv_int=low, Kv_int_b=crossing, A_NVP12=0.52, A_NVP23=0.98))


def test_rounding_twice_changes_nothing_and_each_number_is_a_multiple() -> None:
    train = replace(one_of(trains(np.random.default_rng(3), 1), 0), Kdry_rst=Steps.constant(0.83))
    once = rounded_train(train, [Steps.constant(0.99 - 0.04 * level) for level in range(10)])
    twice = rounded_train(once.train, once.dry_by_level)
    assert all(move.most == pytest.approx(0.0, abs=1e-9) for move in twice.moves)
    assert [steps.values[0] for steps in once.dry_by_level[:3]] == pytest.approx([0.95, 0.95, 0.90])
    for values, resolution in ((once.train.A_brake_emergency.values, 0.01), (once.train.Kdry_rst.values, 0.05)):
        assert values / resolution == pytest.approx(np.round(values / resolution))
    assert 3.6 * once.train.A_brake_service.boundaries == pytest.approx(
        np.round(3.6 * once.train.A_brake_service.boundaries)
    )
    moved = {move.name: move.most for move in once.moves}
    for name, resolution in (("Kdry_rst", 0.05), ("T_brake_service", 0.05), ("L_TRAIN", 1.0)):
        assert 0.0 < moved[name] < resolution
