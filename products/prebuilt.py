"""What a release has compiled and a wheel brings: FMUs and kernels of its platform, and the live page, in a folder that
is only read.

A file of it serves as long as the sources here would make the same. Where no source has changed that is known at once;
else the C is generated, which takes seconds, and compared, so that nothing is compiled but what has changed.
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
#: What makes files of FMUs.
MAKERS = ROOT / "fmu_src"
#: Pictures on the pages inside FMUs, and their icon.
PICTURES = Path(__file__).parent / "pictures"
#: What FMUs and kernels are made from.
SOURCES = ("readers", "fmu_src", "rbd_model", "brake_controller", "products")
#: The live page in the folder, and what it is made from.
PAGE = "live.html"
PAGE_SOURCES = (*SOURCES, "scenarios/live", "scenarios/web", "scenarios/reporting/motion.py")


def sources_here() -> str:
    """A name for the sources of FMUs and kernels as they are now."""
    return digest(*SOURCES)


def content_of(name: str) -> str:
    """A name for what an FMU of the registry is made from: its C with the runtime, what travels with it, and what makes
    files of these.
    """
    found = hashlib.sha256(guid_of(generate(model_of(name))).encode())
    found.update(repr([terminals_of(model_of(name)), set_files(name), experiments_of(name)]).encode())
    for source in (*sorted([*MAKERS.glob("*.py"), *MAKERS.glob("hosts/*.*")]), *sorted(PICTURES.glob("*.png"))):
        found.update(content(source))
    return found.hexdigest()[:24]


def write_contents(folder: Path, platform: str, names: list[str]) -> None:
    """Says in a folder for which platform its files are, from what they were made, and their checksums."""
    made = {"contents": {name: content_of(name) for name in names}, "page": digest(*PAGE_SOURCES)}
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != CONTENTS]
    sums = {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
    about = {"platform": platform, "sources": sources_here()} | made | {"files": sums}
    (folder / CONTENTS).write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")


def contents() -> dict:
    """What `write_contents` has said; nothing where no release has filled the folder, or what it said is damaged."""
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
    """Whether a file has a checksum, looked at once; size, changed [ns]: of the file, which is another one then."""
    return hashlib.sha256(path.read_bytes()).hexdigest() == checksum


def damaged() -> list[str]:
    """Files of the folder that are not as the release made them."""
    return [file for file in contents().get("files", {}) if shipped(file) is None]


def prebuilt(name: str, file: str) -> Path | None:
    """The file of an FMU of the registry that a release made: whole, and as the sources here would make it."""
    path = shipped(file)
    same = path and (prebuilt_from_these(file) or contents()["contents"].get(name) == content_of(name))
    return path if same else None


def prebuilt_from_these(file: str) -> Path | None:
    """A file that a release made from sources that are as they are here, which is known at once."""
    path = shipped(file)
    return path if path and contents().get("sources") == sources_here() else None


def prebuilt_page(name: str = PAGE) -> Path | None:
    """A live page that a release made, if it is whole and no source of it has changed."""
    return shipped(name) if contents().get("page") == digest(*PAGE_SOURCES) else None
