"""Hooks of MkDocs: what the site has beside the pages in docs/, and what becomes of their links, places and formulas.

Added are the README, EQUATIONS.md and the changelog, a page for each scenario and for each module, the notebooks with
what they show when they run, the live page, and a search that works from a disk.
"""

import html
import json
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import catalogue
import material
import nbformat
import ziamath
from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from nbconvert import MarkdownExporter
from nbconvert.preprocessors import ExecutePreprocessor
from pages import DOCS, ROOT
from scenario_pages import pictures_of, scenario_page

from products.sources import HOUSE
from scenarios.live import page as live
from scenarios.live.train_page import train_page

LIVE, TRAIN = "live.html", "train.html"
OUTSIDE = ("README.md", "EQUATIONS.md", "CHANGELOG.md")
#: Of a Python file of ours, and a name in it; the same as a name with dots.
PLACE = rf"(?<![\w/])((?:{'|'.join(HOUSE)})/[\w/]+|build_fmu)\.py(?::\s(\w+(?:\.\w+)*))?"
DOTTED = rf"((?:{'|'.join(HOUSE)})(?:\.\w+)+)"
#: Pages that people wrote come first in a search.
API_PAGE = "---\nsearch:\n  boost: 0.5\n---\n\n::: {}\n"


def is_module(path: Path) -> bool:
    """Whether a file lies in a package; the hosts that travel in archives do not."""
    return (path.parent / "__init__.py").exists()


def modules() -> list[str]:
    """Dotted names of what can be imported of ours, but for the sentences about rooms and the command line."""
    files = [path for package in HOUSE for path in sorted((ROOT / package).rglob("[!_]*.py")) if is_module(path)]
    return [".".join(path.relative_to(ROOT).with_suffix("").parts) for path in [*files, ROOT / "build_fmu.py"]]


def in_rooms(names: list[str]) -> list[Any]:
    """Modules as MkDocs wants a navigation: those of a room below it."""
    rooms: dict[str, list[str]] = {}
    for name in names:
        rooms.setdefault(name.rpartition(".")[0] or name, []).append(f"api/{name}.md")
    return [{room: [{Path(page).stem.rpartition(".")[2]: page} for page in pages]} for room, pages in rooms.items()]


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Scenarios and modules enter the navigation, which mkdocs.yml leaves empty there."""
    rooms = [
        {room: [f"scenarios/{one.name}.md" for module in files for one in catalogue.scenarios_of(module)]}
        for room, files in catalogue.modules().items()
    ]
    added = {"Scenarios": ["scenarios.md", *rooms], "API": in_rooms(modules())}
    config.nav = [{name: added.get(name, pages) for name, pages in entry.items()} for entry in config.nav or []]
    return config


def contents() -> Iterator[tuple[str, str | Path]]:
    """What is added, by its name on the site: a text, or the file that it is."""
    for path in (*(ROOT / name for name in OUTSIDE), *ROOT.glob("products/pictures/*.png")):
        yield path.relative_to(ROOT).as_posix(), path
    for module in chain.from_iterable(catalogue.modules().values()):
        for one in catalogue.scenarios_of(module):
            yield f"scenarios/{one.name}.md", scenario_page(one, module)
            yield from ((f"scenarios/{name}", path) for name, path in pictures_of(one.name).items())
    yield from ((f"api/{name}.md", API_PAGE.format(name)) for name in modules())
    for path in sorted(DOCS.glob("notebooks/*.ipynb")):
        yield f"notebooks/{path.stem}.md", run_notebook(path)
    yield LIVE, live.page()
    yield TRAIN, train_page()
    yield "assets/formulas.ttf", Path(ziamath.__file__).parent / "fonts" / "STIXTwoMath-Regular.ttf"
    yield "assets/instead-of-iframe-worker.js", search_from_disk()


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds what is not in docs/."""
    for name, content in contents():
        given = {"abs_src_path": str(content)} if isinstance(content, Path) else {"content": content}
        files.append(File.generated(config, name, **given))
    return files


def run_notebook(path: Path) -> str:
    """A notebook as a page, with what it shows when it runs. Raises CellExecutionError where a cell fails."""
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
    """Links between the root and docs/ hold on the site, where all lies in one folder."""
    if "/" in page.file.src_uri:
        return markdown
    if page.file.src_uri == "EQUATIONS.md":
        markdown = re.sub(PLACE, lambda place: f"`{place.group()}`", markdown)
    if page.file.src_uri == "scenarios.md":
        markdown = re.sub(r"^\| `([\w-]+)` ", lambda row: thumbnail(row.group(1)), markdown, flags=re.MULTILINE)
    markdown = re.sub(r"\]\((?:\.\./|docs/)", "](", markdown).replace(".ipynb)", ".md)")
    return re.sub(r"!\[The live page.*?\)", rf"[\g<0>]({LIVE})", markdown)


def thumbnail(name: str) -> str:
    """The first cell of a scenario in the table of all."""
    picture = f'<br>![](scenarios/{name}.png){{ width="240" loading="lazy" }}' if pictures_of(name) else ""
    return f"| [`{name}`](scenarios/{name}.md){picture} "


def on_page_content(content: str, **_: Any) -> str:
    """Formulas become MathML, which browsers draw by themselves; places in the code lead to the API."""
    content = re.sub(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', formula, content, flags=re.DOTALL)
    content = re.sub(f"<code>{PLACE}</code>", reference, content)
    return re.sub(f"<code>{DOTTED}</code>", reference, content)


def formula(match: re.Match[str]) -> str:
    """MathML of a formula that arithmatex found: in a line, or in one of its own, which may scroll."""
    source = html.unescape(match.group(2))
    if match.group(1) == "span":
        return str(convert(source))
    return f'<div class="formula">{convert(source, display="block")}</div>'


def reference(match: re.Match[str]) -> str:
    """A place in the code, to be led to its entry in the API; to its module where it is not public."""
    module, name = (*match.groups(), None)[:2]
    public = [part for part in (name or "").split(".") if part]
    known = [module.replace("/", "."), *([] if any(part.startswith("_") for part in public) else public)]
    return f'<autoref identifier="{".".join(known)}" optional>{match.group()}</autoref>'
