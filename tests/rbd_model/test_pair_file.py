"""Contact tables as files: what is written is read, and damaged files are refused in one sentence."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import pytest

from rbd_model.contact.geometry import Sides, european_pair, synthetic_pair
from rbd_model.contact.pair_file import read_pair, write_pair
from rbd_model.contact.pair_table import MOST_PATCHES, pair_record
from readers.text import BadInputError


@lru_cache
def unequal() -> Sides:
    """Return a wheelset with S1002 on 60E1 on the left, and the synthetic wheel on its rail on the right."""
    return Sides(european_pair().left, synthetic_pair().right)


@pytest.mark.parametrize("sides", [synthetic_pair(), european_pair(), unequal()], ids=["synthetic", "S1002", "unequal"])
def test_a_table_that_is_read_is_the_one_that_was_written(sides: Sides, tmp_path: Path) -> None:
    path = write_pair(sides, tmp_path / "pair.csv")
    found = read_pair(path)
    assert found == pair_record(sides)
    assert len(found.lists[0]) == 1 + (sides.left != sides.right)
    assert sides.left.wheel.name in path.read_text(encoding="utf-8").splitlines()[1]


def test_wheels_of_another_radius_have_another_table() -> None:
    smaller = replace(synthetic_pair().left, radius=0.4)
    other = pair_record(Sides(smaller, smaller))
    assert other.number("mean_radius") == 0.4
    assert other.lists == pair_record(synthetic_pair()).lists  # nearest points of profiles do not depend on it


#: How a file is damaged, and the sentence that says so.
DAMAGES = {
    "another file": (r"contact_pair,1", "distance,curvature", "the row must be 'contact_pair' with 1 more cells"),
    "a later format": (r"contact_pair,1", "contact_pair,2", "the format must be 1; got 2"),
    "no number": (r"mean_radius,.*", "mean_radius,big", r"mean_radius must be a number from 0.1 to 1; got big"),
    "millimetres": (r"mean_radius,.*", "mean_radius,460", r"mean_radius must be a number from 0.1 to 1; got 460"),
    "too long a table": (
        r"table,wheel,\d+",
        "table,wheel,20001",
        "the length of wheel must be a number from 1 to 20000",
    ),
    "a broken count": (r"table,wheel,\d+", "table,wheel,2.5", "the length of wheel must be a whole number"),
    "no patches": (
        r"list,treads,\d",
        "list,treads,0",
        f"the length of treads must be a number from 1 to {MOST_PATCHES}",
    ),
    "no direction": (r"sine,0.9.*", "sine,0.5", "cosine and sine above must be those of one angle"),
    "no breadth": (r"rail_ends,.*", "rail_ends,-0.5", "rail_begins above must be below rail_ends"),
    "no number in a row": (r"(table,along,.*\n.*),[^,]*\n", r"\1,nan\n", "a coefficient must be a number"),
    "a row that goes back": (r"(table,along,.*\n.*\n)[^,]*", r"\1-0.9", "breakpoints of along must grow"),
    "a short row": (r"(table,along,.*\n.*),[^,]*\n", r"\1\n", "a row of along must have 5 numbers here; got 4"),
    "a second end": (r"\Z", "list,sides,1\n", "the file must end after its last record"),
    "half a file": (r"(?s)table,rail.*", "", "the row must be 'table'; the file ends"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_table_is_refused_with_row_and_remedy(damage: str, tmp_path: Path) -> None:
    pattern, text, sentence = DAMAGES[damage]
    path = write_pair(synthetic_pair(), tmp_path / "pair.csv")
    whole = path.read_text(encoding="utf-8")
    path.write_text(re.sub(pattern, text, whole, count=1), encoding="utf-8")
    assert path.read_text(encoding="utf-8") != whole
    with pytest.raises(BadInputError, match=rf"pair.csv, row \d+: {sentence}.*\. Make the file again"):
        read_pair(path)
