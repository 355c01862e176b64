"""Writes generated pages, or compares them."""

import sys
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"


def write_or_check(pages: Mapping[Path, str], arguments: list[str]) -> int:
    """Write each text into its file; with --check only compare. Return 1, with a message, for an outdated page."""
    wrong = {path: text for path, text in pages.items() if not path.exists() or path.read_text("utf-8") != text}
    for path, text in wrong.items():
        if "--check" in arguments:
            print(f"{path.relative_to(ROOT)} is not what it is made from: run make pages.", file=sys.stderr)
        else:
            path.write_text(text, encoding="utf-8")
    return 1 if wrong and "--check" in arguments else 0
