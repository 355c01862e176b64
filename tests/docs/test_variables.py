"""docs/variables.md and the documentation inside FMUs agree with modelDescription.xml."""

from __future__ import annotations

import html
import json
import re
import xml.etree.ElementTree as ET
from dataclasses import asdict

import pytest

from brake_controller.cylinder import brake_model, timed_brake
from brake_controller.parameters import qr30
from brake_controller.protection_fmu import wheel_slide_protection
from fmu_src.model_description import TYPES3, model_description, model_description3, variable_table
from fmu_src.pages import documentation
from fmu_src.system import Model, Variable, choosing
from products.registry import FMUS, model_of

MODELS = [*FMUS, "protection"]
#: Attributes of XML with a column of the same name, as text and as numbers.
TEXTS, NUMBERS = ("causality", "variability"), ("start", "min", "max")


def model(name: str) -> Model:
    return wheel_slide_protection().model if name == "protection" else model_of(name)


def rows_of(text: str) -> dict[str, dict[str, str]]:
    """Return the rows of Markdown tables by the name of their variable."""
    found, heads = {}, []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")] if line.startswith("|") else []
        if cells and cells[0].strip() == "name":
            heads = cells
        elif cells and cells[0].startswith("`"):
            row = dict(zip(heads, cells, strict=True))
            found[row["name"].strip("`")] = row
    return found


@pytest.mark.study
@pytest.mark.parametrize("name", ["brake", "bogie"])
def test_the_table_tells_what_the_xml_tells(name: str) -> None:
    shown, told = rows_of(variable_table(name, model(name).variables)), 0
    for element in ET.fromstring(model_description(model(name), "guid")).iter("ScalarVariable"):
        if element.get("causality") == "local":
            assert element.get("name") not in shown
            continue
        row, kind, told = shown[element.attrib["name"]], element[0], told + 1
        assert row["type"] == kind.tag
        assert row["meaning"] == element.get("description")
        assert row["unit"] == kind.get("unit", "")
        for head in TEXTS:
            assert row[head] == element.get(head)
        for head in NUMBERS:
            given, cell = kind.get(head), row.get(head, "")
            assert (cell == "") == (not given), head
            assert not given or float(cell) == pytest.approx(float(given), rel=1e-5), head
    assert told == len(shown)


def test_fmi_3_has_the_same_limits_and_variability() -> None:
    shown = rows_of(variable_table("brake", model("brake").variables))
    elements = {one.get("name"): one for one in ET.fromstring(model_description3(model("brake"), "token")).iter()}
    for variable in model("brake").variables:
        element = elements[variable.name]
        assert element.tag == TYPES3[variable.kind]
        if variable.causality != "local":
            row = shown[variable.name]
            assert [row[head] for head in TEXTS] == [element.get(head) for head in TEXTS]
            assert [bool(row.get(head)) for head in ("min", "max")] == [
                head in element.attrib for head in ("min", "max")
            ]


def test_the_page_inside_an_fmu_tells_the_same_and_its_heads_have_a_scope() -> None:
    page = documentation(model("brake"), "native", ["documentation/picture.png"])
    assert re.search(r'<img [^>]*alt="[^"]+"', page)
    assert page.count('<th scope="col">') == 9
    for name, row in rows_of(variable_table("brake", model("brake").variables)).items():
        cells = "".join(
            f"<td>{html.escape(row.get(head, ''))}</td>"
            for head in ("type", "causality", "variability", "unit", "start", "min", "max", "meaning")
        )
        assert f'<tr><th scope="row"><code>{name}</code></th>{cells}</tr>' in page


@pytest.mark.parametrize("name", MODELS)
def test_every_number_that_chooses_has_a_meaning(name: str) -> None:
    """An integer with the values 0 and 1 is a switch, and its description explains it."""
    for variable in model(name).variables:
        numbers = [number for number, _ in variable.choices]
        if variable.kind == "integer" and (variable.minimum, variable.maximum) != (0.0, 1.0):
            assert numbers == list(range(int(variable.minimum), int(variable.maximum) + 1)), variable.name
            for number, text in variable.choices:
                assert f"{number} {text}" in variable.description
        else:
            assert numbers == []


def test_choices_come_back_from_json() -> None:
    variable = Variable("law", "parameter", start=2.0, **choosing("Law", {0: "none", 2: "steep"}))
    assert variable.description == "Law: 0 none; 2 steep"
    assert (variable.minimum, variable.maximum, variable.kind) == (0.0, 2.0, "integer")
    assert Variable(**json.loads(json.dumps(asdict(variable)))) == variable


def test_a_brake_with_one_kind_of_pneumatics_offers_no_other() -> None:
    pneumatics = next(one for one in brake_model((timed_brake(qr30()),)).variables if one.name == "cylinder_model")
    assert [number for number, _ in pneumatics.choices] == [1]
