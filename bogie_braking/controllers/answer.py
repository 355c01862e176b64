"""A Python class answers a test rig that is behind a socket (controllers loop).

  bogie-braking controllers answer mine.py:PI                    a rig on this computer
  bogie-braking controllers answer mine.py:PI --host 192.0.2.1   a rig on another one

Exit status: 0 the run came to its end; 1 it did not; 2 bad input.
"""

from __future__ import annotations

import argparse
import sys
from contextlib import redirect_stdout
from pathlib import Path

from bogie_braking.controllers.controller_loader import maker_in
from bogie_braking.reporting.scenario import BadInputError
from brake_controller.rig.udp_client import HOST, PORT, answer
from readers.command_line import whole


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("controller", help="FILE.py:CLASS; C has a client of its own: controllers client c")
    parser.add_argument("--host", default=HOST, help=f"where the rig is (default: {HOST})")
    parser.add_argument("--port", type=whole("--port", 1, 65535), default=PORT, help=f"its UDP port (default: {PORT})")


def run(chosen: argparse.Namespace) -> bool:
    """Answer a run; return whether it came to its end. Raises BadInputError."""
    file, _, name = chosen.controller.rpartition(":")
    if not file.endswith(".py"):
        raise BadInputError(f"The controller must be FILE.py:CLASS; got {chosen.controller}.")
    controller = maker_in(Path(file), name)[1]()
    try:
        with redirect_stdout(sys.stderr):  # output of the controller
            given = answer(controller, chosen.host, chosen.port, lambda text: print(text, flush=True))
    except TimeoutError as error:
        print(error, file=sys.stderr)
        return False
    except (OSError, OverflowError) as error:
        place = f"{chosen.host}:{chosen.port}"
        raise BadInputError(f"Cannot reach {place}: {error}. Start the rig, or check --host and --port.") from None
    except Exception as error:
        print(f"The controller {name} failed ({type(error).__name__}: {error}); it answers no more.", file=sys.stderr)
        return False
    print(f"{given} answers given.")
    return True
