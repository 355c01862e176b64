"""The files of a release on the site: what `make release` left in dist/, with sizes and checksums."""

import hashlib
import re
from pathlib import Path

from pages import ROOT

DIST = ROOT / "dist"
#: Of docs/downloads.md, what stands here in its place where there is a release.
PLACE = re.compile(r"<!-- files: begin -->.*<!-- files: end -->", re.DOTALL)


def files() -> list[Path]:
    """What the release consists of; nothing where none was made."""
    return sorted(path for path in DIST.iterdir() if path.is_file()) if DIST.is_dir() else []


def filled(page: str) -> str:
    """The page with a link to each file of the release; as it is where there is none."""
    found = files()
    if not found:
        return page
    rows = [f"| [{path.name}](downloads/{path.name}) | {size(path)} | `{checksum(path)}` |" for path in found]
    return PLACE.sub(lambda _: "\n".join(["| file | size | SHA-256 |", "|---|---|---|", *rows]), page)


def size(path: Path) -> str:
    """Of a file, in kB or MB."""
    count = path.stat().st_size
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.1f} kB"


def checksum(path: Path) -> str:
    """SHA-256 of a file, as SHA256SUMS has it."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
