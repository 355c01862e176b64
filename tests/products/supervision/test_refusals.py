"""Curves, factors and packets refuse arguments of another kind, and numbers that no train has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from inspect import signature
from typing import Any

import numpy as np
import pytest

from bogie_braking import etcs
from readers.text import BadInputError

ONE, STEEP = etcs.Steps.constant(1.0), etcs.Steps([160.0], [1.0, 0.9])
TRAIN = etcs.SupervisedTrain(200.0, ONE, ONE, 3.0, 2.0)
BY_PERCENTAGE = etcs.SupervisedTrain.of_percentage(100.0, "passenger P", 200.0)
COUNTRY, TOLERANCES = etcs.NationalValues(), etcs.Tolerances(friction=0.05)
VEHICLES, UNITS = [etcs.BrakedVehicles(9, 55.0)], [etcs.BrakeUnits(9, 55.0, 0.001)]
OF_VEHICLES = (etcs.factors_of, etcs.causes_of, etcs.one_failure)
OF_PERCENTAGE = {"percentage": 100.0, "position": "freight G", "length": 200.0}
LEVEL = (np.zeros(0), np.zeros(1))
ARCS = etcs.braking_arcs(0.0, 0.0, ONE, LEVEL)
#: Values that no argument below takes.
NEVER: list[Any] = ["text", [[1.0, 2.0], [1.0]], np.nan, 1 + 2j, [True], {}, object(), [0.5, None], np.ma.masked, b"1"]
NEVER.append(etcs.EtcsTrain(TRAIN))  # of a file: take its train


def _given(one: Any) -> dict[str, Any]:
    return {field.name: getattr(one, field.name) for field in fields(one)}


#: Functions with arguments that they take beside their defaults; all are made wrong in turn, but names.
CALLS: dict[Callable[..., Any], dict[str, Any]] = {
    etcs.Steps: {"boundaries": [20.0], "values": [1.0, 0.9]},
    etcs.Steps.constant: {"value": 1.0},
    ONE.at: {"speed": 1.0},
    etcs.Gradients: {"starts": [0.0], "permille": [-10.0]},
    etcs.Gradients.level().lowest_under: {"length": 200.0},
    etcs.SupervisedTrain: _given(TRAIN),
    etcs.SupervisedTrain.of_percentage: OF_PERCENTAGE | {"maximum_speed": 30.0},
    etcs.brake_of_percentage: OF_PERCENTAGE,
    TRAIN.check_level: {"level": 9},
    TRAIN.safe_brake: {"national": COUNTRY},
    TRAIN.build_up_times: {"national": COUNTRY, "target_speed": 0.0},
    BY_PERCENTAGE.speed_factor: {"national": COUNTRY},
    etcs.supervise: {"train": TRAIN, "place": 2000.0, "V_est": [10.0, 20.0]},
    etcs.release_speed: {"train": TRAIN, "beyond": 50.0, "V_ura": None, "national": None},
    etcs.braking_arcs: {"place": 0.0, "speed": 0.0, "brake": ONE, "gradients": LEVEL},
    ARCS.place_at: {"speed": 1.0},
    ARCS.speed_at: {"place": -1.0},
    etcs.NationalValues: _given(COUNTRY),
    etcs.FixedValues: {},
    etcs.FixedValues().dV_ebi: {"speed": 1.0},
    etcs.BrakeUnits: {"count": 9, "force": 55.0},
    etcs.dry_factors: {"units": UNITS},
    etcs.Tolerances: _given(TOLERANCES),
    TOLERANCES.without: {"name": "friction"},
    etcs.BrakedVehicles: {"count": 9, "force": 55.0},
    **{function: {"vehicles": VEHICLES, "tolerances": TOLERANCES} for function in OF_VEHICLES},
    etcs.build_up_of: {"vehicles": VEHICLES, "tolerances": TOLERANCES, "build_up": 2.4},
    etcs.rounded_train: {"train": TRAIN},
    etcs.rounded_national: {"national": COUNTRY},
    etcs.without_effect: {"train": TRAIN, "national": COUNTRY},
    etcs.fmu_parameters: {"train": TRAIN},
    etcs.train_document: {"train": TRAIN},
    etcs.EtcsTrain: {"train": TRAIN},
    etcs.osrd_document: {"train": replace(TRAIN, service_command=True)},
}
#: Arguments that may be None.
MAY_BE_NONE = ("rotating", "maximum_speed")


@pytest.mark.parametrize("function", CALLS, ids=lambda one: one.__qualname__)
def test_an_argument_of_another_kind_is_refused_with_one_message(function: Callable[..., Any]) -> None:
    known = signature(function).parameters.values()
    given = {one.name: one.default for one in known if one.default is not one.empty and one.name != "name"}
    given |= CALLS[function]
    function(**given)
    for name, right in given.items():
        for wrong in [*NEVER, *([] if right is None or name in MAY_BE_NONE else [None])]:
            with pytest.raises(BadInputError) as caught:
                function(**{**given, name: wrong})
            assert "\n" not in str(caught.value), (name, wrong)


supervise, by_percentage, Steps, Gradients = (
    etcs.supervise,
    etcs.SupervisedTrain.of_percentage,
    etcs.Steps,
    etcs.Gradients,
)
SLOPE = [0.0, 800.0]


def packed(**others: Any) -> etcs.RoundedTrain:
    return etcs.rounded_train(replace(TRAIN, **others))


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        # Numbers, names and types.
        (lambda: supervise(TRAIN, [], 20.0), "place must be a number or numbers; got none"),
        (lambda: supervise(TRAIN, "2km", 1.0), "place must be a number or numbers, without text; got 2km"),  # type: ignore[arg-type]
        (lambda: replace(TRAIN, length="200 m"), "length must be a number or numbers, without text; got 200 m"),
        (lambda: supervise(TRAIN, np.ma.array([5.0, 6.0], mask=[0, 1]), 20.0), "place must not have masked"),
        (lambda: supervise(TRAIN, 0.0, 1.0, slippery="no"), "slippery must be True or False; got no"),  # type: ignore[arg-type]
        (lambda: replace(TRAIN, traction_command="no"), "traction_command must be True or False; got no"),
        (lambda: etcs.NationalValues(guidance=2), "guidance must be True or False; got 2"),  # type: ignore[arg-type]
        (lambda: replace(TRAIN, A_brake_service="0.8"), "A_brake_service must be of type Steps; got str"),
        (lambda: supervise(TRAIN, 0.0, 1.0, gradients=[(0.0, 5.0)]), "gradients must be of type Gradients; got list"),  # type: ignore[arg-type]
        (lambda: supervise(TRAIN, 0.0, 1.0, national={}), "national must be of type NationalValues; got dict"),  # type: ignore[arg-type]
        (lambda: supervise(TRAIN, 0.0, 1.0, fixed=4.0), "fixed must be of type FixedValues; got float"),  # type: ignore[arg-type]
        (lambda: supervise(NEVER[-1], 0.0, 1.0), "train must be of type SupervisedTrain; got EtcsTrain"),
        (lambda: etcs.factors_of(VEHICLES, {}), "tolerances must be of type Tolerances; got dict"),  # type: ignore[arg-type]
        (lambda: etcs.factors_of(VEHICLES[0], TOLERANCES), "vehicles must be a list of BrakedVehicles"),  # type: ignore[arg-type]
        (lambda: etcs.read_train(None), "path of a file must be text or a Path; got NoneType"),  # type: ignore[arg-type]
        (lambda: replace(TRAIN, position="P"), "position must be one of passenger P"),
        (lambda: by_percentage(90.0, "P", 300.0), "brake_position must be one of"),
        (lambda: supervise(TRAIN, 0.0, 1.0, kind="stop"), "kind must be one of"),
        # Shapes.
        (lambda: supervise(TRAIN, [0.0, 1.0], [[9.0]] * 3), r"V_est must have the shape .* \(2,\); got \(3,\)"),
        (lambda: supervise(TRAIN, 0.0, [9.0, 8.0], V_ura=[1.0] * 3), "V_ura must have the shape"),
        (lambda: etcs.SupervisedTrain([200.0] * 2, ONE, ONE, [3.0] * 3, 2.0), "T_brake_emergency must have the shape"),
        # Steps and gradients.
        (lambda: Steps([10.0, 5.0], [1.0, 1.0, 1.0]), "must ascend from 0 m/s"),
        (lambda: Steps([10.0], [1.0]), "one value more than boundaries"),
        (lambda: Steps([10.0], [1.0, np.nan]), "must be finite"),
        (lambda: Gradients([0.0], [300.0]), "Give permille"),
        (lambda: Gradients([5.0, 0.0], [0.0, 1.0]), "must ascend"),
        (lambda: Gradients(SLOPE, [0.0, -0.01]), "must be in permille; got .* all below 0.255"),
        (lambda: Gradients([0.0], [0.3], "1"), "Give permille"),
        (lambda: Gradients([0.0], [1.0], "percent"), 'unit must be "permille" or "1"; got percent'),
        (lambda: etcs.braking_arcs(0.0, 0.0, ONE, None), "gradients must be two arrays; got null. Give"),
        (lambda: etcs.braking_arcs(0.0, 0.0, ONE, ([5.0], [0.0])), "one acceleration more than places; got 1 places"),
        (lambda: etcs.braking_arcs(0.0, 0.0, ONE, ([5.0, 0.0], [0.0] * 3)), "Places of gradients must ascend"),
        (lambda: etcs.braking_arcs(0.0, -1.0, ONE, LEVEL), "speed must be finite and at least 0; got -1"),
        (lambda: ARCS.place_at(-1.0), "speed must be at least 0 m/s; got -1"),
        # Train data.
        (lambda: replace(TRAIN, length=0.0), "length must be 1 to 4095 m"),
        (lambda: replace(TRAIN, T_brake_emergency=None), "T_brake_emergency must be a number"),
        (lambda: replace(TRAIN, percentage=300.0), "percentage must be 30 to 250 %"),
        (lambda: replace(TRAIN, rotating=0.1), "rotating must be 0, or 0.3 to 30 %.* 10 for 10 %"),
        (lambda: replace(TRAIN, Kdry_rst=Steps.constant(85.0)), "Kdry_rst must be 0 to 1.55"),
        (lambda: replace(TRAIN, Kn_plus=Steps.constant(6.74)), "Kn_plus must be 0 to 0.01"),
        (lambda: replace(TRAIN, service_feedback=True), "service_feedback must be False without service_command"),
        (lambda: replace(TRAIN, A_brake_service=Steps.constant(-1.0)), "A_brake_service must be above 0"),
        (lambda: replace(TRAIN, A_brake_emergency=Steps(np.arange(1.0, 9.0), np.ones(9))), "at most 7 steps"),
        (lambda: replace(TRAIN, A_brake_emergency=STEEP), "got 160 m/s. Give m/s"),
        (lambda: replace(TRAIN, Kdry_rst=STEEP), "Kdry_rst must have boundaries .* up to 140"),
        (lambda: by_percentage(90.0, "passenger P", -5.0), "longer than 0 m and .* got -5"),
        (lambda: by_percentage(20.0, "freight P", 500.0), "must be 30 to 250 %"),
        (lambda: by_percentage(90.0, "passenger P", 1000.0), "at most 900 m long"),
        (lambda: by_percentage(90.0, "freight P", 300.0, maximum_speed=60.0), "at most 200 km/h"),
        # National and fixed values.
        (lambda: etcs.NationalValues(Kv_int=STEEP), "Kv_int must have boundaries .* up to 140"),
        (lambda: etcs.NationalValues(Kt_int=np.nan), "Kt_int must be 0 to 1.55"),
        (lambda: etcs.NationalValues(A_NVP12=1.0), "A_NVP12 must be at most A_NVP23"),
        (lambda: etcs.NationalValues(reduced_adhesion=0.7), "reduced_adhesion must be three numbers"),  # type: ignore[arg-type]
        (lambda: etcs.FixedValues(T_driver=-1.0), "T_driver must be 0 to 60"),
        # Targets.
        (lambda: supervise(TRAIN, 0.0, -1.0), "V_est must be finite and at least 0"),
        (lambda: supervise(TRAIN, 0.0, 200.0), "V_est must be at most 166.7 m/s; got 200.* 100 / 3.6 for"),
        (lambda: supervise(BY_PERCENTAGE, 0.0, 62.0), "at most 215 km/h"),
        (lambda: supervise(TRAIN, np.nan, 1.0), "place must be finite"),
        (lambda: supervise(TRAIN, 0.0, 1.0, A_est=np.nan), "A_est must be finite"),
        (lambda: supervise(TRAIN, 0.0, 20.0, A_est=30.0), "A_est must be at most 10 m/s2; got 30"),
        (lambda: supervise(TRAIN, 0.0, 1.0, V_ura=-1.0), "V_ura must be finite and at least 0"),
        (lambda: supervise(TRAIN, 0.0, 1.0, target_speed=5.0), "target_speed must be 0"),
        (lambda: supervise(TRAIN, 0.0, [20.0, 30.0], kind="LOA", target_speed=40.0), "at most the largest V_est, 30"),
        (lambda: supervise(TRAIN, 0.0, 1.0, kind="LOA", beyond=5.0), "beyond must be 0"),
        (lambda: etcs.release_speed(TRAIN, 50.0, V_ura=-1.0), "V_ura must be at least 0 m/s; got -1"),
        (lambda: etcs.release_speed(TRAIN, 10.0, A_est=1.0), "A_est must be left out"),
        (lambda: etcs.release_speed(TRAIN, np.nan), "beyond must be one finite number; got nan"),
        (lambda: etcs.release_speed(TRAIN, 10.0, trip=20.0), "trip must be 0 to 10 m"),
        # Factors.
        (lambda: etcs.rounded_down([-0.1]), "factors must be finite and at least 0"),
        (lambda: etcs.rounded_down("0.85"), "factors must be a number or numbers, without text"),
        (lambda: etcs.dry_factors([]), "must have brake units"),
        (lambda: etcs.BrakeUnits(0, 1.0), "count of brake units must be an integer from 1"),
        (lambda: etcs.BrakeUnits(2.5, 1.0), "count of brake units must be an integer from 1"),  # type: ignore[arg-type]
        (lambda: etcs.BrakeUnits(3, 1.0, 5.0), "failure of brake units"),
        (lambda: etcs.dry_factors([etcs.BrakeUnits(40, 1.0 + n, 0.1) for n in range(6)]), "Combinations of failures"),
        (lambda: etcs.BrakedVehicles(10**9, 1.0), "count of braked vehicles must be an integer from 1 to 2000"),
        (lambda: etcs.BrakedVehicles(2, -1.0), "force of braked vehicles must be 0 to"),
        (lambda: etcs.BrakedVehicles(2, 1.0, 0.0), "mass of braked vehicles"),
        (lambda: etcs.factors_of([etcs.BrakedVehicles(2, 0.0)], TOLERANCES), "must have a brake force"),
        (lambda: etcs.causes_of(VEHICLES, TOLERANCES, 10), "confidence level must be an integer from 0 to 9; got 10"),
        (lambda: etcs.Tolerances(friction=5.0), "friction must be from 0 to 0.2; got 5.0. Give 0.05 for 5 %."),
        (lambda: etcs.Tolerances(mass=-0.01), "mass must be from 0 to 0.2; got -0.01."),
        (lambda: etcs.Tolerances(isolated=np.nan), "isolated must be from 0 to 0.5; got nan."),
        (lambda: etcs.Tolerances(delay=200.0), "delay must be from 0 to 10 s; got 200.0."),
        (lambda: etcs.Tolerances(units=2.5, lost=0.1), "units must be an integer from 1 to 16; got 2.5."),  # type: ignore[arg-type]
        (lambda: etcs.Tolerances(lost=True), "lost must be from 0 to 0.5; got true."),
        (lambda: etcs.Tolerances(noticed=0.9), "got no isolated"),
        (lambda: etcs.Tolerances(units=4), "got no lost"),
        # Packets and documents.
        (lambda: packed(A_brake_emergency=Steps.constant(2.6)), "A_brake_emergency must be 0.01 to 2.55 m/s2"),
        (lambda: packed(Kwet_rst=Steps.constant(0.04)), "Kwet_rst must be 0.05 to 1.55"),
        (lambda: packed(rotating=1.5), "must be an integer from 0 to 15 %"),
        (lambda: packed(rotating=16.0), "must be an integer from 0 to 15 %"),
        (lambda: packed(A_brake_service=Steps([170.0], [0.8, 0.7])), r"up to 140 m/s \(504 km/h\); got 170"),
        (lambda: packed(Kdry_rst=Steps(np.arange(1.0, 9.0), np.linspace(0.9, 0.5, 9))), "share at most 7 sections"),
        (lambda: etcs.train_document(TRAIN, (ONE,)), r"dry_by_level must be 10 step functions, or \(\); got 1"),
    ],
)
def test_what_would_give_another_result_than_meant_is_refused(wrong: Callable[[], Any], says: str) -> None:
    with pytest.raises(BadInputError, match=says):
        wrong()
