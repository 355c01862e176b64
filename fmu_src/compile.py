"""C sources -> shared library, with the system's compiler where there is one and otherwise zig from PyPI."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import fmpy
import platformdirs

from fmu_src.codegen import RUNTIME, RUNTIME_HEADERS, RUNTIME_SOURCES, generate
from fmu_src.system import Model

#: Where compiled kernels and FMUs are kept between runs, in the user's folder for such things unless the environment
#: names another; named by the content of their sources and the compiler.
CACHE = Path(os.environ.get("BOGIE_BRAKING_CACHE") or platformdirs.user_cache_dir("bogie-braking", False))
#: No contraction of a*b+c: compilers differ in nothing but the last bits of their mathematical library.
FLAGS = (
    "-std=c11",
    "-g0",  # zig would add the paths of this machine
    "-fPIC",
    "-fvisibility=hidden",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-freciprocal-math",
    "-fno-trapping-math",
    "-Wall",
    "-Wextra",
    "-Werror",
)
#: Generated code at -O2 takes three times as long to compile and runs 5 % faster; the runtime is small.
OPTIMISE_GENERATED, OPTIMISE_RUNTIME = "-O1", "-O2"
FMI_HEADERS = Path(fmpy.__file__).parent / "c-code"


class CompilerError(RuntimeError):
    """The C compiler refused the sources; the message is its own."""


def compiler(target: str | None = None) -> list[str]:
    """Command of the C compiler: $CC, or cc, gcc, clang from PATH, or zig from PyPI; zig for a `target` of it."""
    if target:
        return [sys.executable, "-m", "ziglang", "cc", "-target", target, "-mcpu=baseline"]
    if os.environ.get("CC"):
        return os.environ["CC"].split()
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name):
            return [name]
    return [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline"]


def library_suffix() -> str:
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def compile_library(
    sources: Mapping[str, str], output: Path, flags: Sequence[str] = FLAGS, target: str | None = None
) -> None:
    """Compiles generated sources with the runtime to the shared library `output`. Raises CompilerError."""
    if target and "windows" in target:
        flags = [flag for flag in flags if flag != "-fPIC"]
    with tempfile.TemporaryDirectory() as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text)
        common = [*compiler(target), *flags, f"-I{RUNTIME}", f"-I{FMI_HEADERS}"]
        runtime = [str(RUNTIME / name) for name in RUNTIME_SOURCES]
        objects = {name: str(Path(name).with_suffix(".o")) for name in sources}
        commands = [[*common, OPTIMISE_GENERATED, "-c", "-o", made, name] for name, made in objects.items()]
        commands.append([*common, OPTIMISE_RUNTIME, "-shared", "-o", "library", *objects.values(), *runtime, "-lm"])
        environment = os.environ | {
            "ZIG_GLOBAL_CACHE_DIR": os.environ.get("ZIG_GLOBAL_CACHE_DIR", str(CACHE / "zig")),
            "ZIG_LOCAL_CACHE_DIR": str(Path(folder) / "zig"),
        }
        for command in commands:
            done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
            if done.returncode != 0:
                raise CompilerError(f"The C compiler ({' '.join(compiler(target))}) failed:\n{done.stderr}")
        output.parent.mkdir(parents=True, exist_ok=True)
        partial = output.with_name(f"{output.name}.{os.getpid()}")
        shutil.copyfile(Path(folder) / "library", partial)
        partial.replace(output)


def library_of(sources: Mapping[str, str], flags: Sequence[str] = FLAGS, target: str | None = None) -> Path:
    """Path of the compiled library of these sources, compiled now unless the cache has it."""
    digest = hashlib.sha256(" ".join([*compiler(target), *flags, OPTIMISE_GENERATED, OPTIMISE_RUNTIME]).encode())
    for name in sorted(sources):
        digest.update(sources[name].encode())
    for name in (*RUNTIME_SOURCES, *RUNTIME_HEADERS):
        digest.update((RUNTIME / name).read_bytes())
    path = CACHE / f"{digest.hexdigest()[:24]}{library_suffix()}"
    if not path.exists():
        compile_library(sources, path, flags, target)
    return path


def build_library(model: Model) -> Path:
    """Compiled kernel of a model."""
    return library_of(generate(model))
