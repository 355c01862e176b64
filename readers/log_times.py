"""Times of a log: numbers in a unit, seconds since 1970, dates with times (ISO 8601), and times of day; as text, or as
arrays of numbers, dates or durations.

Clocks are counted from the first row, in whole nanoseconds, so that a log gives the same times to rounding whatever its
clock. As numbers of 64 bits, seconds since 1970 would be rounded to 0.24 us.
"""

from __future__ import annotations

import datetime
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from readers.columns import TableError
from readers.decimal_numbers import MINUS, is_decimal
from readers.text import quoted
from readers.units import factor

#: Numbers from which times are counted from 1970, in seconds, milliseconds, microseconds and nanoseconds: 1973.
EPOCHS = ((1e17, "ns", 1), (1e14, "us", 1_000), (1e11, "ms", 1_000_000), (1e8, "s", 1_000_000_000))
#: Longest number of a time since 1970 [characters], and the first that is too large.
LONGEST, LARGEST = 40, Decimal("1e22")
NANOSECONDS = 1_000_000_000
#: A time of day that falls by more than this passed midnight [ns].
HALF_DAY = 43_200 * NANOSECONDS
DAY = 86_400 * NANOSECONDS
FIRST_DAY = datetime.date(1970, 1, 1).toordinal()
CLOCK = r"(?P<hour>\d{1,2}):(?P<minute>\d\d):(?P<second>\d\d)([.,](?P<fraction>\d{1,9})\d*)?"
ZONE = r"\s*(?P<zone>Z|z|[+-]\d\d:?\d\d)?"
ISO = re.compile(rf"(?P<year>\d{{4}})-(?P<month>\d\d)-(?P<day>\d\d)[Tt ]+{CLOCK}{ZONE}", re.ASCII)
DOTTED = re.compile(rf"(?P<day>\d{{1,2}})\.(?P<month>\d{{1,2}})\.(?P<year>\d{{4}})[ ,T]+{CLOCK}{ZONE}", re.ASCII)
OF_DAY = re.compile(CLOCK, re.ASCII)
FORMS = "Write seconds, 2026-05-01T12:00:00.5 or 12:00:00.5."
#: Numbers of days by which spreadsheets write the dates from 2000 to 2050. A log that begins there is refused if it is
#: shorter than ONE_DAY.
DATES, ONE_DAY = (36_526.0, 55_153.0), 1.0
#: The same days as MATLAB counts them.
MATLAB_DATES = (730_486.0, 749_113.0)
#: Shortest median step of times without a unit. Days at 1 Hz have 1.2e-5.
SHORTEST = 2e-5


@dataclass(frozen=True)
class Times:
    """Times of rows [s]; a row without one has NaN. clock: what they are counted from; "" for numbers as they are.

    begin: the time of the clock from which they are counted, since 1970 or midnight [ns]. has_unit: the numbers are
    durations.
    """

    seconds: NDArray[np.float64]
    clock: str = ""
    begin: int = 0
    has_unit: bool = False


def times_of(cells: Sequence[str], unit: str, numbers: Callable[[], NDArray[np.float64]], place: TimesPlace) -> Times:
    """Return the times of a column."""
    first = next((cell for cell in cells if cell), "")
    if is_decimal(first):
        scale = _since_1970(first, unit)
        return _counted(cells, partial(_exact, scale), place, False) if scale else _plain(numbers(), unit, place)
    for form in (ISO, DOTTED):
        if match := form.fullmatch(first):
            return _counted(cells, partial(_dated, form, match["zone"] is not None), place, False)
    if OF_DAY.fullmatch(first):
        return _counted(cells, _of_day, place, True)
    if not first:
        return Times(numbers())
    raise place.refusal(
        list(cells).index(first), f"times must be numbers, dates or times of day; got {quoted(first)}. {FORMS}"
    )


@dataclass(frozen=True)
class TimesPlace:
    """File, column and row numbers of the times, for messages."""

    source: str
    column: str
    rows: Sequence[int] | NDArray[np.int64]

    def refusal(self, row: int, text: str) -> TableError:
        """Return the error for a time; `row` is numbered from 0."""
        return TableError(f"{self.source}, row {self.rows[row]}, column {self.column}: {text}")


def _plain(seconds: NDArray[np.float64], unit: str, place: TimesPlace) -> Times:
    """Return times as they are, unless they have no unit and look like days. Raises TableError."""
    there = np.flatnonzero(np.isfinite(seconds))
    steps = np.diff(seconds[there])
    if not unit and steps.size and np.all(steps >= 0.0):
        first, step = float(seconds[there[0]]), float(np.median(steps[steps > 0.0])) if np.any(steps > 0.0) else 1.0
        is_date = any(low <= first <= high for low, high in (DATES, MATLAB_DATES))
        if step < SHORTEST or (is_date and np.sum(steps) < ONE_DAY):
            raise place.refusal(
                int(there[0]),
                f"times without a unit must not be days, as spreadsheets write them; got {first:.10g} with steps of "
                f"{step:.4g}. Write time [s] if they are seconds, else 2026-05-01T12:00:00.5.",
            )
    return Times(seconds)


def _since_1970(cell: str, unit: str) -> int:
    """Return the nanoseconds in the unit of a number that is a time since 1970, or 0."""
    size = abs(float(cell.replace(MINUS, "-").replace(",", ".")))
    if not math.isfinite(size):
        return 0
    if unit:
        both = factor(unit, "s")
        whole = round(both[0] / both[1] * NANOSECONDS) if both else 0
        return whole if size * whole >= EPOCHS[-1][0] * NANOSECONDS else 0
    return next((scale for least, _, scale in EPOCHS if size >= least), 0)


def _exact(scale: int, cell: str) -> int | None:
    """Return a number of a file in nanoseconds, rounded to a whole one."""
    value = Decimal(cell.replace(",", ".")) if is_decimal(cell) and len(cell) <= LONGEST else Decimal("inf")
    return int((value * scale).to_integral_value()) if abs(value) < LARGEST else None


def _clock(match: re.Match[str]) -> int | None:
    """Return the time of day of a match [ns]."""
    hour, minute, second = (int(match[one]) for one in ("hour", "minute", "second"))
    if hour > 23 or minute > 59 or second > 60:
        return None
    fraction = int((match["fraction"] or "0").ljust(9, "0"))
    return ((hour * 60 + minute) * 60 + second) * NANOSECONDS + fraction


def _of_day(cell: str) -> int | None:
    match = OF_DAY.fullmatch(cell)
    return _clock(match) if match else None


def _dated(form: re.Pattern[str], zoned: bool, cell: str) -> int | None:
    """Return a date with a time [ns]; None if it is not of the form, or has a time zone where the first has not."""
    match = form.fullmatch(cell)
    if match is None or (match["zone"] is not None) != zoned:
        return None
    clock = _clock(match)
    try:
        day = datetime.date(*(int(match[one]) for one in ("year", "month", "day"))).toordinal()
    except ValueError:
        return None
    zone = (match["zone"] or "Z").upper()
    offset = 0
    if zone != "Z":
        offset = (int(zone[1:3]) * 60 + int(zone[-2:])) * 60 * NANOSECONDS * (-1 if zone[0] == "-" else 1)
    return None if clock is None else (day - FIRST_DAY) * DAY + clock - offset


def _counted(
    cells: Sequence[str], read: Callable[[str], int | None], place: TimesPlace, around_midnight: bool
) -> Times:
    """Return times counted from the first, in seconds."""
    found = np.full(len(cells), math.nan)
    begin: int | None = None
    before, days = 0, 0
    for row, cell in enumerate(cells):
        if not cell:
            continue
        at = read(cell)
        if at is None:
            raise place.refusal(row, f"times must have one form; got {quoted(cell)}. {FORMS}")
        if around_midnight and begin is not None and at < before - HALF_DAY:
            days += DAY
        begin, before = at if begin is None else begin, at
        found[row] = (at + days - begin) / NANOSECONDS
    return Times(found, next((cell for cell in cells if cell), ""), begin or 0)


def times_of_array(
    values: NDArray[Any], unit: str, converted: Callable[[NDArray[np.float64]], NDArray[np.float64]], place: TimesPlace
) -> Times:
    """Return the times of an array of numbers, dates (datetime64) or durations (timedelta64).

    converted: the seconds of numbers in the unit of the file.
    """
    if values.dtype.kind == "m":
        return Times(values / np.timedelta64(1, "s"), has_unit=True)
    there = np.flatnonzero(~np.isnat(values)) if values.dtype.kind == "M" else np.flatnonzero(np.isfinite(values))
    if not there.size:
        return Times(np.full(values.size, math.nan))
    first = values[there[0]]
    if values.dtype.kind == "M":
        begin = int(first.astype("datetime64[ns]").astype(np.int64))
        return Times((values - first) / np.timedelta64(1, "s"), str(first), begin)
    if scale := _since_1970(repr(first.item()), unit):
        steps = (values - first) if values.dtype.kind == "f" else values.astype(np.int64) - np.int64(first)
        return Times(steps.astype(float) * scale / NANOSECONDS, str(first), round(first.item() * scale))
    return _plain(converted(values.astype(float)), unit, place)
