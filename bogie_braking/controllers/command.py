"""Compare wheel-slide controllers on the test rig, replay logs, and run the rig behind a socket.

  bogie-braking controllers compare mine.py:PI           scores, a plot and a page of stops with your controller
  bogie-braking controllers report mine.c                accepted or rejected, by which criterion in which case
  bogie-braking controllers replay log.csv mine.py:PI    its commands in a recorded run
  bogie-braking controllers loop --rail low              the rig behind a UDP socket, paced by the clock
  bogie-braking controllers answer mine.py:PI            a client of such a rig, also on another machine
  bogie-braking controllers client c > udp_client.c      the client of a controller in C; also: python
  bogie-braking controllers header > wheel_slide.h       the header of a controller in C
  bogie-braking controllers reference -o protection      the built-in protection in C, with stops that check a port
  bogie-braking controllers programme > my.toml          a case file, a start for your own
  bogie-braking controllers criteria > limits.toml       criteria of acceptance, a start for your own

'compare --help', 'report --help', 'replay --help' and 'loop --help' say more. A class has the method
step(time, wheel_speeds) -> valves: [s], [m/s] -> 0 apply, 1 hold or 2 vent for each wheelset.

Exit status: 0 if all controllers stopped everywhere. 1 if one did not stop, failed, has no verdict, missed a period in
the loop, or was not accepted by a report. 2: bad input. 3: the simulation failed. 130: interrupted with Ctrl-C.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bogie_braking.controllers import answering, loop, reference, replay, report, verdict
from bogie_braking.controllers.controller_loader import controllers_of
from bogie_braking.controllers.options import add_case, add_draws, add_settings, plan_of, rigged
from bogie_braking.controllers.page import page
from bogie_braking.controllers.picture import draw
from bogie_braking.controllers.scoring import Scored, compare, ideal_distance, runs_of
from bogie_braking.controllers.table import document, drawn, lines, write_document
from bogie_braking.reporting.plots import plt
from bogie_braking.reporting.scenario import BadInputError
from brake_controller.slide_protection import RIG
from products.machine import TRACTION
from products.protection.criteria import CRITERIA
from products.protection.programme import OWN
from products.protection.rails import RAILS
from products.protection.spread import Spread
from readers.command_line import whole
from readers.storage import write_whole

#: Help of `compare`.
COMPARE = """Score wheel-slide controllers on the test rig: a table, a plot, a JSON file, and an animated page.

  bogie-braking controllers compare mine.py:PI                    a Python class, with none and the built-in one
  bogie-braking controllers compare mine.py:PI libpi.so           and a shared library
  bogie-braking controllers compare pi.c --vehicle coach          C, compiled now; on the coach
  bogie-braking controllers compare pi.fmu                        an FMU; pi.toml next to it may name its variables
  bogie-braking controllers compare 'mine.py:PI(kp=0.3)' 'mine.py:PI(kp=0.5)'
                                                                  a class with two choices of its gains
  bogie-braking controllers compare mine.py:PI --rails low,wet    on these rails alone
  bogie-braking controllers compare mine.py:PI --programme full   40 cases: 60 to 200 km/h, sensors and valves that fail
  bogie-braking controllers compare mine.py:Spin --programme starts
                                                                  driven wheels that must not spin
  bogie-braking controllers compare mine.py:PI --programme my.toml
                                                                  your own cases (controllers programme > my.toml)
  bogie-braking controllers compare mine.py:PI --speed 160km/h --pulses 80 --period 10ms
  bogie-braking controllers compare mine.py:PI --html             and results/controllers/compare.html, animated
  bogie-braking controllers compare mine.py:PI --json | jq .runs  for a program

All controllers make the same stops with the same brake, sensors and rails; cylinders fill by flow of air from a
reservoir. Without a controller the wheels may lock. The ideal has the best slip at every instant. Measures are in the
manner of EN 15595, without any claim of conformity.

Each case is drawn 8 times or more: other phases and errors of the sensors' teeth, and friction and load that differ by
some per cent, the same for all controllers. A distance is the mean, with its 95 % interval. Draws are added until the
controllers are told apart, to at most --draws. Controllers that the draws do not tell apart are called so.

Exit status: 0 all controllers stopped everywhere; 1 one did not stop, failed or has no verdict; 2 bad input; 3 the
simulation failed; 130 interrupted with Ctrl-C.
"""


def add_commands(parser: argparse.ArgumentParser, speech: Callable[[argparse.ArgumentParser], None]) -> None:
    """Add the actions on controllers; speech: adds the options for less output to a command."""
    actions = parser.add_subparsers(dest="action", required=True)

    def form(text: str | None) -> dict[str, Any]:
        return {"description": text, "formatter_class": argparse.RawDescriptionHelpFormatter}

    compare = actions.add_parser("compare", help="score controllers on the same rails", **form(COMPARE))
    add_arguments(compare)
    speech(compare)
    reported = actions.add_parser("report", help="accept or reject a controller", **form(report.__doc__))
    report.add_arguments(reported)
    speech(reported)
    replayed = actions.add_parser(
        "replay", help="give a controller the wheel speeds of a recorded run", **form(replay.__doc__)
    )
    replay.add_arguments(replayed)
    speech(replayed)
    looped = actions.add_parser(
        "loop", help="put the rig behind a UDP socket, paced by the clock", **form(loop.__doc__)
    )
    loop.add_arguments(looped)
    add_case(looped)
    speech(looped)
    answered = actions.add_parser("answer", help="answer such a rig with a Python class", **form(answering.__doc__))
    answering.add_arguments(answered)
    client = actions.add_parser("client", help="print a client of such a rig, which goes to another machine")
    client.add_argument("language", choices=list(answering.CLIENTS))
    actions.add_parser("header", help="print wheel_slide.h, which a controller in C includes")
    referenced = actions.add_parser(
        "reference", help="write the built-in protection in C, or check a port of it", **form(reference.__doc__)
    )
    reference.add_arguments(referenced)
    speech(referenced)
    actions.add_parser("programme", help="print the built-in test suite, a start for your own")
    actions.add_parser("criteria", help="print the built-in criteria, a start for your own")
    parser.set_defaults(quiet=False, json=False, out=Path("results"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    text = "FILE.py:CLASS, also with gains, 'FILE.py:CLASS(kp=0.3)'; a library; C that includes wheel_slide.h; an FMU; "
    text += "dump-valve"
    parser.add_argument("controller", nargs="*", help=text)
    level, text = whole("--level", 2, 3), "2 in the plane (default), 3 in space"
    parser.add_argument("--level", type=level, default=2, metavar="LEVEL", help=text)
    group = parser.add_mutually_exclusive_group()
    text = f"some of {','.join(rail.name for rail in RAILS)} (default: all)"
    group.add_argument("--rails", default="", metavar="NAMES", help=text)
    text = "a TOML file with cases; full: the built-in test suite; starts: the one for driven wheels"
    group.add_argument("--programme", metavar="FILE", help=text)
    parser.add_argument("--html", action="store_true", help="also write a page that plays all stops side by side")
    add_draws(parser)
    add_settings(parser, Spread().jitter)


def run(chosen: argparse.Namespace) -> bool:
    """Compare and report, or print a file; return whether all stopped. Raises BadInputError, CompilerError."""
    printed = {"header": RIG / "wheel_slide.h", "programme": OWN, "criteria": CRITERIA}
    if chosen.action == "client":
        printed["client"] = RIG / answering.CLIENTS[chosen.language]
    if chosen.action in printed:
        print(printed[chosen.action].read_text(encoding="utf-8"), end="")
        return True
    if chosen.action == "answer":
        return answering.run(chosen)
    if chosen.action == "reference":
        return reference.run(chosen)
    if chosen.action == "report":
        return report.run(chosen)
    if chosen.action == "replay":
        return replay.run(chosen)
    if chosen.action == "loop":
        return run_loop(chosen)
    machine, settings, cases = rigged(chosen)
    controllers = controllers_of(chosen.controller, len(machine.numbers), TRACTION in cases[0].equipment)
    plan, slow = plan_of(chosen, controllers)
    scores = compare(machine, controllers, cases, settings, plan, chosen.level, chosen.html, verdict.decided)
    draws = drawn(scores, plan, slow)
    folder = chosen.out / "controllers"
    found = verdict.verdicts(scores)
    about = document(machine.title, settings, scores, plan) | {"verdict": verdict.document(found)}
    for name in ("compare.png", "compare.html"):  # of an earlier comparison
        (folder / name).unlink(missing_ok=True)
    text = write_document(folder / "compare.json", about)
    figure = draw(scores)
    figure.savefig(folder / "compare.png")
    plt.close(figure)
    if chosen.html:
        write_whole(folder / "compare.html", page(machine.title, machine, settings, scores, draws).encode())
    if chosen.json:
        print(text, end="")
    elif not chosen.quiet:
        table = [*verdict.lines(found), "", *lines(machine.title, settings, scores, draws)]
        places = [f"Page: {folder / 'compare.html'}"] if chosen.html else []
        print("\n".join([*table, "", f"Picture: {folder / 'compare.png'}", *places]))
    return all(score.stop.distance is not None for score in scores)


def run_loop(chosen: argparse.Namespace) -> bool:
    """Run one stop of a client in the loop; return whether it stopped without a missed period."""
    machine, settings, known = rigged(chosen)
    cases = {case.name: case for case in known}
    if chosen.rail not in cases:
        raise BadInputError(f"There is no case {chosen.rail}; give --rail one of {', '.join(cases)}.")
    [run] = runs_of(machine, [cases[chosen.rail]])
    with loop.socket_at(chosen.host, chosen.port) as own:
        found = loop.run_in_loop(machine, run, settings, own, chosen.pace)
    ideal = ideal_distance(machine, run, settings)
    score = Scored(chosen.rail, "client", found.stop, machine.parameters.wheel_radius, ideal, None, run.driven)
    about = document(machine.title, settings, [score]) | {"loop": loop.document(found)}
    text = write_document(chosen.out / "controllers" / "loop.json", about)
    if chosen.json:
        print(text, end="")
    elif not chosen.quiet:
        print("\n".join([*lines(machine.title, settings, [score]), "", *loop.messages(found)]))
    return found.holds
