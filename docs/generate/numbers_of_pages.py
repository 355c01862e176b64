"""Updates marked numbers on the pages from measured values. --check only compares.

  python docs/generate/numbers_of_pages.py              the numbers of all pages, from docs/data/
  python docs/generate/numbers_of_pages.py --collect    first the cited rows, from results/ to docs/data/

A mark is a comment after a number, invisible on the page: `14<!--= contact-manchester | QUANTITY | .0f -->` is the row
of a scenario's summary.json, `10 000<!--= tests/test_rare.py | RUNS | -->` a constant of a test. Templates
(docs/generate/charts.py) name rows in the same words, `[[scenario | quantity | format]]`. A format with + keeps the
sign. Tests that run a cited
scenario compare its rows with the stored ones (tests/scenarios/test_scenarios.py).
"""

import json
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from charts import CHARTS, HERE, measured
from counts import PAGES, constant
from pages import DOCS, ROOT, write_or_check

from readers.documents import read_document, text_in

KEPT = DOCS / "data" / "numbers.json"
#: A number, and the mark behind it.
MARKED = re.compile(r"(?P<number>[+-]?\d+(?: \d{3})*(?:\.\d+)?(?:e-?\d+)?)<!--= (?P<mark>[^|]+\|[^|]+\|[^|]*?) ?-->")
TEMPLATE = re.compile(r"\[\[([^\]|]+\|[^\]|]+\|[^\]|]*)\]\]")


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


def marks() -> Iterator[Mark]:
    """Yield the marks of all pages and templates."""
    for page in PAGES:
        yield from (Mark.of(one["mark"]) for one in MARKED.finditer(page.read_text("utf-8")))
    for template in HERE.glob("*.in"):
        yield from (Mark.of(one) for one in TEMPLATE.findall(template.read_text("utf-8")))


def cited() -> dict[str, set[str]]:
    """Return rows by scenario that pages cite and that `make charts` does not store."""
    found: dict[str, set[str]] = {}
    for one in marks():
        if not one.of_a_test and one.source not in CHARTS:
            found.setdefault(one.source, set()).add(one.name)
    return found


def kept() -> dict[str, dict[str, float]]:
    """Return the measured rows by scenario."""
    return json.loads(KEPT.read_text("utf-8"))


def collect() -> None:
    """Store the rows that pages cite, of scenarios that have results; the others keep their stored rows."""
    found = {}
    for scenario, names in sorted(cited().items()):
        path = ROOT / "results" / scenario / "summary.json"
        rows = kept().get(scenario, {})
        if path.exists():
            summary = read_document(path)
            if text_in(summary, "scenario", f"{path}") != scenario:
                sys.exit(f"{path} must hold the results of {scenario}. Run {scenario} again.")
            rows = {row["quantity"]: row["simulated"] for row in summary["rows"]}
        found[scenario] = {name: rows[name] for name in sorted(names)}
    KEPT.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def values() -> dict[tuple[str, str], float]:
    """Return all stored rows, by scenario and quantity."""
    return measured()


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
        f"{scenario}: {one.name} was {then[one.name]:{one.form}}, and is {now[one.name]:{one.form}} now. "
        "Run docs/generate/numbers_of_pages.py --collect."
        for one in sorted(set(marks()))
        if one.source == scenario and one.name in now and one.name in then
        if abs(now[one.name] - then[one.name]) > half_a_unit(one, then[one.name])
    ]


def half_a_unit(one: Mark, value: float) -> float:
    """Return half a unit of the last digit on a page."""
    digits = one.printed(value).partition(".")[2]
    return 0.5 * 10.0 ** -len(digits) if "e" not in digits else 0.05 * abs(value)


def main(arguments: list[str]) -> int:
    """Write, or compare."""
    if "--collect" in arguments:
        collect()
    rows = values()
    return write_or_check({page: filled(page.read_text("utf-8"), rows) for page in map(Path, PAGES)}, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
