"""Permitted imports between packages, and content that must never be in the repository."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

import hatch_build
from products.sources import ROOMS

ROOT = Path(__file__).parents[1]
#: Packages of this repository that each package may import.
ALLOWED = {
    "readers": {"readers"},
    "fmu_src": {"fmu_src", "readers"},
    "rbd_model": {"rbd_model", "readers", "fmu_src.system", "fmu_src.chain", "fmu_src.piecewise", "fmu_src.records"},
    "brake_controller": {
        "brake_controller",
        "readers",
        "fmu_src.system",
        "fmu_src.chain",
        "fmu_src.piecewise",
        "fmu_src.records",
    },
    "products": {"products", "readers", "fmu_src", "rbd_model", "brake_controller"},
}
OURS = {*ROOMS, "build_fmu"}


def test_rooms_are_imported_from_by_name() -> None:
    """A wheel moves all packages below one name, and `import fmu_src.system` cannot be adapted (hatch_build.py)."""
    for room in (*ROOMS, "bogie_braking"):
        for path in (ROOT / room).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Import):
                    found = {alias.name.split(".")[0] for alias in node.names} & OURS
                    assert not found, f"{path.relative_to(ROOT)}: write from {found.pop()} import ..."


def test_a_wheel_has_all_rooms() -> None:
    assert hatch_build.ROOMS == ROOMS


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
            names |= {f"{node.module}.{alias.name}" for alias in node.names if node.module.split(".")[0] in OURS}
    return names


def test_supervision_needs_arrays_and_messages_alone() -> None:
    """Trains of this project and ETCS curves meet in numbers, so that each can be checked by itself."""
    for path in (ROOT / "products" / "supervision").glob("*.py"):
        own = {name for name in imported(path) if name.split(".")[0] in OURS}
        assert all(name.startswith(("products.supervision", "readers.text")) for name in own), (path.name, own)


@pytest.mark.parametrize("package", ALLOWED)
def test_imports_run_one_way(package: str) -> None:
    for path in (ROOT / package).rglob("*.py"):
        for name in imported(path):
            if name.split(".")[0] in OURS:
                allowed = any(name == ok or name.startswith(ok + ".") for ok in ALLOWED[package])
                assert allowed, f"{path.relative_to(ROOT)} imports {name}"


#: Limits of rbd_model: files next to its subpackages, and layers, where a subpackage is above all that it imports.
FILES_BESIDE, FLOORS = 4, 6


def arrows(package: str) -> dict[str, set[str]]:
    """Return the imports of each module within a package, including those for type checkers."""
    places = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in (ROOT / package).rglob("*.py")
    }
    return {module: (imported(path) & places.keys()) - {module, package} for module, path in places.items()}


def floors(above: dict[str, set[str]]) -> dict[str, int]:
    """Return the layer of each module, from 1. Raises AssertionError with the cycle if imports form one."""
    found: dict[str, int] = {}

    def stand(one: str, way: tuple[str, ...]) -> int:
        assert one not in way, f"these import each other in a ring: {' -> '.join((*way[way.index(one) :], one))}"
        if one not in found:
            found[one] = 1 + max((stand(other, (*way, one)) for other in sorted(above.get(one, set()))), default=0)
        return found[one]

    for one in above:
        stand(one, ())
    return found


@pytest.mark.parametrize("package", ALLOWED)
def test_no_files_and_no_rooms_import_each_other_in_a_ring(package: str) -> None:
    files = arrows(package)
    floors({module: {one for one in others if not module.startswith(f"{one}.")} for module, others in files.items()})
    rooms: dict[str, set[str]] = {}
    for module, others in files.items():
        own = module.split(".")[1:2]
        rooms.setdefault(*own or [package], set()).update(
            other.split(".")[1] for other in others if other.split(".")[1:2] != own
        )
    highest = max(floors(rooms).values())
    if package == "rbd_model":
        assert highest <= FLOORS
        assert len(list((ROOT / package).glob("[!_]*.py"))) <= FILES_BESIDE


def test_a_ring_is_found() -> None:
    with pytest.raises(AssertionError, match="a -> b -> a"):
        floors({"a": {"b"}, "b": {"a"}})
    assert floors({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == {"c": 1, "b": 2, "a": 3}


#: Subpackages of scenarios/ with one scenario in each file (`coupling` is one scenario in several files). The others
#: are infrastructure.
SUBJECTS = ("thesis", "brakes", "vehicles", "contact", "lines", "numerics", "trains", "comparisons")


#: Package that comparisons import and that no wheel contains.
PEERS = "scenarios.comparisons.peers"


def test_a_wheel_imports_nothing_that_it_leaves_out() -> None:
    """The lists of scenarios and of revisions are exempt: they check first that the module exists."""
    looking = {ROOT / "scenarios" / "catalogue.py", ROOT / "scenarios" / "numerics" / "speed.py"}
    for room in (*ROOMS, "bogie_braking"):
        for path in {*(ROOT / room).rglob("*.py")} - looking:
            place = path.relative_to(ROOT).as_posix()
            for left_out in hatch_build.LEFT_OUT:
                found = {name for name in imported(path) if name.startswith(left_out.replace("/", "."))}
                assert place.startswith(left_out) or not found, place


def test_no_scenario_imports_a_scenario() -> None:
    for path in (ROOT / "scenarios").rglob("*.py"):
        if path.name == "catalogue.py":
            continue
        for name in imported(path):
            leans = any(name == f"scenarios.{room}" or name.startswith(f"scenarios.{room}.") for room in SUBJECTS)
            assert not leans or name.startswith(PEERS), f"{path.relative_to(ROOT)} imports {name}"


def test_rooms_of_subjects_hold_nothing_but_scenarios() -> None:
    catalogue = imported(ROOT / "scenarios" / "catalogue.py")
    for room in SUBJECTS:
        for path in (ROOT / "scenarios" / room).glob("[!_]*.py"):
            assert f"scenarios.{room}.{path.stem}" in catalogue, path.relative_to(ROOT)


Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def public(path: Path) -> Iterator[tuple[str, Definition]]:
    """Yield functions, classes and methods without a leading underscore; methods have the names of their classes."""

    def within(body: Sequence[ast.stmt], outer: str) -> Iterator[tuple[str, Definition]]:
        for node in body:
            if isinstance(node, Definition) and not node.name.startswith("_"):
                yield outer + node.name, node
                if isinstance(node, ast.ClassDef):
                    yield from within(node.body, f"{outer}{node.name}.")

    yield from within(ast.parse(path.read_text(encoding="utf-8")).body, "")


@pytest.mark.parametrize("package", [*ALLOWED, "bogie_braking"])
def test_every_public_function_method_and_class_says_what_it_is(package: str) -> None:
    for path in (ROOT / package).rglob("*.py"):
        for name, node in public(path):
            assert ast.get_docstring(node), f"{path.relative_to(ROOT)}: {name} has no doc string; say what it is."


def tracked() -> list[Path]:
    done = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if done.returncode != 0:
        pytest.skip("not a git checkout")
    return [ROOT / line for line in done.stdout.splitlines()]


def test_repository_holds_no_machine_paths_download_addresses_or_build_products() -> None:
    address = re.compile(r"(?<![\w.])/(work|home|tmp|root)/[a-z]|https?://\S+\.(whl|tgz|jar)\b|pythonhosted")
    for path in tracked():
        if not path.exists() or path == Path(__file__):
            continue
        assert path.suffix not in {".so", ".dll", ".dylib", ".fmu", ".o", ".pyc"}, path
        text = path.read_text(encoding="utf-8", errors="ignore")
        found = address.search(text)
        assert not found, f"{path.relative_to(ROOT)}: {found.group() if found else ''}"
