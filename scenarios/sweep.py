"""Runs one scenario at every combination of the given parameters, into one table.

  bogie-braking sweep levels --vary utilisation=0.5:1.3:9              nine evenly spaced values
  bogie-braking sweep levels --vary utilisation=0.5:1.3:9 --vary level=1,2,3 --jobs 2
                                                                             27 points in two worker processes
  bogie-braking sweep levels --vary utilisation=0.5:1.3:9 --restart    forget the points of an earlier sweep
  bogie-braking sweep levels --vary utilisation=0.5:1.3:9 --scheduler tcp://127.0.0.1:8786
                                                                             on a Dask cluster

results/sweep-NAME/ has table.csv, table.parquet, summary.json, and journal.jsonl with each point that is done: after an
interruption the same command goes on from there. Points that failed stay in the table with their reason. A second sweep
into the same folder is refused while the first one runs.
"""

import argparse
import inspect
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, closing, contextmanager, nullcontext
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from tqdm import tqdm

from readers.storage import is_full, sync_folder
from scenarios import catalogue
from scenarios.reporting.progress import PATIENCE
from scenarios.reporting.report import versions
from scenarios.scenario import BadInputError, Scenario, Sweepable
from scenarios.sweep.cluster import cluster
from scenarios.sweep.grid import Grid, grid_of, points_of
from scenarios.sweep.journal import JOURNAL, Journal
from scenarios.sweep.lock import only_writer
from scenarios.sweep.points import Evaluator, SweepError, in_processes, point_function, sources
from scenarios.sweep.table import Rows, remove_table, write_table


@dataclass(frozen=True)
class Sweep:
    """What is swept, and where its files go."""

    scenario: Scenario
    sweepable: Sweepable
    grid: Grid
    folder: Path

    @cached_property
    def points(self) -> list[dict[str, float]]:
        """Parameters by the numbers of the points."""
        return list(points_of(self.grid))

    def head(self) -> dict[str, Any]:
        """What must be the same for two points to stand in one table."""
        defaults = inspect.signature(self.sweepable.run).parameters
        held = {name: defaults[name].default for name in self.sweepable.parameters if name not in self.grid}
        return {
            "sweep": self.scenario.name,
            "vary": dict(self.grid),
            "held": held,
            "units": dict(self.sweepable.parameters) | dict(self.sweepable.results),
            "versions": versions() | {"sources": sources()},
        }


def add_command(commands: Any) -> None:
    """Adds `sweep` to the commands of the command line."""
    parser = commands.add_parser(
        "sweep",
        help="run one scenario over a grid of parameters",
        description=__doc__,
        epilog=sweepable_text(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", help="a scenario that takes part in sweeps")
    parser.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="PARAMETER",
        help="name=first:last:count or name=a,b,c; several give every combination, the first varying slowest",
    )
    parser.add_argument("--jobs", type=int, metavar="COUNT", help="worker processes (default: one per processor)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster, whose workers take the points")
    parser.add_argument("--restart", action="store_true", help="drop the points of an earlier sweep")
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder of the results (default: results)")


def sweepable_text() -> str:
    """What can be varied, and what comes out."""
    lines = []
    for scenario in catalogue.SCENARIOS:
        if scenario.sweep:
            varied, found = (
                ", ".join(f"{name} [{unit}]" for name, unit in units.items())
                for units in (scenario.sweep.parameters, scenario.sweep.results)
            )
            lines.append(f"{scenario.name}\n  varies: {varied}\n  finds: {found}")
    return "\n".join(lines)


def sweep_of(chosen: argparse.Namespace) -> Sweep:
    """What the command line asks for. Raises BadInputError."""
    scenario = catalogue.find(chosen.name)
    if scenario.sweep is None:
        takers = ", ".join(one.name for one in catalogue.SCENARIOS if one.sweep)
        raise BadInputError(f"{scenario.name} takes no part in sweeps; these do: {takers}.")
    if chosen.jobs is not None and chosen.jobs < 1:
        raise BadInputError(f"Give --jobs a value of at least 1: it was {chosen.jobs}.")
    folder = chosen.out / f"sweep-{scenario.name}"
    for path in (chosen.out, folder):
        if path.exists() and not path.is_dir():
            raise BadInputError(f"{path} is a file; give --out a folder.")
    return Sweep(scenario, scenario.sweep, grid_of(chosen.vary, scenario.sweep.parameters, scenario.name), folder)


def evaluator(chosen: argparse.Namespace) -> AbstractContextManager[Evaluator]:
    """What runs points: worker processes of this machine or a cluster. Entering it raises BadInputError."""
    if chosen.scheduler is not None:
        return cluster(chosen.scheduler)
    return nullcontext(partial(in_processes, chosen.jobs or os.cpu_count() or 1))


def finish(sweep: Sweep, journal: Journal, run_points: Evaluator) -> None:
    """Runs the points that the journal does not have. Raises SweepError, and KeyboardInterrupt with a sentence."""
    left = {number: point for number, point in enumerate(sweep.points) if number not in journal.outcomes}
    evaluate = point_function(sweep.sweepable.run, list(sweep.sweepable.results))
    name, done, count = sweep.folder.name, len(journal.outcomes), len(sweep.points)
    try:
        with (
            closing(run_points(evaluate, left)) as outcomes,
            tqdm(total=count, initial=done, desc=name, delay=PATIENCE, leave=False, unit="point") as bar,
        ):
            for number, outcome in outcomes:
                journal.add(number, outcome)
                bar.update()
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"{name} was interrupted with {len(journal.outcomes)} of {count} points done; the same command goes "
            "on from there."
        ) from None


def tell_what_is_done(sweep: Sweep, journal: Journal, chosen: argparse.Namespace) -> None:
    """Says what an earlier run has left."""
    if journal.cut and not chosen.quiet:
        print(
            f"The last line of {sweep.folder / JOURNAL} was cut off; what it held is computed again.", file=sys.stderr
        )
    if journal.outcomes and not (chosen.quiet or chosen.json):
        print(f"{sweep.folder.name}: {len(journal.outcomes)} of {len(sweep.points)} points are done already.")


def run(chosen: argparse.Namespace) -> bool:
    """Runs or resumes a sweep; whether all its points are good. Raises BadInputError, SweepError, KeyboardInterrupt."""
    sweep = sweep_of(chosen)
    head = sweep.head()
    with saying_where_room_is_missing(sweep.folder), ExitStack() as held:
        run_points: Evaluator | None = None
        if not sweep.folder.exists():  # where no cluster answers, no folder is made
            run_points = held.enter_context(evaluator(chosen))
        held.enter_context(only_writer(sweep.folder))
        if chosen.restart:
            forget(sweep.folder)
        journal = Journal(sweep.folder / JOURNAL, head, sweep.points, sweep.sweepable.results)
        tell_what_is_done(sweep, journal, chosen)
        if len(journal.outcomes) < len(sweep.points):
            run_points = run_points or held.enter_context(evaluator(chosen))
            with journal:
                remove_table(sweep.folder)
                finish(sweep, journal, run_points)
        rows = [(point, journal.outcomes[number]) for number, point in enumerate(sweep.points)]
        failures = sum(outcome.failure is not None for _, outcome in rows)
        written = write_table(sweep.folder, sweep.sweepable, rows, head | {"points": len(rows), "failed": failures})
    if chosen.json:
        print((sweep.folder / "summary.json").read_text(encoding="utf-8"), end="")
    elif not chosen.quiet:
        report(sweep, rows, written)
    return failures == 0


def forget(folder: Path) -> None:
    """Drops what an earlier sweep left, before anything of another one is written."""
    remove_table(folder)
    (folder / JOURNAL).unlink(missing_ok=True)
    sync_folder(folder)


@contextmanager
def saying_where_room_is_missing(folder: Path) -> Iterator[None]:
    """Raises SweepError, with the folder and what to do, where a disk is full."""
    try:
        yield
    except OSError as error:
        if not is_full(error):
            raise
        reason = error.strerror or str(error)
        raise SweepError(
            f"{folder} must have room for the results; got {reason!r}. Make room, and the same command goes on from "
            "the points that are done."
        ) from None


def report(sweep: Sweep, rows: Rows, written: Sequence[str]) -> None:
    """Prints what came out, and the first failure."""
    failed = [(point, outcome.failure) for point, outcome in rows if outcome.failure is not None]
    print(f"{sweep.folder.name}: {len(rows)} points, {len(failed)} failed.")
    if failed:
        at = ", ".join(f"{name} = {value}" for name, value in failed[0][0].items())
        print(f"The first that failed, at {at}: {failed[0][1]}")
    print(f"Table: {', '.join(str(sweep.folder / name) for name in written)}")
    if "table.parquet" not in written:
        print("No table.parquet: pip install 'bogie-braking[sweep]' and give the same command again.")
