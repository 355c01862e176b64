"""The site has every page, every scenario and every public name, no dead link, and asks no network for anything."""

from __future__ import annotations

import ast
import functools
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pytest

from products.sources import HOUSE
from scenarios.catalogue import SCENARIOS

mkdocstrings = pytest.importorskip("mkdocstrings", reason="install the extra: pip install -e .[docs]")
yaml = pytest.importorskip("yaml")

ROOT = Path(__file__).parents[1]


class Leads(HTMLParser):
    """Where a page leads to: places within it, links, and what a browser fetches for it by itself."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.fetched: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Called for each tag, by the base class."""
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        self.links |= {given[name] for name in ("href", "src") if name in given}
        if tag != "a":
            self.fetched |= {given[name] for name in ("href", "src") if name in given}


leads_of = functools.cache(Leads)
#: Behind a host, or where no file is.
FROM_NETWORK, ELSEWHERE = re.compile(r"(https?:)?//"), re.compile(r"\w+:|//")


def pages(entries: list) -> Iterator[str]:
    """All pages of a navigation."""
    for entry in entries:
        (value,) = entry.values()
        if isinstance(value, str):
            yield value
        else:
            yield from pages(value)


def test_every_page_and_every_notebook_has_its_place() -> None:
    """Scenarios and modules find theirs by themselves (`docs/generate/website.py`)."""
    found = list(pages(yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"]))
    assert len(found) == len(set(found))
    docs = {path.name for path in ROOT.glob("docs/*.md")} - {"scenarios.md"}
    notebooks = {f"notebooks/{path.stem}.md" for path in ROOT.glob("docs/notebooks/*.ipynb")}
    assert set(found) == docs | notebooks | {"README.md", "EQUATIONS.md", "CHANGELOG.md", "live.html", "train.html"}


def public_names() -> Iterator[str]:
    """Dotted names of functions, classes and methods that can be imported, without a leading underscore."""

    def within(body: list[ast.stmt], outer: str) -> Iterator[str]:
        for node in body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
                yield f"{outer}.{node.name}"
                if isinstance(node, ast.ClassDef):
                    yield from within(node.body, f"{outer}.{node.name}")

    for path in [ROOT / "build_fmu.py", *(path for package in HOUSE for path in (ROOT / package).rglob("*.py"))]:
        in_package = path.parent == ROOT or (path.parent / "__init__.py").exists()
        if path.name == "__main__.py" or not in_package:
            continue
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        yield from within(ast.parse(path.read_text(encoding="utf-8")).body, module)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built without a warning; notebooks run for it."""
    folder = tmp_path_factory.mktemp("site")
    call = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(call, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.mark.long
def test_every_public_name_is_in_the_site(site: Path) -> None:
    with (site / "objects.inv").open("rb") as file:
        inventory = mkdocstrings.Inventory.parse_sphinx(file)
    assert sorted(set(public_names()) - set(inventory)) == []


@pytest.mark.long
def test_every_scenario_has_a_page(site: Path) -> None:
    table = (site / "scenarios.html").read_text(encoding="utf-8")
    for scenario in SCENARIOS:
        assert f'href="scenarios/{scenario.name}.html"' in table
        assert f"python -m bogie_braking run {scenario.name}" in text_of(site / "scenarios" / f"{scenario.name}.html")


def text_of(path: Path) -> str:
    """What a page shows, without tags."""
    return re.sub(r"<[^>]*>", "", path.read_text(encoding="utf-8"))


@pytest.mark.long
def test_formulas_and_places_in_the_code_are_what_they_should_be(site: Path) -> None:
    physics = (site / "physics.html").read_text(encoding="utf-8")
    source = (ROOT / "docs" / "physics.md").read_text(encoding="utf-8")
    assert physics.count('display="block"') == source.count("$$") // 2
    assert "arithmatex" not in physics
    assert 'href="api/rbd_model.levels.point.html#rbd_model.levels.point.point_vehicle"' in physics
    assert 'href="api/rbd_model.thesis.euler.html' in (site / "EQUATIONS.html").read_text(encoding="utf-8")


def html_of(site: Path) -> list[Path]:
    """All pages but that for addresses that are none, which a server shows and which counts from the server's root."""
    return [path for path in site.rglob("*.html") if path.name != "404.html"]


@pytest.mark.long
def test_nothing_comes_from_a_network(site: Path) -> None:
    for path in html_of(site):
        assert not [address for address in leads_of(path).fetched if FROM_NETWORK.match(address)], path.name
    for path in site.rglob("*.css"):
        assert not re.search(r"url\([\"']?(https?:)?//", path.read_text(encoding="utf-8")), path.name


@pytest.mark.long
def test_no_link_is_dead(site: Path) -> None:
    dead = set()
    for path in html_of(site):
        for link in leads_of(path).links:
            if ELSEWHERE.match(link):
                continue
            name, _, anchor = link.partition("#")
            target = (path.parent / name).resolve() if name else path
            if not target.is_file() or (anchor and target.suffix == ".html" and anchor not in leads_of(target).anchors):
                dead.add(f"{path.relative_to(site)}: {link}")
    assert dead == set()
