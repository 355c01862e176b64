"""What a folder of results holds: runs, sweeps, and what is neither, which is named and left as it is."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scenarios.reporting.report import parted, verdict_of
from scenarios.sweep.journal import JOURNAL

#: Keys of a row that the pages show as text, and as a number or nothing.
TEXTS, NUMBERS = ("quantity", "unit"), ("thesis", "simulated", "deviation")
#: What a run and a sweep are shown by, the best first.
RUN_PAGES, SWEEP_PAGES = ("report.html", "figure.png", "summary.json"), ("table.csv", "summary.json")


@dataclass(frozen=True)
class Run:
    """A scenario's results, as its summary.json tells them; `link` is relative to the folder of all results."""

    name: str
    link: str
    rows: list[dict[str, Any]]
    wall_seconds: float

    @property
    def holds(self) -> bool | None:
        """Whether all that is judged holds; None: nothing is judged."""
        return verdict_of(row["holds"] for row in self.rows)

    @property
    def printed(self) -> list[dict[str, Any]]:
        """Rows of which the thesis prints a value, those that are judged first."""
        judged, others = parted(self.rows, lambda row: row["holds"])
        return [row for row in [*judged, *others] if row["thesis"] is not None]


@dataclass(frozen=True)
class Sweep:
    """A table over a grid; `varied` is for people."""

    name: str
    link: str
    varied: str
    points: int
    failed: int


@dataclass
class Results:
    """Runs and sweeps of a folder; `skipped` has a sentence for each folder that is neither."""

    runs: list[Run] = field(default_factory=list)
    sweeps: list[Sweep] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)


def results_in(out: Path) -> Results:
    """What its folders hold. Those that begin with a dot are being written."""
    found = Results()
    for folder in sorted(path for path in out.glob("[!.]*") if path.is_dir()):
        try:
            one = read(folder)
        except (OSError, ValueError) as error:
            found.skipped.append(f"{folder} is not shown: {error}.")
            continue
        if isinstance(one, Run):
            found.runs.append(one)
        else:
            found.sweeps.append(one)
    return found


def read(folder: Path) -> Run | Sweep:
    """What one folder holds. Raises OSError or ValueError, whose text says what is amiss."""
    path = folder / "summary.json"
    if not path.exists():
        raise ValueError(unfinished(folder))
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"summary.json cannot be read ({error})") from error
    try:
        return sweep(folder, summary) if "sweep" in summary else run(folder, summary)
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"its summary.json is that of no scenario and no sweep ({error!r})") from error


def unfinished(folder: Path) -> str:
    """Why there is no summary."""
    if (folder / JOURNAL).exists():
        return "its sweep has not come to its end, and the same command goes on from there"
    return "it has no summary.json, which a scenario and a sweep leave behind"


def run(folder: Path, summary: Mapping[str, Any]) -> Run:
    """A scenario's results. Raises KeyError or TypeError where something is not as `report.save` writes it."""
    for number, row in enumerate(summary["rows"], 1):
        texts = all(isinstance(row[key], str) for key in TEXTS)
        numbers = all(row[key] is None or isinstance(row[key], float | int) for key in NUMBERS)
        if not (texts and numbers and row["holds"] in (True, False, None)):
            raise TypeError(f"row {number} is no comparison")
    return Run(str(summary["scenario"]), link(folder, RUN_PAGES), summary["rows"], float(summary["wall_seconds"]))


def sweep(folder: Path, summary: Mapping[str, Any]) -> Sweep:
    """A sweep's results. Raises LookupError, TypeError or ValueError where it is not as `write_table` writes it."""
    varied = ", ".join(values(name, summary["units"][name], given) for name, given in summary["vary"].items())
    points, failed = int(summary["points"]), int(summary["failed"])
    return Sweep(str(summary["sweep"]), link(folder, SWEEP_PAGES), varied, points, failed)


def link(folder: Path, pages: Sequence[str]) -> str:
    """To the best of the pages that is there; summary.json is."""
    return f"{folder.name}/{next(name for name in pages if (folder / name).exists())}"


def values(name: str, unit: str, given: Sequence[float]) -> str:
    """What a parameter was given, in words."""
    few = ", ".join(f"{value:g}" for value in given)
    many = f"{len(given)} values from {given[0]:g} to {given[-1]:g}"
    return f"{name} {few if len(given) < 4 else many} {unit if unit != '1' else ''}".rstrip()
