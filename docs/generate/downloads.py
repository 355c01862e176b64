"""The files of a release on the site: the contents of dist/ after `make release`, with sizes and checksums."""

import hashlib
import re
from pathlib import Path

from pages import ROOT, table

DIST = ROOT / "dist"
#: The part of docs/downloads.md that the table replaces if a release exists.
PLACE = re.compile(r"<!-- files: begin -->.*<!-- files: end -->", re.DOTALL)


def files() -> list[Path]:
    """Return the files of the release; empty without one."""
    return sorted(path for path in DIST.iterdir() if path.is_file()) if DIST.is_dir() else []


def filled(page: str) -> str:
    """Return the page with a link to each file of the release; without a release it is not changed."""
    found = files()
    if not found:
        return page
    rows = [(f"[{path.name}](downloads/{path.name})", size(path), f"`{checksum(path)}`") for path in found]
    return PLACE.sub(lambda _: table(("file", "size", "SHA-256"), rows), page)


def size(path: Path) -> str:
    """Return the size of a file in kB or MB."""
    count = path.stat().st_size
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.1f} kB"


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file, as in SHA256SUMS."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
