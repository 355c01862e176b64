"""Update marked numbers on the pages from measured values. --check only compares.

  python docs/generate/numbers_of_pages.py              the numbers of all pages, from docs/data/
  python docs/generate/numbers_of_pages.py --collect    first the cited rows and the figures of CHARTS, from results/

A mark is a comment after a number, invisible on the page: `14<!--= contact-manchester | QUANTITY | .0f -->` is a row
of a scenario's summary.json, `10 000<!--= tests/bogie_braking/test_rare.py | RUNS | -->` a constant of a test. A format
with + keeps the sign. Tests that run a cited scenario compare its rows with the stored ones
(tests/scenarios/test_scenarios.py).
"""

import ast
import json
import re
import shutil
import sys
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from pages import DOCS, ROOT

PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
DATA = DOCS / "data"
#: Scenarios of `make charts`: their figures and summaries are stored in docs/.
CHARTS = (
    *("speed-accuracy", "throughput", "stability-atlas", "coupling-step", "levels", "levels-in-curves"),
    *("contact-model", "thesis-step", "train-brake-evidence"),
)
#: Rows of the other scenarios.
KEPT = DATA / "numbers.json"
#: A number, and the mark behind it.
MARKED = re.compile(r"(?P<number>[+-]?\d+(?: \d{3})*(?:\.\d+)?(?:e-?\d+)?)<!--= (?P<mark>[^|]+\|[^|]+\|[^|]*?) ?-->")


class Mark(NamedTuple):
    """Source of a number: scenario or file of a test, row or constant, and format."""

    source: str
    name: str
    form: str

    @classmethod
    def of(cls, text: str) -> "Mark":
        """Return the mark of the words between bars."""
        return cls(*(part.strip() for part in text.split("|")))

    @property
    def of_a_test(self) -> bool:
        """True if it is a constant of a test."""
        return self.source.endswith(".py")

    def printed(self, value: Any) -> str:
        """Return the number as pages have it, with a sign if the format begins with +."""
        if self.form.startswith("+"):
            text = format(value, self.form)
            return text if text.strip("+-0.") else text[1:]
        text = format(abs(value), self.form)
        return f"{abs(value):,}".replace(",", " ") if not self.form and abs(value) >= 10_000 else text


def constant(file: str, name: str) -> Any:
    """Return the value of a constant of a test. Raises KeyError if it does not exist."""
    for node in ast.parse((ROOT / file).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign):
            target = ast.unparse(node.targets[0]).strip("()").split(", ")
            if name in target:
                value = ast.literal_eval(node.value)
                return value if len(target) == 1 else value[target.index(name)]
    raise KeyError(f"{file} has no constant {name}, which a page cites.")


def marks() -> Iterator[Mark]:
    """Yield the marks of all pages."""
    for page in PAGES:
        yield from (Mark.of(one["mark"]) for one in MARKED.finditer(page.read_text("utf-8")))


def kept() -> dict[str, dict[str, float]]:
    """Return the measured rows by scenario, except those of CHARTS."""
    return json.loads(KEPT.read_text("utf-8"))


def collect() -> None:
    """Store the rows that pages cite of scenarios that have results, and figures and summaries of CHARTS."""
    rows, found = kept(), dict[str, dict[str, float]]()
    for mark in marks():
        folder = ROOT / "results" / mark.source
        if mark.of_a_test or (mark.source not in CHARTS and mark.source in found):
            continue
        summary = json.loads((folder / "summary.json").read_text("utf-8")) if folder.exists() else None
        if mark.source in CHARTS and summary:
            shutil.copyfile(folder / "figure.png", DOCS / "pictures" / f"{mark.source}.png")
            names = ("scenario", "rows", "pictures", "remarks", "versions", "wall_seconds")
            text = json.dumps({name: summary[name] for name in names}, indent=1)
            (DATA / f"{mark.source}.json").write_text(text + "\n", encoding="utf-8")
        elif mark.source not in CHARTS:
            cited = sorted({other.name for other in marks() if other.source == mark.source})
            now = {row["quantity"]: row["simulated"] for row in summary["rows"]} if summary else rows[mark.source]
            found[mark.source] = {name: now[name] for name in cited}
    KEPT.write_text(json.dumps(dict(sorted(found.items())), indent=1) + "\n", encoding="utf-8")


def values() -> dict[tuple[str, str], float]:
    """Return all stored rows, by scenario and quantity."""
    found = {(name, quantity): value for name, rows in kept().items() for quantity, value in rows.items()}
    for name in CHARTS:
        summary = json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))
        found[name, "wall_seconds"] = summary["wall_seconds"]
        found |= {(name, row["quantity"]): row["simulated"] for row in summary["rows"]}
    return found


def filled(text: str, rows: Mapping[tuple[str, str], float]) -> str:
    """Return a page with its numbers. Raises KeyError if a row or a constant does not exist."""

    def number(match: re.Match[str]) -> str:
        one = Mark.of(match["mark"])
        value = constant(one.source, one.name) if one.of_a_test else rows[one.source, one.name]
        return one.printed(value) + match[0][len(match["number"]) :]

    return MARKED.sub(number, text)


def moved(scenario: str, rows: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a message for each cited row of a run whose number on the page would differ from the stored one.

    A value at the edge between two numbers may differ by half a unit of the last digit.
    """
    then, now = kept().get(scenario, {}), {row["quantity"]: row["simulated"] for row in rows}
    return [
        f"{scenario}: {mark.name} was {then[mark.name]:{mark.form}}, and is {now[mark.name]:{mark.form}} now. "
        "Run docs/generate/numbers_of_pages.py --collect."
        for mark in sorted(set(marks()))
        if mark.source == scenario and mark.name in now and mark.name in then
        if abs(now[mark.name] - then[mark.name]) > half_a_unit(mark, then[mark.name])
    ]


def half_a_unit(one: Mark, value: float) -> float:
    """Return half a unit of the last digit on a page."""
    digits = one.printed(value).partition(".")[2]
    return 0.5 * 10.0 ** -len(digits) if "e" not in digits else 0.05 * abs(value)


def main(arguments: list[str]) -> int:
    """Write, or compare: return 1, with a message, for a page with other numbers."""
    if "--collect" in arguments:
        collect()
    rows, wrong = values(), 0
    for page in PAGES:
        old = page.read_text("utf-8")
        new = filled(old, rows)
        if new != old and "--check" in arguments:
            print(f"{page.relative_to(ROOT)} has numbers other than measured: run make pages.", file=sys.stderr)
            wrong = 1
        elif new != old:
            page.write_text(new, encoding="utf-8")
    return wrong


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
