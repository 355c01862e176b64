"""Results of a scenario: a table of thesis against simulation, time series, figures, one JSON file."""

from __future__ import annotations

import math
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, SupportsFloat, TypeVar

from bogie_braking.provenance import encoded
from bogie_braking.reporting.motion import Motion
from bogie_braking.reporting.plots import message_of, plt
from bogie_braking.reporting.text_table import text_table
from fmu_src.cosimulation.provenance_text import KEY
from fmu_src.cosimulation.recording import Recording
from products.run_history import provenance_of
from products.sources import versions
from readers.documents import document_text
from readers.storage import cannot_write

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Bound:
    """Limits of a quantity for which the thesis reports no value, in its unit; `text` describes them."""

    least: float
    most: float
    text: str


def at_most(most: float) -> Bound:
    """Return an upper limit."""
    return Bound(-math.inf, most, f"<= {number(most)}")


def at_least(least: float) -> Bound:
    """Return a lower limit."""
    return Bound(least, math.inf, f">= {number(least)}")


def between(least: float, most: float) -> Bound:
    """Return a lower and an upper limit."""
    return Bound(least, most, f"{number(least)} to {number(most)}")


def near(value: float, band: float) -> Bound:
    """Return limits about a value that is not from the thesis: of theory, of another method, of another program."""
    return Bound(value - band, value + band, f"{number(value)} +- {number(band)}")


def rounding(printed: str) -> float:
    """Return half of the last digit of a published number, its rounding error."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


@dataclass(frozen=True)
class Row:
    """One comparison.

    thesis: the reported value only. asked: largest allowed distance from it in the unit of the quantity, which is its
    `rounding`; or a `Bound` if the thesis reports no value; or None for a row without a limit. A row has no limit if it
    depends on an unreported quantity, or if a parameter was fitted to it; `assumption` states the reason. vampire:
    value of VAMPIRE in the thesis, if any. The row then passes between the values of both programs, widened by the
    tolerance.
    """

    quantity: str
    unit: str
    thesis: float | None
    simulated: float | None
    asked: float | Bound | None
    source: str
    assumption: str = ""
    vampire: float | None = None

    @property
    def deviation(self) -> float | None:
        """Return the difference from the value that the thesis reports, or None."""
        if self.thesis is None or self.simulated is None:
            return None
        return self.simulated - self.thesis

    @property
    def holds(self) -> bool | None:
        """Return whether the value is within its limits; False if it is missing; None if the row has no limit."""
        limits = self.limits
        if limits is None:
            return None
        return self.simulated is not None and limits[0] <= self.simulated <= limits[1]

    @property
    def limits(self) -> tuple[float, float] | None:
        """Return the least and largest value that passes; None if the row has no limit."""
        if isinstance(self.asked, Bound):
            return self.asked.least, self.asked.most
        if self.thesis is None or self.asked is None:
            return None
        printed = [self.thesis, self.thesis if self.vampire is None else self.vampire]
        return min(printed) - self.asked, max(printed) + self.asked

    @property
    def asked_text(self) -> str:
        """Return the limits as text."""
        if isinstance(self.asked, Bound):
            return self.asked.text
        return "-" if self.limits is None else f"+- {number(self.asked)}"

    def as_dict(self) -> dict[str, Any]:
        """Return the row as in summary.json."""
        return {
            "quantity": self.quantity,
            "unit": self.unit,
            "thesis": self.thesis,
            "vampire": self.vampire,
            "simulated": self.simulated,
            "deviation": self.deviation,
            "asked": self.asked_text,
            "limits": None if self.limits is None else [x if math.isfinite(x) else None for x in self.limits],
            "source": self.source,
            "assumption": self.assumption,
            "holds": self.holds,
        }


def measured(
    quantity: str,
    unit: str,
    value: SupportsFloat | None,
    source: str = "",
    asked: Bound | None = None,
    assumption: str = "",
) -> Row:
    """Return a row of a quantity that the thesis does not report."""
    found = value if value is None or isinstance(value, int) else float(value)
    return Row(quantity, unit, None, found, asked, source, assumption)


Found = TypeVar("Found")


@dataclass(frozen=True)
class Measure(Generic[Found]):
    """A measured quantity of each run: name, unit and function of the run; asked, source: as in a `Row`."""

    quantity: str
    unit: str
    value: Callable[[Found], SupportsFloat | None]
    source: str = ""
    asked: Bound | None = None


def rows_of(runs: Mapping[str, Found], *measures: Measure[Found]) -> list[Row]:
    """Return all measures of each run; the name of the run precedes the quantity."""
    return [
        measured(f"{name}: {measure.quantity}", measure.unit, measure.value(run), measure.source, measure.asked)
        for name, run in runs.items()
        for measure in measures
    ]


@dataclass
class Report:
    """All results of a scenario. `simulated_seconds`: simulated time over all runs [s]; 0 if it is irrelevant."""

    rows: list[Row]
    series: Recording
    draw: Callable[[], Figure]
    parameters: Mapping[str, Any]
    simulated_seconds: float
    remarks: list[str] = field(default_factory=list)
    guids: Mapping[str, str] = field(default_factory=dict)
    coupling: Mapping[str, float] = field(default_factory=dict)
    #: Further figures by file name, in addition to figure.png.
    other_figures: dict[str, Callable[[], Figure]] = field(default_factory=dict)
    #: Further tables by file name, in addition to timeseries.csv.
    other_series: dict[str, Recording] = field(default_factory=dict)
    #: Repeats the run that the three-dimensional view of a report shows; None: nothing moves.
    motion: Callable[[], Motion] | None = None

    @property
    def holds(self) -> bool:
        """Return whether no row misses its bound."""
        return all(row.holds is not False for row in self.rows)


def value_of(rows: Sequence[Row], quantity: str) -> float:
    """Return the simulated value of a quantity."""
    for row in rows:
        if row.quantity == quantity and row.simulated is not None:
            return row.simulated
    raise LookupError(f"nothing was simulated of {quantity}")


def save(
    report: Report,
    name: str,
    out: Path,
    wall_seconds: float,
    further: Callable[[Report, Path], None] | None = None,
    options: Mapping[str, Any] | None = None,
) -> Path:
    """Write results/NAME in one move: a run that fails leaves the folder unchanged. options: those that were chosen."""
    provenance = provenance_of("scenario", {"name": name, "options": encoded(options or {})})
    out.mkdir(parents=True, exist_ok=True)
    partial = Path(tempfile.mkdtemp(prefix=f".{name}-", dir=out))
    try:
        summary = {
            "scenario": name,
            "rows": [row.as_dict() for row in report.rows],
            "pictures": draw_all(report, partial),
            "remarks": report.remarks,
            "parameters": dict(report.parameters),
            "coupling": dict(report.coupling),
            "versions": versions() | {"fmus": dict(report.guids)},
            KEY: provenance,
            "wall_seconds": wall_seconds,
            # null if nothing is simulated over time, or if the scenario measures the time of single calls
            "times_real_time": report.simulated_seconds / wall_seconds or None,
        }
        (partial / "summary.json").write_text(document_text(summary), encoding="utf-8")
        for file, series in {"timeseries": report.series, **report.other_series}.items():
            series.provenance = provenance
            series.write(partial / f"{file}.csv")
        if further:
            further(report, partial)
        partial.chmod(0o755)
        exchange(partial, out / name)
        return out / name
    except BaseException as error:
        shutil.rmtree(partial, ignore_errors=True)
        if isinstance(error, OSError):
            raise cannot_write(out / name, error, "choose another folder with --out") from error
        raise


def exchange(made: Path, target: Path) -> None:
    """Replace a folder by another one; the old one is deleted after the new one is in place."""
    before = made.with_name(f"{made.name}-before")
    if target.exists():
        target.replace(before)
    try:
        made.replace(target)
    except OSError:
        if before.exists():
            before.replace(target)
        raise
    shutil.rmtree(before, ignore_errors=True)


def draw_all(report: Report, folder: Path) -> dict[str, str]:
    """Draw the figures into a folder; return their messages by file name."""
    messages = {}
    for file, draw in {"figure": report.draw, **report.other_figures}.items():
        figure = draw()
        messages[f"{file}.png"] = message_of(figure)
        figure.savefig(folder / f"{file}.png", dpi=130)
        plt.close(figure)
    return messages


def number(value: float | None) -> str:
    """Return a value as text with four digits; a dash for None."""
    if value is None:
        return "-"
    if isinstance(value, int):
        return str(value)
    if value == 0.0 or 1e-3 <= abs(value) < 1e6:
        digits = max(0, 4 - (0 if value == 0.0 else math.floor(math.log10(abs(value)))) - 1)
        return f"{value:.{min(digits, 6)}f}"
    return f"{value:.3e}"


#: Number of rows without a limit that are printed nevertheless.
FEW = 5
#: Columns that are omitted if no row has a value.
EMPTY = {"thesis", "VAMPIRE", "deviation"}
VERDICTS = {True: "holds", False: "DOES NOT HOLD", None: "not judged"}


def parted(rows: Sequence[Any], holds: Callable[[Any], bool | None]) -> tuple[list[Any], list[Any]]:
    """Return the rows with a verdict, failed ones first, and the rows without; holds: returns the verdict of a row."""
    of = {verdict: [row for row in rows if holds(row) is verdict] for verdict in VERDICTS}
    return [*of[False], *of[True]], of[None]


def verdict_of(verdicts: Iterable[bool | None]) -> bool | None:
    """Return the verdict of several: False if one fails, None if none has a limit."""
    found = set(verdicts)
    return next((verdict for verdict in (False, True) if verdict in found), None)


def short_table(rows: Sequence[Row], folder: Path) -> str:
    """Return a table of rows with limits and of FEW others, and the place of the rest; all rows if none has limits."""
    judged, others = parted(rows, lambda row: row.holds)
    left = len(others) - FEW
    if not judged or left < 2:
        return table([*judged, *others])
    more = (
        f"{left} more rows that are not judged: {folder / 'summary.json'}, the page of --html, or the table of --all."
    )
    return f"{table([*judged, *others[:FEW]])}\n\n{more}"


def table(rows: Sequence[Row]) -> str:
    """Return the rows as text, with units, without empty columns; the assumptions follow below each row."""
    heads = ["quantity", "unit", "thesis", "VAMPIRE", "simulated", "deviation", "asked", "verdict"]
    lines = [
        [
            row.quantity,
            row.unit,
            number(row.thesis),
            number(row.vampire),
            number(row.simulated),
            number(row.deviation),
            row.asked_text,
            VERDICTS[row.holds],
        ]
        for row in rows
    ]
    kept = [i for i, head in enumerate(heads) if head not in EMPTY or any(line[i] != "-" for line in lines)]
    head, *texts = text_table([[line[i] for i in kept] for line in [heads, *lines]], (0, 1, len(kept) - 1))
    notes = ["; ".join(part for part in (row.source, row.assumption) if part) for row in rows]
    with_notes = [f"{text}\n    {note}" for text, note in zip(texts, notes, strict=True)]
    return "\n".join([head, "-" * len(head), *with_notes])


def stopwatch() -> Callable[[], float]:
    """Return a function that returns the time since this call [s]."""
    begin = time.perf_counter()
    return lambda: time.perf_counter() - begin
