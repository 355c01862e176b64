"""Exit status and message of errors that end a command."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from bogie_braking.exit_status import BAD_INPUT, FAILED, INTERRUPTED
from fmu_src.compile import CompilerError
from fmu_src.cosimulation import CosimulationError
from fmu_src.kernel import SimulationError
from products.study.points import SweepError
from readers.storage import StorageError, cannot_write
from readers.text import BadInputError, FileError


def status_of(error: BaseException, chosen: argparse.Namespace) -> int:
    """Print the message of an error and return the exit status; raise an error that is not expected again."""
    if isinstance(error, KeyboardInterrupt):
        out = getattr(chosen, "out", None)
        earlier = "Interrupted." if out is None else f"Interrupted; what {out} held before is as it was."
        print(error if error.args else earlier, file=sys.stderr)
        return INTERRUPTED
    if isinstance(error, BrokenPipeError):
        raise error
    if isinstance(error, (BadInputError, FileError)):
        print(error, file=sys.stderr)
        return BAD_INPUT
    if isinstance(error, (CosimulationError, CompilerError, SimulationError, SweepError, StorageError)):
        print(error, file=sys.stderr)
        return FAILED
    if isinstance(error, OSError):
        print(cannot_write(getattr(chosen, "out", Path()), error, "choose another folder with --out"), file=sys.stderr)
        return FAILED
    raise error
