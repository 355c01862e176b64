"""Compare wheel-slide controllers on the test rig, replay logs, and run the rig behind a socket.

  bogie-braking controllers compare mine.py:PI           scores, a plot and a page of stops with your controller
  bogie-braking controllers replay log.csv mine.py:PI    its commands in a recorded run
  bogie-braking controllers loop --rail low              the rig behind a UDP socket, paced by the clock
  bogie-braking controllers answer mine.py:PI            a client of such a rig, also on another machine
  bogie-braking controllers client c > udp_client.c      the client of a controller in C; also: python
  bogie-braking controllers header > wheel_slide.h       the header of a controller in C
  bogie-braking controllers programme > my.toml          a case file, a start for your own

'compare --help', 'replay --help' and 'loop --help' say more. A class has the method step(time, wheel_speeds) -> valves:
[s], [m/s] -> 0 apply, 1 hold or 2 vent for each wheelset.

Exit status: 0 all controllers stopped everywhere; 1 one did not stop, failed, has no verdict, or missed a period in the
loop; 2 bad input; 3 the simulation failed; 130 interrupted with Ctrl-C.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from brake_controller.slide_protection import RIG
from products.machine import MACHINES, TRACTION
from products.protection.controller_kinds import InC
from products.protection.own_process import Apart
from products.protection.programme import OWN, PROGRAMMES, Case, four_rails, read_programme
from products.protection.rails import RAILS
from products.protection.settings import (
    FASTEST,
    LONGEST_PERIOD,
    MOST_BRAKE_RATIO,
    MOST_JITTER,
    MOST_PULSES,
    SHORTEST_PERIOD,
    Settings,
)
from products.protection.spread import LARGEST_SPREAD, Spread
from products.registry import ALIASES, fmu_named
from readers.command_line import quantity, whole
from readers.storage import write_whole
from scenarios.controllers import answering, loop, replay, verdict
from scenarios.controllers.controller_loader import Given, controllers_of
from scenarios.controllers.page import page
from scenarios.controllers.picture import draw
from scenarios.controllers.scoring import FEW, LOOKS, Plan, Scored, compare, ideal_distance, runs_of
from scenarios.controllers.table import document, drawn, lines, write_document
from scenarios.reporting.plots import plt
from scenarios.scenario import BadInputError

#: Help of `compare`.
COMPARE = """Score wheel-slide controllers on the test rig: a table, a plot, a JSON file, and an animated page.

  bogie-braking controllers compare mine.py:PI                    a Python class, with none and the built-in one
  bogie-braking controllers compare mine.py:PI libpi.so           and a shared library
  bogie-braking controllers compare pi.c --vehicle coach          C, compiled now; on the coach
  bogie-braking controllers compare pi.fmu                        an FMU; pi.toml next to it may name its variables
  bogie-braking controllers compare 'mine.py:PI(kp=0.3)' 'mine.py:PI(kp=0.5)'
                                                                  a class with two choices of its gains
  bogie-braking controllers compare mine.py:PI --rails low,wet    on these rails alone
  bogie-braking controllers compare mine.py:PI --programme full   32 cases: 60 to 200 km/h, sensors and valves that fail
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
#: Largest number of draws of a case.
MOST_DRAWS = 10_000


def add_commands(parser: argparse.ArgumentParser, speech: Callable[[argparse.ArgumentParser], None]) -> None:
    """Add the actions on controllers; speech: adds the options for less output to a command."""
    actions = parser.add_subparsers(dest="action", required=True)

    def form(text: str | None) -> dict[str, Any]:
        return {"description": text, "formatter_class": argparse.RawDescriptionHelpFormatter}

    compare = actions.add_parser("compare", help="score controllers on the same rails", **form(COMPARE))
    add_arguments(compare)
    speech(compare)
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
    actions.add_parser("programme", help="print the programme that comes along, to begin one of your own with")
    parser.set_defaults(quiet=False, json=False, out=Path("results"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    text = "FILE.py:CLASS, also with gains, 'FILE.py:CLASS(kp=0.3)'; a library; C that includes wheel_slide.h; an FMU"
    parser.add_argument("controller", nargs="*", help=text)
    level, text = whole("--level", 2, 3), "2 in the plane (default), 3 in space"
    parser.add_argument("--level", type=level, default=2, metavar="LEVEL", help=text)
    group = parser.add_mutually_exclusive_group()
    text = f"some of {','.join(rail.name for rail in RAILS)} (default: all)"
    group.add_argument("--rails", default="", metavar="NAMES", help=text)
    text = "a TOML file with cases; full: the programme that comes along; starts: the one for driven wheels"
    group.add_argument("--programme", metavar="FILE", help=text)
    parser.add_argument("--html", action="store_true", help="also write a page that plays all stops side by side")
    add_draws(parser)
    add_settings(parser, Spread().jitter)


def add_draws(parser: argparse.ArgumentParser) -> None:
    """Add the options of the draws."""
    text = f"most draws of a case, 1 to {MOST_DRAWS} (default: {LOOKS[-1]}; {FEW} with a controller in Python)"
    parser.add_argument("--draws", type=whole("--draws", 1, MOST_DRAWS), metavar="N", help=text)
    text = "seed of the draws, from 0 (default: 1)"
    parser.add_argument("--seed", type=whole("--seed", 0, 2**31 - 1), default=1, metavar="N", help=text)
    for name in ("friction", "load"):
        usual = getattr(Spread(), name)
        text = f"half width of the spread of {name}, 0 to {LARGEST_SPREAD:g} (default: {usual:g})"
        one = quantity(f"--{name}-spread", least=0.0, most=LARGEST_SPREAD)
        parser.add_argument(f"--{name}-spread", type=one, default=usual, metavar="SHARE", help=text)


def plan_of(chosen: argparse.Namespace, controllers: Mapping[str, Given]) -> tuple[Plan, str]:
    """Return the requested draws, and the controller because of which they are few."""
    slow = next((name for name, one in controllers.items() if not (one is None or isinstance(one, InC | Apart))), "")
    spread = Spread(chosen.friction_spread, chosen.load_spread, chosen.jitter)
    if chosen.draws:
        return Plan(spread, chosen.seed, chosen.draws), ""
    return Plan(spread, chosen.seed, FEW if slow else LOOKS[-1]), slow


def add_case(parser: argparse.ArgumentParser) -> None:
    """Add the options of a single stop."""
    text = f"one of {','.join(rail.name for rail in RAILS)}, or a case of the programme (default: low)"
    parser.add_argument("--rail", default="low", metavar="NAME", help=text)
    parser.add_argument("--programme", metavar="FILE", help="a TOML file with cases, full or starts")
    parser.set_defaults(rails="")
    add_settings(parser)


def add_settings(parser: argparse.ArgumentParser, jitter: float = 0.0) -> None:
    """Add the options of all stops; jitter: its default."""
    text = (
        f"{' or '.join(MACHINES)}; {' and '.join(f'{own} = {name}' for own, name in ALIASES.items())} (default: bogie)"
    )
    parser.add_argument("--vehicle", type=fmu_named, choices=[*MACHINES, *ALIASES], default="bogie", help=text)
    speed = quantity("--speed", "m/s", 0.0, FASTEST, above=True)
    text = "at the start, as 25 or 90km/h (default: 25 m/s)"
    parser.add_argument("--speed", type=speed, default=25.0, metavar="SPEED", help=text)
    brake_ratio = quantity("--brake-ratio", least=0.0, most=MOST_BRAKE_RATIO, above=True)
    text = "torque over that of the full brake (default: 1)"
    parser.add_argument("--brake-ratio", type=brake_ratio, default=1.0, metavar="RATIO", help=text)
    period = quantity("--period", "s", SHORTEST_PERIOD, LONGEST_PERIOD)
    text = "of the controllers, as 5ms or 0.005 (default: 5ms)"
    parser.add_argument("--period", type=period, default=5e-3, metavar="TIME", help=text)
    text = f"of each speed sensor in a revolution, 1 to {MOST_PULSES} (default: {Settings.pulses})"
    pulses = whole("--pulses", 1, MOST_PULSES)
    parser.add_argument("--pulses", type=pulses, default=Settings.pulses, metavar="COUNT", help=text)
    words = f"0 to {MOST_JITTER:g} (default: {jitter:g})"
    text = f"standard deviation of the pulses' places, as a share of the pitch, {words}"
    one = quantity("--jitter", least=0.0, most=MOST_JITTER)
    parser.add_argument("--jitter", type=one, default=jitter, metavar="SHARE", help=text)
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder of the results (default: results)")


def cases_of(chosen: argparse.Namespace) -> list[Case]:
    """Return the requested cases.

    Raises
    ------
    BadInputError
        If a rail or the case file is unknown, or if a rail is named twice.
    """
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
            raise BadInputError(f"Each of --rails must be given once; got {name} {names.count(name)} times.")
    return [known[name] for name in names]


def run(chosen: argparse.Namespace) -> bool:
    """Compare and report, or print a file; return whether all stopped. Raises BadInputError, CompilerError."""
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
    controllers = controllers_of(chosen.controller, len(machine.numbers), TRACTION in cases[0].equipment)
    plan, slow = plan_of(chosen, controllers)
    scores = compare(machine, controllers, cases, settings, plan, chosen.level, chosen.html, verdict.decided)
    draws = drawn(scores, plan, slow)
    folder = chosen.out / "controllers"
    found = verdict.verdicts(scores)
    about = document(chosen.vehicle, settings, scores, plan) | {"verdict": verdict.document(found)}
    for name in ("compare.png", "compare.html"):  # of an earlier comparison
        (folder / name).unlink(missing_ok=True)
    text = write_document(folder / "compare.json", about)
    figure = draw(scores)
    figure.savefig(folder / "compare.png")
    plt.close(figure)
    if chosen.html:
        write_whole(folder / "compare.html", page(chosen.vehicle, machine, settings, scores, draws).encode())
    if chosen.json:
        print(text, end="")
    elif not chosen.quiet:
        table = [*verdict.lines(found), "", *lines(chosen.vehicle, settings, scores, draws)]
        places = [f"Page: {folder / 'compare.html'}"] if chosen.html else []
        print("\n".join([*table, "", f"Picture: {folder / 'compare.png'}", *places]))
    return all(score.stop.distance is not None for score in scores)


def run_loop(chosen: argparse.Namespace) -> bool:
    """Run one stop of a client in the loop; return whether it stopped without a missed period.

    Raises
    ------
    BadInputError
        If the case is unknown, or the pace out of range.
    """
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
        print("\n".join([*lines(chosen.vehicle, settings, [score]), "", *loop.messages(found)]))
    return found.holds


def settings_of(chosen: argparse.Namespace) -> Settings:
    """Return the settings that the command line requests. Raises BadInputError."""
    given = {one.name: getattr(chosen, one.name) for one in fields(Settings) if hasattr(chosen, one.name)}
    try:
        return Settings(**given)
    except ValueError as error:
        raise BadInputError(str(error)) from None
