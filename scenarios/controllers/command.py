"""Compares wheel-slide controllers on the test rig: one score table, one picture, one JSON file, and a page that plays.

  bogie-braking controllers compare mine.py:PI                    a Python class; none and our own stand beside it
  bogie-braking controllers compare mine.py:PI libpi.so           and a shared library
  bogie-braking controllers compare pi.c --vehicle vehicle        C, compiled now; on the coach
  bogie-braking controllers compare pi.fmu                        an FMU; pi.toml beside it may name its variables
  bogie-braking controllers compare 'mine.py:PI(kp=0.3)' 'mine.py:PI(kp=0.5)'
                                                                  a class with two choices of its gains
  bogie-braking controllers compare mine.py:PI --rails low,wet    on these rails alone
  bogie-braking controllers compare mine.py:PI --programme full   32 cases: 60 to 200 km/h, sensors and valves that fail
  bogie-braking controllers compare mine.py:Spin --programme starts
                                                                  driven wheels that must not spin
  bogie-braking controllers compare mine.py:PI --programme my.toml
                                                                  cases of your own (controllers programme > my.toml)
  bogie-braking controllers compare mine.py:PI --speed 160km/h --teeth 80 --period 10ms
  bogie-braking controllers compare mine.py:PI --html             and results/controllers/compare.html, which plays
  bogie-braking controllers compare mine.py:PI --json | jq .runs  for a program
  bogie-braking controllers header > wheel_slide.h                what a controller in C includes
  bogie-braking controllers replay log.csv mine.py:PI             what it would have done in a recorded run
  bogie-braking controllers loop --rail low                       behind a UDP socket, paced by the clock, for
  bogie-braking controllers answer mine.py:PI                     a client in another process, or on another machine
  bogie-braking controllers client c > udp_client.c               the client of a controller in C; also: python

A class has the method step(time, wheel_speeds) -> valves: [s], [m/s] -> 0 apply, 1 hold or 2 vent for each wheelset.
All make the same stops with the same brake, sensors and rails; cylinders fill by flow of air from a reservoir. Without
a controller the wheels may lock.
The ideal has the best slip at every instant. Measures in the manner of EN 15595, without any claim of conformity.

Each case is run with the looks of the controllers in three places between two teeth of the sensors. A distance is the
mean of those stops; controllers whose difference is within that spread are called equal.

Exit status: 0 all controllers stopped everywhere; 1 one did not stop, failed, was not judged, or missed a period in the
loop; 2 bad input; 3 the simulation failed; 130 interrupted with Ctrl-C.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from brake_controller.slide_protection import RIG
from products.machine import MACHINES, TRACTION
from products.protection.programme import OWN, PROGRAMMES, Case, four_rails, read_programme, speed_of
from products.protection.rails import RAILS
from products.protection.settings import MOST_JITTER, STRONGEST, Settings
from readers.storage import write_whole
from scenarios.controllers import answering, loop, replay, verdict
from scenarios.controllers.controller_loader import controllers_of
from scenarios.controllers.page import page
from scenarios.controllers.picture import draw
from scenarios.controllers.scoring import PHASES, Scored, compare, ideal_distance, runs_of
from scenarios.controllers.table import document, lines, write_document
from scenarios.measuring.pace import time_of
from scenarios.reporting.plots import plt
from scenarios.scenario import BadInputError

#: Stops of each case at most: two phases then lie a hundredth of a tooth apart.
MOST_PHASES = 100


def add_commands(parser: argparse.ArgumentParser, speech: Callable[[argparse.ArgumentParser], None]) -> None:
    """What can be done with controllers; speech: gives a command its ways of printing less."""
    actions = parser.add_subparsers(dest="action", required=True)
    form: dict[str, Any] = {"description": __doc__, "formatter_class": argparse.RawDescriptionHelpFormatter}
    compare = actions.add_parser("compare", help="score controllers on the same rails", **form)
    add_arguments(compare)
    speech(compare)
    replayed = actions.add_parser("replay", help="give a controller the wheel speeds of a recorded run", **form)
    replay.add_arguments(replayed)
    speech(replayed)
    looped = actions.add_parser("loop", help="put the rig behind a UDP socket, paced by the clock", **form)
    loop.add_arguments(looped)
    add_case(looped)
    speech(looped)
    answering.add_arguments(actions.add_parser("answer", help="answer such a rig with a Python class", **form))
    client = actions.add_parser("client", help="print a client of such a rig, which goes to another machine")
    client.add_argument("language", choices=list(answering.CLIENTS))
    actions.add_parser("header", help="print wheel_slide.h, which a controller in C includes")
    actions.add_parser("programme", help="print the programme that comes along, to begin one of your own with")
    parser.set_defaults(quiet=False, json=False, out=Path("results"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    text = "FILE.py:CLASS, also with gains, 'FILE.py:CLASS(kp=0.3)'; a library; C that includes wheel_slide.h; an FMU"
    parser.add_argument("controller", nargs="*", help=text)
    parser.add_argument("--level", type=int, choices=(2, 3), default=2, help="2 in the plane (default), 3 in space")
    group = parser.add_mutually_exclusive_group()
    text = f"some of {','.join(rail.name for rail in RAILS)} (default: all)"
    group.add_argument("--rails", default="", metavar="NAMES", help=text)
    text = "a TOML file with cases; full: the programme that comes along; starts: the one for driven wheels"
    group.add_argument("--programme", metavar="FILE", help=text)
    text = f"stops of each case, with looks elsewhere between two teeth, 1 to {MOST_PHASES} (default: {PHASES})"
    parser.add_argument("--phases", type=int, default=PHASES, metavar="N", help=text)
    parser.add_argument("--html", action="store_true", help="also write a page that plays all stops side by side")
    add_settings(parser)


def add_case(parser: argparse.ArgumentParser) -> None:
    """Options of one stop alone."""
    text = f"one of {','.join(rail.name for rail in RAILS)}, or a case of the programme (default: low)"
    parser.add_argument("--rail", default="low", metavar="NAME", help=text)
    parser.add_argument("--programme", metavar="FILE", help="a TOML file with cases, full or starts")
    parser.set_defaults(rails="")
    add_settings(parser)


def add_settings(parser: argparse.ArgumentParser) -> None:
    """Options of all stops."""
    parser.add_argument("--vehicle", choices=list(MACHINES), default="bogie", help="bogie, or vehicle: the coach")
    parser.add_argument("--speed", default="25", help="at the start, as 25m/s or 160km/h (default: 25 m/s)")
    parser.add_argument("--strength", type=float, default=1.0, help="torque over that of the full brake (default: 1)")
    parser.add_argument("--period", default="5ms", metavar="TIME", help="of the controllers (default: 5ms)")
    parser.add_argument("--teeth", type=int, default=Settings.pulses, help="of each sensor (default: 100)")
    text = "standard deviation of the teeth's places, as a share of the pitch (default: 0)"
    parser.add_argument("--jitter", type=float, default=0.0, help=text)
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder of the results (default: results)")


def cases_of(chosen: argparse.Namespace) -> list[Case]:
    """The cases that are asked for. Raises BadInputError."""
    if chosen.programme:
        path = PROGRAMMES.get(chosen.programme) or Path(chosen.programme)
        try:
            return read_programme(path)
        except OSError:
            raise BadInputError(f"There is no file {path}; give a programme, or {' or '.join(PROGRAMMES)}.") from None
        except ValueError as error:
            raise BadInputError(str(error)) from None
    known = {case.name: case for case in four_rails()}
    names = [name.strip() for name in chosen.rails.split(",") if name.strip()] or list(known)
    for name in names:
        if name not in known:
            raise BadInputError(f"There is no rail {name}; give some of {', '.join(known)}.")
        if names.count(name) > 1:
            raise BadInputError(f"Give each of --rails once: {name} was there {names.count(name)} times.")
    return [known[name] for name in names]


def run(chosen: argparse.Namespace) -> bool:
    """Compares and reports, or prints a file; whether all stopped. Raises BadInputError, CompilerError."""
    printed = {"header": RIG / "wheel_slide.h", "programme": OWN}
    if chosen.action == "client":
        printed["client"] = RIG / answering.CLIENTS[chosen.language]
    if chosen.action in printed:
        print(printed[chosen.action].read_text(encoding="utf-8"), end="")
        return True
    if chosen.action == "answer":
        return answering.run(chosen)
    if chosen.action == "replay":
        return replay.run(chosen)
    if chosen.action == "loop":
        return run_loop(chosen)
    settings = settings_of(chosen)
    machine = MACHINES[chosen.vehicle]()
    cases = cases_of(chosen)
    if not 1 <= chosen.phases <= MOST_PHASES:
        raise BadInputError(f"Set --phases to a whole number from 1 to {MOST_PHASES}: it was {chosen.phases}.")
    controllers = controllers_of(chosen.controller, len(machine.numbers), TRACTION in cases[0].equipment)
    scores = compare(machine, controllers, cases, settings, chosen.level, chosen.html, chosen.phases)
    folder = chosen.out / "controllers"
    found = verdict.verdicts(scores)
    about = document(chosen.vehicle, settings, scores) | {"verdict": verdict.document(found)}
    for name in ("compare.png", "compare.html"):  # of an earlier comparison
        (folder / name).unlink(missing_ok=True)
    text = write_document(folder / "compare.json", about)
    figure = draw(scores)
    figure.savefig(folder / "compare.png")
    plt.close(figure)
    if chosen.html:
        write_whole(folder / "compare.html", page(chosen.vehicle, machine, settings, scores).encode())
    if chosen.json:
        print(text, end="")
    elif not chosen.quiet:
        table = [*verdict.lines(found), "", *lines(chosen.vehicle, settings, scores)]
        places = [f"Page: {folder / 'compare.html'}"] if chosen.html else []
        print("\n".join([*table, "", f"Picture: {folder / 'compare.png'}", *places]))
    return all(score.stop.distance is not None for score in scores)


def run_loop(chosen: argparse.Namespace) -> bool:
    """One stop of a client in the loop; whether it stopped without a missed period. Raises BadInputError."""
    machine, settings = MACHINES[chosen.vehicle](), settings_of(chosen)
    cases = {case.name: case for case in cases_of(chosen)}
    if chosen.rail not in cases:
        raise BadInputError(f"There is no case {chosen.rail}; give --rail one of {', '.join(cases)}.")
    [run] = runs_of(machine, [cases[chosen.rail]])
    with loop.socket_at(chosen.host, chosen.port) as own:
        found = loop.run_in_loop(machine, run, settings, own, chosen.pace)
    ideal = ideal_distance(machine, run, settings)
    score = Scored(chosen.rail, "client", found.stop, machine.parameters.wheel_radius, ideal, None, run.driven)
    about = document(chosen.vehicle, settings, [score]) | {"loop": loop.document(found)}
    text = write_document(chosen.out / "controllers" / "loop.json", about)
    if chosen.json:
        print(text, end="")
    elif not chosen.quiet:
        print("\n".join([*lines(chosen.vehicle, settings, [score]), "", *loop.sentences(found)]))
    return found.holds


def settings_of(chosen: argparse.Namespace) -> Settings:
    """What the command line asks for. Raises BadInputError."""
    period = time_of(chosen.period, "--period")
    if chosen.teeth < 1:
        raise BadInputError(f"Set --teeth to a whole number of at least 1: it was {chosen.teeth}.")
    if not 0.0 < chosen.strength <= STRONGEST:
        raise BadInputError(f"Set --strength above 0 and up to {STRONGEST:g}: it was {chosen.strength:g}.")
    if not 0.0 <= chosen.jitter <= MOST_JITTER:
        raise BadInputError(f"Set --jitter to 0 to {MOST_JITTER:g} of the pitch: it was {chosen.jitter:g}.")
    try:
        return Settings(
            speed=speed_of(chosen.speed),
            strength=chosen.strength,
            period=period,
            pulses=chosen.teeth,
            jitter=chosen.jitter,
        )
    except ValueError as error:
        raise BadInputError(str(error)) from None
