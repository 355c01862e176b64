"""Adapters in another Python: peers whose packages need other versions than this project.

The environment variable BOGIE_BRAKING_PEERS is the path of that Python. It runs this file, which imports adapters by
their paths and needs none of the project: jobs in, answers out, a JSON line each.
"""

from __future__ import annotations

import atexit
import importlib.util
import json
import os
import subprocess
import sys
import time
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

PLACE = "BOGIE_BRAKING_PEERS"


class OtherPython:
    """A process of another Python with adapters; `seconds` is the processor time of its answers [s].

    Raises
    ------
    ImportError
        If the Python cannot be started, or has not the program of an adapter.
    RuntimeError
        If an adapter fails, or the process ends.
    """

    def __init__(self, python: str) -> None:
        self.python, self.seconds = python, 0.0
        try:
            self.process = subprocess.Popen(
                [python, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8"
            )
        except OSError as error:
            raise ImportError(f"{PLACE} must be the path of a Python; got {python}: {error}.") from error
        atexit.register(self.process.kill)

    def call(self, adapter: str, name: str, *arguments: Any) -> Any:
        """Return what a function of an adapter returns."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            self.process.stdin.write(json.dumps([adapter, name, arguments]) + "\n")
            self.process.stdin.flush()
            found = json.loads(self.process.stdout.readline())
        except (OSError, ValueError) as error:
            raise RuntimeError(f"{self.python} ended") from error
        self.seconds += found["seconds"]
        if "missing" in found:
            raise ImportError(found["missing"])
        if "error" in found:
            raise RuntimeError(found["error"])
        return found["value"]

    def answer(self, adapter: str, question: str, inputs: Mapping[str, Any]) -> Any:
        """Return the answers of an adapter."""
        return self.call(adapter, "answer", question, dict(inputs))


def other_python() -> OtherPython | None:
    """Return the Python that PLACE names, started once; None without it."""
    return _started(os.environ[PLACE]) if os.environ.get(PLACE) else None


@lru_cache
def _started(python: str) -> OtherPython:
    return OtherPython(python)


def seconds() -> float:
    """Return the processor time of answers in another Python so far [s]."""
    other = other_python()
    return other.seconds if other else 0.0


def main() -> None:
    """Answer jobs until the input ends; what programs print goes to standard error."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    for line in sys.stdin:
        begin = _processor_time()
        try:
            adapter, name, arguments = json.loads(line)
            found = {"value": getattr(_imported(adapter), name)(*arguments)}
        except ImportError as error:
            found = {"missing": str(error)}
        except KeyboardInterrupt:
            return
        except BaseException as error:  # programs in Rust raise their own
            found = {"error": f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}"}
        print(json.dumps(found | {"seconds": _processor_time() - begin}), file=answers, flush=True)


@lru_cache
def _imported(adapter: str) -> Any:
    name = f"adapter_{Path(adapter).stem}"
    about = importlib.util.spec_from_file_location(name, adapter)
    if about is None or about.loader is None:
        raise ImportError(f"{adapter} is not a Python file")
    module = sys.modules[name] = importlib.util.module_from_spec(about)
    about.loader.exec_module(module)
    return module


def _processor_time() -> float:
    ended = os.times()
    return time.process_time() + ended.children_user + ended.children_system


if __name__ == "__main__":
    sys.path.pop(0)  # the folder of this file, whose modules are not the programs' own
    main()
