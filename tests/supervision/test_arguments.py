"""Arguments of every public function of curves and factors that are of no use: one message each, never a result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, fields
from typing import Any

import numpy as np
import pytest

from bogie_braking import etcs
from readers.text import BadInputError

ONE = etcs.Steps.constant(1.0)
TRAIN = etcs.SupervisedTrain(200.0, ONE, ONE, 3.0, 2.0)
BY_PERCENTAGE = etcs.SupervisedTrain.of_percentage(100.0, "passenger P", 200.0)
COUNTRY, TOLERANCES = etcs.NationalValues(), etcs.Tolerances(friction=0.05)
VEHICLES, UNITS = [etcs.BrakedVehicles(9, 55.0)], [etcs.BrakeUnits(9, 55.0, 0.001)]
LEVEL = (np.zeros(0), np.zeros(1))
ARCS = etcs.braking_arcs(0.0, 0.0, ONE, LEVEL)
#: Values that no argument below takes.
NEVER: list[Any] = ["text", [[1.0, 2.0], [1.0]], np.nan, 1 + 2j, [True], {}, object(), [0.5, None], np.ma.masked, b"1"]


def _given(one: Any) -> dict[str, Any]:
    return {field.name: getattr(one, field.name) for field in fields(one)}


#: Functions with arguments that they take; all are made wrong in turn, but names.
CALLS: dict[Callable[..., Any], dict[str, Any]] = {
    etcs.Steps: {"boundaries": [20.0], "values": [1.0, 0.9]},
    etcs.Steps.constant: {"value": 1.0},
    ONE.at: {"speed": 1.0},
    etcs.Gradients: {"starts": [0.0], "permille": [-10.0], "unit": None},
    etcs.Gradients.level().lowest_under: {"length": 200.0},
    etcs.SupervisedTrain: _given(TRAIN),
    etcs.SupervisedTrain.of_percentage: {
        "percentage": 100.0,
        "position": "passenger P",
        "length": 200.0,
        "resolution": 0.0,
        "maximum_speed": 30.0,
    },
    etcs.brake_of_percentage: {"percentage": 100.0, "position": "freight G", "length": 200.0, "resolution": 0.0},
    TRAIN.check_level: {"level": 9},
    TRAIN.safe_brake: {"national": COUNTRY, "slippery": False},
    TRAIN.build_up_times: {"national": COUNTRY, "target_speed": 0.0},
    BY_PERCENTAGE.speed_factor: {"national": COUNTRY},
    etcs.supervise: {
        "train": TRAIN,
        "place": 2000.0,
        "V_est": [10.0, 20.0],
        "kind": "EOA",
        "target_speed": 0.0,
        "beyond": 0.0,
        "gradients": None,
        "national": None,
        "fixed": None,
        "A_est": 0.0,
        "V_ura": None,
        "slippery": False,
        "pipe_fall": 0.0,
    },
    etcs.release_speed: {"train": TRAIN, "beyond": 50.0, "trip": 0.0, "place": 0.0, "V_ura": None, "national": None},
    etcs.braking_arcs: {"place": 0.0, "speed": 0.0, "brake": ONE, "gradients": LEVEL, "eased": None},
    ARCS.place_at: {"speed": 1.0},
    ARCS.speed_at: {"place": -1.0},
    etcs.NationalValues: _given(COUNTRY),
    etcs.FixedValues: asdict(etcs.FixedValues()),
    etcs.FixedValues().dV_ebi: {"speed": 1.0},
    etcs.BrakeUnits: asdict(UNITS[0]),
    etcs.dry_factors: {"units": UNITS, "common": 0.0},
    etcs.Tolerances: asdict(TOLERANCES),
    TOLERANCES.without: {"name": "friction"},
    etcs.BrakedVehicles: asdict(VEHICLES[0]),
    etcs.factors_of: {"vehicles": VEHICLES, "tolerances": TOLERANCES},
    etcs.causes_of: {"vehicles": VEHICLES, "tolerances": TOLERANCES, "level": 9},
    etcs.one_failure: {"vehicles": VEHICLES, "tolerances": TOLERANCES, "level": 9},
    etcs.build_up_of: {"vehicles": VEHICLES, "tolerances": TOLERANCES, "build_up": 2.4},
    etcs.rounded_train: {"train": TRAIN, "dry_by_level": ()},
    etcs.rounded_national: {"national": COUNTRY},
    etcs.without_effect: {"train": TRAIN, "national": COUNTRY, "slippery": False},
    etcs.fmu_parameters: {"train": TRAIN, "national": None, "fixed": None, "version": 2},
    etcs.train_document: {"train": TRAIN, "dry_by_level": ()},
    etcs.EtcsTrain: {"train": TRAIN, "dry_by_level": ()},
}
#: Arguments that may be None.
MAY_BE_NONE = ("rotating", "maximum_speed")


@pytest.mark.parametrize("function", CALLS, ids=lambda one: one.__qualname__)
def test_an_argument_of_another_kind_is_refused_with_one_message(function: Callable[..., Any]) -> None:
    given = CALLS[function]
    function(**given)
    for name, right in given.items():
        for wrong in [*NEVER, *([] if right is None or name in MAY_BE_NONE else [None])]:
            with pytest.raises(BadInputError) as caught:
                function(**{**given, name: wrong})
            assert "\n" not in str(caught.value), (name, wrong)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda: etcs.braking_arcs(0.0, 0.0, ONE, None), "gradients must be two arrays; got null. Give"),
        (lambda: etcs.braking_arcs(0.0, 0.0, ONE, ([5.0], [0.0])), "one acceleration more than places; got 1 places"),
        (lambda: etcs.braking_arcs(0.0, 0.0, ONE, ([5.0, 0.0], [0.0] * 3)), "Places of gradients must ascend"),
        (lambda: etcs.braking_arcs(0.0, -1.0, ONE, LEVEL), "speed must be finite and at least 0; got -1"),
        (lambda: ARCS.place_at(-1.0), "speed must be at least 0 m/s; got -1"),
        (
            lambda: etcs.supervise(TRAIN, 0.0, 200.0),
            "V_est must be at most 166.7 m/s; got 200.* 100 / 3.6 for",
        ),
        (lambda: etcs.supervise(TRAIN, 0.0, 20.0, A_est=30.0), "A_est must be at most 10 m/s2; got 30"),
        (lambda: etcs.supervise(TRAIN, [0.0, 1.0], [[9.0]] * 3), r"V_est must have the shape .* \(2,\); got \(3,\)"),
        (lambda: etcs.supervise(TRAIN, 0.0, [9.0, 8.0], V_ura=[1.0] * 3), "V_ura must have the shape"),
        (lambda: etcs.supervise(TRAIN, [], 20.0), "place must be a number or numbers; got none"),
        (lambda: etcs.supervise(TRAIN, np.ma.array([5.0, 6.0], mask=[0, 1]), 20.0), "place must not have masked"),
        (lambda: etcs.release_speed(TRAIN, 50.0, V_ura=-1.0), "V_ura must be at least 0 m/s; got -1"),
        (lambda: etcs.SupervisedTrain([200.0] * 2, ONE, ONE, [3.0] * 3, 2.0), "T_brake_emergency must have the shape"),
        (lambda: etcs.SupervisedTrain(200.0, ONE, ONE, None, 2.0), "T_brake_emergency must be a number"),  # type: ignore[arg-type]
        (lambda: etcs.SupervisedTrain(200.0, ONE, ONE, 3.0, 2.0, position="P"), "position must be one of passenger P"),
        (lambda: etcs.SupervisedTrain(200.0, ONE, ONE, 3.0, 2.0, percentage=300.0), "percentage must be 30 to 250 %"),
        (lambda: etcs.rounded_down([-0.1]), "factors must be finite and at least 0"),
        (lambda: etcs.factors_of(VEHICLES[0], TOLERANCES), "vehicles must be a list of BrakedVehicles"),  # type: ignore[arg-type]
        (lambda: etcs.BrakeUnits(2.5, 1.0), "count of brake units must be an integer from 1"),  # type: ignore[arg-type]
        (lambda: etcs.read_train(None), "path of a file must be text or a Path; got NoneType"),  # type: ignore[arg-type]
        (lambda: etcs.train_document(TRAIN, (ONE,)), r"dry_by_level must be 10 step functions, or \(\); got 1"),
    ],
)
def test_what_would_give_another_result_than_meant_is_refused(wrong: Callable[[], Any], says: str) -> None:
    with pytest.raises(BadInputError, match=says):
        wrong()
