"""Score wheel-slide controllers on the test rig: a table, a plot, a JSON file, and an animated page.

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

from __future__ import annotations

import argparse
from functools import partial

from bogie_braking.controllers import verdict
from bogie_braking.controllers.controller_loader import controllers_of
from bogie_braking.controllers.options import add_draws, add_settings, plan_of, rigged
from bogie_braking.controllers.page import page
from bogie_braking.controllers.picture import draw
from bogie_braking.controllers.scoring import compare
from bogie_braking.controllers.table import document, drawn, lines, show, write_document
from bogie_braking.reporting.plots import saved
from products.machine import TRACTION
from products.protection.rails import RAILS
from products.protection.spread import Spread
from readers.command_line import whole
from readers.storage import write_whole


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
    """Compare and report; return whether all stopped. Raises BadInputError, CompilerError."""
    machine, settings, cases = rigged(chosen)
    controllers = controllers_of(chosen.controller, len(machine.numbers), TRACTION in cases[0].equipment)
    plan, slow = plan_of(chosen, controllers)
    scores = compare(machine, controllers, cases, settings, plan, chosen.level, chosen.html, verdict.unsettled)
    draws = drawn(scores, plan, slow)
    folder = chosen.out / "controllers"
    found = verdict.verdicts(scores)
    about = document(machine.title, settings, scores, plan) | {"verdict": verdict.document(found)}
    for name in ("compare.png", "compare.html"):  # of an earlier comparison
        (folder / name).unlink(missing_ok=True)
    text = write_document(folder / "compare.json", about)
    pictures = saved(partial(draw, scores), folder / "compare.png")
    if chosen.html:
        write_whole(folder / "compare.html", page(machine.title, machine, settings, scores, draws).encode())
    table = [*verdict.lines(found), "", *lines(machine.title, settings, scores, draws)]
    places = [f"Picture: {picture}" for picture in pictures]
    places += [f"Page: {folder / 'compare.html'}"] if chosen.html else []
    show(chosen, text, [*table, "", *places])
    return all(score.stop.distance is not None for score in scores)
