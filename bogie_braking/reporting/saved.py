"""Contents of a folder of results: runs and sweeps. Other folders are named and left unchanged."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bogie_braking.reporting.report import parted, verdict_of
from products.study.grid import LARGEST_GRID
from products.study.journal import JOURNAL
from readers.documents import (
    integer_in,
    is_number,
    list_in,
    mapping_in,
    member,
    number_in,
    read_document,
    text_in,
)
from readers.text import shown

#: Keys of a row that the pages show as text, and as a number or empty.
TEXTS, NUMBERS = ("quantity", "unit"), ("thesis", "simulated", "deviation")
#: Longest run of a scenario that is accepted [s]: a month.
LONGEST = 31 * 86400.0
#: Pages that show a run and a sweep, the best first.
RUN_PAGES, SWEEP_PAGES = ("report.html", "figure.png", "summary.json"), ("table.csv", "summary.json")


@dataclass(frozen=True)
class SavedRun:
    """A scenario's results, as in its summary.json; `link` is relative to the folder of all results."""

    name: str
    link: str
    rows: list[dict[str, Any]]
    wall_seconds: float

    @property
    def holds(self) -> bool | None:
        """Return whether all rows with limits pass; None: no row has a limit."""
        return verdict_of(row["holds"] for row in self.rows)

    @property
    def printed(self) -> list[dict[str, Any]]:
        """Return the rows for which the thesis reports a value, those with limits first."""
        judged, others = parted(self.rows, lambda row: row["holds"])
        return [row for row in [*judged, *others] if row["thesis"] is not None]


@dataclass(frozen=True)
class Sweep:
    """A table over a grid; `varied` describes the parameters."""

    name: str
    link: str
    varied: str
    points: int
    failed: int


@dataclass
class SavedResults:
    """Runs and sweeps of a folder; `skipped` has a message for each folder that is neither."""

    runs: list[SavedRun] = field(default_factory=list)
    sweeps: list[Sweep] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)


def results_in(out: Path) -> SavedResults:
    """Return the contents of a folder's subfolders.

    Those that begin with a dot are still being written and are skipped.
    """
    results = SavedResults()
    for folder in sorted(path for path in out.glob("[!.]*") if path.is_dir()):
        try:
            one = read(folder)
        except (OSError, ValueError) as error:
            results.skipped.append(f"{folder} is not shown: {str(error).removesuffix('.')}.")
            continue
        if isinstance(one, SavedRun):
            results.runs.append(one)
        else:
            results.sweeps.append(one)
    return results


def read(folder: Path) -> SavedRun | Sweep:
    """Return the contents of one folder."""
    path = folder / "summary.json"
    if not path.exists():
        raise ValueError(unfinished(folder))
    summary = read_document(path, path.name)
    swept = isinstance(summary, dict) and "sweep" in summary
    return sweep(folder, summary) if swept else run(folder, summary)


def wall_seconds(folder: Path) -> float | None:
    """Return the stored wall time of a scenario's last run [s], or None."""
    try:
        summary = read_document(folder / "summary.json", "summary.json")
        return number_in(summary, "wall_seconds", "summary.json", 0.0, LONGEST)
    except (OSError, ValueError):
        return None


def unfinished(folder: Path) -> str:
    """Return the reason why the summary is missing."""
    if (folder / JOURNAL).exists():
        return "its sweep has not come to its end, and the same command goes on from there"
    return "it has no summary.json, which a scenario and a sweep leave behind"


def run(folder: Path, summary: Mapping[str, Any]) -> SavedRun:
    """Return a scenario's results. Raises ValueError if an entry is not as `report.save` writes it."""
    name = text_in(summary, "scenario", "summary.json")
    rows = list_in(summary, "rows", "summary.json")
    for number, row in enumerate(rows, 1):
        check_row(row, f"summary.json, row {number}")
    wall = number_in(summary, "wall_seconds", "summary.json", 0.0, LONGEST)
    return SavedRun(name, link(folder, RUN_PAGES), rows, wall)


def check_row(row: Any, what: str) -> None:
    """Raise ValueError if a row is not a comparison, or if deviation or verdict do not follow from its numbers."""
    for key in TEXTS:
        text_in(row, key, what)
    for key in NUMBERS:
        if member(row, key, what) is not None:
            number_in(row, key, what)
    thesis, simulated, deviation = (row[key] for key in NUMBERS)
    expected = None if thesis is None or simulated is None else simulated - thesis
    if deviation != expected:  # a double of the same two doubles
        raise ValueError(f"{what}: deviation must be simulated less thesis, {expected}; got {deviation}.")
    holds, due = member(row, "holds", what), verdict(row, what)
    if holds is not due:
        raise ValueError(f"{what}: holds must be {shown(due)} by its limits; got {shown(holds)}.")


def verdict(row: Mapping[str, Any], what: str) -> bool | None:
    """Return whether a saved row is within its own limits; None if it has none."""
    limits = member(row, "limits", what)
    if limits is None:
        return None
    if not (isinstance(limits, list) and len(limits) == 2 and all(x is None or is_number(x) for x in limits)):
        raise ValueError(f"{what}: limits must be two numbers, each of which may be null; got {shown(limits)}.")
    least, most = (end if x is None else x for x, end in zip(limits, (-math.inf, math.inf), strict=True))
    return row["simulated"] is not None and least <= row["simulated"] <= most


def sweep(folder: Path, summary: Mapping[str, Any]) -> Sweep:
    """Return a sweep's results. Raises ValueError if an entry is not as `write_table` writes it."""
    what = "summary.json"
    vary, units = mapping_in(summary, "vary", what), mapping_in(summary, "units", what)
    for name, given in vary.items():
        if not (isinstance(given, list) and given and all(map(is_number, given))):
            raise ValueError(f"{what}: vary {name} must be a list of numbers; got {shown(given)}.")
    points = integer_in(summary, "points", what, 1, LARGEST_GRID)
    if points != (due := math.prod(map(len, vary.values()))):
        raise ValueError(f"{what}: points must be those of its grid, {due}; got {points}.")
    failed = integer_in(summary, "failed", what, 0, points)
    varied = ", ".join(values(name, text_in(units, name, what), given) for name, given in vary.items())
    return Sweep(text_in(summary, "sweep", what), link(folder, SWEEP_PAGES), varied, points, failed)


def link(folder: Path, pages: Sequence[str]) -> str:
    """Return the link to the best of the pages that exist; summary.json does."""
    return f"{folder.name}/{next(name for name in pages if (folder / name).exists())}"


def values(name: str, unit: str, given: Sequence[float]) -> str:
    """Return the values of a parameter as text."""
    few = ", ".join(f"{value:g}" for value in given)
    many = f"{len(given)} values from {given[0]:g} to {given[-1]:g}"
    return f"{name} {few if len(given) < 4 else many} {unit if unit != '1' else ''}".rstrip()
