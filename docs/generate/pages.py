"""Write the pages with their generated tables into build/pages/: `make pages`. The site fills the same pages.

A line `<!-- generated: NAME -->` on a page is replaced by the text that `generated()` in docs/generate/NAME.py returns.
"""

import importlib
import re
import sys
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
MARK = re.compile(r"^<!-- generated: (\w+) -->$", re.MULTILINE)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in [heads, ["---"] * len(heads), *rows])


def filled(page: str, without: Collection[str] = ()) -> str:
    """Return a page with its generated parts, except for the named ones."""
    return MARK.sub(lambda mark: mark[0] if mark[1] in without else generated(mark[1]), page)


def generated(name: str) -> str:
    """Return the part that a file of this folder generates."""
    text: str = importlib.import_module(name).generated()
    return text.strip("\n")


def main() -> int:
    folder = ROOT / "build" / "pages"
    folder.mkdir(parents=True, exist_ok=True)
    for path in sorted(DOCS.glob("*.md")):
        text = path.read_text(encoding="utf-8")
        if MARK.search(text):
            (folder / path.name).write_text(filled(text), encoding="utf-8")
            print(folder / path.name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
