"""Tables of docs/benchmark.md from docs/data/benchmark.json and the cases.

  python -m bogie_braking benchmark --json > results/benchmark.json
  python -m bogie_braking benchmark NAMES --range --json > results/ranges.json       cases with unknown inputs
  python docs/generate/benchmark.py --collect results/benchmark.json results/ranges.json    into docs/data/

The scores are those of one run with all peers. tests/scenarios/test_benchmark.py compares some of them.
"""

import json
import sys
from pathlib import Path
from typing import Any

from pages import DOCS, table

from readers.documents import read_document
from scenarios.benchmark.case import BenchmarkCase
from scenarios.benchmark.case_file import CASES, cases_in, read_case
from scenarios.benchmark.score import Score
from scenarios.benchmark.words import DASH, bound, published, size, time

KEPT = DOCS / "data" / "benchmark.json"
#: Entries of a score that are kept, and the digits of their numbers.
ENTRIES, DIGITS = ("case", "answer", "program", "points", "answered", "worst", "rms", "holds", "cost"), 4


def collect(source: Path, with_ranges: Path) -> None:
    """Write the scores of a run, and the ranges of another, into docs/data/."""
    read, ranges = read_document(source), dict[str, list[int]]()
    for one in read_document(with_ranges)["ranges"]:
        if one["lower"] is not None:
            counts = ranges.setdefault(one["case"], [0, 0, one["draws"]])
            counts[0] += one["lower"] <= one["published"] <= one["upper"]
            counts[1] += 1
    scores = [{name: shortened(one[name]) for name in ENTRIES} for one in read["scores"] if one["worst"] is not None]
    lines = ",\n".join(json.dumps(score) for score in scores)
    programs = json.dumps(read["programs"])
    head = f'{{"programs": {programs},\n"ranges": {json.dumps(ranges)},\n"scores": ['
    KEPT.write_text(f"{head}\n{lines}\n]}}\n", encoding="utf-8")


def shortened(value: Any) -> Any:
    """Return a number with a few digits."""
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def cell(case: BenchmarkCase, one: dict[str, Any] | None) -> str:
    """Return the largest error of a program, the root mean square of many, and the number of points with an answer."""
    if one is None:
        return DASH
    answer = case.answers[one["answer"]]
    score = Score(case, answer, one["program"], (), (), None)
    spread = f", rms {size(score, one['rms'])}" if one["answered"] > 20 else ""
    count = "" if one["answered"] == one["points"] else f" ({one['answered']} of {one['points']})"
    return size(score, one["worst"], "+") + spread + count + (" **!**" if one["holds"] is False else "")


def generated() -> str:
    """Return the tables of errors, of processor time, and of sources."""
    read = read_document(KEPT)
    cases = {name: read_case(path) for name, path in cases_in([CASES]).items()}
    programs, found = list(read["programs"]), {}
    for one in read["scores"]:
        found[one["case"], one["answer"], one["program"]] = one
    rows = []
    for name, case in cases.items():
        for answer in case.answers.values():
            told = tuple(point.published.get(answer.name) for point in case.points)
            score = Score(case, answer, programs[0], told, told, None)
            own = found.get((name, answer.name, programs[0]))
            cells = [cell(case, found.get((name, answer.name, program))) for program in programs]
            limit = bound(score) if answer.judged else "shown only"
            text = [f"`{name}`", answer.what, str(score.points), published(score), limit, *cells]
            rows.append((rank(case, own), text))
    rows.sort(key=lambda row: row[0])
    heads = ["case", "answer", "points", "published", "bound", *programs]
    costs = [[f"`{name}`", *(time(cost_of(found, name, program)) for program in programs)] for name in cases]
    sources = [[f"`{name}`", one.source, one.licence, one.sureness] for name, one in cases.items()]
    ranges = [
        [f"`{name}`", ", ".join(cases[name].unknown), f"{inside} of {total}", str(draws)]
        for name, (inside, total, draws) in read["ranges"].items()
    ]
    parts = [
        table(heads, [text for _, text in rows]),
        "Processor time of a point:",
        table(["case", *programs], costs),
        "Published values within 5 to 95 % of the answers, where inputs are drawn at random ([ranges](#ranges)):",
        table(["case", "random inputs", "in range", "draws"], ranges),
        "Sources:",
        table(["case", "source", "licence", "how sure"], sources),
    ]
    return "\n\n".join(parts) + "\n"


def rank(case: BenchmarkCase, own: dict[str, Any] | None) -> tuple[int, float]:
    """Return the place of a row: errors of this project beyond their bounds, shown ones, then the others by size."""
    if own is None:
        return 3, 0.0
    answer = case.answers[own["answer"]]
    if answer.bound is not None and answer.judged:
        return (2 if own["holds"] else 0), -abs(own["worst"]) / answer.bound
    return 1, -abs(own["worst"])


def cost_of(found: dict[Any, dict[str, Any]], case: str, program: str) -> float | None:
    """Return the processor time of a point [s]; None without an answer."""
    costs = [one["cost"] for (name, _, by), one in found.items() if (name, by) == (case, program)]
    return costs[0] if costs else None


if __name__ == "__main__":
    collect(*map(Path, sys.argv[sys.argv.index("--collect") + 1 :]))
