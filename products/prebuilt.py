"""What a release has compiled and a wheel brings: FMUs and kernels of its platform, and the live page, in a folder that
is only read.

A file of it serves as long as the sources here would make the same. Where no source has changed that is known at once;
else the C is generated, which takes seconds, and compared, so that nothing is compiled but what has changed.
"""

import hashlib
import json
from pathlib import Path

from fmu_src.codegen import generate, guid_of
from products.experiments import experiments_of
from products.parameter_sets import set_files
from products.registry import model_of
from products.sources import PREBUILT, ROOT, content, digest
from products.terminals import terminals_of

CONTENTS = "contents.json"
#: What makes files of FMUs.
MAKERS = ROOT / "fmu_src"
#: Pictures on the pages inside FMUs, and their icon.
PICTURES = Path(__file__).parent / "pictures"
#: What FMUs and kernels are made from.
SOURCES = ("readers", "fmu_src", "rbd_model", "brake_controller", "products")
#: The live page in the folder, and what it is made from.
PAGE = "live.html"
PAGE_SOURCES = (*SOURCES, "scenarios/live", "scenarios/reporting/motion.py", "scenarios/reporting/page/canvas.js")


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
    """Says in a folder for which platform its files are, and from what they were made."""
    made = {"contents": {name: content_of(name) for name in names}, "page": digest(*PAGE_SOURCES)}
    about = {"platform": platform, "sources": sources_here()} | made
    (folder / CONTENTS).write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")


def contents() -> dict:
    """What `write_contents` has said; nothing where no release has filled the folder."""
    file = PREBUILT / CONTENTS
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def prebuilt(name: str, file: str) -> Path | None:
    """The file of an FMU of the registry that a release made, if the sources here would make the same."""
    path, about = PREBUILT / file, contents()
    if not about or not path.exists():
        return None
    same = about["sources"] == sources_here() or about["contents"][name] == content_of(name)
    return path if same else None


def prebuilt_page(name: str = PAGE) -> Path | None:
    """A live page that a release made, if no source of it has changed."""
    same = contents().get("page") == digest(*PAGE_SOURCES)
    return PREBUILT / name if same else None
