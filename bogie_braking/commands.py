"""Actions of the command line."""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import nullcontext
from dataclasses import fields
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from bogie_braking.exit_status import BAD_INPUT, DOES_NOT_HOLD, FAILED, HOLDS, INTERRUPTED
from fmu_src.compile import CompilerError
from fmu_src.cosimulation.slave import CosimulationError
from fmu_src.kernel import SimulationError
from products.prebuilt import PAGE
from products.registry import FMUS
from products.study.points import SweepError
from readers.command_line import check_folder
from readers.storage import StorageError, cannot_write
from scenarios import sweep
from scenarios.catalogue import SCENARIOS, find
from scenarios.completion import completion
from scenarios.controllers import command as controllers
from scenarios.live.page import write_page
from scenarios.live.train_page import PAGE as TRAIN_PAGE
from scenarios.live.train_page import write_train_page
from scenarios.measuring import pace
from scenarios.reporting.progress import ticking, without_bars
from scenarios.reporting.report import Report, save, short_table, stopwatch, table
from scenarios.reporting.saved import wall_seconds
from scenarios.scenario import BadInputError, Options, Scenario

#: Commands that write into the folder of --out.
WRITING = {"run", "sweep", "report", "live", "compare", "replay", "loop"}


def check(scenario: Scenario, options: Options) -> None:
    """Raise BadInputError if a scenario does not take an option."""
    for name in sorted(options.given - scenario.takes):
        takers = ", ".join(one.name for one in SCENARIOS if name in one.takes)
        raise BadInputError(f"--{name.replace('_', '-')} has no effect on {scenario.name}; it belongs to {takers}.")


def run(chosen: argparse.Namespace) -> int:
    """Run a scenario, save and show its results; return the exit status. Raises BadInputError."""
    scenario, out = find(chosen.name), chosen.out
    options = Options(**{item.name: getattr(chosen, item.name) for item in fields(Options)})
    check(scenario, options)
    further = None
    if chosen.html:
        look_for_plotly()
        from scenarios.reporting.html_report import write_report

        further = partial(write_report, scenario)
    elapsed = stopwatch()
    with ticking(scenario.name, wall_seconds(out / scenario.name)):
        report = scenario.run(options)
        folder = save(report, scenario.name, out, elapsed(), further)
    if chosen.json:
        print((folder / "summary.json").read_text(encoding="utf-8"), end="")
    elif not chosen.quiet:
        show(scenario, report, folder, chosen.all)
    return HOLDS if report.holds else DOES_NOT_HOLD


def look_for_plotly() -> None:
    """Raise BadInputError before a run if Plotly, an optional dependency, is not installed."""
    if find_spec("plotly") is None:
        raise BadInputError("A page of results needs Plotly: pip install 'bogie-braking[pages]'.")


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


def index(out: Path) -> int:
    """Join all results of a folder into one page, and print which are left out."""
    look_for_plotly()
    from scenarios.reporting.index import write_index

    page, skipped = write_index(out)
    for sentence in skipped:
        print(sentence, file=sys.stderr)
    print(f"Index: {page}")
    return HOLDS


def show_list(chosen: argparse.Namespace) -> int:
    """Print all scenarios, as text, as names alone or as JSON."""
    width = max(len(scenario.name) for scenario in SCENARIOS)
    if chosen.json:
        about = [
            {"name": one.name, "group": one.group, "summary": one.summary, "options": sorted(one.takes)}
            for one in SCENARIOS
        ]
        print(json.dumps(about, indent=2))
        return HOLDS
    if chosen.quiet:
        print(*(one.name for one in SCENARIOS), sep="\n")
        return HOLDS
    for number, group in enumerate(dict.fromkeys(one.group for one in SCENARIOS)):
        print("\n" * bool(number) + f"{group}:")
        for scenario in SCENARIOS:
            if scenario.group == group:
                print(f"  {scenario.name.ljust(width)}  {scenario.summary}")
    return HOLDS


def show_completion(parser: argparse.ArgumentParser, commands: Any, shell: str) -> int:
    """Print the script with which a shell completes the command line."""
    names = {"run": [one.name for one in SCENARIOS], "sweep": [one.name for one in SCENARIOS if one.sweep]}
    names["pace"] = [*FMUS, *pace.LEVELS]
    print(completion(parser, commands.choices, names, shell))
    return HOLDS


def carry_out(chosen: argparse.Namespace) -> int:
    """Run a command that writes results, and return the exit status."""
    try:
        if {chosen.command, getattr(chosen, "action", None)} & WRITING:
            check_folder(chosen.out)
        if chosen.command == "live":
            pages = write_page(chosen.out / PAGE), write_train_page(chosen.out / TRAIN_PAGE)
            print("Open in a browser:", *(page.resolve().as_uri() for page in pages), sep="\n")
            return HOLDS
        if chosen.command == "report":
            return index(chosen.out)
        with without_bars() if chosen.quiet else nullcontext():
            if chosen.command == "pace":
                return HOLDS if pace.run(chosen) else DOES_NOT_HOLD
            if chosen.command == "controllers":
                return HOLDS if controllers.run(chosen) else DOES_NOT_HOLD
            if chosen.command == "sweep":
                return HOLDS if sweep.run(chosen) else DOES_NOT_HOLD
            return run(chosen)
    except BadInputError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt as interrupt:
        out = getattr(chosen, "out", None)
        earlier = "Interrupted." if out is None else f"Interrupted; what {out} held before is as it was."
        print(interrupt if interrupt.args else earlier, file=sys.stderr)
        return INTERRUPTED
    except (CosimulationError, CompilerError, SimulationError, SweepError) as error:
        print(error, file=sys.stderr)
        return FAILED
    except BrokenPipeError:
        raise
    except StorageError as error:
        print(error, file=sys.stderr)
        return FAILED
    except OSError as error:
        print(cannot_write(getattr(chosen, "out", Path()), error, "choose another folder with --out"), file=sys.stderr)
        return FAILED
