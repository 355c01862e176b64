"""Distances of another program, OSRD: with its habits they are its own, by the standard shorter where EBD counts."""

from __future__ import annotations

import csv
import os
from pathlib import Path

import numpy as np
import pytest

from products.supervision import Curves, FixedValues, NationalValues, Steps, SupervisedTrain, supervise
from tests.products.supervision.osrd_habits import Osrd, decelerate

OF_OTHERS = Path(os.environ.get("CURVES_OF_OTHERS", "nowhere"))
pytestmark = pytest.mark.skipif(not OF_OTHERS.is_dir(), reason="CURVES_OF_OTHERS names no folder of their values")
KMH = 1.0 / 3.6
T_BS, T_BE = 2.0, 2.5
#: Differences to its printed places with its habits [m]: it cuts curves at their crossings, which this does not.
ITS_OWN = 0.1
GUIDANCE, LIMIT_142, LIMIT_112 = "GUI from 0 to 288", "LOA 141.9984 at 41500", "LOA 111.9996 at 45500"
LOCATION_112, LOCATION_142 = "SvL=EOA 47000", "EOA 42315.000+862"
END_40, END_159 = "EOA 47000.000: I of EOA", "SvL 100 m after EOA: EOA curve"
SLOW, MIDDLE, CROSSING, FAST, FASTEST = 40.0, 111.9996, 159.4114755, 141.9984, 288.0


def rows_of(name: str, key: str) -> dict[str, dict[str, str]]:
    with (OF_OTHERS / name).open(encoding="utf-8") as text:
        return {row[key]: row for row in csv.DictReader(text)}


@pytest.fixture(scope="module")
def given() -> dict[str, Steps]:
    rows = rows_of("etcs_cases_osrd_inputs.csv", "parameter")
    found = {}
    for name in ("gamma_emergency", "gamma_service", "gamma_normal_service", "k_dry", "k_wet"):
        columns = (rows[name][column].split(";") for column in ("boundaries_m_s", "values"))
        found[name] = Steps(*(np.array([float(one) for one in column if one]) for column in columns))
    return found


@pytest.fixture(scope="module")
def train(given: dict[str, Steps]) -> SupervisedTrain:
    return SupervisedTrain(
        400.0,
        given["gamma_emergency"],
        given["gamma_service"],
        T_BE,
        T_BS,
        Kdry_rst=given["k_dry"],
        Kwet_rst=given["k_wet"],
        T_traction_cut_off=1.0,
        traction_command=True,
        service_command=True,
        A_brake_normal_service=given["gamma_normal_service"],
    )


@pytest.fixture(scope="module")
def osrd(train: SupervisedTrain, given: dict[str, Steps]) -> Osrd:
    return Osrd(train.safe_brake(NationalValues()), given["gamma_service"], given["gamma_normal_service"], T_BE, T_BS)


def theirs(case: str) -> float:
    """Return the distance of the case whose name begins so [m]."""
    rows = rows_of("etcs_cases_osrd.csv", "case")
    return next(float(row["value"]) for name, row in rows.items() if name.startswith(case))


def limits(train: SupervisedTrain, speed: float, **others: object) -> Curves:
    """Return limits by the standard: baseline 4.0.0, with the acceleration that OSRD assumes."""
    set_up = {"national": NationalValues(guidance=True), "fixed": FixedValues(T_indication_more=4.0), "A_est": 0.4}
    return supervise(train, 0.0, speed * KMH, **(set_up | others))  # type: ignore[arg-type]


def test_its_distances_follow_from_its_habits(osrd: Osrd, given: dict[str, Steps]) -> None:
    guidance = decelerate(given["gamma_normal_service"], 0.0, 0.0).at(FASTEST * KMH)
    assert -guidance == pytest.approx(theirs(GUIDANCE), abs=0.01)
    for case, place in {
        LIMIT_142: osrd.of_target(FASTEST * KMH, FAST * KMH),
        LIMIT_112: osrd.of_target(FAST * KMH, MIDDLE * KMH),
        LOCATION_112: osrd.of_target(MIDDLE * KMH),
        LOCATION_142: osrd.of_target(FAST * KMH),
        END_40: osrd.of_stop(SLOW * KMH),
        END_159: osrd.of_stop(CROSSING * KMH),
    }.items():
        assert -place == pytest.approx(theirs(case), abs=ITS_OWN), case
    # Curves cross there if the supervised location is 90 m behind the end of authority; the case states 100 m.
    assert osrd.of_target(CROSSING * KMH, place=90.0) == pytest.approx(-theirs(END_159), abs=ITS_OWN)


def test_by_the_standard_distances_from_the_emergency_brake_are_shorter(train: SupervisedTrain) -> None:
    """Those from the service brake differ by its steps alone. Guidance to a limit begins before it, 3.13.9.3.5.9."""
    for case, found in {
        LOCATION_112: limits(train, MIDDLE),
        LOCATION_142: limits(train, FAST),
        LIMIT_112: limits(train, FAST, kind="LOA", target_speed=MIDDLE * KMH),
    }.items():
        assert 4.0 < theirs(case) + float(found.I[0]) < 9.0, case
    for case, speed in ((END_40, SLOW), (END_159, CROSSING)):
        assert -float(limits(train, speed, beyond=1e4).I[0]) == pytest.approx(theirs(case), abs=0.6)
    guidance = limits(train, FASTEST).GUI
    assert guidance is not None
    assert float(guidance[0]) == pytest.approx(-6919.9, abs=0.05)
    # Guidance is the first limit from 288 to 142 km/h. OSRD ends it at the limit itself, the standard before it.
    fast = limits(train, FASTEST, kind="LOA", target_speed=FAST * KMH)
    assert float(fast.I[0]) == pytest.approx(-6604.54, abs=0.01)


def test_limits_at_the_speed_of_a_target_are_those_of_the_closed_form(train: SupervisedTrain) -> None:
    """From one arc of EBD: 667.43 and 544.87 m before targets of 142 and 112 km/h; OSRD has 675.63 and 551.98 m."""
    for speed, place in ((FAST, 667.43), (MIDDLE, 544.87)):
        found = limits(train, speed, kind="LOA", target_speed=speed * KMH).I
        assert float(found[0]) == pytest.approx(-place, abs=0.01)
