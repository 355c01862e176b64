"""Compiled files of a release in a wheel: FMUs and kernels of its platform, and the live page, in a read-only folder.

A file is valid as long as the present sources would make the same. If no source has changed, this is known at once. If
one has, the C is generated, which takes seconds, and compared: only changed files are compiled.
"""

import hashlib
import json
from functools import cache
from pathlib import Path

from fmu_src.codegen import generate, guid_of
from products.experiments import experiments_of
from products.parameter_sets import set_files
from products.registry import model_of
from products.sources import PREBUILT, ROOT, content, digest
from products.terminals import terminals_of
from readers.documents import read_document

CONTENTS = "contents.json"
#: Source of the makers of FMU files.
MAKERS = ROOT / "fmu_src"
#: Figures on the pages inside FMUs, and their icon.
PICTURES = Path(__file__).parent / "pictures"
#: Sources of FMUs and kernels.
SOURCES = ("readers", "fmu_src", "rbd_model", "brake_controller", "products")
#: The live page in the folder, and its sources.
PAGE = "live.html"
PAGE_SOURCES = (*SOURCES, "bogie_braking/live", "bogie_braking/web", "bogie_braking/reporting/motion.py")


def sources_here() -> str:
    """A name for the sources of FMUs and kernels as they are now."""
    return digest(*SOURCES)


def content_of(name: str) -> str:
    """Return a name for the content of an FMU of the registry: its C and runtime, its further files, and its makers."""
    found = hashlib.sha256(guid_of(generate(model_of(name))).encode())
    found.update(repr([terminals_of(model_of(name).variables), set_files(name), experiments_of(name)]).encode())
    for source in (*sorted([*MAKERS.glob("*.py"), *MAKERS.glob("hosts/*.*")]), *sorted(PICTURES.glob("*.png"))):
        found.update(content(source))
    return found.hexdigest()[:24]


def write_contents(folder: Path, platform: str, names: list[str]) -> None:
    """Write the platform, the sources and the checksums of the files of a folder into it."""
    made = {"contents": {name: content_of(name) for name in names}, "page": digest(*PAGE_SOURCES)}
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != CONTENTS]
    sums = {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
    about = {"platform": platform, "sources": sources_here()} | made | {"files": sums}
    (folder / CONTENTS).write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")


def contents() -> dict:
    """Return the contents that `write_contents` wrote; empty without a release, or if they are damaged."""
    file = PREBUILT / CONTENTS
    try:
        about = read_document(file)
    except (OSError, ValueError):
        return {}
    good = isinstance(about, dict) and isinstance(about.get("contents"), dict) and isinstance(about.get("files"), dict)
    return about if good else {}


def shipped(file: str) -> Path | None:
    """A file of the folder that is as the release made it."""
    path, about = PREBUILT / file, contents()
    try:
        now = path.stat()
        return path if _same(path, about.get("files", {}).get(file, ""), now.st_size, now.st_mtime_ns) else None
    except OSError:
        return None


@cache
def _same(path: Path, checksum: str, size: int, changed: int) -> bool:
    """Return whether a file has a checksum, computed once; size, changed [ns]: of the file, which identify it."""
    return hashlib.sha256(path.read_bytes()).hexdigest() == checksum


def damaged() -> list[str]:
    """Return the files of the folder that differ from the release."""
    return [file for file in contents().get("files", {}) if shipped(file) is None]


def prebuilt(name: str, file: str) -> Path | None:
    """The file of an FMU of the registry that a release made: whole, and as the sources here would make it."""
    path = shipped(file)
    same = path and (prebuilt_from_these(file) or contents()["contents"].get(name) == content_of(name))
    return path if same else None


def prebuilt_from_these(file: str) -> Path | None:
    """Return a file that a release made from the present sources, or None if a source has changed."""
    path = shipped(file)
    return path if path and contents().get("sources") == sources_here() else None


def prebuilt_page(name: str = PAGE) -> Path | None:
    """A live page that a release made, if it is whole and no source of it has changed."""
    return shipped(name) if contents().get("page") == digest(*PAGE_SOURCES) else None
