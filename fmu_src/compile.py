"""C sources -> shared library, with the system's compiler where there is one and otherwise zig, an extra from PyPI."""

from __future__ import annotations

import ctypes
import errno
import hashlib
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import platformdirs

from fmu_src.cached_files import keep, missing, own_folder, whole
from fmu_src.codegen import (
    BATCH_SOURCES,
    FACE_SOURCES,
    KERNEL_SOURCES,
    RUNTIME,
    RUNTIME_HEADERS,
    RUNTIME_SOURCES,
    STUDY_SOURCES,
    generate,
)
from fmu_src.objects import FACES
from fmu_src.progress import counting
from fmu_src.system import Model
from readers.extras import EXTRAS, has, install, need
from readers.storage import ANOTHER_TEMPORARY, StorageError, cannot_write, sentence, write_whole

#: Folder of compiled kernels and FMUs, in the user's cache folder unless the environment names another. Files are named
#: by the content of their sources and the compiler.
CACHE = Path(os.environ.get("BOGIE_BRAKING_CACHE") or platformdirs.user_cache_dir("bogie-braking", False)).absolute()
#: Remedies for a message: how to set another cache folder, and its requirements.
ANOTHER_CACHE = "name another folder in the environment, BOGIE_BRAKING_CACHE"
FROM_WHICH_IT_LOADS = f"{ANOTHER_CACHE}, on a disk from which programs may run"
#: No contraction of a*b+c: compilers differ in nothing but the last bits of their mathematical library.
FLAGS = (
    "-std=c11",
    "-g0",  # zig would add the paths of this machine
    "-fPIC",
    "-fvisibility=hidden",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-Wall",
    "-Wextra",
    "-Werror",
)
#: On x86 of 32 bits: numbers of 64 bits in SSE registers as everywhere else, not of 80 in the old ones.
FLAGS_X86 = ("-msse2", "-mfpmath=sse")
#: Generated code at -O2 takes three times as long to compile and runs 5 % faster; the runtime is small.
OPTIMISE_GENERATED, OPTIMISE_RUNTIME = "-O1", "-O2"
#: Files of the runtime that each step runs through, which are compiled as the runtime is; the others as generated code.
STEPPING = (
    *("evaluate.c", "linear.c", "rosenbrock.c", "algebraic.c", "reuse.c", "outputs.c"),
    *("integrate.c", "step.c", "fixed.c", "locate.c", "modes.c"),
)
#: Messages of compilers if a disk, a quota or a limit is full.
FULL_DISK = ("No space left", "Disk quota exceeded", "File size limit", "File too large")


class CompilerError(RuntimeError):
    """The C compiler refused the sources; the message is its own."""


def fmi_headers() -> Path:
    """Return the folder of the headers of the standards, as FMPy brings them. Raises MissingExtraError."""
    need("fmpy")
    return Path(str(find_spec("fmpy").origin)).parent / "c-code"  # type: ignore[union-attr]


def cache() -> Path:
    """Return the folder of the cache, created if missing; only its owner can write to it."""
    with _told():
        return own_folder(CACHE, ANOTHER_CACHE)


@contextmanager
def _told() -> Iterator[None]:
    """Turn a StorageError into a CompilerError, which all who compile expect."""
    try:
        yield
    except StorageError as error:
        raise CompilerError(str(error)) from error


#: Command that installs zig, the compiler from PyPI.
INSTALL_ZIG = install(EXTRAS["ziglang"][0])


def compiler(target: str | None = None) -> list[str]:
    """Return the command of the C compiler: $CC, cc, gcc or clang from PATH, or zig from PyPI; zig if `target` is
    given.

    The command may name a compiler that is not installed: `run` reports that.
    """
    if target:
        return [sys.executable, "-m", "ziglang", "cc", "-target", target, "-mcpu=baseline"]
    if os.environ.get("CC", "").strip():
        return os.environ["CC"].split()
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name):
            return [name]
    return [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline"]


def library_suffix() -> str:
    """Return the ending of a shared library's name on this machine, with its dot."""
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def run(command: Sequence[str], target: str | None, folder: Path) -> None:
    """Run the compiler with these arguments in a folder, with zig's local cache there. Raises CompilerError.

    target: of zig; None for this machine.
    """
    environment = os.environ | {
        "ZIG_GLOBAL_CACHE_DIR": os.environ.get("ZIG_GLOBAL_CACHE_DIR", str(CACHE / "zig")),
        "ZIG_LOCAL_CACHE_DIR": str(folder / "zig"),
    }
    called = compiler(target)
    if called[1:3] == ["-m", "ziglang"] and not has("ziglang"):
        raise CompilerError(_zig_is_missing(target))
    try:
        done = subprocess.run([*called, *command], cwd=folder, env=environment, capture_output=True, text=True)
    except OSError:
        advice = f"name one in $CC that is here, or leave $CC empty and install gcc or clang, or: {INSTALL_ZIG}"
        raise CompilerError(f"The C compiler {called[0]} of $CC is not on this machine; {advice}") from None
    if done.returncode != 0 and any(words in done.stderr for words in FULL_DISK):
        told = cannot_write(folder, OSError(errno.ENOSPC, "no space is left"), ANOTHER_TEMPORARY)
        raise CompilerError(str(told)) from told
    if done.returncode != 0:
        raise CompilerError(f"The C compiler ({' '.join(called)}) failed:\n{done.stderr}{_zig_may_be_damaged(called)}")


def _zig_may_be_damaged(called: Sequence[str]) -> str:
    """Return a remedy for a damaged cache of zig, which has no checksums."""
    own = "ziglang" in called and "ZIG_GLOBAL_CACHE_DIR" not in os.environ
    return f"If the sources are without fault, remove the folder {CACHE / 'zig'} and try again." if own else ""


def _zig_is_missing(target: str | None) -> str:
    """Return the message that no compiler is available, with its remedy."""
    if target == WEB_TARGET:
        advice = f"run `make live`, which installs it, or without a checkout {INSTALL_ZIG}"
        return f"A live page needs zig, which is not installed: {advice}"
    if target:
        return f"To compile for {target} takes zig, which is not installed: {INSTALL_ZIG}"
    return f"There is no C compiler on this machine: install gcc or clang, name a compiler in $CC, or: {INSTALL_ZIG}"


def objects_of(sources: Mapping[str, str], flags: Sequence[str], target: str | None = None) -> list[Path]:
    """Return object files of C files that include the runtime's headers, each compiled unless the cache has it.

    One file for each processor is compiled at once, the longest first, so that none is left over at the end.
    """
    included = {name: headers_of(name, sources) for name in sources if not name.endswith(".h")}
    length = {name: len(sources[name]) + sum(map(len, own.values())) for name, own in included.items()}
    names = sorted(included, key=lambda name: -length[name])
    with (
        ThreadPoolExecutor(os.cpu_count()) as pool,
        counting(text="compiling", total=sum(length.values()), unit="B", unit_scale=True) as bar,
    ):
        under_way = {
            pool.submit(_object_of, name, {name: sources[name]} | included[name], flags, target): name for name in names
        }
        for done in as_completed(under_way):
            bar.update(length[under_way[done]])
    return [one.result() for one in under_way]


def headers_of(name: str, sources: Mapping[str, str]) -> dict[str, str]:
    """Return the sources that a file includes, and those that these include."""
    found: dict[str, str] = {}
    waiting = [name]
    while waiting:
        text = sources[waiting.pop()]
        more = [source for source in sources if source.endswith(".h") and source not in found and f'"{source}"' in text]
        found |= {one: sources[one] for one in more}
        waiting += more
    return found


def _object_of(name: str, files: Mapping[str, str], flags: Sequence[str], target: str | None) -> Path:
    """Return the object file of a C file; files: the file and the headers that it includes."""
    headers = [f"-I{fmi_headers()}"] if name in FACES else []

    def compiled(folder: Path) -> Path:
        for file, text in files.items():
            (folder / file).write_text(text)
        run([*flags, f"-I{RUNTIME}", *headers, "-c", "-o", "object", name], target, folder)
        return folder / "object"

    return in_cache(f"{_content([*compiler(target), *flags, name], files, RUNTIME_HEADERS)}.o", compiled)


def in_cache(name: str, make: Callable[[Path], Path]) -> Path:
    """Return the path of a file in the cache, made now unless it is there and whole."""
    path = cache() / name
    with _told(), missing(path, ANOTHER_CACHE) as absent:
        if absent:
            with workshop() as folder:
                data = make(folder).read_bytes()
            keep(data, path, ANOTHER_CACHE)
    return path


def noted(name: str, make: Callable[[], str], good: Callable[[str], bool] = bool) -> str:
    """Return the text that the cache has by this name, made again if it is missing, damaged or not `good`.

    Raises CompilerError.
    """
    note = cache() / name
    text = note.read_text(encoding="utf-8") if whole(note) else ""
    if not good(text):
        text = make()
        with _told():
            keep(text.encode(), note, ANOTHER_CACHE)
    return text


def path_from(text: str) -> Path | None:
    """Return the file that a note names from the cache's folder on, if it is whole; a copied cache has its own."""
    path = cache() / text
    return path if text and path.is_relative_to(cache()) and ".." not in path.parts and whole(path) else None


@contextmanager
def workshop() -> Iterator[Path]:
    """Yield a temporary folder for compiling. Raises CompilerError if it cannot be written."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            yield Path(folder)
    except OSError as error:
        place = Path(tempfile.tempdir or "a folder for temporary files")
        raise CompilerError(str(cannot_write(place, error, ANOTHER_TEMPORARY))) from error


def loaded(path: Path) -> ctypes.CDLL:
    """Load a library of the cache into this process. Raises CompilerError."""
    try:
        return ctypes.CDLL(str(path))
    except OSError as error:
        raise CompilerError(f"Cannot load {path}: {error}. {sentence(FROM_WHICH_IT_LOADS)}") from error


@lru_cache
def here() -> str:
    """Return the parts of the cache key besides sources and compiler: system, processor, C library."""
    return " ".join([sys.platform, platform.machine(), *platform.libc_ver()])


def _content(words: Sequence[str], sources: Mapping[str, str], runtime: Sequence[str]) -> str:
    """Return a cache name for the result of a command, as given in this file, on generated sources and the runtime."""
    digest = hashlib.sha256("\n".join([here(), *words]).encode())
    for name in sorted(sources):
        digest.update(sources[name].encode())
    for path in (*(RUNTIME / name for name in runtime), Path(__file__)):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:24]


def compile_library(
    sources: Mapping[str, str],
    output: Path,
    flags: Sequence[str] = FLAGS,
    target: str | None = None,
    fmu: bool = False,
    lanes: int = 0,
) -> None:
    """Compile generated sources with the runtime to a shared library.

    A library calls its own functions, also if the host has loaded others of the same names.
    """
    flags = _flags_for(target, flags)
    names, shown = (FACE_SOURCES, []) if fmu else (STUDY_SOURCES, ["-DKERNEL_LIBRARY"])
    single = {name: text for name, text in sources.items() if not name.startswith("batch_")}
    several = {name: text for name, text in sources.items() if name not in single}
    objects = objects_of(single, [*flags, OPTIMISE_GENERATED], target)
    stepping, others = ([name for name in KERNEL_SOURCES if (name in STEPPING) == one] for one in (True, False))
    objects += objects_of(_unit("stepping.c", stepping), [*flags, *shown, OPTIMISE_RUNTIME], target)
    beside = {name: (RUNTIME / name).read_text() for name in names}
    objects += objects_of(_unit("runtime.c", others) | beside, [*flags, *shown, OPTIMISE_GENERATED], target)
    if lanes:
        wide, runtime = (
            [*flags, f"-DBATCH_LANES={lanes}"],
            {name: (RUNTIME / name).read_text() for name in BATCH_SOURCES},
        )
        objects += objects_of(several, [*wide, OPTIMISE_GENERATED], target)
        objects += objects_of(runtime, [*wide, *shown, OPTIMISE_RUNTIME], target)
    with workshop() as folder:
        run([*_linking(flags, target), "-o", "library", *map(str, objects), "-lm"], target, folder)
        data = (folder / "library").read_bytes()
    output.parent.mkdir(parents=True, exist_ok=True)
    write_whole(output, data)


def _unit(name: str, files: Sequence[str]) -> dict[str, str]:
    """Return one C file of several of the runtime: a compiler reads common headers once, half of its work."""
    return {name: "".join(f'#line 1 "{file}"\n{(RUNTIME / file).read_text()}' for file in files)}


def _flags_for(target: str | None, flags: Sequence[str]) -> list[str]:
    """Return the flags for a target of zig."""
    windows, old = bool(target) and "windows" in str(target), str(target).startswith("x86-")
    return [*(flag for flag in flags if not (windows and flag == "-fPIC")), *(FLAGS_X86 if old else ())]


def _linking(flags: Sequence[str], target: str | None) -> list[str]:
    """Return flags that make a library of objects; unoptimised, zig would add what only unoptimised code needs."""
    place = target or sys.platform
    bound = ["-Wl,-Bsymbolic"] if "linux" in place else []  # the other formats bind inside by themselves
    if target and "windows" in target:
        bound = ["-s"]  # with symbols for a debugger the file has a number that differs from build to build
    return [*flags, OPTIMISE_RUNTIME, "-shared", *bound]


def library_of(
    sources: Mapping[str, str],
    flags: Sequence[str] = FLAGS,
    target: str | None = None,
    fmu: bool = False,
    lanes: int = 0,
) -> Path:
    """Return the path of the compiled library of these sources; see compile_library."""
    words = [*compiler(target), *_linking(flags, target), OPTIMISE_GENERATED, str(fmu), str(lanes)]
    content = _content(words, sources, (*RUNTIME_SOURCES, *BATCH_SOURCES, *RUNTIME_HEADERS))

    def linked(folder: Path) -> Path:
        compile_library(sources, folder / "linked", flags, target, fmu, lanes)
        return folder / "linked"

    return in_cache(f"{content}{library_suffix()}", linked)


#: For files that are not ours, whose warnings are not either.
FOREIGN_FLAGS = tuple(flag for flag in FLAGS if not flag.startswith("-W"))


def plain_library(
    sources: Mapping[str, str], foreign: Mapping[str, str] | None = None, target: str | None = None
) -> Path:
    """Return the path of a shared library of C files that need nothing of the runtime.

    foreign: files of a user; target: of zig. Raises CompilerError.
    """
    own = _flags_for(target, FLAGS)
    parts = [(sources, own), (foreign or {}, _flags_for(target, FOREIGN_FLAGS))]
    words = [*compiler(target), *_linking(own, target), *sorted(sources), "foreign", *sorted(foreign or {})]
    # Elsewhere what is missing is an error anyway.
    complete = ["-Wl,-z,defs"] if "linux" in (target or sys.platform) else []

    def linked(folder: Path) -> Path:
        objects = [one for files, flags in parts for one in objects_of(files, [*flags, OPTIMISE_RUNTIME], target)]
        run([*_linking(own, target), *complete, "-o", "library", *map(str, objects), "-lm"], target, folder)
        return folder / "library"

    return in_cache(f"{_content(words, {**sources, **(foreign or {})}, RUNTIME_HEADERS)}{library_suffix()}", linked)


#: WebAssembly with the C library of WASI; a page gives what of its system the kernel asks for.
WEB_TARGET = "wasm32-wasi"


def web_module(model: Model, beside: Mapping[str, str] | None = None) -> Path:
    """Return the path of a WebAssembly module with the functions of kernel.h, and malloc.

    beside: C files that need nothing of the runtime, whose functions a page calls too.
    """
    runtime = {name: (RUNTIME / name).read_text() for name in KERNEL_SOURCES}
    return _web(generate(model), {**runtime, **(beside or {})})


def web_library(sources: Mapping[str, str]) -> Path:
    """Return the path of a WebAssembly module of C files that need nothing of the runtime, with malloc."""
    return _web({}, sources)


def _web(generated: Mapping[str, str], others: Mapping[str, str]) -> Path:
    """Return the module of generated sources and further ones, which are compiled as the runtime is."""
    flags = [flag for flag in FLAGS if flag != "-fPIC"]
    linking = [OPTIMISE_RUNTIME, "-mexec-model=reactor", "-s", "-Wl,--export-dynamic", "-Wl,--export=malloc"]
    shown = ["-DKERNEL_LIBRARY"] if generated else []
    words = [*compiler(WEB_TARGET), *flags, *linking]
    content = _content(words, {**generated, **others}, RUNTIME_HEADERS)

    def linked(folder: Path) -> Path:
        objects = objects_of(generated, [*flags, OPTIMISE_GENERATED], WEB_TARGET) if generated else []
        objects += objects_of(others, [*flags, *shown, OPTIMISE_RUNTIME], WEB_TARGET)
        run([*linking, "-o", "module", *map(str, objects), "-lm"], WEB_TARGET, folder)
        return folder / "module"

    return in_cache(f"{content}.wasm", linked)


def build_library(model: Model) -> Path:
    """Return the compiled kernel of a model, for kernel.py."""
    return library_of(generate(model))
