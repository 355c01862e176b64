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

import pytest

import bogie_braking as bb
from scenarios.catalogue import SCENARIOS
from tests.bogie_braking.axe import violations
from tests.bogie_braking.browser import Browser, browser

__all__ = ["browser"]

pytest.importorskip("mkdocstrings", reason="install the extra: pip install -e .[docs]")
pytest.importorskip("zensical", reason="needs Python 3.11")
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
#: Places of a page among the results that a reader sees without scrolling.
SEEN = 5
#: Open the search, whose elements are below a shadow root.
OPEN = """new Promise(done => {
  document.querySelector(".md-search__button").click()
  const look = setInterval(() => {
    const roots = [...document.querySelectorAll("*")].map(one => one.shadowRoot).filter(Boolean)
    window.search = roots.find(one => one.querySelector("input"))
    if (window.search) { clearInterval(look); done() }
  }, 20)
})"""
#: Type into it, and wait until the results change.
SEARCH = """new Promise(done => {
  const field = window.search.querySelector("input")
  const found = () => [...window.search.querySelectorAll("a")].map(one => one.pathname)
  const before = String(found())
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set.call(field, %s)
  field.dispatchEvent(new Event("input", { bubbles: true }))
  const look = setInterval(() => {
    if (found().length && String(found()) !== before) { clearInterval(look); done(found()) }
  }, 50)
  setTimeout(() => done([]), 20000)
})"""
#: Wait until the page has a colour scheme, and has faded to it.
FOLLOWED = """new Promise(done => {
  const look = setInterval(() => {
    if (document.body.dataset.mdColorScheme === "%s") { clearInterval(look); setTimeout(done, 300) }
  }, 20)
})"""
#: Addresses on a network, and addresses that are not files of the site.
FROM_NETWORK, ELSEWHERE = re.compile(r"(https?:)?//"), re.compile(r"\w+:|//")


def pages(entries: list) -> Iterator[str]:
    """Yield all pages of a navigation."""
    for entry in entries:
        for value in entry.values() if isinstance(entry, dict) else [entry]:
            yield from [value] if isinstance(value, str) else pages(value)


def test_every_page_and_every_notebook_has_its_place() -> None:
    """Pages of scenarios are added automatically (`docs/generate/website.py`)."""
    tabs = yaml.safe_load((ROOT / "docs" / "site.yml").read_text(encoding="utf-8"))["nav"]
    assert len(tabs) <= MOST_TABS
    found = list(pages(tabs))
    assert len(found) == len(set(found))
    texts = [*ROOT.glob("docs/*.md"), *ROOT.glob("docs/hosts/*.md")]
    docs = {path.relative_to(ROOT / "docs").as_posix() for path in texts}
    notebooks = {f"notebooks/{path.stem}.md" for path in ROOT.glob("docs/notebooks/*.ipynb")}
    assert set(found) == docs | notebooks | {
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "api.md",
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


def built(folder: Path, *options: str) -> Path:
    """Build the site into a folder; a warning is an error."""
    call = [sys.executable, "docs/generate/website.py", str(folder), *options]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(call, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site in its short form."""
    return built(tmp_path_factory.mktemp("built") / "site", "--short")


@pytest.mark.long
def test_the_whole_site_has_what_the_short_one_lacks(tmp_path: Path) -> None:
    """Notebooks have their output, the live pages their button, and the tables of variables those of every FMU."""
    whole = built(tmp_path / "site")
    for name in ("live.html", "live-train.html"):
        assert "brake" in leads_of(whole / name).anchors, name
    assert "bogiedynamics" in leads_of(whole / "variables.html").anchors
    for notebook in ROOT.glob("docs/notebooks/*.ipynb"):
        assert "data:image/png" in (whole / "notebooks" / f"{notebook.stem}.html").read_text(encoding="utf-8")


def test_every_public_name_is_in_the_api_and_other_pages_lead_there(site: Path) -> None:
    anchors = leads_of(site / "api.html").anchors
    names = {f"bogie_braking.{name}" for name in bb.__all__} - {"bogie_braking.__version__"}
    assert names | {"bogie_braking.parts.Springs", "bogie_braking.etcs.supervise"} <= anchors
    assert "products.train.train.Train.drive" in anchors
    assert {f"api.html#{name}" for name in names} <= leads_of(site / "public.html").links
    assert "api.html#bogie_braking.arc" in leads_of(site / "ways.html").links


def test_every_scenario_has_a_page_without_a_run(site: Path) -> None:
    table = (site / "scenarios.html").read_text(encoding="utf-8")
    for scenario in SCENARIOS:
        assert f'href="scenarios/{scenario.name}.html"' in table
        assert f"python -m bogie_braking run {scenario.name}" in text_of(site / "scenarios" / f"{scenario.name}.html")


def text_of(path: Path) -> str:
    """Return the text of a page without tags."""
    return re.sub(r"<[^>]*>", "", path.read_text(encoding="utf-8"))


def test_formulas_and_places_in_the_code_are_what_they_should_be(site: Path) -> None:
    physics = (site / "physics.html").read_text(encoding="utf-8")
    source = (ROOT / "docs" / "physics.md").read_text(encoding="utf-8")
    assert physics.count('display="block"') == source.count("$$") // 2
    assert "arithmatex" not in physics
    assert "<code>rbd_model/levels/point.py: point_vehicle</code>" in physics


def html_of(site: Path) -> list[Path]:
    """Return all pages except 404.html, whose links start at the server's root."""
    return [path for path in site.rglob("*.html") if path.name != "404.html"]


def test_nothing_comes_from_a_network(site: Path) -> None:
    for path in html_of(site):
        assert not [address for address in leads_of(path).fetched if FROM_NETWORK.match(address)], path.name
    for path in site.rglob("*.css"):
        assert not re.search(r"url\([\"']?(https?:)?//", path.read_text(encoding="utf-8")), path.name


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


def test_the_search_finds_what_a_user_means(site: Path, browser: Browser) -> None:
    page = browser.open(site / "index.html", 1440)
    page.evaluate(OPEN)
    for words, meant in ASKED.items():
        found = [Path(place).relative_to(site).as_posix() for place in page.evaluate(SEARCH % json.dumps(words))]
        assert any(re.match(rf"{meant}[./]", place) for place in found[:SEEN]), f"{words}: {found}"
    assert page.errors == page.requests == []


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


@pytest.mark.parametrize("name", ["index", "physics", "train"])
def test_nothing_is_hard_to_read_or_to_use(site: Path, browser: Browser, name: str) -> None:
    for scheme in ("light", "dark"):
        page = browser.open(site / f"{name}.html", 1440)
        page.prefer(scheme)
        page.evaluate(FOLLOWED % {"light": "default", "dark": "slate"}[scheme])
        assert violations(page) == []
        page.close()
