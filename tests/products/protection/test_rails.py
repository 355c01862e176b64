"""Rails by name: every reader and the page that lists them use the same friction and law."""

from __future__ import annotations

from pathlib import Path

from products.parameter_sets import PARAMETER_SETS
from products.protection import rails
from products.protection.programme import read_programme
from products.protection.rails import RAILS
from rbd_model.track.friction import CONDITIONS

NAMED = {name: make() for name, make in CONDITIONS.items()}
#: Suffixes of parameter sets and their rails.
SETS = {"dry-rail": "dry", "wet-rail": "wet", "low-adhesion": "low", "very-low-adhesion": "very_low"}


def test_the_page_lists_each_rail_with_its_numbers() -> None:
    page = (Path(__file__).parents[3] / "docs" / "physics.md").read_text(encoding="utf-8")
    rows = [row.strip("| ").split(" | ") for row in page.split("| rail |")[1].split("\n\n")[0].splitlines()[2:]]
    found = {name: ([float(one) for one in numbers], source, sure) for name, *numbers, source, sure in rows}
    assert found == {
        name: ([rail.friction, *rail.law.values().values()], rail.source, "yes" if rail.verified else "no")
        for name, rail in NAMED.items()
    }


def test_no_two_names_stand_for_one_rail() -> None:
    assert len(set(NAMED.values())) == len(NAMED)


def test_protected_stops_and_parameter_sets_have_the_rails_of_the_table() -> None:
    assert [rail.condition == NAMED[rail.name] for rail in RAILS if rail.name in NAMED] == [True] * 3
    for ending, name in SETS.items():
        values = PARAMETER_SETS[f"coach-{ending}"].values()
        assert {key: values[key] for key in NAMED[name].values(4)} == NAMED[name].values(4)


def test_cases_of_programmes_are_called_by_the_rail_that_they_have() -> None:
    """A case with its own friction differs from all named rails."""
    for file in ("programme.toml", "starts.toml"):
        for case in read_programme(Path(rails.__file__).with_name(file)):
            first = case.name.split(",")[0].replace(" ", "_")
            assert case.rail == first or first not in NAMED
            assert case.friction not in {rail.friction for rail in NAMED.values()}
