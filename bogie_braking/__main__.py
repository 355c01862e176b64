"""Simulate how railway bogies, vehicles and trains brake.

  bogie-braking run demo                         three stops: table, data and figure
  bogie-braking consist check train.toml         masses, brakes and stops of a train
  bogie-braking controllers compare mine.py:PI   scores of a wheel-slide controller
  bogie-braking etcs train.toml --target 2000    braking curves of ETCS, and its stops
  bogie-braking vehicle check mine.toml          loads, modes, stops of your vehicle
  bogie-braking line check mine.csv              what a line demands, and a figure
  bogie-braking build bogie                      an FMU
  bogie-braking COMMAND --help                   examples and options of a command

`python -m bogie_braking` is the same.

Exit status: 0 if all rows pass. 1 if a row or a point of a sweep fails, or if doctor
misses a part. 2: bad input. 3: a simulation or this program failed. 130: interrupted with
Ctrl-C. 141: the reader of the output has ended.

commands:
"""

from __future__ import annotations

import os
import sys
import traceback

from bogie_braking.commands import COMMANDS, module_of, parser_of
from bogie_braking.exit_status import BAD_INPUT, FAILED, NOBODY_READS
from readers.extras import named_extras
from readers.text import BadInputError

#: Printed without arguments.
FIRST = """To see a train brake in a browser: bogie-braking live. Three stops in a table: bogie-braking run demo.
With files of yours: consist check TRAIN, vehicle check FILE, line check FILE, controllers compare CONTROLLER.
All commands: bogie-braking --help. What is installed, and what is missing: bogie-braking doctor."""


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit status, as in the description."""
    try:
        with named_extras():
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
    """Run a command and return its exit status. The module of that command alone is imported."""
    if not given:
        print(FIRST, file=sys.stderr)
        return BAD_INPUT
    loaded = {*given[:1]} & COMMANDS.keys()
    chosen = parser_of(loaded, __doc__).parse_args(given)
    try:
        status: int = module_of(chosen.command).run(chosen)
    except (Exception, KeyboardInterrupt) as error:
        from bogie_braking.commands.failures import status_of  # heavy: FMUs, equations

        return status_of(error, chosen)
    return status


if __name__ == "__main__":
    sys.exit(main())
