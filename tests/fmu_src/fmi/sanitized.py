"""Compile FMUs with sanitizers, and link C programs to them."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import RUNTIME, RUNTIME_SOURCES

SANITIZERS = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
HEADERS = [f"-I{RUNTIME}", f"-I{compiling.fmi_headers()}"]


def runtime() -> dict[str, str]:
    return {name: (RUNTIME / name).read_text() for name in RUNTIME_SOURCES}


def sanitized(sources: Mapping[str, str]) -> list[str | Path]:
    """Return the command that links a program to the objects of generated sources and the runtime.

    The code is not optimised, which takes a quarter of the time to compile.
    """
    flags = [*compiling.FLAGS, "-O0", *SANITIZERS]
    return [*compiling.compiler(), *flags, *HEADERS, *compiling.objects_of({**sources, **runtime()}, flags)]


def run(command: list[str | Path], folder: Path) -> subprocess.CompletedProcess:
    done = subprocess.run([str(part) for part in command], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0 and "-fsanitize" in " ".join(map(str, command)) and "error:" not in done.stderr:
        pytest.skip(f"this compiler has no sanitizer libraries: {done.stderr[-200:]}")
    return done


def driver(objects: list[str | Path], source: Path, folder: Path) -> Path:
    done = run([*objects, source, "-o", folder / "driver", "-lm"], folder)
    assert done.returncode == 0, done.stderr
    return folder / "driver"
