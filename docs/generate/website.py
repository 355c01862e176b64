"""Build the site of the documentation in build/site: `make docs`.

  python docs/generate/website.py                    with the output of the notebooks
  python docs/generate/website.py --short FOLDER     in seconds, into FOLDER: notebooks are not run, no page is compiled

`write_sources` writes all pages into one folder, and `build` calls Zensical there. The pages are those of docs/, README
and changelog, a page for each scenario, API, notebooks with their output, live pages and the files of a release.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import chain
from pathlib import Path
from typing import Any

import api_page
import catalogue
import downloads
import front_picture
import nbformat
import yaml
import zensical
import ziamath
from nbconvert import MarkdownExporter
from nbconvert.preprocessors import ExecutePreprocessor
from pages import DOCS, ROOT, filled
from scenario_pages import messages_of, pictures_of, scenario_page

from bogie_braking.live import page as live
from bogie_braking.live.train_page import PAGE as TRAIN_PAGE
from bogie_braking.live.train_page import train_page

SETTINGS = DOCS / "site.yml"
LIVE = "live.html"
#: Files outside docs/ by their names on the site, which starts at docs/index.md.
OUTSIDE = {"inside/README.md": "README.md"} | {name: name for name in ("CHANGELOG.md", "CONTRIBUTING.md", "LICENSE")}
#: Files of docs/ that are not on the site as they are.
NOT_COPIED = shutil.ignore_patterns("generate", "data", SETTINGS.name)
#: Tables that the short form leaves out, as they come from the equations of all FMUs.
FROM_EQUATIONS = ("variables", "equations")
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
#: Colours of a terminal, which the generator always writes.
COLOUR = re.compile(r"\x1b\[[\d;]*m")
#: The lines between the first two of `---`: settings of a page.
HEAD = re.compile(r"\A---\n(.*?)^---\n", re.DOTALL | re.MULTILINE)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Build the site of the documentation.")
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "build" / "site")
    parser.add_argument("--short", action="store_true", help="without notebooks' output and compiled pages")
    given = parser.parse_args(arguments)
    folder = given.folder.resolve()
    sources = folder.with_name(f"{folder.name}-sources")
    write_sources(sources, given.short)
    return build(sources, folder)


def build(sources: Path, site: Path) -> int:
    """Build the site from its sources; return the status of the generator, which is not 0 after a warning."""
    path = os.pathsep.join([str(Path(__file__).parent), str(ROOT)])
    command = [sys.executable, "-m", "zensical", "build", "--strict", "--clean", "--config-file", "mkdocs.yml"]
    environment = os.environ | {"PYTHONPATH": path}
    done = subprocess.run(command, cwd=sources, env=environment, capture_output=True, text=True, check=False)
    print(COLOUR.sub("", done.stdout + done.stderr).partition("Traceback")[0].strip())
    shutil.rmtree(site, ignore_errors=True)
    shutil.move(sources / "site", site)  # the generator writes below the folder of its settings only
    return done.returncode


def write_sources(folder: Path, short: bool) -> None:
    """Write the settings of the generator and the pages below `folder`."""
    shutil.rmtree(folder, ignore_errors=True)
    pages = folder / "pages"
    shutil.copytree(DOCS, pages, ignore=NOT_COPIED)
    for name, content in contents(short):
        path = pages / name
        path.parent.mkdir(parents=True, exist_ok=True)
        given = content.read_bytes() if isinstance(content, Path) else content.encode("utf-8")
        if path.suffix == ".md":
            given = page_of_site(name, given.decode("utf-8"), short).encode("utf-8")
        path.write_bytes(given)
    (folder / "mkdocs.yml").write_text(yaml.safe_dump(settings(), sort_keys=False), encoding="utf-8")


def settings() -> dict[str, Any]:
    """Return the settings of the generator, with the scenarios in the navigation."""
    found: dict[str, Any] = yaml.safe_load(SETTINGS.read_text(encoding="utf-8"))
    rooms = [
        {
            catalogue.title(room): [
                f"scenarios/{scenario.name}.md" for module in files for scenario in catalogue.scenarios_of(module)
            ]
        }
        for room, files in catalogue.modules().items()
    ]
    scenarios = next(entry for entry in found["nav"] if "Scenarios" in entry)
    scenarios["Scenarios"] += rooms
    found["plugins"]["mkdocstrings"]["handlers"]["python"]["paths"] = [str(ROOT)]
    return found | {"docs_dir": "pages", "site_dir": "site"}


def contents(short: bool) -> Iterator[tuple[str, str | Path]]:
    """Yield pages, and what is outside docs/, by name on the site: a text or a file."""
    with ProcessPoolExecutor(2) as pool:  # live pages and notebooks take longest
        if short:
            yield from ((name, "") for name in (LIVE, TRAIN_PAGE))
            late = {}
        else:
            late = {LIVE: pool.submit(live.page), TRAIN_PAGE: pool.submit(train_page)}
        for path in sorted(DOCS.glob("notebooks/*.ipynb")):
            late[f"notebooks/{path.stem}.md"] = pool.submit(notebook_page, path, not short)
        yield from ((path.relative_to(DOCS).as_posix(), path) for path in DOCS.rglob("*.md"))
        yield from ((name, ROOT / path) for name, path in OUTSIDE.items())
        yield from ((path.relative_to(ROOT).as_posix(), path) for path in ROOT.glob("products/pictures/*.png"))
        yield from ((f"downloads/{path.name}", path) for path in downloads.files())
        yield from scenario_contents()
        yield "api.md", api_page.generated()
        yield "pictures/one-step.svg", front_picture.svg()
        yield "assets/formulas.ttf", Path(ziamath.__file__).parent / "fonts" / "STIXTwoMath-Regular.ttf"
        yield "assets/instead-of-iframe-worker.js", search_from_disk()
        yield from ((name, page.result()) for name, page in late.items())


def scenario_contents() -> Iterator[tuple[str, str | Path]]:
    """Yield the page of each scenario and its figures by name on the site."""
    for module in chain.from_iterable(catalogue.modules().values()):
        for scenario in catalogue.scenarios_of(module):
            yield f"scenarios/{scenario.name}.md", scenario_page(scenario, module)
            yield from ((f"scenarios/{name}", path) for name, path in pictures_of(scenario.name).items())


def notebook_page(path: Path, run: bool) -> str:
    """Return a notebook as a page, with its output if it is run. Raises CellExecutionError if a cell fails."""
    exporter = MarkdownExporter()
    exporter.register_preprocessor(ExecutePreprocessor(extra_arguments=["--log-level=ERROR"]), enabled=run)
    text, _ = exporter.from_notebook_node(nbformat.read(path, 4), {"metadata": {"path": str(ROOT)}})
    return f"{text}\n\n[The notebook]({path.name})\n"


def search_from_disk() -> str:
    """Return the worker of the search as a script, as browsers start none from a file."""
    folder = Path(zensical.__file__).parent / "templates/assets/javascripts/workers"
    (worker,) = folder.glob("search.*.js")
    return (
        'if (location.protocol === "file:") {\n'
        f"  const source = {json.dumps(worker.read_text(encoding='utf-8'))}\n"
        "  window.Worker = class extends Worker {\n"
        "    constructor() { super(URL.createObjectURL(new Blob([source]))) }\n"
        "  }\n"
        "}\n"
    )


def page_of_site(name: str, text: str, short: bool) -> str:
    """Return a page as the generator reads it: its settings, then its text with words of users for the search."""
    head = HEAD.match(text)
    about = yaml.safe_load(head[1]) if head else {}
    if name.startswith("scenarios/"):  # they would hide the pages that explain them
        about["search"] = {"exclude": True}
    text = linked(name, text[head.end() :] if head else text, short)
    if words := WORDS.get(name.removesuffix(".md")):
        text = re.sub(r"^(# .*\n)", rf"\1\n<p hidden>{', '.join(words)}</p>\n", text, count=1, flags=re.MULTILINE)
    return f"---\n{yaml.safe_dump(about)}---\n\n{text}" if about else text


def linked(name: str, text: str, short: bool = False) -> str:
    """Return the text of a page with its generated parts, and with links as on the site."""
    if name == "inside/README.md":
        text = re.sub(r"\]\((?:docs/)?(?!#|\w+:)", "](../", text)
        return re.sub(r"!\[The live page.*?\)", rf"[\g<0>](../{LIVE})", text)
    if name.startswith("hosts/"):
        return text.replace("](../../README.md", "](../inside/README.md").replace("](../../", "](../")
    if "/" in name:
        return text
    text = filled(text, FROM_EQUATIONS if short else ())
    if name == "scenarios.md":
        text = re.sub(r"^\| `([\w-]+)` ", lambda row: thumbnail(row.group(1)), text, flags=re.MULTILINE)
    if name == "public.md":
        text = api_page.ROW.sub(names_linked, text)
    if name == "downloads.md":
        text = downloads.filled(text)
    text = re.sub(r"\]\((?:\.\./|docs/)", "](", text).replace(".ipynb)", ".md)")
    return re.sub(r"!\[The live page.*?\)", rf"[\g<0>]({LIVE})", text.replace("](README.md", "](inside/README.md"))


def names_linked(row: re.Match[str]) -> str:
    """Return a row of the table of public names, with each name as a link to its entry in the API."""
    link = r'<autoref identifier="bogie_braking.\1" optional><code>\1</code></autoref>'
    return row[0].replace(row[2], re.sub(r"`(\w+)`", link, row[2])) if row[2] else row[0]


def thumbnail(name: str) -> str:
    """Return the first cell of a scenario in the table of all: its main figure and the message of that."""
    message = messages_of(name).get(f"{name}.png")
    picture = f'<br>![](scenarios/{name}.png){{ width="240" loading="lazy" }}<br>*{message}*' if message else ""
    return f"| [`{name}`](scenarios/{name}.md){picture} "


if __name__ == "__main__":
    sys.exit(main())
