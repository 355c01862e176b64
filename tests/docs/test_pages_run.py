"""Run everything that the pages show, each page from top to bottom, and compare the output with the page.

Python code is run, or written to a file if its first line names one, as C and TOML are. Changes are applied and
commands called, a few of them in a short form (SHORT). The folder is a copy of the checkout with those FMUs of `make
demo` that the page names. Blocks that need other programs are not run (UNTESTED).
"""

from __future__ import annotations

import contextlib
import doctest
import importlib.util
import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from bogie_braking.__main__ import main
from products.sources import HOUSE

ROOT = Path(__file__).parents[2]
#: A fenced block: its language and its text.
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
#: Kinds of blocks that are not run: commands (`bash`, `bat`), their output (`log`), other languages and files, and
#: Python (`py`) that takes too long to build.
UNTESTED = {"bash", "bat", "csharp", "csv", "java", "julia", "log", "py", "rust", "xml"}
#: All kinds of blocks; those run are Python, commands, changes, output and other files.
KINDS = UNTESTED | {"python", "sh", "diff", "text", "c", "cpp", "toml", "pascal"}
#: Programs that the commands of a block may call.
PROGRAMS = {"python", "make", "cc", "c++", "./host"}
#: Packages that a page needs but an installation may lack, and the extra that installs them.
EXTRAS = {
    "docs/hosts/ecos-and-libcosim.md": ("masters", ("ecospy", "libcosimpy")),
    "docs/calibrate.md": ("formats", ("asammdf",)),
}
#: Commands that install, or run all tests, and their replacements in every run.
DRY = {f"make {target}": f"make --dry-run {target}" for target in ("demo", "test")}
#: FMUs that `make demo` builds, and their files.
OF_DEMO = {"bogie": "BogieDynamics.fmu", "brake": "BrakeCylinder.fmu", "braked-vehicle": "BrakedVehicle.fmu"}
#: Pages whose kernels take half a minute and more to compile.
SLOW = {"README.md", "CONTRIBUTING.md", "docs/controller.md", "docs/hosts.md", "docs/public.md", "docs/training.md"}
SLOW |= {"docs/running-behaviour.md"}
#: Commands that take more than some seconds, and their replacements; `make test-long` runs the originals.
SHORT = {
    "python build_fmu.py ssp": "python build_fmu.py brake",
    "python -m bogie_braking run wheelset-constant-speed --html": "python -m bogie_braking run critical-speed --html",
    "python -m bogie_braking live": "python -m bogie_braking live --help",
    # It reads the whole cache; tests/bogie_braking/test_command_line.py has an empty one.
    "python -m bogie_braking doctor": "python -m bogie_braking doctor --help",
    "python -m bogie_braking pace spatial --step 1ms --seconds 10": "python -m bogie_braking pace --help",
    "python study.py": "python -m py_compile study.py",
    "python train.py": "python train.py 1 1",
    "python -m bogie_braking controllers compare trained.py:Policy --rails dry,low": (
        "python -m bogie_braking controllers compare trained.py:Policy --rails dry --draws 1"
    ),
    "python -m bogie_braking controllers compare 'share.py:LetGo(share=0.7)' 'share.py:LetGo(share=0.9)' --rails low": (
        "python -m bogie_braking controllers compare 'share.py:LetGo(share=0.7)' 'share.py:LetGo(share=0.9)'"
        " --rails dry --draws 1"
    ),
    "python -m bogie_braking controllers compare many.py:LetAllGo let_go.py:LetGo --rails wet,low": (
        "python -m bogie_braking controllers compare many.py:LetAllGo let_go.py:LetGo --rails dry --draws 1"
    ),
    "python -m bogie_braking controllers compare let_go.c let_go.py:LetGo --vehicle coach --programme my.toml": (
        "python -m bogie_braking controllers compare --help"
    ),
} | {
    f"python -m bogie_braking {command} {rest}": f"python -m bogie_braking {command} --help"
    for command, rest in (
        ("run", "controller-prototype"),
        ("run", "qr30-180kpa"),
        ("run", "train-brake-evidence"),
        ("run", "line-from-file --line mine.csv"),
        ("sweep", "anti-skid --vary friction=0.03:0.15:13 --vary application_time=1:6:6 --jobs 2"),
    )
}
PAGES = [
    path
    for path in (
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        *sorted(ROOT.glob("docs/*.md")),
        *sorted(ROOT.glob("docs/hosts/*.md")),
    )
    if BLOCK.search(path.read_text("utf-8"))
]
NOTEBOOKS = [pytest.param(path, id=path.stem) for path in sorted(ROOT.glob("docs/notebooks/*.ipynb"))]


def name(page: Path) -> str:
    """Return the path of a page from the root."""
    return page.relative_to(ROOT).as_posix()


@pytest.fixture
def checkout(request: pytest.FixtureRequest, tmp_path: Path, fmus: dict, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a copy of a newcomer's checkout as the current folder, with the FMUs of `make demo` that a page names."""
    given = request.node.callspec.params
    page = (ROOT / str(given.get("page") or given["path"])).read_text(encoding="utf-8")
    for package in (*HOUSE, "evidence", "docs", "tests"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    for file in (
        "build_fmu.py",
        "LICENSE",
        "README.md",
        "CONTRIBUTING.md",
        "CHANGELOG.md",
        "Makefile",
        "pyproject.toml",
    ):
        shutil.copyfile(ROOT / file, tmp_path / file)
    (tmp_path / "build" / "native").mkdir(parents=True)
    for fmu, file in OF_DEMO.items():
        if file in page:
            shutil.copyfile(fmus[fmu, "native"], tmp_path / "build" / "native" / file)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    return tmp_path


def apply(change: str, before: str) -> None:
    """Insert the lines with + after the line above them, in the last file that the page names before the block."""
    target = Path(re.findall(r"`([\w/]+\.py)`", before)[-1])
    text, above = target.read_text(encoding="utf-8"), ""
    for line in change.splitlines(keepends=True):
        if line.startswith("+"):
            assert text.count(above) == 1, above
            text = text.replace(above, above + line[1:])
        above = line[1:]
    target.write_text(text, encoding="utf-8")


def shown_in_this_process(arguments: list[str]) -> str:
    """Return the output of the command line, without the start of a process; it must succeed."""
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(io.StringIO()) as shown:
        patch.setenv("COLUMNS", "200")
        try:
            status = main(arguments)
        except SystemExit as ends:  # of --help
            status = int(ends.code or 0)
    assert status == 0, f"{arguments}\n{shown.getvalue()}"
    return shown.getvalue()


def shown_by_commands(commands: str, instead: Mapping[str, str], changed: bool = False) -> str:
    """Return the output of the commands of a block; each must succeed.

    instead: replacements of some commands. changed: the page changes the packages, so that every command needs a
    process of its own.
    """
    shown = ""
    for line in commands.splitlines():
        command = line.split("#")[0].strip()
        program, *arguments = shlex.split(instead.get(command, command))
        assert program in PROGRAMS, command
        if arguments[:2] == ["-m", "bogie_braking"] and not changed:
            shown += shown_in_this_process(arguments[2:])
            continue
        called = [sys.executable if program == "python" else program, *arguments]
        environment = os.environ | {"PYTHONPATH": str(Path.cwd()), "COLUMNS": "200"}
        done = subprocess.run(called, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
        shown += done.stdout
    return shown


def shown_by_python(code: str, names: dict[str, object]) -> str:
    """Return the output of a block that shares the names of earlier ones; a block that becomes a file has none."""
    file = re.match(r"# ([\w/]+\.py)\n", code)
    if file:
        Path(file.group(1)).write_text(code, encoding="utf-8")
        return ""
    with contextlib.redirect_stdout(io.StringIO()) as shown:
        exec(code, names)
    return shown.getvalue()


def skip_without_extra(page: str) -> None:
    """Skip the test of a page here if a required package is missing."""
    extra, packages = EXTRAS.get(page, ("", ()))
    if any(importlib.util.find_spec(package) is None for package in packages):
        pytest.skip(f"install the extra: pip install -e .[{extra}]")


def run_page(page: str, instead: Mapping[str, str]) -> None:
    """Run the blocks of a page in the current folder."""
    shown, names = "", {}
    for block in BLOCK.finditer(page):
        kind, text = block.groups()
        assert kind in KINDS, f"Say what this block is: {text}"
        if kind == "python":
            shown = shown_by_python(text, names)
        elif kind == "sh":
            shown = shown_by_commands(text, instead, "```diff" in page)
        elif kind == "diff":
            apply(text, page[: block.start()])
        elif kind in ("c", "cpp", "toml"):
            file = re.match(r"(?:/\* |# |// )([\w/-]+\.\w+)", text)
            assert file, f"Say in its first line which file this is: {text}"
            Path(file[1]).write_text(text, encoding="utf-8")
        elif kind == "text":
            same = doctest.OutputChecker().check_output(text, shown, doctest.ELLIPSIS)
            assert same, f"The page says\n{text}\nand there came\n{shown}"


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=pytest.mark.study if page in SLOW else ()) for page in map(name, PAGES)],
)
def test_a_page_runs_and_prints_what_it_says(page: str, checkout: Path) -> None:
    skip_without_extra(page)
    run_page((checkout / page).read_text(encoding="utf-8"), DRY | SHORT)


@pytest.mark.long
@pytest.mark.parametrize("page", [name(path) for path in PAGES if any(one in path.read_text("utf-8") for one in SHORT)])
def test_a_page_runs_whole(page: str, checkout: Path) -> None:
    skip_without_extra(page)
    run_page((checkout / page).read_text(encoding="utf-8"), DRY)


def test_what_is_not_as_the_page_says_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run_page("```python\nprint(6 * 7)\n```\n```text\n42\n```\n", {})
    for wrong in (
        "```python\nprint(6 * 7)\n```\n```text\n43\n```\n",
        "```sh\npython nothing.py\n```\n",
        "```\nls\n```\n",
    ):
        with pytest.raises(AssertionError):
            run_page(wrong, {})


def test_commands_that_are_shortened_are_on_a_page() -> None:
    pages = "".join(path.read_text(encoding="utf-8") for path in PAGES)
    assert [command for command in DRY | SHORT if command not in pages] == []


@pytest.mark.parametrize("path", NOTEBOOKS)
def test_a_notebook_runs_and_holds_no_outputs(path: Path, checkout: Path) -> None:
    cells = [cell for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    assert all(not cell["outputs"] and cell["execution_count"] is None for cell in cells)
    names: dict[str, object] = {}
    for cell in cells:
        exec("".join(cell["source"]), names)
    assert plt.get_fignums()
    plt.close("all")
