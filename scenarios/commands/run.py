"""Run a scenario: print its table, write table, data and figure into results/NAME/.

bogie-braking run qr30-180kpa                            one of `bogie-braking list`
bogie-braking run bogie-lateral --html                   also report.html: charts that zoom, the motion in space
bogie-braking run line-from-file --line mine.csv         a bogie along your line
bogie-braking run qr30-180kpa --torque-csv measured.csv  with a measured torque
bogie-braking run qr30-180kpa --step 0.1ms               with another macro step
bogie-braking run qr30-180kpa --json | jq .rows          the summary for a program
for name in $(bogie-braking list --quiet); do bogie-braking run $name; done
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

from bogie_braking.common_options import add_out, add_speech, add_track, bars, describe
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from bogie_braking.reporting.progress import ticking
from bogie_braking.reporting.report import Report, save, short_table, stopwatch, table
from bogie_braking.reporting.saved import wall_seconds
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.variables import LARGEST_TOLERANCE
from readers.command_line import check_folder, quantity
from readers.extras import need
from readers.text import BadInputError
from scenarios.catalogue import SCENARIOS, find

#: The largest macro step of any scenario, and the smallest, with which one takes hours [s].
LARGEST_STEP, SMALLEST_STEP = 0.1, 1e-5
#: The smallest coupling error of a macro step above rounding.
SMALLEST_ERROR = 1e-9
PROFILES = """Equivalent conicity (EN 15302), rolling radii and contact angles of wheels on rails from files. A line of
a file is y, z in mm; y = 0 of a wheel is its tape circle, 70 mm from the back of the flange. One file or diameter
serves both sides; two are left and right: run contact-geometry --wheel new.csv worn.csv --rail 60e1.csv --diameter 920
918"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `run`."""
    describe(parser, __doc__)
    parser.add_argument("name", help="a name from 'list'")
    add_out(parser)
    parser.add_argument("--kind", choices=["native", "python"], help="which FMUs (default: native)")
    step, text = quantity("--step", "s", SMALLEST_STEP, LARGEST_STEP), "macro step, as 1ms or 0.001 in seconds"
    parser.add_argument("--step", type=step, metavar="TIME", help=f"{text} (default: 1ms; lock boundary 10ms)")
    text = "torque of the trailing wheelset, a log of time [s] and torque [N.m]"
    parser.add_argument("--torque-csv", type=Path, metavar="FILE", help=text)
    text = "map from the names of --torque-csv to time and torque, a TOML file (default: guessed, and told)"
    parser.add_argument("--columns", type=Path, metavar="FILE", help=text)
    text = "largest error of a macro step, in nominal values; the steps are chosen by it"
    error = quantity("--coupling-tolerance", least=SMALLEST_ERROR, most=LARGEST_TOLERANCE)
    parser.add_argument("--coupling-tolerance", type=error, metavar="ERROR", help=text)
    parser.add_argument("--all", action="store_true", help="also print the rows that are not judged, in their order")
    parser.add_argument("--html", action="store_true", help="also write report.html, one page that needs no other file")
    text = "line for line-from-file: a CSV with the columns distance, curvature, cant, gradient, and more if you like"
    parser.add_argument("--line", type=Path, metavar="FILE", help=text)
    add_profiles(parser)
    add_speech(parser)


def add_profiles(runner: argparse.ArgumentParser) -> None:
    """Add the options of contact-geometry to `run`, in their own group."""
    group = runner.add_argument_group("your profiles, for contact-geometry", PROFILES)
    sides: dict[str, Any] = {"nargs": "+", "action": "extend"}
    group.add_argument("--wheel", type=Path, metavar="FILE", help="profile of both wheels, or left and right", **sides)
    group.add_argument("--rail", type=Path, metavar="FILE", help="profile of both rails, or left and right", **sides)
    add_track(group)


def names() -> Sequence[str]:
    """Return the names of all scenarios."""
    return [scenario.name for scenario in SCENARIOS]


def check(scenario: Scenario, options: Options) -> None:
    """Raise BadInputError if a scenario does not take an option."""
    for name in sorted(options.given - scenario.takes):
        takers = ", ".join(one.name for one in SCENARIOS if name in one.takes)
        raise BadInputError(f"--{name.replace('_', '-')} has no effect on {scenario.name}; it belongs to {takers}.")


def run(chosen: argparse.Namespace) -> int:
    """Run a scenario, save and show its results; return the exit status. Raises BadInputError."""
    check_folder(chosen.out)
    scenario, out = find(chosen.name), chosen.out
    if chosen.all and (chosen.json or chosen.quiet):
        raise BadInputError(f"--all has no effect with {'--json' if chosen.json else '--quiet'}. Leave one out.")
    options = Options(**{item.name: getattr(chosen, item.name) for item in fields(Options)})
    check(scenario, options)
    further = None
    if chosen.html:
        need("plotly")
        from bogie_braking.reporting.html_report import write_report

        further = partial(write_report, scenario)
    elapsed = stopwatch()
    with bars(chosen), ticking(scenario.name, wall_seconds(out / scenario.name)):
        report = scenario.run(options)
        given = {name: getattr(options, name) for name in sorted(options.given)}
        folder = save(report, scenario.name, out, elapsed(), further, given)
    if chosen.json:
        print((folder / "summary.json").read_text(encoding="utf-8"), end="")
    elif not chosen.quiet:
        show(scenario, report, folder, chosen.all)
    return HOLDS if report.holds else DOES_NOT_HOLD


def show(scenario: Scenario, report: Report, folder: Path, whole: bool) -> None:
    """Print the table of a scenario, `whole` or its evaluated rows alone, its remarks, and the place of its results."""
    print(f"{scenario.name}: {scenario.summary}\n")
    print(table(report.rows) if whole else short_table(report.rows, folder))
    if any(row.holds is False for row in report.rows):
        print("\nThe documentation gives the reasons: page Verification, section Known deviations.")
    for remark in report.remarks:
        print(f"\n{remark}")
    print(f"\nPicture: {folder / 'figure.png'}")
    if (folder / "report.html").exists():
        print(f"Report: {folder / 'report.html'}")
