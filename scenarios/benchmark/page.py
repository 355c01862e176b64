"""Page of a benchmark, one file with its figures; its tables as text, CSV and JSON."""

from __future__ import annotations

import base64
import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bogie_braking.reporting.plots import png_of
from bogie_braking.web.frame import filled
from readers.storage import write_whole, writing
from scenarios.benchmark.band import Band
from scenarios.benchmark.picture import figure_of_bands, figure_of_errors, figures_over_two_inputs
from scenarios.benchmark.programs import Program
from scenarios.benchmark.score import Scored, rows_of
from scenarios.benchmark.words import (
    HEADS,
    RANGES,
    columns,
    rows_of_bands,
    rows_of_cost,
    rows_of_points,
    rows_of_table,
    sentence,
)

#: Files that a benchmark writes.
PAGE, PICTURE, TABLE, DOCUMENT = "benchmark.html", "benchmark.png", "benchmark.csv", "benchmark.json"


@dataclass(frozen=True)
class Results:
    """Scores of all cases, the programs, the reasons of missing ones, and ranges of this project's answers."""

    scored: Sequence[Scored]
    programs: Sequence[Program]
    missing: Mapping[str, str]
    ranges: Sequence[Band] = ()

    @property
    def names(self) -> list[str]:
        """Names of the programs."""
        return [program.name for program in self.programs]

    @property
    def notes(self) -> list[str]:
        """Why programs are missing, or failed."""
        failed = [
            f"{name} failed on {one.case.name}, {why}" for one in self.scored for name, why in one.failures.items()
        ]
        return [f"{name} is missing: {why}" for name, why in self.missing.items()] + failed


def text_of(results: Results) -> str:
    """Return tables of errors, cost and ranges as text, and why a program gave no answers."""
    names, scored = results.names, results.scored
    lines = [*columns((*HEADS, *names), rows_of_table(scored, names)), ""]
    lines += [*columns(("processor time of a point", *names), rows_of_cost(scored, names)), ""]
    if results.ranges:
        lines += [*columns(RANGES, rows_of_bands(results.ranges)), ""]
    if results.notes:
        lines += [*results.notes, ""]
    return "\n".join([*lines, sentence(scored, names[0])])


def write_results(results: Results, folder: Path) -> list[Path]:
    """Write page, figure, table and document into a folder and return their paths. Raises StorageError."""
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    png = png_of(figure_of_errors(results.scored, results.names))
    whole = {
        PAGE: page(results, png).encode(),
        PICTURE: png,
        TABLE: table_of(results.scored).encode(),
        DOCUMENT: json.dumps(document(results), indent=2).encode(),
    }
    for name, data in whole.items():
        write_whole(folder / name, data)
    return [folder / name for name in whole]


def page(results: Results, png: bytes) -> str:
    """Return the text of the page."""
    names = results.names
    pictures = {
        name: _text(png_of(figure)) for name, figure in figures_over_two_inputs(results.scored, names[0]).items()
    }
    return filled(
        "benchmark.html.jinja",
        title="Benchmark of braking",
        headline=sentence(results.scored, names[0]),
        heads=(*HEADS, *names),
        rows=rows_of_table(results.scored, names),
        costs=rows_of_cost(results.scored, names),
        range_heads=RANGES,
        ranges=rows_of_bands(results.ranges),
        range_picture=_text(png_of(figure_of_bands(results.ranges))) if results.ranges else "",
        programs=results.programs,
        scored=results.scored,
        points={one.case.name: rows_of_points(one) for one in results.scored},
        pictures=pictures,
        notes=results.notes,
        png=_text(png),
    )


def _text(png: bytes) -> str:
    return base64.b64encode(png).decode()


def table_of(scored: Sequence[Scored]) -> str:
    """Return a CSV table with a row for each point, answer and program; an empty cell where there is no value."""
    memory = io.StringIO()
    rows = list(rows_of(scored))
    writer = csv.DictWriter(memory, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return memory.getvalue()


def document(results: Results) -> dict[str, Any]:
    """Return scores and ranges as a document: errors relative or in SI units, None for a dash."""
    return {
        "programs": {program.name: program.version for program in results.programs},
        "missing": dict(results.missing),
        "scores": [
            {
                "case": one.case.name,
                "answer": each.answer.name,
                "program": each.program,
                "points": each.points,
                "answered": len(each.errors),
                "relative": each.answer.relative,
                "judged": each.answer.judged,
                "bound": each.answer.bound,
                "worst": each.worst,
                "rms": each.rms,
                "holds": each.holds,
                "cost": each.cost,
            }
            for one in results.scored
            for each in one.scores
        ],
        "ranges": [
            {
                "case": one.case.name,
                "point": one.number,
                "answer": one.answer.name,
                **{name: getattr(one, name) for name in ("published", "value", "lower", "median", "upper")},
                "draws": one.draws,
                "answered": one.answered,
            }
            for one in results.ranges
        ],
        "failures": {one.case.name: one.failures for one in results.scored if one.failures},
    }
