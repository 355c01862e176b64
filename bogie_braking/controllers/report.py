"""Accept or reject a wheel-slide controller: cases and criteria in the manner of EN 15595 and UIC 541-05.

  bogie-braking controllers report mine.c                        the 40 built-in cases and criteria
  bogie-braking controllers report mine.py:PI --vehicle coach    a Python class, on the coach
  bogie-braking controllers report mine.c --vehicle regio.toml   on your vehicle, from its data sheet
  bogie-braking controllers report                               the built-in protection
  bogie-braking controllers report mine.c --programme my.toml --criteria limits.toml
                                                                 your own cases and limits
  bogie-braking controllers report mine.c --html                 and results/controllers/report.html, animated
  bogie-braking controllers report --check results/controllers/report.json
                                                                 make a report again, and compare

It writes results/controllers/report.json: verdict, findings and stops, with SHA-256 digests of controller, cases and
criteria. A distance, a share or an air is the mean over draws: a criterion passes or fails if its interval lies on one
side of the limit. Cases for which it does not are drawn more often, to at most --draws. Locks, flats, pressures,
vents, commands and jerk are those of the worst draw.

No claim of conformity: the standards could not be read, and all stops are simulated.

Exit status: 0 accepted, or the report was reproduced; 1 rejected, not decided, or not reproduced; 2 bad input; 3 the
simulation failed; 130 interrupted with Ctrl-C.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bogie_braking.controllers.acceptance import ACCEPTED, findings, stops_for_report
from bogie_braking.controllers.controller_loader import IN_PYTHON, Given, controller_of
from bogie_braking.controllers.options import add_draws, add_settings, cases_of, plan_of, rigged
from bogie_braking.controllers.report_document import (
    check_message,
    differences,
    input_differences,
    inputs_of,
    read_report,
    report_document,
)
from bogie_braking.controllers.report_page import report_page
from bogie_braking.controllers.report_text import lines, undecided_note
from bogie_braking.controllers.scoring import DrawsPlan
from bogie_braking.controllers.table import about, drawn, show, write_document
from bogie_braking.reporting.scenario import BadInputError
from products.machine import MACHINES, TRACTION
from products.protection.criteria import CRITERIA, Criterion, check_scopes, read_criteria
from products.protection.programme import PROGRAMMES, Case
from products.protection.rig_in_c import slide_protection
from products.protection.spread import Spread
from readers.command_line import CommandLine, whole
from readers.storage import write_whole

#: Name of the built-in protection.
BUILT_IN = "protection"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    text = "as in 'controllers compare'; without one, the built-in protection"
    parser.add_argument("controller", nargs="?", help=text)
    text = "a TOML file with cases (default: full, the built-in ones)"
    parser.add_argument("--programme", metavar="FILE", help=text)
    text = "a TOML file with criteria (default: the built-in ones)"
    parser.add_argument("--criteria", metavar="FILE", help=text)
    level, text = whole("--level", 2, 3), "2 in the plane (default), 3 in space"
    parser.add_argument("--level", type=level, default=2, metavar="LEVEL", help=text)
    parser.add_argument("--html", action="store_true", help="also write a page that plays the first draw of each case")
    text = "make this report again with its own options, and compare; only files may be given in addition"
    parser.add_argument("--check", type=Path, metavar="REPORT", help=text)
    add_draws(parser)
    add_settings(parser, Spread().jitter)


def run(chosen: argparse.Namespace) -> bool:
    """Report on a controller; return whether it is accepted, or with --check whether the report was reproduced.

    Raises
    ------
    BadInputError
        If the controller, a file or an option is invalid.
    """
    if chosen.check:
        return check(chosen)
    document, shown, page = made(chosen)
    folder = chosen.out / "controllers"
    (folder / "report.html").unlink(missing_ok=True)  # of an earlier report
    text = write_document(folder / "report.json", document)
    if page:
        write_whole(folder / "report.html", page.encode())
    places = [f"Page: {folder / 'report.html'}"] if page else []
    show(chosen, text, [*shown, "", f"Report: {folder / 'report.json'}", *places])
    return bool(document["verdict"] == ACCEPTED)


def check(chosen: argparse.Namespace) -> bool:
    """Make a report again, and print whether it is reproduced; a controller whose digest is another is not run."""
    report = read_report(chosen.check)
    parser = CommandLine(add_help=False)
    add_arguments(parser)
    refuse_options(chosen, parser.parse_args([]))
    again = parser.parse_args(report["arguments"])
    for name in ("controller", "programme", "criteria"):
        setattr(again, name, getattr(chosen, name) or getattr(again, name))
    again.vehicle = again.vehicle if chosen.vehicle in MACHINES else chosen.vehicle
    again.programme, again.rails = again.programme or "full", ""
    found = input_differences(report, inputs_of(files_of(again, cases_of(again))))
    if not found:
        document, _, _ = made(again)
        # A file in another place may have another name.
        named = {key: report.get(key) for key in ("controller", "message")} if chosen.controller else {}
        found = differences(report, document | named)
    print(check_message(chosen.check, found, len(report["findings"])))
    return not found


def refuse_options(chosen: argparse.Namespace, default: argparse.Namespace) -> None:
    """Refuse options beside --check that a report has already. Raises BadInputError."""
    free = {"check", "controller", "programme", "criteria", "quiet", "json", "out"}
    free |= set() if chosen.vehicle in MACHINES and chosen.vehicle != default.vehicle else {"vehicle"}
    given = [name for name, value in vars(default).items() if name not in free and getattr(chosen, name) != value]
    if given:
        names = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise BadInputError(
            f"--check takes all options from the report; got {names}. Only files may be given: leave it out."
        )


def made(chosen: argparse.Namespace) -> tuple[dict[str, Any], list[str], str]:
    """Return the document of a report, its lines for the terminal, and its page, empty if not requested."""
    chosen.programme, chosen.rails = chosen.programme or "full", ""
    machine, settings, cases = rigged(chosen)
    if TRACTION in cases[0].equipment:
        raise BadInputError("A report must be about stops; got starts. Give --programme cases without traction.")
    criteria = criteria_of(chosen.criteria, cases)
    name, controller = given_controller(chosen.controller, len(machine.numbers))
    plan, slow = plan_of(chosen, {name: controller})
    inputs = inputs_of(files_of(chosen, cases))
    tested = stops_for_report(machine, name, controller, cases, criteria, settings, plan, chosen.level, chosen.html)
    found = findings(tested, criteria, len(plan.looks))
    document = report_document(name, arguments_of(chosen, plan), inputs, tested, criteria, found)
    scores = [one.score for one in tested]
    conditions = [about(machine.title, settings, scores), drawn(scores, plan, slow)]
    shown = [*lines(name, found, criteria), "", *conditions, *filter(None, [undecided_note(found, plan.most)])]
    page = report_page(machine, "; ".join(conditions), document, tested, criteria, found) if chosen.html else ""
    return document, shown, page


def criteria_of(path: str | None, cases: Sequence[Case]) -> list[Criterion]:
    """Return the criteria of a file, or the built-in ones. Raises BadInputError."""
    try:
        criteria = read_criteria(Path(path) if path else CRITERIA)
        check_scopes(criteria, cases)
    except OSError:
        raise BadInputError(f"There is no file {path}; give --criteria a TOML file.") from None
    except ValueError as error:
        raise BadInputError(str(error)) from None
    return criteria


def given_controller(given: str | None, wheelsets: int) -> tuple[str, Given]:
    """Return the name of a controller and its form. Raises BadInputError."""
    return controller_of(given, wheelsets) if given else (BUILT_IN, slide_protection())


def files_of(chosen: argparse.Namespace, cases: Sequence[Case]) -> dict[str, Path]:
    """Return the files of a report: controller, vehicle, cases, lines, criteria; variables of an FMU.

    Built-in protection and vehicles are part of the sources.
    """
    files = {f"line of {case.name}": case.line_file for case in cases if case.line_file}
    if chosen.controller:
        in_python = IN_PYTHON.fullmatch(chosen.controller)
        files["controller"] = Path(in_python["file"] if in_python else chosen.controller)
        names = files["controller"].with_suffix(".toml")
        if files["controller"].suffix == ".fmu" and names.is_file():
            files["variables"] = names
    if chosen.vehicle not in MACHINES:
        files["vehicle"] = Path(chosen.vehicle)
    return files | {
        "programme": PROGRAMMES.get(chosen.programme or "full", Path(chosen.programme or "full")),
        "criteria": Path(chosen.criteria) if chosen.criteria else CRITERIA,
    }


def arguments_of(chosen: argparse.Namespace, plan: DrawsPlan) -> list[str]:
    """Return the arguments with which the command makes the same report."""
    given = {
        "programme": chosen.programme,
        "criteria": chosen.criteria,
        "level": chosen.level,
        "vehicle": chosen.vehicle,
        "speed": f"{chosen.speed!r} m/s",
        "brake-ratio": chosen.brake_ratio,
        "period": f"{chosen.period!r} s",
        "pulses": chosen.pulses,
        "jitter": chosen.jitter,
        "draws": plan.most,
        "seed": plan.seed,
        "friction-spread": plan.spread.friction,
        "load-spread": plan.spread.load,
    }
    options = [f"--{name}={value}" for name, value in given.items() if value is not None]
    return [chosen.controller, *options] if chosen.controller else options
