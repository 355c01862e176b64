"""Curves against the test frames of ERA and the table of the conversion model, where they are."""

from __future__ import annotations

import csv
import os
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

from brake_controller import brake_weight
from brake_controller.brake_weight import BrakingKind, deceleration_steps
from products.supervision import FixedValues, Gradients, NationalValues, Steps, SupervisedTrain, gradients, supervise
from products.supervision.conversion import (
    BRAKE_POSITIONS,
    KMH,
    SERVICE_MOST,
    basic_decelerations,
    build_up_time,
    deceleration_of,
    limit_speed,
)

OF_OTHERS = Path(os.environ.get("CURVES_OF_OTHERS", "nowhere"))
there = pytest.mark.skipif(not OF_OTHERS.is_dir(), reason="CURVES_OF_OTHERS names no folder of their values")
#: Places in the frames have two decimals; on gradients they differ by the workbook's steps [m].
LEVEL, ON_GRADIENTS, OF_STEPS, TOLERATED = 0.01, 0.1, 0.015, 0.25
POSITIONS = {"FreightTrainInG": "freight G", "FreightTrainInP": "freight P", "PassengerTrainInP": "passenger P"}
LIMITS = ("EBD", "EBI", "SBI2", "W", "P", "I")
#: Steps of the curves in the workbook of ERA, to which it so rounds up the first limit speed [m/s].
ROUNDED_UP = 0.1 * KMH


def rows_of(name: str) -> list[dict[str, str]]:
    with (OF_OTHERS / name).open(encoding="utf-8") as text:
        return list(csv.DictReader(text))


def frames() -> dict[str, dict[str, str]]:
    return {row["case"]: row for row in rows_of("etcs_cases_inputs.csv")} if OF_OTHERS.is_dir() else {}


def train_and_country(given: dict[str, str]) -> tuple[SupervisedTrain, NationalValues]:
    number = {name: float(text) for name, text in given.items() if text.replace(".", "").isdigit()}
    others = {
        "T_traction_cut_off": number["T_traction_cut_off_s"],
        "traction_command": given["traction_cut_off_interface"] == "True",
        "service_command": given["service_brake_command"] == "True",
    }
    length = number["train_length_m"]
    if given["model"] == "gamma":
        brake = Steps.constant(number["gamma_m_s2"])
        times = number["T_brake_emergency_s"], number["T_brake_service_s"]
        return SupervisedTrain(length, brake, brake, *times, **others), NationalValues()
    position = POSITIONS[given["brake_position"]]
    rounded = number.get("resolution", ROUNDED_UP)
    train = SupervisedTrain.of_percentage(number["lambda_pct"], position, length, resolution=rounded, **others)
    factors = [Steps.constant(number[name]) for name in ("Kv_int", "Kr_int")]
    return train, NationalValues(Kv_int=factors[0], Kr_int=factors[1], Kt_int=number["Kt_int"])


def line_of(given: dict[str, str]) -> Gradients:
    pairs = [pair.split(":") for pair in given["gradient_start_m:permille"].split(";")]
    return Gradients(*np.array(pairs, dtype=float).T)


def worst(case: str, given: dict[str, str], **others: object) -> float:
    """Return the largest difference of a place of a frame [m]."""
    train, country = train_and_country(given)
    set_up = {"kind": "MRSP", "gradients": line_of(given), "national": country, "V_ura": 0.0} | others
    places: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for row in rows_of("etcs_cases.csv"):
        if row["case"] == case and row["curve"] in LIMITS and "clamped" not in row["note"]:
            places[row["curve"]].append((float(row["speed_kmh"]) * KMH, float(row["value"])))
    assert set(places) == set(LIMITS)
    differences = []
    for limit, pairs in places.items():
        speeds, before = np.array(pairs).T
        found = supervise(train, 7000.0, speeds, **set_up)  # type: ignore[arg-type]
        differences.append(np.abs(7000.0 - getattr(found, limit) - before).max())
    return float(max(differences))


@there
@pytest.mark.parametrize("case", frames())
def test_curves_are_those_of_the_frames(case: str) -> None:
    given = frames()[case]
    level = given["gradient_start_m:permille"] == "0.0:0.0"
    assert worst(case, given) < (LEVEL if level else ON_GRADIENTS)


@there
@pytest.mark.parametrize("case", ["Gamma PasInP", "Lambda PasInP SBInterface", "Lambda FrInG 100%"])
def test_differences_on_gradients_are_the_steps_of_the_workbook(case: str) -> None:
    """Its curves have steps of 0.1 km/h, each with the deceleration at its lowest speed and last place."""
    given = frames()[case]
    train, country = train_and_country(given | {"resolution": "0"})
    edges, permille = line_of(given).lowest_under(train.length)
    safe, slopes = train.safe_brake(country), gradients.acceleration_by(permille, None)
    speeds = np.arange(75, 1901) * ROUNDED_UP
    brakes = safe.at(speeds + 1e-9)
    before = [0.0]
    for n, half_square in enumerate((np.diff(speeds**2) / 2.0).tolist()):
        part = int((edges < 7000.0 - before[-1]).sum())
        before.append(before[-1] + half_square / float(brakes[n] + slopes[part]))
    rows = [row for row in rows_of("etcs_cases.csv") if row["case"] == case and row["curve"] == "EBD"]
    for row in rows[2:]:  # from 10 km/h on
        n = round(10.0 * float(row["speed_kmh"])) - 75
        assert before[n] == pytest.approx(float(row["value"]), abs=OF_STEPS)


@there
def test_each_of_these_faults_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    """10 % rotating mass, no foot of 7.5 km/h, the indication of the other baseline, no longer build-up."""
    case = "Lambda PasInP SBInterface"
    given = frames()[case]
    assert worst(case, given, fixed=FixedValues(T_indication_more=4.0)) > TOLERATED
    assert worst(case, given, kind="EOA") > TOLERATED
    for name in ("ROTATING_UPHILL", "ROTATING_DOWNHILL"):
        monkeypatch.setattr(gradients, name, 10.0)
    assert worst(case, given) > TOLERATED


@there
def test_decelerations_are_those_of_the_conversion_table() -> None:
    rows = rows_of("etcs_cases_conversion_table.csv")
    shares = np.array([float(row["lambda_pct"]) for row in rows])
    table = np.array([[float(row[f"AD_{n}"]) for n in range(6)] for row in rows])
    assert np.abs(basic_decelerations(shares) - table).max() < 1e-8
    speeds = np.array([float(row["V_lim_kmh_rounded"]) for row in rows])
    assert np.abs(limit_speed(shares) / KMH - speeds).max() <= 0.5 + 1e-9


@pytest.mark.parametrize("position", BRAKE_POSITIONS)
@pytest.mark.parametrize("emergency", [True, False])
def test_both_conversion_models_of_the_project_agree(position: str, emergency: bool) -> None:
    """Decelerations and times of supervision are those of braking distances, at each speed, percentage and length."""
    case = BrakingKind[f"{'EMERGENCY' if emergency else 'SERVICE'}_{position.upper().replace(' ', '_')}"]
    for share in (30.0, 62.0, 95.0, 135.0, 157.0, 250.0):
        steps = deceleration_of(share if emergency else min(share, SERVICE_MOST))
        for one in deceleration_steps(case, share):
            assert steps.at([one.least + 1e-6, min(one.most, 60.0)]) == pytest.approx(one.deceleration, rel=1e-12)
    for length in (50.0, 399.0, 500.0, BRAKE_POSITIONS[position]):
        assert build_up_time(position, length, emergency) == pytest.approx(brake_weight.build_up_time(case, length))


@pytest.mark.parametrize("position", ["freight P", "freight G"])
@pytest.mark.parametrize("emergency", [True, False])
def test_build_up_times_of_long_freight_trains_join_those_of_short_ones(position: str, emergency: bool) -> None:
    """The formulas of SUBSET-026 meet at 900 m within half a second."""
    assert build_up_time(position, 900.1, emergency) == pytest.approx(
        build_up_time(position, 900.0, emergency), abs=0.5
    )
