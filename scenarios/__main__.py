"""Runs the scenarios.

  python -m scenarios list                                       what there is
  python -m scenarios run qr30-180kpa                            run one; results/qr30-180kpa/ has table, data, figure
  python -m scenarios run bogie-heavy-braking --kind python      with the pythonfmu FMUs
  python -m scenarios run qr30-180kpa --step 0.0001              with another macro step
  python -m scenarios run qr30-180kpa --coupling-tolerance 1e-4  macro steps chosen by the error of the coupling
  python -m scenarios run qr30-180kpa --torque-csv measured.csv  with a measured history (time [s], torque [N.m])
  python -m scenarios run contact-geometry --wheel left.csv right.csv --rail 60e1.csv --diameter 920 918
                                                                 equivalent conicity (EN 15302) of profiles of yours
  python -m scenarios run line-from-file --line mine.csv         a bogie along a line of yours
  python -m scenarios run bogie-lateral --html                   and report.html: charts that zoom, the motion in space
  python -m scenarios report                                     results/index.html: all results on one page
  python -m scenarios sweep bogie-heavy-braking --vary friction=0.1:0.3:11 --vary frame_height=0.4,0.8,1.2 --jobs 2
                                                                 every combination, one table; interrupted, it resumes
  python -m scenarios sweep levels --vary utilisation=0.5:1.3:81 --scheduler tcp://127.0.0.1:8786
                                                                 on a Dask cluster
  python -m scenarios live                                       a page that brakes a bogie in any browser
  python -m scenarios run levels --json | jq .rows               the summary for a program; --quiet: the status alone
  for name in $(python -m scenarios list --quiet); do ...        names alone
  python -m scenarios doctor                                     what is there, what is missing, what to do
  eval "$(bogie-braking completion bash)"                        completes the command bogie-braking, which is the same

Exit status: 0 all rows hold (sweep: all points are good), 1 a row does not hold (a point failed; doctor: something that
is needed is missing), 2 bad input, 3 a simulation (the sweep) failed, 130 interrupted (Ctrl-C): finished points of a
sweep are kept, results as they were.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from contextlib import nullcontext
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

from scenarios import doctor

if __name__ == "__main__" and sys.argv[1:2] == ["doctor"]:  # before the imports of what it may find missing
    sys.exit(doctor.main())

from fmu_src.compile import CompilerError
from fmu_src.cosimulation.slave import CosimulationError
from fmu_src.kernel import KernelError
from scenarios.catalogue import SCENARIOS, find
from scenarios.completion import SHELLS, completion
from scenarios.live.page import write_page
from scenarios.reporting.progress import ticking, without_bars
from scenarios.reporting.report import Result, save, short_table, stopwatch, table
from scenarios.scenario import BadInputError, Options, Scenario
from scenarios.sweep import command as sweep
from scenarios.sweep.points import SweepError

HOLDS, DOES_NOT_HOLD, BAD_INPUT, FAILED = range(4)
#: What a shell says of a program that Ctrl-C has ended.
INTERRUPTED = 130
#: The largest macro step that any scenario is meant for [s].
LARGEST_STEP = 0.1


def check(scenario: Scenario, options: Options) -> None:
    step = options.macro_step()
    if not (math.isfinite(step) and 0.0 < step <= LARGEST_STEP):
        raise BadInputError(f"Give --step a value above 0 and up to {LARGEST_STEP} s: it was {step} s.")
    tolerance = options.coupling_tolerance
    if tolerance is not None and not (math.isfinite(tolerance) and tolerance > 0.0):
        raise BadInputError(f"Give --coupling-tolerance a value above 0: it was {tolerance}.")
    for name in sorted(options.given - scenario.takes):
        takers = ", ".join(one.name for one in SCENARIOS if name in one.takes)
        raise BadInputError(f"--{name.replace('_', '-')} has no effect on {scenario.name}; it belongs to {takers}.")


def run(chosen: argparse.Namespace) -> int:
    scenario, out = find(chosen.name), chosen.out
    options = Options(**{item.name: getattr(chosen, item.name) for item in fields(Options)})
    check(scenario, options)
    further = None
    if chosen.html:
        from scenarios.reporting.html_report import write_report  # Plotly: for pages alone

        further = partial(write_report, scenario)
    if out.exists() and not out.is_dir():
        raise BadInputError(f"{out} is a file; give --out a folder.")
    elapsed = stopwatch()
    with ticking(scenario.name, last_time(out / scenario.name)):
        result = scenario.run(options)
        folder = save(result, scenario.name, out, elapsed(), further)
    if chosen.json:
        print((folder / "summary.json").read_text(encoding="utf-8"), end="")
    elif not chosen.quiet:
        show(scenario, result, folder, chosen.all)
    return HOLDS if result.holds else DOES_NOT_HOLD


def last_time(folder: Path) -> float | None:
    """What the results of a scenario, if there are any, say that its run took [s]."""
    try:
        return float(json.loads((folder / "summary.json").read_text(encoding="utf-8"))["wall_seconds"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def show(scenario: Scenario, result: Result, folder: Path, whole: bool) -> None:
    print(f"{scenario.name}: {scenario.summary}\n")
    print(table(result.rows) if whole else short_table(result.rows, folder))
    if any(row.holds is False for row in result.rows):
        print("\nWhat is known not to hold stands with its reason in docs/checking.md, What does not hold.")
    for remark in result.remarks:
        print(f"\n{remark}")
    print(f"\nPicture: {folder / 'figure.png'}")
    if (folder / "report.html").exists():
        print(f"Report: {folder / 'report.html'}")


def index(out: Path) -> int:
    """Joins all results of a folder into one page, and says what is not on it."""
    from scenarios.reporting.index import write_index  # Plotly: for pages alone

    page, skipped = write_index(out)
    for sentence in skipped:
        print(sentence, file=sys.stderr)
    print(f"Index: {page}")
    return HOLDS


def show_list(chosen: argparse.Namespace) -> int:
    width = max(len(scenario.name) for scenario in SCENARIOS)
    if chosen.json:
        about = [{"name": one.name, "summary": one.summary, "options": sorted(one.takes)} for one in SCENARIOS]
        print(json.dumps(about, indent=2))
        return HOLDS
    for scenario in SCENARIOS:
        print(scenario.name if chosen.quiet else f"{scenario.name.ljust(width)}  {scenario.summary}")
    return HOLDS


def show_completion(parser: argparse.ArgumentParser, commands: Any, shell: str) -> int:
    names = {"run": [one.name for one in SCENARIOS], "sweep": [one.name for one in SCENARIOS if one.sweep]}
    print(completion(parser, commands.choices, names, shell))
    return HOLDS


def add_speech(parser: argparse.ArgumentParser, quiet: str, document: str) -> None:
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--quiet", action="store_true", help=quiet)
    group.add_argument("--json", action="store_true", help=f"{document} as one JSON document instead")


PROFILES = """Equivalent conicity (EN 15302), rolling radii and contact angles of wheels on rails from files: lines of
y, z in mm, y = 0 of a wheel on its tape circle, 70 mm from the flange's back. One file or diameter is for both sides,
two are left and right: run contact-geometry --wheel new.csv worn.csv --rail 60e1.csv --diameter 920 918"""


def add_profiles(runner: argparse.ArgumentParser) -> None:
    group = runner.add_argument_group("profiles of yours, for contact-geometry", PROFILES)
    sides: dict[str, Any] = {"nargs": "+", "action": "extend"}
    group.add_argument("--wheel", type=Path, metavar="FILE", help="profile of both wheels, or left and right", **sides)
    group.add_argument("--rail", type=Path, metavar="FILE", help="profile of both rails, or left and right", **sides)
    text = "at the tape circle, of both wheels, or left and right (default: 920)"
    group.add_argument("--diameter", type=float, metavar="MM", help=text, **sides)
    text = "lays the rails by their gauge faces, 14 mm below the top (default: y = 0 of their files 1500 mm apart)"
    group.add_argument("--gauge", type=float, metavar="MM", help=text)
    group.add_argument(
        "--flange-back", type=float, metavar="MM", help="between the backs of the flanges (default: 1360)"
    )
    text = "inclines rails that stand upright in their files by 1:N (default: they lie as in the files)"
    group.add_argument("--inclination", type=float, metavar="N", help=text)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m scenarios", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="command", required=True)
    add_speech(commands.add_parser("list", help="what there is"), "names alone", "names, summaries and options")
    commands.add_parser("doctor", help="what is there and what is missing, each with what to do")
    shell = commands.add_parser("completion", help="a script with which a shell completes the command bogie-braking")
    shell.add_argument("shell", choices=SHELLS)
    runner = commands.add_parser("run", help="run one scenario")
    runner.add_argument("name", help="a name from 'list'")
    runner.add_argument("--out", type=Path, default=Path("results"), help="folder of the results (default: results)")
    runner.add_argument("--kind", choices=["native", "python"], help="which FMUs (default: native)")
    runner.add_argument("--step", type=float, metavar="SECONDS", help="macro step (default: 0.001; lock boundary 0.01)")
    runner.add_argument(
        "--torque-csv", type=Path, metavar="FILE", help="time [s], torque [N.m] of the trailing wheelset"
    )
    text = "error of one step in nominal values; chooses the macro steps"
    runner.add_argument("--coupling-tolerance", type=float, metavar="ERROR", help=text)
    runner.add_argument("--all", action="store_true", help="print the rows that are not judged too, in their order")
    runner.add_argument("--html", action="store_true", help="write report.html too, a page that needs nothing else")
    text = "line for line-from-file, a table with its head: distance, curvature, cant, gradient and more (docs/line.md)"
    runner.add_argument("--line", type=Path, metavar="FILE", help=text)
    add_profiles(runner)
    reporter = commands.add_parser("report", help="join all results into one page")
    text = "folder of the results (default: results)"
    reporter.add_argument("--out", type=Path, default=Path("results"), help=text)
    sweep.add_command(commands)
    page = commands.add_parser("live", help="write a page that brakes a bogie, or a coach, in any browser")
    page.add_argument("--out", type=Path, default=Path("results"), help="folder of live.html (default: results)")
    for command in ("run", "sweep"):
        add_speech(commands.choices[command], "no progress, no table: the exit status tells", "the summary")
    chosen = parser.parse_args(arguments)
    if chosen.command == "list":
        return show_list(chosen)
    if chosen.command == "doctor":
        return doctor.main()
    if chosen.command == "completion":
        return show_completion(parser, commands, chosen.shell)
    try:
        if chosen.command == "live":
            print(f"Open in a browser: {write_page(chosen.out / 'live.html')}")
            return HOLDS
        if chosen.command == "report":
            return index(chosen.out)
        with without_bars() if chosen.quiet else nullcontext():
            if chosen.command == "sweep":
                return HOLDS if sweep.run(chosen) else DOES_NOT_HOLD
            return run(chosen)
    except BadInputError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt as interrupt:
        earlier = f"Interrupted; what {chosen.out} held before is as it was."
        print(interrupt if interrupt.args else earlier, file=sys.stderr)
        return INTERRUPTED
    except (CosimulationError, CompilerError, KernelError, SweepError) as error:
        print(error, file=sys.stderr)
        return FAILED
    except OSError as error:
        print(
            f"The results cannot be written to {chosen.out} ({error}); choose another folder with --out.",
            file=sys.stderr,
        )
        return FAILED


if __name__ == "__main__":
    sys.exit(main())
