"""Rows of a log: their order in time, gaps, missing values, speeds in wrong units, means over intervals."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from readers.columns import TableError
from readers.text import shown

#: Shortest gap that is reported, in median steps.
GAP = 5.0
#: Longest bridged gap of an input, in median steps, and the least [s].
BRIDGED_STEPS, BRIDGED = 10.0, 2.0
#: Ratios of a wheel's speed to the vehicle's that show a wrong unit, their relative width, and least speeds [m/s].
WRONG = {"it were in km/h": 3.6, "it were in mph": 2.2369, "speed were in km/h": 1 / 3.6, "speed were in mph": 0.44704}
NEAR, MOVES = 0.03, 1.0
#: Speed above all services [m/s], assumed. Higher ones are reported.
FASTEST = 120.0
#: Deceleration above that of all brakes [m/s2] over a time [s] from above a speed [m/s], assumed. Higher ones are
#: reported.
STEEP, OVER, FAST = 2.0, 10.0, 30.0
#: Time by which the first row of an event is moved before its last one [s], and its largest share of the step before.
EVENT, EVENT_SHARE = 1e-5, 0.5
#: Share of the different times from which repeated ones are not events, but times with too few digits.
MOST_EVENTS = 0.5
#: Share of an interval by which rounded times may be before its begin.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Log:
    """A log: columns by the names of variables, in their units.

    Attributes
    ----------
    source : str
        Its path, for messages.
    numbers : dict
        Columns by name, shape (rows,), `time` first and increasing; NaN: no value.
    units : dict
        Their units.
    places : array of int, shape (rows,)
        Number of each row as an editor shows it.
    messages : list of str
        What was guessed, converted and left out, one line each.
    """

    source: str
    numbers: dict[str, NDArray[np.float64]]
    units: dict[str, str]
    places: NDArray[np.int64] = field(repr=False)
    messages: list[str] = field(default_factory=list)

    def refusal(self, row: int, column: str, text: str) -> TableError:
        """Return the error for a value; `row` is numbered from 0, `text` gives limit, value and remedy."""
        return TableError(f"{self.source}, row {self.places[row]}, column {shown(column)}: {text}")

    def rows(self, keep: NDArray[np.bool_]) -> Log:
        """Return the log with some of its rows."""
        numbers = {name: values[keep] for name, values in self.numbers.items()}
        return Log(self.source, numbers, self.units, self.places[keep], self.messages)


def in_order(log: Log) -> Log:
    """Return the log in the order of time (`ordered`), with its speeds checked (`check_speeds`). Raises TableError."""
    return check_speeds(ordered(log))


def ordered(log: Log) -> Log:
    """Return the log without rows that have no time or repeat the row before, with messages on gaps and missing values.

    Rows of one time with other values are an event of a simulation (super-dense time, FMI 2.0, section 3.1): the first
    holds until there, the last from there on.
    """
    timed = np.isfinite(log.numbers["time"])
    if not np.all(timed):
        log.messages.append(f"{log.source}: left out {count_of(np.sum(~timed))} without a time.")
        log = log.rows(timed)
    table = np.array(list(log.numbers.values()))
    same = np.all((table[:, 1:] == table[:, :-1]) | (np.isnan(table[:, 1:]) & np.isnan(table[:, :-1])), axis=0)
    again = np.concatenate([[False], same]) if table.shape[1] else np.zeros(0, bool)
    if np.any(again):
        first = log.places[np.argmax(again)]
        log.messages.append(
            f"{log.source}: left out {count_of(np.sum(again))} equal to the row before, as row {first}."
        )
        log = log.rows(~again)
    log = _with_events(log)
    time = log.numbers["time"]
    if time.size < 2:
        raise TableError(f"{log.source} must have at least 2 rows of values; it has {time.size}. Add rows.")
    _check_growth(log, np.diff(time))
    log.messages.extend(_gaps(log, np.diff(time)))
    return log


def _with_events(log: Log) -> Log:
    steps = np.diff(log.numbers["time"])
    repeated = int(np.sum(steps == 0.0))
    if not repeated or np.any(steps < 0.0) or repeated > MOST_EVENTS * (steps.size + 1 - repeated):
        return log
    time, keep = events_apart(log.numbers["time"])
    first = log.places[1:][steps == 0.0][0]
    log.messages.append(
        f"{log.source}: {count_of(repeated)} with the time before and other values, as row {first}: an event, after "
        "which the last row holds."
    )
    kept = log.rows(keep)
    return replace(kept, numbers=kept.numbers | {"time": time})


def events_apart(time: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return increasing times, and which rows are kept.

    The first and the last row of a time are kept, the first EVENT earlier. At the begin the last alone is kept.

    Takes time [s] (rows,).
    """
    same = np.diff(time) == 0.0
    first, last = ~np.append(False, same), ~np.append(same, False)
    before = first & ~last & (time > time[0])
    keep, moved = last | before, time.copy()
    moved[before] -= np.minimum(EVENT, EVENT_SHARE * np.diff(time, prepend=time[0])[before])
    return moved[keep], keep


def after_events(time: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which rows are samples: all but the first one of each event."""
    steps = np.diff(time)
    most = min(1.01 * EVENT, EVENT_SHARE * float(np.median(steps))) if steps.size else 0.0
    return np.append(~((steps > 0.0) & (steps <= most)), np.ones(min(time.size, 1), bool))


def count_of(count: int) -> str:
    """Return a number of rows as text."""
    return "1 row" if count == 1 else f"{count} rows"


def _check_growth(log: Log, steps: NDArray[np.float64]) -> None:
    bad = np.flatnonzero(~(steps > 0.0))
    if not bad.size:
        return
    row, time = int(bad[0]), log.numbers["time"]
    remedy = "Sort the rows, or remove this one."
    if np.sum(steps == 0.0) > 1 and np.all(steps >= 0.0):
        remedy = f"{np.sum(steps == 0.0)} rows repeat a time: export it with more digits."
    raise TableError(
        f"{log.source}, row {log.places[row + 1]}, column time: values must grow from row to row; got "
        f"{time[row + 1]:.12g} s after {time[row]:.12g} s. {remedy}"
    )


def check_speeds(log: Log) -> Log:
    """Return the log, with a message if its speeds are unlikely.

    Raises TableError if a wheel turns as if its speed or the vehicle's were in another unit.
    """
    wheels = [name for name in log.numbers if name.startswith("wheel_speed_")] if "speed" in log.numbers else []
    for name in wheels:
        wheel, speed = log.numbers[name], _continued(log.numbers["time"], log.numbers["speed"])
        moves = (wheel > MOVES) & (speed > MOVES)
        ratio = float(np.median(wheel[moves] / speed[moves])) if np.any(moves) else 1.0
        for unit in (one for one, size in WRONG.items() if abs(ratio / size - 1.0) < NEAR):
            raise TableError(
                f"{log.source}: {name} must be near speed; got {ratio:.3g} times as much in the median, as if {unit}. "
                "Name the units, as in speed [km/h]."
            )
    log.messages.extend(_unlikely_speeds(log))
    return log


def _continued(time: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return values, those that are missing on lines between their neighbours."""
    there = np.isfinite(values)
    return np.interp(time, time[there], values[there]) if np.any(there) else values


def _unlikely_speeds(log: Log) -> list[str]:
    """Return a line if the speeds are those of no train, as numbers in km/h are under a name with m/s."""
    wheels = [name for name in log.numbers if name.startswith("wheel_speed_")]
    names = [name for name in (["speed"] if "speed" in log.numbers else wheels) if log.units[name] == "m/s"]
    speeds = np.array([log.numbers[name] for name in names])
    there = np.any(np.isfinite(speeds), axis=0) if names else np.zeros(0, bool)
    if not np.any(there):
        return []
    time, fastest = log.numbers["time"][there], np.nanmax(speeds[:, there], axis=0)
    fall = fastest - np.interp(time + OVER, time, fastest)
    steep = np.max(fall[(fastest > FAST) & (time + OVER <= time[-1])], initial=0.0) / OVER
    got = f"slows down by {steep:.3g} m/s2 over {OVER:g} s" if steep > STEEP else ""
    got = f"reaches {np.max(fastest):.4g} m/s" if np.max(fastest) > FASTEST else got
    one = "speed" if names == ["speed"] else "the fastest wheel"
    return [f"{log.source}: {one} {got}, more than trains do. Check that its unit is not km/h."] if got else []


def _gaps(log: Log, steps: NDArray[np.float64]) -> list[str]:
    """Return the lines on gaps in time and on missing values."""
    said = []
    usual = float(np.median(steps))
    wide = np.flatnonzero(steps > GAP * usual)
    if wide.size:
        at = int(np.argmax(steps))
        count = "1 gap" if wide.size == 1 else f"{wide.size} gaps"
        said.append(
            f"{log.source}: {count} between rows, the longest {steps[at]:.4g} s after row {log.places[at]}; the usual "
            f"step is {usual:.4g} s."
        )
    for name, values in log.numbers.items():
        if empty := int(np.sum(np.isnan(values))):
            said.append(f"{log.source}: {shown(name)} has no value in {empty} of {values.size} rows.")
    return said


def filled(
    clock: NDArray[np.float64], values: NDArray[np.float64], name: str, longest: float | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times and values of an input without its missing values.

    Takes clock, values [s] (rows,), longest [s].
    """
    there = np.isfinite(values)
    times = clock[there]
    if times.size < 2:
        raise TableError(f"{name} must have at least 2 values; it has {times.size}. Check the column.")
    longest = _longest(clock, longest)
    steps = np.diff(np.concatenate([clock[:1], times, clock[-1:]]))
    if np.max(steps) > longest:
        at = int(np.argmax(steps))
        since = clock[0] if at == 0 else times[at - 1]
        raise TableError(
            f"{name} must have no gap above {longest:g} s, as it drives the run; got one of {steps[at]:.4g} s after "
            f"{since:.6g} s. Cut the log there, or allow it (--longest-gap, longest_gap=)."
        )
    return times, values[there]


def bridged(
    clock: NDArray[np.float64], values: NDArray[np.float64], longest: float | None = None
) -> NDArray[np.float64]:
    """Return values, those that are missing on a line between their neighbours; NaN in gaps that `filled` refuses.

    Takes clock, values [s] (rows,), longest [s].
    """
    there = np.isfinite(values)
    if np.all(there) or not np.any(there):
        return values
    times = clock[there]
    behind = np.searchsorted(times, clock, "left")
    before = np.where(behind > 0, times[behind - 1], clock[0])
    after = np.where(behind < times.size, times[np.minimum(behind, times.size - 1)], clock[-1])
    near = there | (after - before <= _longest(clock, longest))
    return np.where(near, np.interp(clock, times, values[there]), math.nan)


def _longest(clock: NDArray[np.float64], longest: float | None) -> float:
    """Return the longest gap that is bridged [s]."""
    return max(BRIDGED, BRIDGED_STEPS * float(np.median(np.diff(clock)))) if longest is None else longest


def averaged(rows: NDArray[np.float64], interval: float) -> NDArray[np.float64]:
    """Return means of rows over intervals from the first row on.

    Takes rows [s] (rows, columns), interval [s].
    """
    bins = np.floor((rows[:, 0] - rows[0, 0]) / interval + ROUNDING).astype(np.int64)
    starts = np.flatnonzero(np.concatenate([[True], np.diff(bins) > 0]))
    there = np.isfinite(rows)
    count = np.add.reduceat(there.astype(float), starts)
    total = np.add.reduceat(np.where(there, rows, 0.0), starts)
    return np.divide(total, count, out=np.full(total.shape, math.nan), where=count > 0)
