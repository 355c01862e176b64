"""Hooks of MkDocs: pages in addition to those in docs/, and changes of links, places in the code and formulas.

Additional pages are the README, the changelog, a page for each scenario and for each public name, and the
notebooks with their output. The live pages, the files of a release, and a search that works from a disk are added too.
"""

import html
import json
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import catalogue
import downloads
import front_picture
import material
import nbformat
import ziamath
from api_pages import api_pages
from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from nbconvert import MarkdownExporter
from nbconvert.preprocessors import ExecutePreprocessor
from pages import DOCS, ROOT, filled
from scenario_pages import messages_of, pictures_of, scenario_page

from bogie_braking.live import page as live
from bogie_braking.live.train_page import PAGE as TRAIN_PAGE
from bogie_braking.live.train_page import train_page
from products.sources import HOUSE

LIVE = "live.html"
#: Files outside docs/ by their names on the site, which starts at docs/index.md.
OUTSIDE = {"inside/README.md": "README.md", "CHANGELOG.md": "CHANGELOG.md"}
#: Path of a Python file of the project, and a name in it; the same as a name with dots.
PLACE = rf"(?<![\w/])((?:{'|'.join(HOUSE)})/[\w/]+|build_fmu)\.py(?::\s(\w+(?:\.\w+)*))?"
DOTTED = rf"((?:{'|'.join(HOUSE)})(?:\.\w+)+)"
#: Weights of pages in the search, by the beginnings of their names: guides first, then tables, then the others.
BOOST = {
    **dict.fromkeys(("scenarios", "variables", "architecture", "checking", "limits"), 0.3),
    **dict.fromkeys(("api/", "inside/", "ways", "equations", "CHANGELOG"), 0.1),
}
#: Words of users that a page answers, where its headings say them otherwise.
WORDS = {
    "public": ["stopping distance", "first stop"],
    "physics": ["shoe friction", "slip", "lock-up", "adhesion"],
    "choosing": ["accuracy", "tolerance", "level"],
    "calibrate": ["calibrate", "calibration", "parameter identification"],
    "rare": ["histogram", "stopping distance", "distribution", "Monte Carlo"],
    "line": ["gradient", "curve", "slope"],
    "controller": ["protection", "WSP", "anti-skid", "teeth", "encoder"],
    "hosts": ["Simulink", "Dymola", "Simpack", "OpenModelica"],
    "installation": ["license", "licence", "install"],
    "units": ["units", "signs"],
}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Add scenarios and public names to the navigation, which is empty there in mkdocs.yml."""
    rooms = [
        {room: [f"scenarios/{scenario.name}.md" for module in files for scenario in catalogue.scenarios_of(module)]}
        for room, files in catalogue.modules().items()
    ]
    config.nav = completed(config.nav or [], {"Scenarios": ["scenarios.md", *rooms], "API": list(api_pages())})
    return config


def completed(nav: Any, added: dict[str, list[Any]]) -> Any:
    """Return a navigation or a page of it, with the empty sections of these names filled."""
    if not isinstance(nav, list):
        return nav
    return [
        one if isinstance(one, str) else {name: added.get(name) or completed(one[name], added) for name in one}
        for one in nav
    ]


def contents() -> Iterator[tuple[str, str | Path]]:
    """Yield the added contents by name on the site: a text or a file."""
    yield from ((name, ROOT / path) for name, path in OUTSIDE.items())
    yield from ((path.relative_to(ROOT).as_posix(), path) for path in ROOT.glob("products/pictures/*.png"))
    yield from ((f"downloads/{path.name}", path) for path in downloads.files())
    for module in chain.from_iterable(catalogue.modules().values()):
        for scenario in catalogue.scenarios_of(module):
            yield f"scenarios/{scenario.name}.md", scenario_page(scenario, module)
            yield from ((f"scenarios/{name}", path) for name, path in pictures_of(scenario.name).items())
    yield from api_pages().items()
    for path in sorted(DOCS.glob("notebooks/*.ipynb")):
        yield f"notebooks/{path.stem}.md", run_notebook(path)
    yield LIVE, live.page()
    yield TRAIN_PAGE, train_page()
    yield "pictures/one-step.svg", front_picture.svg()
    yield "assets/formulas.ttf", Path(ziamath.__file__).parent / "fonts" / "STIXTwoMath-Regular.ttf"
    yield "assets/instead-of-iframe-worker.js", search_from_disk()


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the files outside docs/."""
    for name, content in contents():
        given = {"abs_src_path": str(content)} if isinstance(content, Path) else {"content": content}
        files.append(File.generated(config, name, **given))
    return files


def run_notebook(path: Path) -> str:
    """Return a notebook as a page with its output. Raises CellExecutionError if a cell fails."""
    exporter = MarkdownExporter()
    exporter.register_preprocessor(ExecutePreprocessor(extra_arguments=["--log-level=ERROR"]), enabled=True)
    text, _ = exporter.from_notebook_node(nbformat.read(path, 4), {"metadata": {"path": str(ROOT)}})
    return f"{text}\n\n[The notebook]({path.name})\n"


def search_from_disk() -> str:
    """The worker of the search as a string, as browsers start none from a file."""
    folder = Path(material.__file__).parent / "templates/assets/javascripts/workers"
    (worker,) = folder.glob("search.*.js")
    return (
        'if (location.protocol === "file:") {\n'
        f"  const source = {json.dumps(worker.read_text(encoding='utf-8'))}\n"
        "  window.Worker = class extends Worker {\n"
        "    constructor() { super(URL.createObjectURL(new Blob([source]))) }\n"
        "  }\n"
        "}\n"
    )


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """A page gets its place in the search; links between the root and docs/ hold on the site, all in one folder."""
    name = page.file.src_uri
    page.meta.setdefault("tags", WORDS.get(name.removesuffix(".md"), []))
    page.meta.setdefault("search", {"boost": next((BOOST[some] for some in BOOST if name.startswith(some)), 1.0)})
    if name == "inside/README.md":
        markdown = re.sub(r"\]\((?:docs/)?(?!#|\w+:)", "](../", markdown)
        return re.sub(r"!\[The live page.*?\)", rf"[\g<0>](../{LIVE})", markdown)
    if name.startswith("hosts/"):
        return markdown.replace("](../../README.md", "](../inside/README.md").replace("](../../", "](../")
    if "/" in name:
        return markdown
    markdown = filled(markdown)
    if name == "equations.md":
        markdown = re.sub(PLACE, lambda place: f"`{place.group()}`", markdown)
    if name == "scenarios.md":
        markdown = re.sub(r"^\| `([\w-]+)` ", lambda row: thumbnail(row.group(1)), markdown, flags=re.MULTILINE)
    if name == "downloads.md":
        markdown = downloads.filled(markdown)
    markdown = re.sub(r"\]\((?:\.\./|docs/)", "](", markdown).replace(".ipynb)", ".md)")
    return re.sub(r"!\[The live page.*?\)", rf"[\g<0>]({LIVE})", markdown.replace("](README.md", "](inside/README.md"))


def thumbnail(name: str) -> str:
    """Return the first cell of a scenario in the table of all: its main figure and the message of that."""
    message = messages_of(name).get(f"{name}.png")
    picture = f'<br>![](scenarios/{name}.png){{ width="240" loading="lazy" }}<br>*{message}*' if message else ""
    return f"| [`{name}`](scenarios/{name}.md){picture} "


def on_page_content(content: str, page: Page, **_: Any) -> str:
    """Convert formulas to MathML, which browsers draw, and link public names in the code to the API.

    Scrolling elements can be reached by keys. The numbers of scenarios are not searched: they would hide the pages that
    explain them.
    """
    if page.file.src_uri.startswith("scenarios"):
        content = content.replace("<table>", "<table data-search-exclude>")
    content = re.sub(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', formula, content, flags=re.DOTALL)
    content = content.replace("<pre><span></span>", '<pre tabindex="0"><span></span>')
    content = re.sub(f"<code>{PLACE}</code>", reference, content)
    content = re.sub(f"<code>{DOTTED}</code>", reference, content)
    short = r"bb\.(\w+)" if page.file.src_uri != "public.md" else r"(?:bb\.)?(\w+)"
    return re.sub(f"<code>{short}</code>", lambda one: to_api(f"bogie_braking.{one[1]}", one[0]), content)


def formula(match: re.Match[str]) -> str:
    """Return the MathML of a formula that arithmatex found: in a line, or a separate one, which may scroll."""
    source = html.unescape(match.group(2))
    if match.group(1) == "span":
        return str(convert(source))
    return f'<div class="formula" tabindex="0">{convert(source, display="block")}</div>'


def reference(match: re.Match[str]) -> str:
    """A place in the code, to be led to its entry in the API."""
    return to_api(".".join(part for part in match.groups() if part).replace("/", "."), match.group())


def to_api(name: str, shown: str) -> str:
    """Return a link to the entry of a dotted name in the API; without an entry the shown text is not changed."""
    return f'<autoref identifier="{name}" optional>{shown}</autoref>'
