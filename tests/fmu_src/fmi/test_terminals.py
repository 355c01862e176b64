"""The terminals of the FMUs: valid, with existing variables, and sufficient to connect FMUs."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path

import fmpy
import pytest
from fmpy import read_model_description
from lxml import etree

from products.building import NATIVE
from products.registry import DIFFERENT

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
PNG = b"\x89PNG\r\n\x1a\n"


def file_of(path: Path) -> etree._Element:
    with zipfile.ZipFile(path) as archive:
        return etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))


def terminals(path: Path) -> dict[str, tuple[str, dict[str, tuple[str, str]]]]:
    """Return kind and members by name of the terminal; a member has a variable and a kind of connection."""
    found = {}
    for one in file_of(path).iter("Terminal"):
        members = {m.get("memberName"): (m.get("variableName"), m.get("variableKind")) for m in one}
        found[one.get("name")] = (one.get("terminalKind"), members)
        assert len(members) == len(one)
    assert len(found) == len(list(file_of(path).iter("Terminal")))
    return found


def causalities(path: Path) -> dict[str, str]:
    return {v.name: v.causality for v in read_model_description(str(path)).modelVariables}


def plugs(sources: Path, targets: Path) -> Iterator[tuple[str, str, str, str]]:
    """Yield pairs of terminals of one kind, with each output of the first FMU that becomes an input of the second."""
    outputs, inputs = causalities(sources), causalities(targets)
    for (here, (kind, ours)), (there, (other, theirs)) in product(
        terminals(sources).items(), terminals(targets).items()
    ):
        if kind == other and ours.keys() == theirs.keys():
            for member, (variable, _) in ours.items():
                if outputs[variable] == "output" and inputs[theirs[member][0]] == "input":
                    yield here, there, variable, theirs[member][0]


@pytest.mark.study
@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("name", DIFFERENT)
def test_terminals_follow_the_schema_and_name_variables_that_are_there(fmus: Mapping, name: str, kind: str) -> None:
    path = fmus[name, kind]
    etree.XMLSchema(file=str(SCHEMA)).assertValid(file_of(path))
    known, found = causalities(path), terminals(path)
    assert found
    for _, members in found.values():
        assert {known[variable] for variable, _ in members.values()} == {"input", "output"}  # all exist
    with zipfile.ZipFile(path) as archive:
        assert archive.read("terminalsAndIcons/icon.png").startswith(PNG)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("bogie", {f"{kind}_{n}" for kind in ("brake", "drive", "rail") for n in (1, 2)} | {"drawbar"}),
        ("brake", {"brake"}),
        ("rail", {"rail_1", "rail_2"}),
    ],
)
def test_each_place_where_others_connect_is_a_terminal(fmus: Mapping, name: str, expected: set[str]) -> None:
    assert terminals(fmus[name, "native"]).keys() == expected


def test_brake_plugs_into_each_wheelset_of_the_bogie(fmus: Mapping) -> None:
    """The system BogieBraking has the same connections."""
    brake, bogie = fmus["brake", "native"], fmus["bogie", "native"]
    assert set(plugs(brake, bogie)) == {("brake", f"brake_{n}", "brake_torque", f"brake_torque_{n}") for n in (1, 2)}
    back = {("angular_velocity", "angular_velocity_1"), ("angular_velocity", "angular_velocity_2")}
    assert {(target, source) for *_, source, target in plugs(bogie, brake)} == back


def test_forces_at_a_drawbar_add_up_and_speeds_are_equal(fmus: Mapping) -> None:
    kind, members = terminals(fmus["bogie", "fmi3"])["drawbar"]
    assert kind == "_bogie-braking_drawbar"
    assert members == {"speed": ("speed", "signal"), "force": ("drawbar_force", "inflow")}


@pytest.mark.study
def test_couplers_of_the_vehicle_are_terminals(fmus: Mapping) -> None:
    assert {"coupler_front", "coupler_rear", "brake_4"} <= terminals(fmus["vehicle", "native"]).keys()
    braked = terminals(fmus["braked-vehicle", "native"]).keys()
    assert {"coupler_front", "protection_4"} <= braked
    assert "brake_4" not in braked  # its brakes are inside
