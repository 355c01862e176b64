"""The site has every page, scenario and public name, no dead link, and loads nothing from a network.

Its search finds the right page for the words of a user, and its first page addresses all readers.
"""

from __future__ import annotations

import functools
import importlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import pytest

import bogie_braking as bb
from scenarios.catalogue import SCENARIOS
from tests.bogie_braking.axe import violations
from tests.bogie_braking.browser import Browser, browser

__all__ = ["browser"]

mkdocstrings = pytest.importorskip("mkdocstrings", reason="install the extra: pip install -e .[docs]")
yaml = pytest.importorskip("yaml")

ROOT = Path(__file__).parents[2]


class Leads(HTMLParser):
    """Collect the targets of a page: anchors, links, and files that a browser loads by itself."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.fetched: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the targets of one tag; the base class calls it."""
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        self.links |= {given[name] for name in ("href", "src") if name in given}
        if tag != "a":
            self.fetched |= {given[name] for name in ("href", "src") if name in given}


leads_of = functools.cache(Leads)
MOST_TABS = 8
#: Least count of compared numbers, which shows that the pages were read.
MANY = 40
#: A number of at least two digits; years and versions do not occur next to a link.
NUMBER = re.compile(r"(?<![\w.])\d[\d.e-]*\d(?![\w.])")
#: Search words and the page that they should find; the page of one host may replace that of all hosts.
ASKED = {
    "stopping distance": "public",
    "shoe friction": "physics",
    "calibrate": "calibrate",
    "histogram": "rare",
    "gradient": "line",
    "protection": "controller",
    "teeth": "controller",
    "Simulink": "hosts",
    "license": "installation",
    "units": "units",
}
#: Type into the search of a page, and wait until the results change.
SEARCH = """new Promise(done => {
  const field = document.querySelector(".md-search__input"), list = document.querySelector(".md-search-result__list")
  list.replaceChildren()
  field.focus()
  field.value = %s
  field.dispatchEvent(new KeyboardEvent("keyup", { bubbles: true }))
  const look = setInterval(() => {
    const found = [...list.querySelectorAll(".md-search-result__item > a")].map(one => one.pathname)
    if (found.length) { clearInterval(look); done(found) }
  }, 50)
  setTimeout(() => done([]), 20000)
})"""
#: Addresses on a network, and addresses that are not files of the site.
FROM_NETWORK, ELSEWHERE = re.compile(r"(https?:)?//"), re.compile(r"\w+:|//")


def pages(entries: list) -> Iterator[str]:
    """Yield all pages of a navigation."""
    for entry in entries:
        for value in entry.values() if isinstance(entry, dict) else [entry]:
            yield from [value] if isinstance(value, str) else pages(value)


def test_every_page_and_every_notebook_has_its_place() -> None:
    """Scenarios and public names are added automatically (`docs/generate/website.py`)."""
    tabs = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"]
    assert len(tabs) <= MOST_TABS
    found = list(pages(tabs))
    assert len(found) == len(set(found))
    texts = [*ROOT.glob("docs/*.md"), *ROOT.glob("docs/hosts/*.md")]
    docs = {path.relative_to(ROOT / "docs").as_posix() for path in texts} - {"scenarios.md"}
    notebooks = {f"notebooks/{path.stem}.md" for path in ROOT.glob("docs/notebooks/*.ipynb")}
    assert set(found) == docs | notebooks | {
        "CHANGELOG.md",
        "inside/README.md",
        "live.html",
        "live-train.html",
    }


def test_numbers_of_summaries_stand_on_the_pages_that_they_cite() -> None:
    """Checks each paragraph of the first page and of the questions, and the tables of validation."""
    front, questions, validation = (
        (ROOT / "docs" / name).read_text(encoding="utf-8") for name in ("index.md", "faq.md", "validation.md")
    )
    rows = re.findall(r"^\| [^-|][^|]*\|[^|]*(\|.*\|)$", validation, re.MULTILINE)
    looked_at = 0
    for part in (*front.split("\n\n"), *questions.split("\n\n"), *rows):
        cited = re.findall(r"\]\((\w+\.md)", part)
        text = " ".join((ROOT / "docs" / name).read_text(encoding="utf-8") for name in cited)
        for number in NUMBER.findall(re.sub(r"\]\([^)]*\)", "]", part)) if cited else []:
            looked_at += 1
            assert re.search(rf"(?<![\d.]){re.escape(number)}(?!\d)", text), f"{number} is not in {cited}"
    assert looked_at > MANY


@pytest.mark.study
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # ziamath warns at import
def test_links_to_the_root_hold_in_pages_of_hosts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "generate"))
    website = importlib.import_module("website")
    page = SimpleNamespace(file=SimpleNamespace(src_uri="hosts/rust.md"), meta={})
    written = "[a](../../README.md#limits) [b](../../CHANGELOG.md) [c](../hosts.md)"
    shown = "[a](../inside/README.md#limits) [b](../CHANGELOG.md) [c](../hosts.md)"
    assert website.on_page_markdown(written, page) == shown
    assert page.meta["search"] == {"boost": 1.0}


def test_downloads_list_the_files_of_a_release_where_there_is_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "generate"))
    downloads = importlib.import_module("downloads")
    page = (ROOT / "docs" / "downloads.md").read_text(encoding="utf-8")
    monkeypatch.setattr(downloads, "DIST", tmp_path / "none")
    assert downloads.filled(page) == page
    monkeypatch.setattr(downloads, "DIST", tmp_path)
    (tmp_path / "a.whl").write_bytes(b"abc")
    filled = downloads.filled(page)
    assert "make release" not in filled
    checksum = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert f"| [a.whl](downloads/a.whl) | 0.0 kB | `{checksum}` |" in filled


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site without a warning; the build runs the notebooks."""
    folder = tmp_path_factory.mktemp("site")
    call = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(call, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.mark.long
def test_every_public_name_is_in_the_site_and_no_page_is_of_a_room(site: Path) -> None:
    with (site / "objects.inv").open("rb") as file:
        inventory = mkdocstrings.Inventory.parse_sphinx(file)
    names = {f"bogie_braking.{name}" for name in bb.__all__} - {"bogie_braking.__version__", "bogie_braking.parts"}
    assert names | {"bogie_braking.parts.Springs", "products.train.train.Train.drive"} <= set(inventory)
    linked = leads_of(site / "public.html").links
    assert {path.relative_to(site).as_posix() for path in site.glob("api/*.html")} <= {
        one.partition("#")[0] for one in linked
    }


@pytest.mark.long
def test_the_pages_that_brake_are_those_and_no_guides(site: Path) -> None:
    """A guide of the same name would replace one of them."""
    for name in ("live.html", "live-train.html"):
        assert "brake" in leads_of(site / name).anchors, name
    assert "in-python" in leads_of(site / "train.html").anchors


@pytest.mark.long
def test_every_scenario_has_a_page(site: Path) -> None:
    table = (site / "scenarios.html").read_text(encoding="utf-8")
    for scenario in SCENARIOS:
        assert f'href="scenarios/{scenario.name}.html"' in table
        assert f"python -m bogie_braking run {scenario.name}" in text_of(site / "scenarios" / f"{scenario.name}.html")


def text_of(path: Path) -> str:
    """Return the text of a page without tags."""
    return re.sub(r"<[^>]*>", "", path.read_text(encoding="utf-8"))


@pytest.mark.long
def test_formulas_and_places_in_the_code_are_what_they_should_be(site: Path) -> None:
    physics = (site / "physics.html").read_text(encoding="utf-8")
    source = (ROOT / "docs" / "physics.md").read_text(encoding="utf-8")
    assert physics.count('display="block"') == source.count("$$") // 2
    assert "arithmatex" not in physics
    assert "<code>rbd_model/levels/point.py: point_vehicle</code>" in physics
    assert "api/Line.html#bogie_braking.arc" in leads_of(site / "ways.html").links


def html_of(site: Path) -> list[Path]:
    """Return all pages except 404.html, whose links start at the server's root."""
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
            name, _, anchor = link.removesuffix("#embed=1").partition("#")  # `#embed=1` sets the view of the live page
            target = (path.parent / name).resolve() if name else path
            if not target.is_file() or (anchor and target.suffix == ".html" and anchor not in leads_of(target).anchors):
                dead.add(f"{path.relative_to(site)}: {link}")
    assert sorted(dead) == []


@pytest.mark.long
def test_the_search_finds_what_a_user_means(site: Path, browser: Browser) -> None:
    page = browser.open(site / "index.html", 1440)
    for words, meant in ASKED.items():
        found = [Path(place).relative_to(site).as_posix() for place in page.evaluate(SEARCH % json.dumps(words))]
        assert any(re.match(rf"{meant}[./]", place) for place in found[:2]), f"{words}: {found}"
    assert page.errors == page.requests == []


@pytest.mark.long
@pytest.mark.parametrize(("width", "height"), [(1440, 900), (390, 844)])
def test_the_first_screen_says_what_it_is_what_to_click_and_where_to_go(
    site: Path, browser: Browser, width: int, height: int
) -> None:
    page = browser.open(site / "index.html", width, height)
    shown = "[...document.querySelectorAll('.front h1, .front iframe, .front-doors a')]"
    assert page.evaluate(f"Math.max(...{shown}.map(one => one.getBoundingClientRect().bottom))") <= height
    assert page.evaluate("document.querySelectorAll('.front-doors a').length") == 3
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate("document.querySelector('.front iframe').getAttribute('src')").startswith("live.html#")


@pytest.mark.long
@pytest.mark.parametrize("name", ["index", "physics", "hosts", "public"])
def test_nothing_is_hard_to_read_or_to_use(site: Path, browser: Browser, name: str) -> None:
    for scheme in ("light", "dark"):
        page = browser.open(site / f"{name}.html", 1440)
        page.prefer(scheme)
        assert violations(page) == []
        page.close()
