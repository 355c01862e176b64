"""The table [tolerances] of a TOML file: units, limits, and one message for each refused entry."""

from __future__ import annotations

from pathlib import Path

import pytest

from products.supervision.tolerances import ENTRIES, Tolerances
from products.tolerance_file import read_tolerances
from readers.text import BadInputError


def read(folder: Path, text: str) -> Tolerances:
    path = folder / "brake.toml"
    path.write_text(text, encoding="utf-8")
    return read_tolerances(path)


def test_every_entry_is_read_in_its_unit(tmp_path: Path) -> None:
    values = {"%": '"0.5 %"', "s": '"300 ms"', "1": "4"}
    found = read(
        tmp_path, "[tolerances]\n" + "\n".join(f"{name} = {values[one.unit]}" for name, one in ENTRIES.items())
    )
    for name, entry in ENTRIES.items():
        assert getattr(found, name) == pytest.approx({"%": 0.005, "s": 0.3, "1": 4}[entry.unit])
    assert read(tmp_path, "[tolerances]\nfriction = 0\ndelay = '0.2 s'\n") == Tolerances(delay=0.2)


@pytest.mark.parametrize(
    ("text", "says"),
    [
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
    ],
)
def test_a_table_that_cannot_be_meant_is_refused(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(BadInputError, match=says):
        read(tmp_path, text)
