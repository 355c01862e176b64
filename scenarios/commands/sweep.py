"""Run one scenario at every combination of the given parameters, into one table.

  bogie-braking sweep anti-skid --vary friction=0.04:0.12:9              nine evenly spaced values
  bogie-braking sweep anti-skid --vary friction=0.04:0.12:9 --vary protected=0,1 --jobs 2
                                                                         18 points in two worker processes
  bogie-braking sweep anti-skid --vary friction=0.04:0.12:9 --restart    discard the points of an earlier sweep
  bogie-braking sweep anti-skid --vary friction=0.04:0.12:9 --scheduler tcp://127.0.0.1:8786
                                                                         on a Dask cluster

results/sweep-NAME/ has table.csv, table.parquet, summary.json, and journal.jsonl with each point that is done: after an
interruption the same command continues from there. Points that failed stay in the table with their reason. A second
sweep into the same folder is refused while the first one runs.
"""

from __future__ import annotations

import argparse
import inspect
import os
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path

from bogie_braking.common_options import add_out, add_speech, bars, describe
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from products.run_history import provenance_of
from products.study.cluster import cluster
from products.study.grid import grid_of, points_of
from products.study.journal import JOURNAL, Journal
from products.study.points import Evaluator, Outcome, in_processes, point_function
from products.study.study import Study, kept_outcomes_of
from readers.command_line import check_folder, whole
from readers.extras import install
from readers.text import BadInputError
from scenarios import catalogue


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `sweep`."""
    describe(parser, __doc__)
    parser.epilog = sweepable_text()
    parser.add_argument("name", help="a scenario that takes part in sweeps")
    text = "name=first:last:count or name=a,b,c; several give every combination, the first varying slowest"
    parser.add_argument("--vary", action="append", default=[], metavar="PARAMETER", help=text)
    text = "worker processes (default: one per processor)"
    parser.add_argument("--jobs", type=whole("--jobs", 1), metavar="COUNT", help=text)
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster, whose workers take the points")
    parser.add_argument("--restart", action="store_true", help="drop the points of an earlier sweep")
    add_out(parser)
    add_speech(parser)


def names() -> Sequence[str]:
    """Return the names of scenarios that can be swept."""
    return [scenario.name for scenario in catalogue.SCENARIOS if scenario.sweep]


def sweepable_text() -> str:
    """Return the parameters and results of all sweepable scenarios."""
    lines = []
    for scenario in catalogue.SCENARIOS:
        if scenario.sweep:
            varied, found = (
                ", ".join(f"{name} [{unit}]" for name, unit in units.items())
                for units in (scenario.sweep.parameters, scenario.sweep.results)
            )
            lines.append(f"{scenario.name}\n  varies: {varied}\n  finds: {found}")
    return "\n".join(lines)


def study_of(chosen: argparse.Namespace) -> Study:
    """Return the study that the command line requests."""
    scenario = catalogue.find(chosen.name)
    sweepable = scenario.sweep
    if sweepable is None:
        raise BadInputError(f"{scenario.name} takes no part in sweeps; these do: {', '.join(names())}.")
    name = f"sweep-{scenario.name}"
    check_folder(chosen.out / name)
    grid = grid_of(chosen.vary, sweepable.parameters, scenario.name)
    defaults = inspect.signature(sweepable.run).parameters
    head = {
        "sweep": scenario.name,
        "vary": dict(grid),
        "held": {parameter: defaults[parameter].default for parameter in sweepable.parameters if parameter not in grid},
        "units": dict(sweepable.parameters) | dict(sweepable.results),
    }
    units = {one: sweepable.parameters[one] for one in grid} | dict(sweepable.results)
    promised = list(sweepable.results)
    provenance = provenance_of("scenario sweep", {"name": scenario.name, "vary": dict(grid)})
    return Study(name, units, promised, points_of(grid), point_function(sweepable.run, promised), head, provenance)


def evaluator(chosen: argparse.Namespace) -> AbstractContextManager[Evaluator]:
    """Return the evaluator of points: worker processes of this computer or a cluster.

    Entering it raises BadInputError.
    """
    if chosen.scheduler is not None and chosen.jobs is not None:
        raise BadInputError("--jobs has no effect with --scheduler, whose cluster has its own workers. Leave one out.")
    if chosen.scheduler is not None:
        return cluster(chosen.scheduler)
    return nullcontext(partial(in_processes, chosen.jobs or os.cpu_count() or 1))


def run(chosen: argparse.Namespace) -> int:
    """Run or resume a sweep; return DOES_NOT_HOLD if a point failed. Raises BadInputError, SweepError."""
    check_folder(chosen.out)
    with bars(chosen):
        study = study_of(chosen)
        folder, tell = chosen.out / study.name, partial(tell_what_is_done, study, chosen)
        outcomes, written = kept_outcomes_of(study, evaluator(chosen), folder, chosen.restart, tell)
    if chosen.json:
        print((folder / "summary.json").read_text(encoding="utf-8"), end="")
    elif not chosen.quiet:
        report(study, outcomes, folder, written)
    return HOLDS if all(outcome.failure is None for outcome in outcomes) else DOES_NOT_HOLD


def tell_what_is_done(study: Study, chosen: argparse.Namespace, journal: Journal) -> None:
    """Print the number of points that an earlier run has completed."""
    if journal.cut and not chosen.quiet:
        path = chosen.out / study.name / JOURNAL
        print(f"The last line of {path} was cut off; what it held is computed again.", file=sys.stderr)
    if journal.outcomes and not (chosen.quiet or chosen.json):
        print(f"{study.name}: {len(journal.outcomes)} of {len(study.points)} points are done already.")


def report(study: Study, outcomes: Sequence[Outcome], folder: Path, written: Sequence[str]) -> None:
    """Print the results, and the first failure."""
    failed = [number for number, outcome in enumerate(outcomes) if outcome.failure is not None]
    print(f"{study.name}: {len(outcomes)} points, {len(failed)} failed.")
    if failed:
        at = ", ".join(f"{name} = {value}" for name, value in study.points[failed[0]].items())
        print(f"The first that failed, at {at}: {outcomes[failed[0]].failure}")
    print(f"Table: {', '.join(str(folder / name) for name in written)}")
    if "table.parquet" not in written:
        print(f"No table.parquet: {install('sweep')} and give the same command again.")
