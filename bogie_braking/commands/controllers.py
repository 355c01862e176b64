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
from pathlib import Path

from bogie_braking.common_options import add_speech, bars, describe
from bogie_braking.controllers import answer, compare, loop, reference, replay, report
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from brake_controller.slide_protection import RIG
from products.protection.criteria import CRITERIA
from products.protection.programme import OWN
from readers.command_line import check_folder

#: Help of each action, in their order.
ACTIONS = {
    "compare": "score controllers on the same rails",
    "report": "accept or reject a controller",
    "replay": "give a controller the wheel speeds of a recorded run",
    "loop": "put the rig behind a UDP socket, paced by the clock",
    "answer": "answer such a rig with a Python class",
    "client": "print a client of such a rig, which goes to another machine",
    "header": "print wheel_slide.h, which a controller in C includes",
    "reference": "write the built-in protection in C, or check a port of it",
    "programme": "print the built-in test suite, a start for your own",
    "criteria": "print the built-in criteria, a start for your own",
}
#: Modules of the actions that run; the docstring is the description.
MODULES = {
    "compare": compare,
    "report": report,
    "replay": replay,
    "loop": loop,
    "answer": answer,
    "reference": reference,
}
#: Files of the actions that print one.
PRINTED = {"header": RIG / "wheel_slide.h", "programme": OWN, "criteria": CRITERIA}
#: Clients by language, beside wheel_slide.h.
CLIENTS = {"c": "udp_client.c", "python": "udp_client.py"}
#: Actions that write into the folder of --out.
WRITING = {"compare", "report", "replay", "loop"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the actions on controllers."""
    describe(parser, __doc__)
    actions = parser.add_subparsers(dest="action", required=True)
    for name, text in ACTIONS.items():
        action = actions.add_parser(name, help=text)
        if name == "client":
            action.add_argument("language", choices=list(CLIENTS))
        if name in MODULES:
            describe(action, MODULES[name].__doc__)
            MODULES[name].add_arguments(action)
            if name != "answer":
                add_speech(action, "the comparison")
    parser.set_defaults(quiet=False, json=False, out=Path("results"))


def run(chosen: argparse.Namespace) -> int:
    """Run an action; return DOES_NOT_HOLD if a controller did not stop, was not accepted, or missed a period."""
    if chosen.action in WRITING:
        check_folder(chosen.out)
    if chosen.action in MODULES:
        with bars(chosen):
            return HOLDS if MODULES[chosen.action].run(chosen) else DOES_NOT_HOLD
    path = RIG / CLIENTS[chosen.language] if chosen.action == "client" else PRINTED[chosen.action]
    print(path.read_text(encoding="utf-8"), end="")
    return HOLDS
