"""The command line of bogie-braking; `python -m bogie_braking` is the same.

  bogie-braking list                                             all scenarios, each in a sentence
  bogie-braking run qr30-180kpa                                  runs one: table, data, figure in results/qr30-180kpa/
  bogie-braking run bogie-heavy-braking --kind python            with the pythonfmu FMUs
  bogie-braking run qr30-180kpa --step 0.1ms                     with another macro step
  bogie-braking run qr30-180kpa --coupling-tolerance 1e-4        with macro steps chosen by the error of the coupling
  bogie-braking run qr30-180kpa --torque-csv measured.csv        with a measured torque (time [s], torque [N.m])
  bogie-braking run contact-geometry --wheel left.csv right.csv --rail 60e1.csv --diameter 920 918
                                                                 equivalent conicity (EN 15302) of your profiles
  bogie-braking run line-from-file --line mine.csv               a bogie along your line
  bogie-braking run bogie-lateral --html                         also report.html: charts that zoom, the motion in space
  bogie-braking report                                           results/index.html: all results on one page
  bogie-braking sweep bogie-heavy-braking --vary friction=0.1:0.3:11 --vary frame_height=0.4,0.8,1.2 --jobs 2
                                                                 every combination in one table; the same command
                                                                 resumes a sweep that was interrupted
  bogie-braking sweep levels --vary utilisation=0.5:1.3:81 --scheduler tcp://127.0.0.1:8786
                                                                 on a Dask cluster
  bogie-braking pace spatial --step 1ms --seconds 10             in real time on this machine: longest step, overruns
  bogie-braking controllers compare mine.py:PI                   scores wheel-slide controllers, in Python and in C
  bogie-braking live                                             pages that brake a coach, a bogie or a train
  bogie-braking build bogie                                      FMUs; build --help says more
  bogie-braking run levels --json | jq .rows                     the summary for a program
  for name in $(bogie-braking list --quiet); do ...              the names alone
  bogie-braking doctor                                           what is installed, what is missing, what to do
  eval "$(bogie-braking completion bash)"                        completion of this command in a shell

Exit status: 0 all rows hold, or all points of a sweep were run; 1 a row does not hold, a point failed, a paced step
overran, or doctor misses something that is needed; 2 bad input; 3 a simulation, a sweep or this program failed; 130
interrupted with Ctrl-C: earlier results and the finished points of a sweep stay; 141 the program that read the output
has ended.
"""

from __future__ import annotations

import argparse
import os
import sys
import traceback
from pathlib import Path
from typing import Any

from bogie_braking.exit_status import BAD_INPUT, FAILED, NOBODY_READS
from fmu_src import __version__
from readers.command_line import CommandLine, quantity
from readers.text import BadInputError

#: The largest macro step of any scenario, and the smallest, with which one takes hours [s].
LARGEST_STEP, SMALLEST_STEP = 0.1, 1e-5
#: The smallest coupling error of a macro step above rounding.
SMALLEST_ERROR = 1e-9


def add_speech(parser: argparse.ArgumentParser, quiet: str, document: str) -> None:
    """Add --quiet and --json to a command, with the given help."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--quiet", action="store_true", help=quiet)
    group.add_argument("--json", action="store_true", help=f"{document} as one JSON document")


CONTROLLERS = "compare wheel-slide controllers, a Python class, C or a library, on the test rig"
PACE = "run an FMU in real time on this machine: longest step, overruns, jitter"
PROFILES = """Equivalent conicity (EN 15302), rolling radii and contact angles of wheels on rails from files. A line of
a file is y, z in mm; y = 0 of a wheel is its tape circle, 70 mm from the back of the flange. One file or diameter
serves both sides; two are left and right: run contact-geometry --wheel new.csv worn.csv --rail 60e1.csv --diameter 920
918"""


def add_profiles(runner: argparse.ArgumentParser) -> None:
    """Add the options of contact-geometry to `run`, in their own group."""
    group = runner.add_argument_group("your profiles, for contact-geometry", PROFILES)
    sides: dict[str, Any] = {"nargs": "+", "action": "extend"}
    group.add_argument("--wheel", type=Path, metavar="FILE", help="profile of both wheels, or left and right", **sides)
    group.add_argument("--rail", type=Path, metavar="FILE", help="profile of both rails, or left and right", **sides)
    text = "diameter of both wheels at the tape circle, or left and right, as 920 or 0.92m (default: 920 mm)"
    group.add_argument("--diameter", type=quantity("--diameter", "mm"), metavar="MM", help=text, **sides)
    text = "gauge, measured 14 mm below the top (default: the y = 0 of both files lie 1500 mm apart)"
    group.add_argument("--gauge", type=quantity("--gauge", "mm"), metavar="MM", help=text)
    text = "distance between the backs of the flanges (default: 1360 mm)"
    group.add_argument("--flange-back", type=quantity("--flange-back", "mm"), metavar="MM", help=text)
    text = "inclines the rails by 1:N, for files in which they stand upright (default: as in the files)"
    group.add_argument("--inclination", type=quantity("--inclination"), metavar="N", help=text)
    text = "side of y in the rails' files that is turned to the middle of the track (default: found by lean or wear)"
    group.add_argument("--gauge-side", choices=("y-", "y+"), help=text, **sides)


def parser_of(asked: str) -> tuple[argparse.ArgumentParser, Any]:
    """Return the command line and its commands; `asked`: the given command, whose options alone are loaded."""
    from scenarios.completion import SHELLS

    parser = CommandLine(
        prog="bogie-braking", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--version", action="version", version=f"bogie-braking {__version__}")
    commands = parser.add_subparsers(dest="command", required=True)
    add_speech(commands.add_parser("list", help="list all scenarios"), "names alone", "names, summaries and options")
    commands.add_parser("doctor", help="say what is installed and what is missing, each with what to do")
    shell = commands.add_parser("completion", help="print a script with which a shell completes this command")
    shell.add_argument("shell", choices=SHELLS)
    runner = commands.add_parser("run", help="run one scenario")
    runner.add_argument("name", help="a name from 'list'")
    runner.add_argument("--out", type=Path, default=Path("results"), help="folder of the results (default: results)")
    runner.add_argument("--kind", choices=["native", "python"], help="which FMUs (default: native)")
    step, text = quantity("--step", "s", SMALLEST_STEP, LARGEST_STEP), "macro step, as 1ms or 0.001 in seconds"
    runner.add_argument("--step", type=step, metavar="TIME", help=f"{text} (default: 1ms; lock boundary 10ms)")
    runner.add_argument(
        "--torque-csv",
        type=Path,
        metavar="FILE",
        help="torque of the trailing wheelset: time [s], torque [N.m]",
    )
    text = "largest error of a macro step, in nominal values; the steps are chosen by it"
    error = quantity("--coupling-tolerance", least=SMALLEST_ERROR)
    runner.add_argument("--coupling-tolerance", type=error, metavar="ERROR", help=text)
    runner.add_argument("--all", action="store_true", help="also print the rows that are not judged, in their order")
    runner.add_argument("--html", action="store_true", help="also write report.html, one page that needs no other file")
    text = "line for line-from-file: a CSV with the columns distance, curvature, cant, gradient, and more if you like"
    runner.add_argument("--line", type=Path, metavar="FILE", help=text)
    text = "for speed, in a checkout: also measure this commit, branch or tag, and print new over old; takes minutes"
    runner.add_argument("--against", metavar="REVISION", help=text)
    add_profiles(runner)
    reporter = commands.add_parser("report", help="join all results into one page")
    text = "folder of the results (default: results)"
    reporter.add_argument("--out", type=Path, default=Path("results"), help=text)
    if asked in ("sweep", "completion"):
        from scenarios.sweep import add_command  # heavy: all scenarios, and what each lets vary

        add_command(commands)
    else:
        commands.add_parser("sweep", help="run one scenario over a grid of parameters")
    form: dict[str, Any]
    if asked in ("pace", "completion"):
        from scenarios.measuring import pace  # heavy: FMUs

        form = {"description": pace.__doc__, "formatter_class": argparse.RawDescriptionHelpFormatter}
        pace.add_arguments(commands.add_parser("pace", help=PACE, **form))
    else:
        commands.add_parser("pace", help=PACE)
    if asked in ("controllers", "completion"):
        from scenarios.controllers import command as controllers  # heavy: NumPy, batches

        form = {"description": controllers.__doc__, "formatter_class": argparse.RawDescriptionHelpFormatter}
        of_controllers = commands.add_parser("controllers", help=CONTROLLERS, **form)
        controllers.add_commands(
            of_controllers,
            lambda one: add_speech(one, "no progress and no table, only the exit status", "the comparison"),
        )
    else:
        commands.add_parser("controllers", help=CONTROLLERS)
    page = commands.add_parser("live", help="write pages that brake a coach, a bogie or a train in any browser")
    page.add_argument("--out", type=Path, default=Path("results"), help="folder of both pages (default: results)")
    for command in ("run", "sweep", "pace"):
        add_speech(commands.choices[command], "no progress and no table, only the exit status", "the summary")
    commands.add_parser("build", help="build FMUs", add_help=False)
    return parser, commands


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit status, as in the description."""
    try:
        status = answer(sys.argv[1:] if arguments is None else arguments)
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left would be written at the exit
        return NOBODY_READS
    except BadInputError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except Exception:
        traceback.print_exc()  # Python would end with the status of a failed row
        return FAILED
    return status


def answer(given: list[str]) -> int:
    """Run a command. Heavy modules are imported by the commands that use them."""
    asked = given[0] if given else ""
    if asked == "build":
        from build_fmu import main as build

        return build(given[1:], "bogie-braking build")
    if given == ["doctor"]:  # before the imports of what it may find missing
        from scenarios import doctor

        return doctor.main()
    parser, commands = parser_of(asked)
    chosen = parser.parse_args(given)
    from bogie_braking import commands as does

    if chosen.command == "list":
        return does.show_list(chosen)
    if chosen.command == "completion":
        return does.show_completion(parser, commands, chosen.shell)
    return does.carry_out(chosen)


if __name__ == "__main__":
    sys.exit(main())
