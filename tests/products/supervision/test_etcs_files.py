"""Files of ETCS data: written and read back, and refused where they are wrong."""

from __future__ import annotations

import copy
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bogie_braking import etcs
from products.supervision.tolerances import ENTRIES
from readers.text import BadInputError, FileError
from tests.products.supervision.random_trains import one_of, trains

SPEEDS = np.linspace(1.0, 45.0, 12)
NATIONAL = etcs.NationalValues(guidance=True)


def train_of_all() -> etcs.SupervisedTrain:
    """Return a train with a value for each entry of a file."""
    train = one_of(trains(np.random.default_rng(5), 1), 0, traction_command=True, service_command=True)
    normal, factors = (
        etcs.Steps(np.array([31.7]), np.array([0.55, 0.41])),
        etcs.Steps(np.array([20.1]), np.array([0.9, 0.8])),
    )
    return replace(
        train,
        Kdry_rst=factors,
        Kwet_rst=etcs.Steps.constant(0.93),
        rotating=7.3,
        A_brake_normal_service=normal,
        Kn_plus=etcs.Steps.constant(0.007),
        Kn_minus=etcs.Steps.constant(0.002),
        without_adhesion=True,
        freight=True,
        maximum_speed=61.0,
    )


def limits(train: etcs.SupervisedTrain, level: int = 9) -> np.ndarray:
    national = replace(NATIONAL, M_NVEBCL=level)
    found = etcs.supervise(train, 2000.0, SPEEDS, national=national, A_est=0.5)
    return np.array([getattr(found, name) for name in ("EBD", "EBI", "SBI1", "SBI2", "P", "I")])


def test_a_written_train_is_read_back_bit_for_bit(tmp_path: Path) -> None:
    path, levels = tmp_path / "train.json", [etcs.Steps.constant(1.0 - 0.037 * n) for n in range(10)]
    percentage = etcs.SupervisedTrain.of_percentage(97.3, "freight P", 611.7, maximum_speed=30.0, rotating=4.0)
    for train, by_level in ((train_of_all(), []), (train_of_all(), levels), (percentage, [])):
        etcs.write_train(path, train, by_level, "a train")
        found = etcs.read_train(path)
        assert etcs.train_document(found.train, found.dry_by_level, found.name) == json.loads(path.read_text())
        expected = replace(train, Kdry_rst=by_level[3]) if by_level else train
        assert np.array_equal(limits(found.at_level(3), 3), limits(expected))
    numbers = json.loads(path.read_text())
    assert numbers["L_TRAIN"] == {"value": 611.7, "unit": "m"}
    assert numbers["M_BRAKE_PERCENTAGE"] == {"value": 97.3, "unit": "%"}


def test_a_train_goes_to_osrd_and_back_in_both_places_of_its_versions(tmp_path: Path) -> None:
    path = tmp_path / "stock.json"
    train = replace(train_of_all(), rotating=None, without_adhesion=False, freight=False, maximum_speed=None)
    for one in (train, replace(train, traction_command=False)):
        stock = etcs.osrd_document(one)
        newer = {"length": stock["length"], "supported_signaling_systems": [{"type": "BAL"}]}
        newer["supported_signaling_systems"] += [{"type": "ETCS_LEVEL2", "brake_params": stock["etcs_brake_params"]}]
        for read in (stock, newer):
            path.write_text(json.dumps(read))
            assert limits(etcs.read_osrd_train(path)) == pytest.approx(limits(one), abs=1e-9)


def test_a_factor_of_one_confidence_level_is_refused_at_another(tmp_path: Path) -> None:
    path, six = tmp_path / "train.json", replace(train_of_all(), level=6)
    etcs.write_train(path, six)
    found = etcs.read_train(path)
    assert np.array_equal(limits(found.train, 6), limits(six, 6))
    by_level = etcs.EtcsTrain(six, tuple(etcs.Steps.constant(1.0 - 0.05 * n) for n in range(10)))
    for refused in (
        lambda: limits(found.train, 7),
        lambda: found.at_level(7),
        lambda: limits(by_level.at_level(9), 0),
        lambda: etcs.fmu_parameters(six),
    ):
        with pytest.raises(BadInputError, match=r"Kdry_rst of confidence level [69] alone; got M_NVEBCL"):
            refused()
    with pytest.raises(BadInputError, match="level must be an integer from 0 to 9; got 10"):
        by_level.at_level(10)
    etcs.write_train(path, six, by_level.dry_by_level)
    with pytest.raises(BadInputError, match="Kdry_rst of confidence level 9 alone; got M_NVEBCL 0"):
        limits(etcs.read_train(path).train, 0)


def changed(document: dict[str, Any], place: list[str], value: Any) -> dict[str, Any]:
    found = inside = copy.deepcopy(document)
    for name in place[:-1]:
        inside = inside[name]
    inside[place[-1]] = value
    return found


ALL = """M_NVEBCL = 7
M_NVAVADH = 0.2
M_NVKTINT = 1.2
V_NVKVINT = ["0 km/h", "108 km/h"]
M_NVKVINT = [0.7, 0.8]
M_NVKVINT_b = [0.6, 0.65]
A_NVP12 = "0.9 m/s2"
A_NVP23 = 1.1
L_NVKRINT = [0, 300]
M_NVKRINT = [1.0, 0.9]
A_NVMAXREDADH2 = 0.6
Q_NVGUIPERM = true
Q_NVINHSMICPERM = true
Q_NVSBFBPERM = true
"""


def test_a_file_has_all_national_values(tmp_path: Path) -> None:
    path = tmp_path / "country.toml"
    path.write_text(ALL)
    found = etcs.read_national(path)
    assert (found.M_NVEBCL, found.M_NVAVADH, found.Kt_int, found.A_NVP12, found.A_NVP23) == (7, 0.2, 1.2, 0.9, 1.1)
    assert found.Kv_int.boundaries == pytest.approx([30.0])
    assert [*found.Kv_int.values, *found.Kr_int.values, *found.Kr_int.boundaries] == [0.7, 0.8, 1.0, 0.9, 300.0]
    assert found.Kv_int_b is not None
    assert found.Kv_int_b.values.tolist() == [0.6, 0.65]
    assert (found.reduced_adhesion, found.guidance, found.exact_speed, found.feedback) == ((1.0, 0.6, 0.7), *[True] * 3)


def tolerances_in(folder: Path, text: str) -> etcs.Tolerances:
    path = folder / "brake.toml"
    path.write_text(text, encoding="utf-8")
    return etcs.read_tolerances(path)


def test_every_entry_is_read_in_its_unit(tmp_path: Path) -> None:
    values = {"%": '"0.5 %"', "s": '"300 ms"', "1": "4"}
    found = tolerances_in(
        tmp_path, "[tolerances]\n" + "\n".join(f"{name} = {values[one.unit]}" for name, one in ENTRIES.items())
    )
    for name, entry in ENTRIES.items():
        assert getattr(found, name) == pytest.approx({"%": 0.005, "s": 0.3, "1": 4}[entry.unit])
    assert tolerances_in(tmp_path, "[tolerances]\nfriction = 0\ndelay = '0.2 s'\n") == etcs.Tolerances(delay=0.2)


#: Wrong files of each reader: place and value in a document, or the text, and the message.
WRONG_IN_TRAINS = [
    (["T_brake_emergency", "unit"], "m", "must have a unit that converts to s; got m"),
    (["T_brake_emergency", "value"], "2.4", "T_brake_emergency must be a number; got '2.4'. Remove the quotes"),
    (["T_brake_emergency", "value"], 99.0, "T_brake_emergency must be 0 to 60 s; got 99"),
    (["T_brake_emergency"], 2.4, 'must be {"value": ..., "unit": "s"}; got 2.4'),
    (["T_brake_emergncy"], 2.4, "not a name of train data; did you mean T_brake_emergency"),
    (["A_brake_service", "values", "value"], [1.0], "one value more than boundaries"),
    (["A_brake_service", "boundaries", "value"], "no", "must be a list of numbers; got no"),
    (["Kdry_rst"], [], "one step function or a list of 10; got 0"),
    (["M_BRAKE_PERCENTAGE"], {"value": 90, "unit": "%"}, "M_BRAKE_PERCENTAGE stands for A_brake_emergency"),
    (["M_BRAKE_POSITION"], "R", "M_BRAKE_POSITION must be one of passenger P"),
    (["Q_SERVICEBRAKEINTERFACE"], 1, "must be true or false; got 1"),
    (["M_NVEBCL"], {"value": 6.5, "unit": "1"}, "level must be an integer from 0 to 9; got 6.5"),
    (["version"], 2, '"version": 1'),
]
WRONG_IN_STOCKS = [
    (["etcs_brake_params", "t_bs2"], 1.0, "t_bs1 and t_bs2 must be equal"),
    (["etcs_brake_params", "k_dry", "values"], [2.0, 1.0], "Kdry_rst must be 0 to 1.55"),
    (["etcs_brake_params", "k_dry", "values"], [1.0], "k_dry: Steps must have one value more"),
    (["etcs_brake_params", "t_be"], -1, "t_be must be a number of at least 0 s"),
    (["etcs_brake_params", "k_moist"], 1, "k_moist is not a parameter"),
    (["length"], "x", "length must be a number from 1 to 4095"),
]
WRONG_COUNTRIES = [
    ("M_NVEBLC = 3", "M_NVEBLC is not a national value of the curves; did you mean M_NVEBCL"),
    ("M_NVEBCL = 2.5", "M_NVEBCL must be an integer from 0 to 9; got 2.5"),
    ("M_NVKVINT = [0.7, 0.8]", "one factor for each start of V_NVKVINT, 1 to 32; got 2 factors and 1 starts"),
    ("V_NVKVINT = [0, 10]", "V_NVKVINT must have a list of factors"),
    ("V_NVKVINT = [5, 10]\nM_NVKVINT = [1, 1]", "must ascend from 0 to at most 600 km/h"),
    ("Q_NVGUIPERM = 2", "Q_NVGUIPERM must be true or false; got 2"),
    ('A_NVP12 = "3 km/h"', "A_NVP12 must be a number, alone in m/s2"),
    ('A_NVP12 = "0,3 m/s2"', "got 0,3 m/s2. Write a decimal point: 0.3 m/s2"),
    ("A_NVP12 = 1", "A_NVP12 must be at most A_NVP23"),
    ("A_NVMAXREDADH1 = 4", "A_NVMAXREDADH1 must be 0 to 3.15; got 4"),
    ("M_NVKVINT = 3", "M_NVKVINT must be 0 to 2.54; got 3"),
]
WRONG_TOLERANCES = [
    ("", r"must have a table \[tolerances\]"),
    ("tolerances = 5", r"must have a table \[tolerances\]"),
    ("[tolerances]\nfriction = 5", 'friction must have its unit; got 5. Write "5 %"'),
    ('[tolerances]\nfriction = "0.05"', "friction must have its unit; got 0.05"),
    ('[tolerances]\nfriction = "25 %"', "friction must be from 0 to 20 %; got 25 %"),
    ('[tolerances]\nfriction = "-1 %"', "friction must be from 0 to 20 %; got -1 %"),
    ('[tolerances]\nfriction = "5 kN"', "friction must be from 0 to 20 %; got 5 kN"),
    ('[tolerances]\nfriction = "2,5 %"', "got 2,5 %. Write a decimal point: 2.5 %"),
    ('[tolerances]\ndelay = "3 min"', "delay must be from 0 to 10 s; got 3 min"),
    ("[tolerances]\ndelay = 0.3", 'delay must have its unit; got 0.3. Write "0.3 s"'),
    ('[tolerances]\nlost = "1 %"\nunits = 1.5', "units must be an integer from 1 to 16; got 1.5"),
    ('[tolerances]\nlost = "1 %"\nunits = 1000000000', "units must be an integer from 1 to 16"),
    ('[tolerances]\nfrictoin = "5 %"', "'frictoin' is not a tolerance. Did you mean friction"),
    ('[tolerances]\nnoticed = "5 %"', "got no isolated"),
    ("[tolerances]\nfriction = true", "friction must be from 0 to 20 %; got true"),
    ('[tolerances]\nfriction = "5 %"\n[other]\n', "alone; got other"),
    ("[tolerances", "must be TOML"),
]


@pytest.mark.parametrize(
    ("read", "wrong", "says"),
    [
        *((etcs.read_train, (etcs.train_document, *wrong), re.escape(says)) for *wrong, says in WRONG_IN_TRAINS),
        *((etcs.read_osrd_train, (etcs.osrd_document, *wrong), says) for *wrong, says in WRONG_IN_STOCKS),
        *((etcs.read_national, text, says) for text, says in WRONG_COUNTRIES),
        *((etcs.read_tolerances, text, says) for text, says in WRONG_TOLERANCES),
    ],
)
def test_a_file_that_is_wrong_is_refused(read: Any, wrong: Any, says: str, tmp_path: Path) -> None:
    path = tmp_path / "wrong.file"
    if not isinstance(wrong, str):
        document, place, value = wrong
        wrong = json.dumps(changed(document(train_of_all()), place, value))
    path.write_text(wrong)
    with pytest.raises(FileError if read is not etcs.read_tolerances else BadInputError, match=says):
        read(path)
