"""Updates numbers of tests and scenarios in the text of pages. --check only compares.

A phrase of `PHRASES` marks a number on any page; the number before it is replaced.
"""

import ast
import json
import re
import sys
from typing import Any

from pages import DOCS, ROOT, write_or_check

PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted(DOCS.glob("*.md"))]
STATES = "tests/thesis/test_against_kernel.py"
CALLS = "tests/fmu/test_state_machine.py"
#: The scenario that measured a small slip error, and its quantity [%].
SLIP = "planar: largest error of peak slip of the trailing wheelset, no lock-up"
#: A number in the text, its thousands parted.
NUMBER = r"\d+(?: \d{3})*"


def constant(file: str, name: str) -> Any:
    """Return the value of a constant of a test. Raises KeyError if it does not exist."""
    for node in ast.parse((ROOT / file).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign):
            (target,) = node.targets
            names = target.elts if isinstance(target, ast.Tuple) else [target]
            values = (
                node.value.elts if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple) else [node.value]
            )
            for one, value in zip(names, values, strict=False):
                if isinstance(one, ast.Name) and one.id == name:
                    return ast.literal_eval(value)
    raise KeyError(f"{file} has no constant {name}, which docs/generate/counts.py puts into the pages.")


def slip_that_is_missing() -> float:
    """Return the share of its slip that the planar level leaves out [%]."""
    rows = json.loads((DOCS / "data" / "levels.json").read_text(encoding="utf-8"))["rows"]
    return next(float(row["simulated"]) for row in rows if row["quantity"] == SLIP)


#: The words behind a number, and its value.
PHRASES = {
    "random states on straight track": sum(constant(STATES, "STATES").values()),
    "calls each": constant(CALLS, "SHORT"),
    "by `make test-long`": constant(CALLS, "LONG"),
    "% small": round(slip_that_is_missing()),
}


def filled(text: str) -> str:
    """A page with its numbers."""
    for words, value in PHRASES.items():
        behind = r"\s+".join(map(re.escape, words.split()))
        number = f"{value:,}".replace(",", " ") if value >= 10_000 else str(value)
        text = re.sub(rf"\b{NUMBER}(?=\s+{behind})", number, text)
    return text


if __name__ == "__main__":
    sys.exit(write_or_check({page: filled(page.read_text(encoding="utf-8")) for page in PAGES}, sys.argv[1:]))
