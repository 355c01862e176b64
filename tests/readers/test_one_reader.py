"""Check that users' tables and TOML files are read only in `readers`."""

from __future__ import annotations

import re
from pathlib import Path

from products.sources import HOUSE
from readers.units import quantity_of

ROOT = Path(__file__).parents[2]
#: Functions that read tables and TOML, by name.
READS = re.compile(
    r"csv\.(?:reader|DictReader)|loadtxt|genfromtxt|fromstring\(|read_csv|_?tomllib\.loads?|import tomli"
)
#: Files that call one of them: the readers, and modules for tables of the project itself. reference.py compares such a
#: table cell by cell. A reader of numbers would accept other strings of the same number.
READERS = {"readers/tables.py", "readers/toml_files.py"}
OF_OWN_DATA = {
    *("products/promised_variables.py", "evidence/contact/creep_laws.py", "scenarios/contact/contact_manchester.py"),
    *("evidence/measuring/exact_states.py", "bogie_braking/controllers/reference.py"),
}


def test_no_second_reader_of_users_tables() -> None:
    found = set()
    for room in (*HOUSE, "evidence"):
        for path in (ROOT / room).rglob("*.py"):
            text = re.sub(r"ET\.fromstring\(", "", path.read_text(encoding="utf-8"))
            if READS.search(text):
                found.add(path.relative_to(ROOT).as_posix())
    assert found == READERS | OF_OWN_DATA


def test_the_page_on_files_names_units_that_are_known() -> None:
    page = (ROOT / "docs" / "files.md").read_text(encoding="utf-8").split("| quantity | units |")[1].split("\n\n")[0]
    units = re.findall(r"`([^`]+)`", page)
    assert len(units) > 40
    assert [one for one in units if quantity_of(one) is None] == []
