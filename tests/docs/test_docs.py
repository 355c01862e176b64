"""Everything that the pages name exists, and generated pages are up to date.

`tests/docs/test_pages_run.py` runs the code of the pages.
"""

from __future__ import annotations

import ast
import functools
import importlib
import importlib.util
import json
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import bogie_braking as bb
from evidence.measuring import slide_bound
from products.sources import HOUSE
from scenarios.catalogue import SCENARIOS

ROOT = Path(__file__).parents[2]
WRITTEN = sorted(
    path.relative_to(ROOT).as_posix() for folder in ("*", "hosts/*") for path in ROOT.glob(f"docs/{folder}.md")
)
PAGES = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", *WRITTEN]
#: Files that a build or a run writes, files in an archive, and examples of names.
MADE = (
    "TRAINS/",
    "build/",
    "results/",
    "binaries/",
    "bogie/",
    "unpacked/",
    "rbd_model/body/orifice_damper.py",
    "rbd_model/contact/creep/carter.py",
    "brake_controller/distributors/direct.py",
)
#: A file with its folder, optionally followed by a name in it.
PLACE = re.compile(r'(?<![\w/.*"-])((?:[\w-]+/)+[\w-]+(?:\.\w+)+)(?::[ :](\w+(?:\.\w+)*)(?=[`|<\s]))?')


# -- what pages name -----------------------------------------------------------------------------------------------


def anchors(text: str) -> set[str]:
    """Return the anchors of the headings of a page, as GitHub makes them."""
    heads = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def broken_links(page: str, text: str) -> list[str]:
    """Return the relative links whose file or heading does not exist."""
    broken = []
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        name, _, anchor = link.partition("#")
        target = (ROOT / page).parent / name if name else ROOT / page
        if link.startswith(("http://", "https://")):
            continue
        if not target.exists() or (anchor and anchor not in anchors(target.read_text(encoding="utf-8"))):
            broken.append(link)
    return broken


@functools.cache
def definitions(path: Path) -> set[str]:
    """Return the names of the functions and classes of a Python file, nested ones as Outer.inner."""
    found, left = set(), [("", node) for node in ast.parse(path.read_text(encoding="utf-8")).body]
    while left:
        outer, node = left.pop()
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(outer + node.name)
            left += [(f"{outer}{node.name}.", inner) for inner in node.body]
    return found


def unknown_places(text: str) -> list[str]:
    """Return cited files, and functions in files (`path.py: name`, path.py::name), that do not exist; skip links."""
    unknown = []
    for name, inside in PLACE.findall(re.sub(r"\]\([^)]*\)", "]", text)):
        path = ROOT / name
        known = path.exists() and (not inside or path.suffix != ".py" or inside in definitions(path))
        if not known and not name.startswith(MADE) and "NAME" not in name:
            unknown.append(f"{name} {inside}".strip())
    return unknown


def exists_in_packages(dotted: str) -> bool:
    """Return whether a dotted name is a module of this repository, or an attribute of one."""
    module, _, name = dotted.rpartition(".")
    try:
        return hasattr(importlib.import_module(module), name) or importlib.util.find_spec(dotted) is not None
    except ModuleNotFoundError:
        return False


def unknown_names(text: str) -> list[str]:
    """Return the dotted names, C functions, make targets and scenarios to run that do not exist."""
    runtime = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "fmu_src/runtime").glob("*.[ch]"))
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    scenarios = {"NAME", *(scenario.name for scenario in SCENARIOS)}
    dotted = re.findall(rf"`((?:{'|'.join(HOUSE)})\.[\w.]+)`", text)
    unknown = [name for name in dotted if not exists_in_packages(name)]
    unknown += [name for name in re.findall(r"`((?:kernel|face|fmi[23])_?\w+)`", text) if name not in runtime]
    unknown += [name for name in re.findall(r"`make (\w+)`", text) if f"\n{name}:" not in makefile]
    run = re.findall(r"(?:-m bogie_braking|bogie-braking) (?:run|sweep) (\w[\w-]*)", text)
    return unknown + [name for name in run if name not in scenarios]


@pytest.mark.parametrize("page", PAGES)
def test_what_a_page_links_to_and_names_exists(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    assert broken_links(page, text) == []
    assert unknown_places(text) == []
    assert unknown_names(text) == []


#: A line that imports a package of this project, in an example or a notebook.
IMPORT = re.compile(rf"^[ \">]*(?:from|import) ((?:{'|'.join((*HOUSE, 'evidence'))})[.\w]*)", re.MULTILINE)


def inner_imports(text: str) -> list[str]:
    """Return the imported modules that are not public."""
    public = {"bogie_braking", "bogie_braking.__main__", *(f"bogie_braking.{name}" for name in bb.__all__)}
    return [module for module in IMPORT.findall(text) if module not in public]


def test_examples_import_public_names_alone() -> None:
    """CONTRIBUTING.md is about the inside."""
    for path in [ROOT / page for page in ("README.md", *WRITTEN)] + sorted(ROOT.glob("docs/notebooks/*.ipynb")):
        assert inner_imports(path.read_text(encoding="utf-8")) == [], path.name
    assert len(inner_imports((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"))) > 1


def test_what_does_not_exist_is_found() -> None:
    assert broken_links("docs/running.md", "[a](nowhere.md) [b](choosing.md#nowhere) [c](../README.md)") == [
        "nowhere.md",
        "choosing.md#nowhere",
    ]
    text = "`rbd_model/nowhere.py`, `rbd_model/levels/point.py: nothing`, docs/none.md"
    text += " `rbd_model/levels/point.py: point_vehicle`"
    assert unknown_places(text) == ["rbd_model/nowhere.py", "rbd_model/levels/point.py nothing", "docs/none.md"]
    text = "`rbd_model.levels.models.none` `kernel_none` `make none` bogie-braking run none"
    text += " `rbd_model.levels.models.recommend_level`"
    assert unknown_names(text) == ["rbd_model.levels.models.none", "kernel_none", "none", "none"]


def test_every_dependency_stands_in_the_table_of_licences() -> None:
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8").partition("[tool.")[0]
    asked = set(re.findall(r'^  "([a-z][a-z0-9-]+)', project, re.MULTILINE)) - {"bogie-braking"}
    table = (ROOT / "docs" / "installation.md").read_text(encoding="utf-8").partition("\n## Licences\n")[2]
    assert {"casadi", "ziglang", "scikit-sundae", "zensical"} < asked
    assert asked <= set(re.findall(r"[\w-]+", table))


def test_code_and_tests_cite_pages_that_are_here() -> None:
    """A citation of a document outside the repository explains nothing."""
    pages = {Path(page).name for page in PAGES} | {"api.md"}  # the site has it
    sources = [path for package in (*HOUSE, "tests", "docs/generate") for path in (ROOT / package).rglob("*.[pch]*")]
    for path in [ROOT / "Makefile", ROOT / "build_fmu.py", *sources]:
        if path.suffix in {".py", ".c", ".h", ""} and path != Path(__file__):
            cited = re.findall(r"([\w-]+\.md)\b(?!\.in)", path.read_text(encoding="utf-8"))
            assert set(cited) <= pages, f"{path.relative_to(ROOT)} cites {sorted(set(cited) - pages)}"


@pytest.fixture(scope="module")
def numbers() -> ModuleType:
    """Import docs/generate/numbers_of_pages.py."""
    sys.path.append(str(ROOT / "docs" / "generate"))
    return importlib.import_module("numbers_of_pages")


def test_numbers_on_the_pages_are_those_measured(numbers: ModuleType) -> None:
    """If this fails, run `make pages`; after a change of methods or cases run `make charts` before."""
    assert numbers.main(["--check"]) == 0


@pytest.mark.study
def test_every_generated_part_of_a_page_has_its_generator(numbers: ModuleType) -> None:
    found = [
        name
        for page in WRITTEN
        for name in re.findall(r"(?m)^<!-- generated: (.*) -->", (ROOT / page).read_text("utf-8"))
    ]
    assert sorted(found) == ["benchmark", "catalogue", "equations", "notches", "variables"]
    for name in found:
        assert len(importlib.import_module(name).generated()) > 1000


def test_every_equation_of_the_thesis_has_a_home_and_a_test_or_a_reason(numbers: ModuleType) -> None:
    assert importlib.import_module("equations").complaints() == []


def test_the_table_of_the_slide_bound_is_that_of_its_data() -> None:
    table = slide_bound.table(json.loads(slide_bound.DATA.read_text(encoding="utf-8")))
    assert table in (ROOT / "docs" / "controller.md").read_text(encoding="utf-8")


def test_a_number_with_a_mark_is_that_of_its_source(numbers: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """The source is a stored row or a constant. The generator corrects numbers; a run reports a row that it changes."""
    rows = {("a-scenario", "a row"): -14.37}
    mark = "<!--= tests/fmu_src/fmi/test_state_machine.py | SHORT | -->"
    page = f"It is 10<!--= a-scenario | a row | .0f --> %, of 7{mark} seeds."
    found = numbers.filled(page, rows)
    assert re.sub(r"<!--.*?-->", "", found) == "It is 14 %, of 20 000 seeds."
    assert numbers.filled(found, rows) == found
    signed = page.replace("10<", "+10<").replace(".0f", "+.0f")
    assert re.sub(r"<!--.*?-->", "", numbers.filled(signed, rows)).startswith("It is -14 %")
    with pytest.raises(KeyError):
        numbers.filled(page.replace("a row", "no row"), rows)
    mark = numbers.Mark("a-scenario", "a row", ".0f")
    monkeypatch.setattr(numbers, "kept", lambda: {"a-scenario": {"a row": 14.37}})
    monkeypatch.setattr(numbers, "marks", lambda: [mark])
    for value, count in ((14.37, 0), (14.8, 0), (15.0, 1)):
        assert len(numbers.moved("a-scenario", [{"quantity": "a row", "simulated": value}])) == count


def test_every_mark_on_a_page_can_be_read(numbers: ModuleType) -> None:
    """A mark with another spelling would be ignored without a message."""
    for page in numbers.PAGES:
        text = page.read_text(encoding="utf-8")
        assert len(numbers.MARKED.findall(text)) == text.count("<!--="), page


def test_options_of_the_commands_on_the_pages_are_known() -> None:
    known = {}
    for program in ("build_fmu.py", "-m bogie_braking run", "-m bogie_braking sweep"):
        call = [sys.executable, *program.split(), "--help"]
        known[program] = subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    asked = 0
    for page in PAGES:
        for program, rest in re.findall(
            r"python (build_fmu\.py|-m bogie_braking run|-m bogie_braking sweep)([^`\n]*)",
            (ROOT / page).read_text("utf-8"),
        ):
            for option in re.findall(r"--[\w-]+", rest):
                asked += 1
                assert option in known[program], f"{page}: {program} has no {option}"
    assert asked > 5
