"""The native FMU: the compiled kernel with its FMI functions, no Python inside, for one platform or for several.

One binary works for FMI 2.0 and 3.0; the archives differ in modelDescription.xml and in the names of the platforms.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from fmu_src.archive import write_archive
from fmu_src.codegen import FACE_SOURCES, KERNEL_SOURCES, RUNTIME, RUNTIME_HEADERS, generate, guid_of
from fmu_src.compile import library_of, library_suffix
from fmu_src.equations_in_c import TABLE_FILE
from fmu_src.host_programs import host_variables, hosts
from fmu_src.model_description import model_description, model_description3
from fmu_src.pages import pages
from fmu_src.record_file import OWN
from fmu_src.standard_headers import standard_headers
from fmu_src.system import Model
from readers.extras import OptionalModule

fmpy = OptionalModule("fmpy")

#: Folder in binaries/ -> targets of zig, and suffix of the library. Two targets make one universal binary. The glibc is
#: that of CentOS 7. The macOS is the first on ARM; zig by default would require one of four years later. FMI 2.0 has no
#: name for Linux on ARM; this is the one of FMI 3.0, which FMPy uses as well.
PLATFORMS: dict[str, tuple[tuple[str, ...], str]] = {
    "linux64": (("x86_64-linux-gnu.2.17",), ".so"),
    "win64": (("x86_64-windows-gnu",), ".dll"),
    "win32": (("x86-windows-gnu",), ".dll"),
    "darwin64": (("x86_64-macos.11.0", "aarch64-macos.11.0"), ".dylib"),
    "aarch64-linux": (("aarch64-linux-gnu.2.17",), ".so"),
}
#: The same for FMI 3.0.
PLATFORMS3: dict[str, tuple[tuple[str, ...], str]] = {
    "x86_64-linux": (("x86_64-linux-gnu.2.17",), ".so"),
    "x86_64-windows": (("x86_64-windows-gnu",), ".dll"),
    "x86-windows": (("x86-windows-gnu",), ".dll"),
    "x86_64-darwin": (("x86_64-macos.11.0",), ".dylib"),
    "aarch64-darwin": (("aarch64-macos.11.0",), ".dylib"),
    "aarch64-linux": (("aarch64-linux-gnu.2.17",), ".so"),
}
#: Of Mach-O files: CPU type and subtype by target.
MACHINES = {"x86_64-macos.11.0": (0x01000007, 3), "aarch64-macos.11.0": (0x0100000C, 0)}
#: Headers of the runtime that are not in FMUs: they belong to studies.
_NOT_OF_ALL = {"studies.h", "batch.h", "batch_lanes.h"}
HEADERS = tuple(name for name in RUNTIME_HEADERS if name not in _NOT_OF_ALL)
#: Content of sources/ besides the generated files and the standard's headers, by version of FMI.
SOURCES = {
    2: (*KERNEL_SOURCES, *(name for name in FACE_SOURCES if name != "fmi3.c"), *HEADERS),
    3: (*KERNEL_SOURCES, *(name for name in FACE_SOURCES if name != "fmi2.c"), *HEADERS),
}
#: The one file to compile; it includes the others.
ONE_UNIT = "all.c"


def build_native_fmu(
    model: Model, path: Path, platforms: Sequence[str] = (), extras: Mapping[str, bytes] | None = None
) -> None:
    """Write the native FMU of a model, of FMI 2.0; platforms: of PLATFORMS, by default this machine."""
    _build(model, path, 2, platforms, extras or {})


def build_native_fmu3(
    model: Model, path: Path, platforms: Sequence[str] = (), extras: Mapping[str, bytes] | None = None
) -> None:
    """Write the native FMU of FMI 3.0; platforms: of PLATFORMS3."""
    _build(model, path, 3, platforms, extras or {})


def _build(model: Model, path: Path, version: int, platforms: Sequence[str], extras: Mapping[str, bytes]) -> None:
    sources = generate(model)
    guid = guid_of(sources)
    files = {name: text.encode() for name, text in sources.items()}
    files |= {name: (RUNTIME / name).read_bytes() for name in SOURCES[version]}
    files |= standard_headers(version)
    files[ONE_UNIT] = one_unit(model, [*sources, *SOURCES[version]], version).encode()
    if version == 2:
        about, kind = model_description(model, guid, source_files=[ONE_UNIT]), "native"
    else:
        about, kind = model_description3(model, guid), "fmi3"
        files["buildDescription.xml"] = build_description(model).encode()
    contents = {"modelDescription.xml": about.encode()} | {f"sources/{name}": data for name, data in files.items()}
    for name, (targets, suffix) in platforms_of(version, platforms).items():
        contents[f"binaries/{name}/{model.name}{suffix}"] = binary_of(sources, targets, fmu=True)
    programs = hosts(model.name, guid, version, host_variables(model), ONE_UNIT)
    write_archive(path, contents | pages(model, kind, extras) | programs | dict(extras))


def platforms_of(version: int, names: Sequence[str] = ()) -> dict[str, tuple[tuple[str, ...], str]]:
    """Return platforms as in PLATFORMS; without names this machine, which has no target of zig."""
    if not names:
        return {{2: fmpy.platform, 3: fmpy.platform_tuple}[version]: ((), library_suffix())}
    return {name: {2: PLATFORMS, 3: PLATFORMS3}[version][name] for name in names}


def one_unit(model: Model, names: Sequence[str], version: int) -> str:
    """Return C that makes one unit of the files, so that only the functions of FMI have external names."""
    # The model comes first: the others read it, and in one unit it is not declared before. It has its records.
    tables = [name for name in names if name.startswith(TABLE_FILE) and name not in KERNEL_SOURCES]
    records = [name for name in tables if name.startswith(f"{TABLE_FILE}{OWN}")]
    first = [*records, "model.c", *(name for name in tables if name not in records)]
    files = [*first, *(name for name in names if name.endswith(".c") and name not in first)]
    return (
        "/* The whole FMU in one unit of C99 or later, or C++. Only the functions of FMI are seen outside.\n"
        f" * A program that links it with others names them apart: -DFMI{version}_FUNCTION_PREFIX={model.name}_ */\n"
        "#define ONE_UNIT\n"
        '#pragma GCC diagnostic ignored "-Wunused-function" /* each face leaves out what the other one needs */\n'
        + "".join(f'#include "{name}"\n' for name in files)
    )


def binary_of(sources: Mapping[str, str], targets: Sequence[str], fmu: bool, lanes: int = 0) -> bytes:
    """Return a library for targets of zig, one file for two; none: for this machine, with its own compiler."""
    return binary_for(targets, lambda target: library_of(sources, target=target, fmu=fmu, lanes=lanes))


def binary_for(targets: Sequence[str], compiled: Callable[[str | None], Path]) -> bytes:
    """Return a library for targets of zig, one file for two; none: for this machine. Raises CompilerError."""
    libraries = {target: compiled(target).read_bytes() for target in targets}
    if len(libraries) > 1:
        return universal(libraries)
    return next(iter(libraries.values()), None) or compiled(None).read_bytes()


def build_description(model: Model) -> str:
    """Return buildDescription.xml of FMI 3.0: how sources/ are compiled."""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<fmiBuildDescription fmiVersion="3.0">\n'
        f'  <BuildConfiguration modelIdentifier="{model.name}">\n    <SourceFileSet language="C99">\n'
        f'      <SourceFile name="{ONE_UNIT}"/>\n    </SourceFileSet>\n    <Library name="m"/>\n'
        "  </BuildConfiguration>\n</fmiBuildDescription>\n"
    )


def universal(libraries: Mapping[str, bytes]) -> bytes:
    """Return one Mach-O file for several CPUs; each part begins on a page of 16 kB."""
    page = 1 << 14
    header, parts, offset = struct.pack(">II", 0xCAFEBABE, len(libraries)), b"", page
    for target, library in libraries.items():
        header += struct.pack(">IIIII", *MACHINES[target], offset, len(library), 14)
        padded = library + bytes(-len(library) % page)
        parts += padded
        offset += len(padded)
    return header + bytes(page - len(header)) + parts
