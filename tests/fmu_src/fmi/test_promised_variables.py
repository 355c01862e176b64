"""Interface baseline of the FMU variables, and the messages about changes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from products.promised_variables import changes, last_version
from products.registry import FMUS, model_of

#: FMUs that the last version does not have.
NEW = {"driven-wheelset"}


@pytest.mark.parametrize("name", FMUS)
def test_what_has_changed_since_the_last_version_is_in_the_changelog(name: str) -> None:
    unreleased = (Path(__file__).parents[3] / "CHANGELOG.md").read_text(encoding="utf-8").split("\n## ")[1]
    for sentence in changes(name):
        families = [re.sub(r"(_[1-4])?(_left|_right)?(_speed)?$", "", word) for word in sentence.split() if "_" in word]
        assert any(one.removeprefix("state_") in unreleased for one in families), sentence


def test_the_table_is_of_all_fmus() -> None:
    _, promised = last_version()
    assert set(promised) == set(FMUS) - NEW
    assert promised["bogie"]["brake_torque_1"] == ("input", "N.m", "0", "")


def test_the_meaning_of_what_is_true_or_false_is_promised() -> None:
    """Since 0.1.0 a wheelset at rest is not locked."""
    version, _ = last_version()
    old, new = "locked by its brake", "locked: its brake holds it while its axle moves; false at rest"
    told = f"the meaning of locked_2 is The trailing wheelset is {new} in place of The trailing wheelset is {old}"
    assert version != "0.1.0" or f"bogie: {told}, since version 0.1.0." in changes("bogie")


def test_nothing_was_promised_of_an_fmu_that_there_was_not() -> None:
    assert changes("roller-rig", model_of("brake").variables) == []


def test_each_change_of_a_variable_is_a_sentence() -> None:
    version, _ = last_version()
    first, second, *others = model_of("brake").variables
    now = [
        replace(first, name="hurry"),
        replace(second, unit="bar"),
        *(replace(one, start=0.3) if one.name == "constant_shoe_friction" else one for one in others),
    ]
    assert changes("brake", now) == [
        f"brake: hurry is new, {first.causality} [{first.unit}], since version {version}.",
        f"brake: {first.name} is gone, since version {version}.",
        f"brake: pneumatics is called cylinder_model now, since version {version}.",
        f"brake: the unit of {second.name} is bar in place of {second.unit}, since version {version}.",
        f"brake: the start value of constant_shoe_friction is 0.3 in place of 0.25, since version {version}.",
    ]
