"""Which equations and which code these are: digests of source files, in the checkout or in an installed package."""

import hashlib
import platform
from collections.abc import Collection
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

from fmu_src import __version__
from readers.extras import has

ROOT = Path(__file__).resolve().parents[1]
#: The public package, which in a wheel has all others inside.
PUBLIC = "bogie_braking"
#: The packages of a wheel next to `bogie_braking`; each may import those before it, scenarios also `bogie_braking`.
ROOMS = ("readers", "fmu_src", "rbd_model", "brake_controller", "products", "scenarios")
#: All packages with the public API.
HOUSE = (*ROOMS, PUBLIC)
#: Kinds of source files that affect results; and with further files of FMUs and pages.
CODE = {".py", ".c", ".h"}
KINDS = CODE | {".cpp", ".cs", ".png", ".js", ".css", ".jinja", ".npz", ".toml"}
#: Compiled files of a release, empty in a checkout; `make release` fills it in wheels.
PREBUILT = ROOT / "products" / "prebuilt"


def digest(*places: str, kinds: Collection[str] = KINDS) -> str:
    """Return a digest of the sources of some kinds in folders, and of files, by their paths from the root."""
    found = hashlib.sha256()
    for path in sorted((path for place in places for path in _sources(_place(place), kinds)), key=_name):
        found.update(_name(path).encode())
        found.update(content(path))
    return found.hexdigest()[:24]


def content(path: Path) -> bytes:
    """Return the content of a source file, equal in a checkout and in a wheel, where all packages are in one."""
    return path.read_bytes().replace(b"from bogie_braking.", b"from ") if path.suffix == ".py" else path.read_bytes()


def sources() -> str:
    """Return a digest of all equations, scenarios and C sources; results of two digests share no table.

    Layout of results, figures and styles of pages do not change it. It is equal in a checkout and in a wheel of it.
    """
    return digest(*HOUSE, kinds=CODE)


#: The digest at the first call in this process, whose modules are those of then.
sources_of_process = lru_cache(maxsize=1)(sources)


def _sources(place: Path, kinds: Collection[str]) -> list[Path]:
    found = [place] if place.is_file() else [path for path in place.rglob("*") if path.suffix in kinds]
    others = [PREBUILT, *((ROOT / name for name in (*ROOMS, "build_fmu.py")) if place == ROOT else ())]
    return [path for path in found if not any(path.is_relative_to(other) for other in others)]


def _place(name: str) -> Path:
    if ROOT.name == PUBLIC and name == PUBLIC:  # in a wheel the public package has all others inside
        return ROOT
    return ROOT.parent / name if ROOT.name == PUBLIC and name.startswith(f"{PUBLIC}/") else ROOT / name


def _name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix().removeprefix(f"{PUBLIC}/")


def versions() -> dict[str, str]:
    """Return the versions of the installed packages that determine a result."""
    packages = ["casadi", "fmpy", "matplotlib", "numpy", "pythonfmu", "scipy", "ziglang"]
    return {"bogie-braking": __version__, "python": platform.python_version()} | {
        name: version(name) for name in packages if has(name)
    }
