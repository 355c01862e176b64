"""Brake weight percentage, stopping distance and brake force: reference distances, inversions, limits, messages."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from brake_controller import brake_weight
from brake_controller.brake_weight import (
    FROM_100,
    FROM_120,
    Assessment,
    BrakingKind,
    braked_weight,
    braking_distance,
    build_up_time,
    deceleration_steps,
    distance_of_vehicle,
    force_of_percentage,
    limit_speed,
    mean_deceleration,
    percentage_of_vehicle,
    stopping_distance,
    train_percentage,
)
from scenarios.benchmark.case import CasePoint
from scenarios.benchmark.case_file import CASES, read_case
from scenarios.benchmark.own.percentage import answer

#: The ten distances, given to 0.1 m.
EXAMPLE = read_case(CASES / "conversion-model.toml")
TOLD = 0.1
#: Relative tolerance of inverse functions: rounding errors and the bracket of the search.
INVERTED = 1e-10
KMH = 1 / 3.6
#: Calculated by hand from SUBSET-026 A.3.7 to A.3.9 for each of them: build-up time [s], and edge [km/h] and
#: deceleration [m/s2] of each step.
BY_HAND = [
    (5.02, [(120, 0.826)]),
    (6.55, [(120, 0.826)]),
    (10.63, [(100, 0.5635)]),
    (14.45, [(100, 0.5635)]),
    (11.6092, [(100, 0.751)]),
    (14.45, [(80, 0.526)]),
    (5.02, [(137.52535, 1.0885), (150, 0.8463405), (160, 0.7968465)]),
    (10.6, [(120, 0.826)]),
    (22.39, [(100, 0.5635)]),
    (23.12, [(90, 0.601)]),
]
LENGTHS = {case: np.linspace(0.0, case.value.most_length, 61).tolist() for case in BrakingKind}
PERCENTAGES = np.linspace(30.0, 250.0, 89).tolist()


def told(case: BrakingKind, speed: float, percentage: float, length: float) -> float:
    return stopping_distance(case, speed * KMH, percentage, length)


# ---- trains ----------------------------------------------------------------------------------------------------------


def missed(point: CasePoint) -> float:
    """Return the error of a distance [m]."""
    return answer(point.inputs)["distance"] - point.published["distance"]


@pytest.mark.parametrize(("point", "by_hand"), list(zip(EXAMPLE.points, BY_HAND, strict=True)))
def test_a_train_stops_in_the_distance_that_its_percentage_tells(point: CasePoint, by_hand: tuple) -> None:
    (time, steps), speed = by_hand, point.inputs["speed"]
    bands = zip([0.0, *(edge for edge, _ in steps)], steps, strict=False)
    own = speed * time + sum((up**2 - low**2) * KMH**2 / (2 * a) for low, (up, a) in bands)
    assert own == pytest.approx(point.published["distance"], abs=TOLD)
    assert answer(point.inputs)["distance"] == pytest.approx(own, rel=1e-6)
    assert missed(point) == pytest.approx(0.0, abs=TOLD)


def worst() -> float:
    return max(abs(missed(point)) for point in EXAMPLE.points)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("BASIC", (0.0765, 0.0075)),
        ("BASIC", (0.076, 0.00751)),
        ("LIMIT_FACTOR", 16.80),
        ("LIMIT_POWER", 0.427),
        ("SERVICE_PERCENTAGE", 64.0),
        ("BANDS", (*brake_weight.BANDS[:2], (150.0, (0.0489, 5.81e-3, -6.76e-6, 5.58e-8)), *brake_weight.BANDS[3:])),
        ("BANDS", (*brake_weight.BANDS[:3], (180.0, (0.0490, 5.52e-3, -3.85e-6, 3.00e-8)), *brake_weight.BANDS[4:])),
    ],
)
def test_another_constant_misses_a_distance(name: str, value: object, monkeypatch: pytest.MonkeyPatch) -> None:
    assert worst() < TOLD
    monkeypatch.setattr(brake_weight, name, value)
    assert worst() > TOLD


@pytest.mark.parametrize(
    ("percentage", "edges", "decelerations"),
    [
        # Limit speeds 89.9, 109.9, 120.9, 165.0 and 179.0 km/h; the polynomials are summed by hand.
        (50.0, (100, 120, 150, 180, math.inf), (0.451, 0.37605, 0.409775, 0.328475, 0.318125, 0.31345375)),
        (80.0, (120, 150, 180, math.inf), (0.676, 0.6519200, 0.4980056, 0.4803200, 0.472977760)),
        (100.0, (150, 180, math.inf), (0.826, 0.6171, 0.5915, 0.58173)),
        (206.5, (180, math.inf), (1.62475, 1.2878761, 1.2000183)),
        (250.0, (180, math.inf), (1.951, 1.656125, 1.47511875)),
    ],
)
def test_bands_below_the_limit_speed_fall_away(
    percentage: float, edges: tuple[float, ...], decelerations: tuple[float, ...]
) -> None:
    """Speed ranges beyond all reference distances are included."""
    steps = deceleration_steps(BrakingKind.EMERGENCY_FREIGHT_P, percentage)
    limit = 16.85 * percentage**0.428
    assert [step.most / KMH for step in steps] == pytest.approx([limit, *edges])
    assert [step.least / KMH for step in steps] == pytest.approx([0.0, limit, *edges[:-1]])
    assert [step.deceleration for step in steps] == pytest.approx(decelerations, rel=1e-6)


def test_from_100_to_120_kmh_the_model_brakes_harder_than_below_up_to_98_percent() -> None:
    """The published constants have this rise. At other edges the deceleration falls with speed."""
    for percentage in PERCENTAGES:
        steps = deceleration_steps(BrakingKind.EMERGENCY_FREIGHT_P, percentage)
        pairs = itertools.pairwise(steps)
        rises = [later.most / KMH for one, later in pairs if later.deceleration > one.deceleration]
        assert rises in ([], [pytest.approx(120.0)])
        assert percentage > 98.3 or percentage < 90.0 or rises


@pytest.mark.parametrize("case", BrakingKind)
def test_distance_falls_with_percentage_and_grows_with_speed_and_length(case: BrakingKind) -> None:
    held = [one for one in PERCENTAGES if not case.value.service or one <= 135.0]
    for speed in (10.0, 99.0, 101.0, 130.0, 160.0, 200.0):
        assert np.all(np.diff([told(case, speed, one, 700.0) for one in held]) < 0.0)
    for percentage in (30.0, 64.0, 98.0, 165.0, 250.0):
        assert np.all(np.diff([told(case, speed, percentage, 700.0) for speed in range(0, 201)]) > 0.0)
    assert np.all(np.diff([told(case, 100.0, 65.0, length) for length in LENGTHS[case]]) >= 0.0)
    assert told(case, 0.0, 65.0, 700.0) == 0.0


@pytest.mark.parametrize("case", BrakingKind)
def test_distance_goes_on_over_the_edges_of_bands(case: BrakingKind) -> None:
    """The deceleration is discontinuous there, the distance is not; nor is it where the limit speed reaches an edge."""
    near = 1e-9
    for percentage in (40.0, 65.0, 100.0, 135.0):
        for edge in (limit_speed(percentage) / KMH, 100.0, 120.0, 150.0, 180.0):
            below, above = (told(case, edge * (1 + sign * near), percentage, 700.0) for sign in (-1, 1))
            assert above == pytest.approx(below, rel=10 * near)
    for edge in (100.0, 120.0, 150.0):
        percentage = (edge / 16.85) ** (1 / 0.428)
        below, above = (told(case, 200.0, percentage * (1 + sign * near), 700.0) for sign in (-1, 1))
        assert above == pytest.approx(below, rel=10 * near)


@pytest.mark.parametrize(
    ("name", "jump"),
    [
        ("EMERGENCY_FREIGHT_P", 0.36),  # 16.07 and 16.43 s
        ("EMERGENCY_FREIGHT_G", 0.38),  # 16.05 and 16.43 s
        ("SERVICE_FREIGHT_P", 0.03),  # 27.93 and 27.96 s
        ("SERVICE_FREIGHT_G", 0.03),
    ],
)
def test_the_build_up_time_steps_up_a_little_behind_900_m(name: str, jump: float) -> None:
    case = BrakingKind[name]
    assert build_up_time(case, 900.0 + 1e-9) - build_up_time(case, 900.0) == pytest.approx(jump, abs=1e-6)


def test_short_trains_count_as_400_m_in_emergency_in_p_and_in_service_in_g() -> None:
    """A.3.8.1, A.3.8.2 and A.3.9.3; the other paragraphs have the length of the train."""
    for case in BrakingKind:
        shortest = build_up_time(case, 0.0)
        held = case.name.startswith("EMERGENCY") != case.name.endswith("G")
        assert (shortest == build_up_time(case, 400.0)) is held
    assert build_up_time(BrakingKind.SERVICE_PASSENGER_P, 0.0) == 3.0


def test_brakes_begin_to_act_before_they_count_as_on() -> None:
    for case in BrakingKind:
        assert all(0.0 < case.value.reaction_time < build_up_time(case, length) for length in LENGTHS[case])


def test_full_service_is_braked_with_135_percent_at_most() -> None:
    for percentage in (135.0, 180.0, 250.0):
        service = deceleration_steps(BrakingKind.SERVICE_PASSENGER_P, percentage)
        assert service == deceleration_steps(BrakingKind.EMERGENCY_PASSENGER_P, 135.0)


def test_the_percentage_of_a_train_is_that_of_its_weights() -> None:
    masses = [80e3, 90e3, 30e3]
    percentages = [105.0, 60.0, 70.0]
    weights = [braked_weight(one, mass) for one, mass in zip(percentages, masses, strict=True)]
    assert weights == pytest.approx([84e3, 54e3, 21e3])
    assert train_percentage(weights, masses) == pytest.approx(79.5)  # 159 t on 200 t
    assert train_percentage([84e3, 0.0, 21e3], masses) == pytest.approx(52.5)


def test_braking_distance_is_the_integral_of_speed_over_deceleration() -> None:
    """Compare with the sum over 10^5 slices of speed."""
    steps = deceleration_steps(BrakingKind.EMERGENCY_FREIGHT_P, 45.0)
    edges = np.linspace(0.0, 200.0 * KMH, 100_001)
    middle = (edges[1:] + edges[:-1]) / 2
    chosen = np.searchsorted([step.most for step in steps], middle)
    slices = middle * np.diff(edges) / np.array([step.deceleration for step in steps])[chosen]
    assert braking_distance(steps, 200.0 * KMH) == pytest.approx(float(np.sum(slices)), rel=1e-4)


# ---- single vehicles -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("assessment", "percentage", "distance"),
    [(FROM_100, 100.0, 480.364), (FROM_100, 65.0, 704.533), (FROM_120, 100.0, 702.807), (FROM_120, 150.0, 494.876)],
)
def test_a_vehicle_is_assessed_by_its_stopping_distance(
    assessment: Assessment, percentage: float, distance: float
) -> None:
    """52840 / S - 10 and 83634 / S - 19 (EN 16834, UIC 544-1), inverted by hand."""
    assert distance_of_vehicle(percentage, assessment) == pytest.approx(distance, abs=1e-3)
    assert percentage_of_vehicle(distance, assessment) == pytest.approx(percentage, rel=1e-5)
    other = replace(assessment, offset=assessment.offset + 0.1)
    assert distance_of_vehicle(percentage, other) != pytest.approx(distance, abs=1e-3)


def test_the_deceleration_of_a_vehicle_leaves_out_2_s() -> None:
    """From 100 km/h in 480.364 m: 27.778^2 / 2 / (480.364 - 55.556) (EN 14531-1)."""
    assert mean_deceleration(100 * KMH, 480.364) == pytest.approx(0.90818, abs=1e-5)
    assert mean_deceleration(100 * KMH, 480.364, 0.0) == pytest.approx(0.80315, abs=1e-5)


@pytest.mark.parametrize("assessment", [FROM_100, FROM_120])
def test_distance_force_and_percentage_come_back(assessment: Assessment) -> None:
    for percentage in (5.0, 65.0, 150.0, 400.0):
        distance = distance_of_vehicle(percentage, assessment)
        assert percentage_of_vehicle(distance, assessment) == pytest.approx(percentage, rel=INVERTED)
        deceleration = mean_deceleration(assessment.speed, distance)
        force = force_of_percentage(percentage, 93.6e3, assessment)
        assert force == pytest.approx(93.6e3 * deceleration, rel=INVERTED)


# ---- what is refused -------------------------------------------------------------------------------------------------


REFUSED: list[tuple[Callable[[], object], str]] = [
    (
        lambda: told(BrakingKind.EMERGENCY_FREIGHT_P, 100, 0.0, 700),
        "brake weight percentage is 0 %, but must be from 30 to 250",
    ),
    (lambda: told(BrakingKind.EMERGENCY_FREIGHT_P, 100, -5.0, 700), "percentage is -5 %, but must be from 30 to 250 %"),
    (lambda: told(BrakingKind.EMERGENCY_FREIGHT_P, 100, 251.0, 700), "percentage is 251 %"),
    (lambda: told(BrakingKind.EMERGENCY_FREIGHT_P, 100, math.nan, 700), "percentage is nan %"),
    (
        lambda: told(BrakingKind.EMERGENCY_FREIGHT_P, -1, 65, 700),
        "speed is -0.277778 m/s, but must be from 0 to 55.5556 m/s",
    ),
    (lambda: told(BrakingKind.EMERGENCY_FREIGHT_P, 201, 65, 700), "speed is 55.8333 m/s"),
    (lambda: told(BrakingKind.EMERGENCY_FREIGHT_P, math.nan, 65, 700), "speed is nan m/s"),
    (
        lambda: build_up_time(BrakingKind.EMERGENCY_PASSENGER_P, 901),
        "length of the train is 901 m, but must be from 0 to 900 m",
    ),
    (
        lambda: build_up_time(BrakingKind.SERVICE_FREIGHT_G, 1501),
        "length of the train is 1501 m, but must be from 0 to 1500 m",
    ),
    (lambda: build_up_time(BrakingKind.SERVICE_FREIGHT_G, -1), "length of the train is -1 m"),
    (lambda: build_up_time(BrakingKind.SERVICE_FREIGHT_G, math.nan), "length of the train is nan m"),
    (lambda: limit_speed(math.inf), "percentage is inf %"),
    (lambda: percentage_of_vehicle(5284.0, FROM_100), "distance is 5284 m, but must be below 5284 m"),
    (lambda: percentage_of_vehicle(0.0, FROM_100), "stopping distance is 0 m"),
    (lambda: percentage_of_vehicle(math.nan, FROM_100), "stopping distance is nan m"),
    (lambda: distance_of_vehicle(-10.0, FROM_100), "percentage is -10 %, but must be finite and above 0 %"),
    (lambda: mean_deceleration(30.0, 60.0), "distance is 60 m, but must be finite and above 60 m"),
    (lambda: mean_deceleration(30.0, 600.0, -1.0), "build-up time is -1 s, but must be finite and at least 0 s"),
    (lambda: mean_deceleration(30.0, math.nan), "stopping distance is nan m"),
    (lambda: force_of_percentage(65.0, math.nan, FROM_100), "mass is nan kg"),
    (lambda: force_of_percentage(1000.0, 80e3, FROM_100), "which the vehicle runs before its brake is on"),
    (lambda: braked_weight(65.0, 0.0), "mass is 0 kg"),
    (lambda: train_percentage([50e3], [80e3, 80e3]), "There are 1 braked weights and 2 masses"),
    (lambda: train_percentage([], []), "There are 0 braked weights and 0 masses"),
    (lambda: train_percentage([-1.0], [80e3]), "braked weight is -1 kg"),
    (lambda: train_percentage([50e3], [math.nan]), "mass is nan kg"),
]


@pytest.mark.parametrize(("asked", "sentence"), REFUSED)
def test_what_cannot_be_is_refused_with_one_sentence(asked: Callable[[], object], sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)) as refused:
        asked()
    text = str(refused.value)
    assert re.fullmatch(r"(The|There) [^\n]+: [^\n]+\.", text)
