"""Page of a benchmark, one file with its figure; its tables as text, CSV and JSON."""

from __future__ import annotations

import base64
import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from readers.storage import write_whole, writing
from scenarios.benchmark.picture import picture
from scenarios.benchmark.programs import Program
from scenarios.benchmark.score import Scored, rows_of
from scenarios.benchmark.words import HEADS, columns, rows_of_cost, rows_of_table, sentence
from scenarios.reporting.plots import plt
from scenarios.web.frame import filled

#: Files that a benchmark writes.
PAGE, PICTURE, TABLE, DOCUMENT = "benchmark.html", "benchmark.png", "benchmark.csv", "benchmark.json"


def text_of(scored: Sequence[Scored], programs: Sequence[Program], missing: Mapping[str, str]) -> str:
    """Return tables of errors and cost as text, and why a program gave no answers."""
    names = [one.name for one in programs]
    lines = [*columns((*HEADS, *names), rows_of_table(scored, names)), ""]
    lines += columns(("processor time of a point", *names), rows_of_cost(scored, names))
    notes = notes_of(scored, missing)
    lines += ["", *notes] if notes else []
    return "\n".join([*lines, "", sentence(scored, names[0])])


def notes_of(scored: Sequence[Scored], missing: Mapping[str, str]) -> list[str]:
    """Return why programs are missing, or failed."""
    failed = [f"{name} failed on {one.case.name}, {why}" for one in scored for name, why in one.failures.items()]
    return [f"{name} is missing: {why}" for name, why in missing.items()] + failed


def write_results(
    scored: Sequence[Scored], programs: Sequence[Program], missing: Mapping[str, str], folder: Path
) -> list[Path]:
    """Write page, figure, table and document into a folder and return their paths. Raises StorageError."""
    figure, memory = picture(scored, [one.name for one in programs]), io.BytesIO()
    figure.savefig(memory, format="png", dpi=110)
    plt.close(figure)
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    whole = {
        PAGE: page(scored, programs, missing, memory.getvalue()).encode(),
        PICTURE: memory.getvalue(),
        TABLE: table_of(scored).encode(),
        DOCUMENT: json.dumps(document(scored, programs, missing), indent=2).encode(),
    }
    for name, data in whole.items():
        write_whole(folder / name, data)
    return [folder / name for name in whole]


def page(scored: Sequence[Scored], programs: Sequence[Program], missing: Mapping[str, str], png: bytes) -> str:
    """Return the text of the page."""
    names = [one.name for one in programs]
    return filled(
        "benchmark.html.jinja",
        title="Benchmark of braking",
        headline=sentence(scored, names[0]),
        heads=(*HEADS, *names),
        rows=rows_of_table(scored, names),
        costs=rows_of_cost(scored, names),
        programs=programs,
        scored=scored,
        notes=notes_of(scored, missing),
        png=base64.b64encode(png).decode(),
    )


def table_of(scored: Sequence[Scored]) -> str:
    """Return a CSV table with a row for each point, answer and program; an empty cell where there is no value."""
    memory = io.StringIO()
    rows = list(rows_of(scored))
    writer = csv.DictWriter(memory, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return memory.getvalue()


def document(scored: Sequence[Scored], programs: Sequence[Program], missing: Mapping[str, str]) -> dict[str, Any]:
    """Return scores as a document: errors relative or in SI units, None for a dash."""
    return {
        "programs": {one.name: one.version for one in programs},
        "missing": dict(missing),
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
            for one in scored
            for each in one.scores
        ],
        "failures": {one.case.name: one.failures for one in scored if one.failures},
    }
