"""What a scenario leaves behind: a table of thesis against simulation, time series, a figure, one JSON."""

import math
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, SupportsFloat, TypeVar

from matplotlib.figure import Figure

from fmu_src.cosimulation.recording import Recording
from products.sources import versions
from readers.documents import document_text
from readers.storage import cannot_write
from scenarios.reporting.motion import Motion
from scenarios.reporting.plots import message_of, plt


@dataclass(frozen=True)
class Bound:
    """What is asked of a quantity whose value the thesis does not print, in its unit; `text` is for people."""

    least: float
    most: float
    text: str


def at_most(most: float) -> Bound:
    """Not above a limit."""
    return Bound(-math.inf, most, f"<= {number(most)}")


def at_least(least: float) -> Bound:
    """Not below a limit."""
    return Bound(least, math.inf, f">= {number(least)}")


def between(least: float, most: float) -> Bound:
    """Within two limits."""
    return Bound(least, most, f"{number(least)} to {number(most)}")


def near(value: float, band: float) -> Bound:
    """Within a band about a value that is not the thesis's: of theory, of another method, of another program."""
    return Bound(value - band, value + band, f"{number(value)} +- {number(band)}")


def rounding(printed: str) -> float:
    """Half of the last digit of a number as it is printed: all that it leaves open."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


@dataclass(frozen=True)
class Row:
    """One comparison.

    thesis: what it prints, and nothing else. asked: how far from that the value may be, in the unit of the quantity,
    which is its `rounding`, or a `Bound` where nothing is printed. None: the row is not judged, because it hangs on
    something that is not printed, or because a parameter was fitted to it; `assumption` says which. Where the thesis
    also prints VAMPIRE's value, the row holds between the two programs, the band added.
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
        """From what the thesis prints."""
        if self.thesis is None or self.simulated is None:
            return None
        return self.simulated - self.thesis

    @property
    def holds(self) -> bool | None:
        """Whether the value is as asked; one that should be there and is not does not hold; None: not judged."""
        limits = self.limits
        if limits is None:
            return None
        return self.simulated is not None and limits[0] <= self.simulated <= limits[1]

    @property
    def limits(self) -> tuple[float, float] | None:
        """Least and largest value that holds; None: not judged."""
        if isinstance(self.asked, Bound):
            return self.asked.least, self.asked.most
        if self.thesis is None or self.asked is None:
            return None
        printed = [self.thesis, self.thesis if self.vampire is None else self.vampire]
        return min(printed) - self.asked, max(printed) + self.asked

    @property
    def asked_text(self) -> str:
        """What is asked, for people."""
        if isinstance(self.asked, Bound):
            return self.asked.text
        return "-" if self.limits is None else f"+- {number(self.asked)}"

    def as_dict(self) -> dict[str, Any]:
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
    """A row of what the thesis does not print; a count stays a whole number."""
    found = value if value is None or isinstance(value, int) else float(value)
    return Row(quantity, unit, None, found, asked, source, assumption)


Found = TypeVar("Found")


@dataclass(frozen=True)
class Measure(Generic[Found]):
    """What is measured of each run: a quantity with its unit and how it is read; asked, source: as in a `Row`."""

    quantity: str
    unit: str
    value: Callable[[Found], SupportsFloat | None]
    source: str = ""
    asked: Bound | None = None


def rows_of(runs: Mapping[str, Found], *measures: Measure[Found]) -> list[Row]:
    """All measures of each run; the name of the run stands ahead of the quantity."""
    return [
        measured(f"{name}: {one.quantity}", one.unit, one.value(run), one.source, one.asked)
        for name, run in runs.items()
        for one in measures
    ]


@dataclass
class Report:
    """Everything a scenario found. `simulated_seconds`: time simulated over all runs; 0 where that is not the point."""

    rows: list[Row]
    series: Recording
    draw: Callable[[], Figure]
    parameters: Mapping[str, Any]
    simulated_seconds: float
    remarks: list[str] = field(default_factory=list)
    guids: Mapping[str, str] = field(default_factory=dict)
    coupling: Mapping[str, float] = field(default_factory=dict)
    #: Further figures by file name, beside figure.png.
    other_figures: dict[str, Callable[[], Figure]] = field(default_factory=dict)
    #: Further tables by file name, beside timeseries.csv.
    other_series: dict[str, Recording] = field(default_factory=dict)
    #: Runs again what the page of a report shows in three dimensions; None: nothing moves.
    motion: Callable[[], Motion] | None = None

    @property
    def holds(self) -> bool:
        return all(row.holds is not False for row in self.rows)


def value_of(rows: Sequence[Row], quantity: str) -> float:
    """What was simulated of a quantity. Raises LookupError where no row has it, or nothing was found."""
    for row in rows:
        if row.quantity == quantity and row.simulated is not None:
            return row.simulated
    raise LookupError(f"nothing was simulated of {quantity}")


def save(
    report: Report, name: str, out: Path, wall_seconds: float, further: Callable[[Report, Path], None] | None = None
) -> Path:
    """Writes results/NAME in one move: a run that fails on the way leaves the folder as it was.

    Among the pictures in summary.json each has its message. Raises ValueError where a figure has none,
    StorageError.

    further: writes what else is asked for into the folder, when all else is there.
    """
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
            "wall_seconds": wall_seconds,
            # null where nothing runs in time, or the time of single calls is what is measured
            "times_real_time": report.simulated_seconds / wall_seconds or None,
        }
        (partial / "summary.json").write_text(document_text(summary), encoding="utf-8")
        for file, series in {"timeseries": report.series, **report.other_series}.items():
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
    """Puts a folder in the place of another one, which is deleted when the new one stands there."""
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
    """Draws the figures into a folder; their messages by file name."""
    messages = {}
    for file, draw in {"figure": report.draw, **report.other_figures}.items():
        figure = draw()
        messages[f"{file}.png"] = message_of(figure)
        figure.savefig(folder / f"{file}.png", dpi=130)
        plt.close(figure)
    return messages


def number(value: float | None) -> str:
    if value is None:
        return "-"
    if isinstance(value, int):
        return str(value)
    if value == 0.0 or 1e-3 <= abs(value) < 1e6:
        digits = max(0, 4 - (0 if value == 0.0 else math.floor(math.log10(abs(value)))) - 1)
        return f"{value:.{min(digits, 6)}f}"
    return f"{value:.3e}"


#: Rows that are not judged and yet printed.
FEW = 5
#: Columns that are left out where no row has a value.
EMPTY = {"thesis", "VAMPIRE", "deviation"}
VERDICTS = {True: "holds", False: "DOES NOT HOLD", None: "not judged"}


def parted(rows: Sequence[Any], holds: Callable[[Any], bool | None]) -> tuple[list[Any], list[Any]]:
    """Rows that are judged, those that do not hold first, and rows that are not; holds: what tells it of a row."""
    of = {verdict: [row for row in rows if holds(row) is verdict] for verdict in VERDICTS}
    return [*of[False], *of[True]], of[None]


def verdict_of(verdicts: Iterable[bool | None]) -> bool | None:
    """Of several together: False where one does not hold, None where none is judged."""
    found = set(verdicts)
    return next((verdict for verdict in (False, True) if verdict in found), None)


def short_table(rows: Sequence[Row], folder: Path) -> str:
    """The table of what is judged, and of FEW rows that are not; where the others are. Where nothing is judged, all."""
    judged, others = parted(rows, lambda row: row.holds)
    left = len(others) - FEW
    if not judged or left < 2:
        return table([*judged, *others])
    more = (
        f"{left} more rows that are not judged: {folder / 'summary.json'}, the page of --html, or the table of --all."
    )
    return f"{table([*judged, *others[:FEW]])}\n\n{more}"


def table(rows: Sequence[Row]) -> str:
    """The rows as text, with units, without columns that would be empty; below each what was assumed."""
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
    heads, lines = [heads[i] for i in kept], [[line[i] for i in kept] for line in lines]
    widths = [max(len(line[i]) for line in [heads, *lines]) for i in range(len(heads))]

    def text(line: Sequence[str]) -> str:
        cells = [line[0].ljust(widths[0]), line[1].ljust(widths[1])]
        cells += [cell.rjust(width) for cell, width in zip(line[2:-1], widths[2:-1], strict=True)]
        return "  ".join([*cells, line[-1]]).rstrip()

    shown = [text(heads), "-" * len(text(heads))]
    for row, line in zip(rows, lines, strict=True):
        shown.append(text(line))
        note = "; ".join(part for part in (row.source, row.assumption) if part)
        shown.append(f"    {note}")
    return "\n".join(shown)


def stopwatch() -> Callable[[], float]:
    begin = time.perf_counter()
    return lambda: time.perf_counter() - begin
