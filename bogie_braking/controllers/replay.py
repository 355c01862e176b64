"""Replay the wheel speeds of a recorded run to a controller: a table and a plot of its commands.

  bogie-braking controllers replay log.csv mine.py:PI                    at the times of the rows
  bogie-braking controllers replay log.csv pi.c --period 10ms            every 10 ms, with the last row before
  bogie-braking controllers replay log.csv pi.fmu --json | jq .wheelsets

  bogie-braking controllers replay log.csv mine.py:PI --columns map.toml  with a map from the log's names to these

The log has the columns time [s] and wheel_speed_1 [m/s] to wheel_speed_N [m/s]; valve_1 [1] and so on are compared with
the commands. The commands do not change the wheel speeds, which are those of the log. Other names, units and clocks are
read as the page Your own tables and files of the documentation describes.

Exit status: 0 the controller answered to the end; 1 it failed; 2 bad input; 3 this program failed; 130 interrupted.
"""

from __future__ import annotations

import argparse
import contextlib
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bogie_braking.controllers.controller_loader import Given, controller_of
from bogie_braking.controllers.table import show, write_document
from bogie_braking.measured_data import not_a_log
from bogie_braking.reporting.plots import FOUR, one_word, plt, saved, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.scenario import BadInputError
from bogie_braking.reporting.text_table import text_table
from brake_controller.protection_fmu import MOST_WHEELSETS
from brake_controller.wheel_slide import APPLY, COMMANDS, HOLD, VENT, ControllerError, Supervised
from fmu_src.cosimulation.arrays import log_from, named_arrays
from fmu_src.cosimulation.measured import table_from
from fmu_src.cosimulation.recording import Recording
from products.controller_kinds import single
from products.protection.own_process import Apart, NoControllerError, ProcessEndedError, called_apart
from products.protection.settings import LONGEST_PERIOD
from readers.command_line import quantity
from readers.log_columns import ColumnMap
from readers.log_rows import after_events, bridged, filled
from readers.text import FileError, quoted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Fastest wheel of a log [m/s], twice the fastest of a case file.
FASTEST_LOGGED = 200.0
#: Units of the columns that are read; a log may have others.
UNITS_OF_LOG = {"time": "s", "speed": "m/s"}
for _number in range(1, MOST_WHEELSETS + 1):
    UNITS_OF_LOG |= {f"wheel_speed_{_number}": "m/s", f"valve_{_number}": "1"}
#: Shortest allowed period [s].
SHORTEST = 1e-4
#: Longest gap that may be bridged [s].
LONGEST_GAP = 86400.0
#: Share of a row's time within which a call uses this row instead of the one before.
SAME = 1e-9
WORDS = {APPLY: "apply", HOLD: "hold", VENT: "vent"}
HEADS = ("wheelset", *WORDS.values(), "first command", "longest vent", "changes", "as in the log")
UNITS = ("", "%", "%", "%", "s", "s", "1", "%")


@dataclass(frozen=True)
class Replayed:
    """Commands of a controller in a recorded run: times [s], shape (rows,), and valves, shape (rows, wheelsets).

    as_in_log: share of rows in which each valve got the command of the log, if it has commands. message: message of a
    controller that failed, whose valves end there.
    """

    controller: str
    log: Recording
    times: np.ndarray
    valves: np.ndarray
    as_in_log: tuple[float | None, ...]
    message: str

    @property
    def wheelsets(self) -> list[dict[str, float | None]]:
        """Return the shares of each wheelset's commands, the time of the first hold or vent, the longest vent [s]."""
        return [self._wheelset(self.valves[:, place], self.as_in_log[place]) for place in range(self.valves.shape[1])]

    def _wheelset(self, valve: np.ndarray, as_in_log: float | None) -> dict[str, float | None]:
        told = np.flatnonzero(valve != APPLY)
        shares = {WORDS[command]: float(np.mean(valve == command)) if valve.size else 0.0 for command in COMMANDS}
        return shares | {
            "first_command": float(self.times[told[0]]) if told.size else None,
            "longest_vent": max((end - begin for begin, end in self.spans(valve, VENT)), default=0.0),
            "changes": float(np.count_nonzero(np.diff(valve))),
            "as_in_log": as_in_log,
        }

    def spans(self, valve: np.ndarray, command: int) -> list[tuple[float, float]]:
        """Return begin and end of each interval of a command at a valve [s]; the last row ends at its own time."""
        edges = np.flatnonzero(np.diff(np.concatenate([[0], (valve == command).astype(int), [0]])))
        until = np.append(self.times[: valve.size], self.times[valve.size - 1 :][:1])
        return [(float(until[begin]), float(until[end])) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    text = "a log (CSV, Parquet, .mat, MDF, HDF5) with time [s] and wheel_speed_1 [m/s] and so on; also speed, valve_1"
    parser.add_argument("log", type=Path, help=text)
    text = "FILE.py:CLASS, a shared library, a C file that includes wheel_slide.h, or an FMU"
    parser.add_argument("controller", help=text)
    text = "ask so often, with the last row before; default: at the times of the rows"
    period = quantity("--period", "s", SHORTEST, LONGEST_PERIOD)
    parser.add_argument("--period", type=period, metavar="TIME", help=text)
    add_log_options(parser)
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder of the results (default: results)")


def add_log_options(parser: argparse.ArgumentParser) -> None:
    """Add the options by which a log is read."""
    text = "map from the names of the log to those of the columns, a TOML file (default: guessed, and told)"
    parser.add_argument("--columns", type=Path, metavar="FILE", help=text)
    text = "longest gap in the log that is bridged (default: ten usual steps, and at least 2 s)"
    gap = quantity("--longest-gap", "s", SHORTEST, LONGEST_GAP)
    parser.add_argument("--longest-gap", type=gap, metavar="TIME", help=text)


def run(chosen: argparse.Namespace) -> bool:
    """Replay and report; return whether the controller answered to the end. Raises BadInputError, CompilerError."""
    period: float | None = chosen.period
    log = read_log(chosen.log, chosen.columns, chosen.longest_gap)
    if not chosen.quiet:
        print(*log.messages, sep="\n", end="\n" * bool(log.messages), file=sys.stderr)
    name, controller = controller_of(chosen.controller, wheelsets_in(log))
    try:
        call = partial(called_apart, replay) if isinstance(controller, Apart) else replay
        found: Replayed = call(log, name, controller, period)
    except NoControllerError as error:
        raise BadInputError(f"{name} is no controller ({error}); give one.") from None
    except ProcessEndedError as error:
        print(f"The controller {name} {error}; of its commands nothing is known.", file=sys.stderr)
        return False
    folder = chosen.out / "controllers"
    text = write_document(folder / "replay.json", document(found) | {"log": str(chosen.log), "period": period})
    pictures = [f"Picture: {picture}" for picture in saved(partial(draw, found), folder / "replay.png")]
    show(chosen, text, [*lines(chosen.log, found, period), "", *pictures])
    return not found.message


def read_log(given: Any, columns: ColumnMap | None = None, longest_gap: float | None = None) -> Recording:
    """Return a log with the speeds of wheels; its messages name guessed, converted and omitted columns.

    given: path of a file, Recording, mapping of arrays, data frame, data set or structured array.
    """
    try:
        if isinstance(given, str | Path):
            return _checked(str(given), table_from(given, UNITS_OF_LOG, columns), longest_gap)
        if (arrays := named_arrays(given, "The log")) is None:
            raise not_a_log("The log", given)
        return _checked("The log", log_from(arrays, UNITS_OF_LOG, columns, "The log"), longest_gap)
    except FileError as error:
        raise BadInputError(str(error)) from None


def _checked(path: str, log: Recording, longest_gap: float | None) -> Recording:
    """Return the rows of a log with a wheel speed, and the others bridged. Raises BadInputError, FileError."""
    count = wheelsets_in(log)
    if not 1 <= count <= MOST_WHEELSETS:
        raise BadInputError(
            f"{path} has {count} columns wheel_speed_1 [m/s] and so on; give it 1 to {MOST_WHEELSETS}. Name them "
            "by a map with --columns."
        )
    for name in (wheels := speeds_of(count)):
        if name not in log.names:
            there = quoted(", ".join(log.names), 200)
            raise BadInputError(f"{path}: the column {name} [m/s] is missing; there are {there}. Add it.")
        filled(log["time"], log[name], f"{path}: {name}", longest_gap)
        low, high = np.nanmin(log[name]), np.nanmax(log[name])
        if not (low >= 0.0 and high <= FASTEST_LOGGED):
            raise BadInputError(
                f"{path}: {name} must be from 0 to {FASTEST_LOGGED:g} m/s; got {low:g} to {high:g} m/s. Check its unit."
            )
    columns = [bridged(log["time"], log[name], longest_gap) if name in wheels else log[name] for name in log.names]
    of_wheels = np.any([np.isfinite(log[name]) for name in wheels], axis=0)
    return Recording(log.units, np.column_stack(columns)[of_wheels], log.messages)


def wheelsets_in(log: Recording) -> int:
    """Return the number of wheelsets whose speeds a log has."""
    return sum(bool(re.fullmatch(r"wheel_speed_\d+", name)) for name in log.names)


def speeds_of(count: int) -> list[str]:
    """Return the names of the columns of `count` wheelsets."""
    return [f"wheel_speed_{number}" for number in range(1, count + 1)]


def replay(log: Recording, name: str, form: Given, period: float | None) -> Replayed:
    """Return the commands of a new controller in a recorded run, every `period` [s]. Raises NoControllerError."""
    count = wheelsets_in(log)
    if isinstance(form, Apart):
        form = form.made(count, period or float(np.median(np.diff(log["time"]))))
    samples = after_events(log["time"])
    rows = log["time"][samples]
    times = rows if period is None else rows[0] + period * np.arange(int((rows[-1] - rows[0]) / period + SAME) + 1)
    last = np.searchsorted(rows, times + SAME * np.min(np.diff(rows)), "right") - 1
    speeds = np.column_stack([log[speed][samples] for speed in speeds_of(count)])[last]
    controller = single(name, form, count, period or float(np.median(np.diff(rows))))
    valves, message = commands_of(Supervised(controller, count), times, speeds)
    recorded = [log[f"valve_{n}"][samples][last] if f"valve_{n}" in log.names else None for n in range(1, count + 1)]
    same = [None if one is None else _share(one[: len(valves)], valves[:, n]) for n, one in enumerate(recorded)]
    return Replayed(name, log, times, valves, tuple(same), message)


def _share(recorded: np.ndarray, valve: np.ndarray) -> float | None:
    """Return the share of the recorded commands, where there are any, that a valve got too."""
    there = np.isfinite(recorded)
    return float(np.mean(recorded[there] == valve[there])) if np.any(there) else None


def commands_of(controller: Supervised, times: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, str]:
    """Return the commands of a controller until it fails.

    Takes times [s] (rows,), speeds [m/s] (rows, wheelsets); returns (rows, wheelsets).
    """
    valves, message = [], ""
    with contextlib.redirect_stdout(sys.stderr):  # output of the controller
        asked = zip(times.tolist(), speeds.tolist(), strict=True)
        for time, row in counting(asked, "replay", len(speeds), "question"):
            try:
                valves.append(controller.step(time, row))
            except ControllerError as error:
                message = str(error).replace("; the brake stays applied", "")
                break
    return np.array(valves, int).reshape(-1, controller.wheelsets), message


def lines(path: Path, found: Replayed, period: float | None) -> Iterator[str]:
    """Yield the lines of the table, and the messages."""
    gaps = 1e3 * np.diff(found.times)
    every = f"{gaps.min():.4g} ms" if np.ptp(gaps) < 1e-3 * gaps.min() else f"{gaps.min():.4g} to {gaps.max():.4g} ms"
    at = "at the times of its rows" if period is None else "with the last row before"
    span = found.times[-1] - found.times[0]
    yield f"{path}: {span:.1f} s; {found.controller} is asked {found.times.size} times {at}, every {every}."
    yield "The wheels do not feel its commands: they turn as they did."
    yield ""
    rows = [HEADS, UNITS, *(cells(number, wheelset) for number, wheelset in enumerate(found.wheelsets, 1))]
    yield from text_table(rows)
    if found.message:
        yield ""
        yield found.message


def cells(number: int, one: dict[str, float | None]) -> tuple[str, ...]:
    """Return a row of the table."""

    def text(name: str, form: str, factor: float = 1.0) -> str:
        value = one[name]
        return "-" if value is None else format(factor * value, form)

    shares = [text(word, ".1f", 100.0) for word in WORDS.values()]
    seconds = text("first_command", ".3f"), text("longest_vent", ".3f")
    return str(number), *shares, *seconds, text("changes", ".0f"), text("as_in_log", ".1f", 100.0)


def document(found: Replayed) -> dict[str, object]:
    """Return the results for programs; SI units, shares of 1."""
    content = {"controller": found.controller, "message": found.message, "questions": int(found.times.size)}
    return content | {"answers": len(found.valves), "wheelsets": found.wheelsets}


def draw(found: Replayed) -> Figure:
    """Draw the wheels' speeds, the vehicle's speed if the log has it, and below them the commands of each valve."""
    log, count = found.log, found.valves.shape[1]
    figure, (above, below) = plt.subplots(
        2, 1, sharex=True, figsize=(9.0, 4.6 + 0.25 * count), height_ratios=[4.0, 0.6 + 0.3 * count]
    )
    if log.units.get("speed") == "m/s":
        above.plot(log["time"], log["speed"], color="0.2", linewidth=1.2, label="vehicle")
    for place, name in enumerate(speeds_of(count)):
        colour = FOUR[place % len(FOUR)]
        above.plot(log["time"], log[name], color=colour, linewidth=0.9, label=f"wheelset {place + 1}")
    above.set_ylabel("speed [m/s]")
    above.legend(loc="upper right", fontsize=8)
    for place in range(count):
        for command, colour in ((HOLD, "0.75"), (VENT, FOUR[place % len(FOUR)])):
            spans = [(begin, end - begin) for begin, end in found.spans(found.valves[:, place], command)]
            below.broken_barh(spans, (count - place - 0.9, 0.8), facecolors=colour)
    below.set_yticks([count - place - 0.5 for place in range(count)], [f"valve {place + 1}" for place in range(count)])
    below.set(ylim=(0, count), xlabel="time [s]", title="hold grey, vent in colour")
    return titled(figure, message(found))


def message(found: Replayed) -> str:
    """Return the title of the figure."""
    told = [wheelset["first_command"] for wheelset in found.wheelsets if wheelset["first_command"] is not None]
    if not told:
        return f"{one_word(found.controller)} lets all brakes apply"
    vents = [one["vent"] or 0.0 for one in found.wheelsets]
    share = 100 * max(vents)
    return f"{one_word(found.controller)} would act from {min(told):.2f} s, venting {share:.0f} % at most"
