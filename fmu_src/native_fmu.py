"""The native FMU: the compiled kernel with its faces, no Python inside, for one platform or for several.

One binary serves FMI 2.0 and 3.0; the archives differ in modelDescription.xml and in the names of the platforms.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from pathlib import Path

import fmpy

from fmu_src.archive import write_archive
from fmu_src.codegen import RUNTIME, RUNTIME_HEADERS, RUNTIME_SOURCES, generate, guid_of
from fmu_src.compile import FMI_HEADERS, library_of, library_suffix
from fmu_src.model_description import model_description
from fmu_src.model_description3 import model_description3
from fmu_src.pages import pages
from fmu_src.system import Model

#: Folder in binaries/ -> targets of zig, and suffix of the library. Two targets make one universal binary. The glibc is
#: that of CentOS 7. FMI 2.0 has no name for Linux on ARM; this is the one of FMI 3.0, which FMPy looks for as well.
PLATFORMS: dict[str, tuple[tuple[str, ...], str]] = {
    "linux64": (("x86_64-linux-gnu.2.17",), ".so"),
    "win64": (("x86_64-windows-gnu",), ".dll"),
    "darwin64": (("x86_64-macos", "aarch64-macos"), ".dylib"),
    "aarch64-linux": (("aarch64-linux-gnu.2.17",), ".so"),
}
#: The same for FMI 3.0.
PLATFORMS3: dict[str, tuple[tuple[str, ...], str]] = {
    "x86_64-linux": (("x86_64-linux-gnu.2.17",), ".so"),
    "x86_64-windows": (("x86_64-windows-gnu",), ".dll"),
    "x86_64-darwin": (("x86_64-macos",), ".dylib"),
    "aarch64-darwin": (("aarch64-macos",), ".dylib"),
    "aarch64-linux": (("aarch64-linux-gnu.2.17",), ".so"),
}
#: Of Mach-O files: CPU type and subtype by target.
MACHINES = {"x86_64-macos": (0x01000007, 3), "aarch64-macos": (0x0100000C, 0)}
FMI_HEADER_FILES = (
    *("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    *("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
)


def build_native_fmu(
    model: Model, path: Path, platforms: Sequence[str] = (), extras: Mapping[str, bytes] | None = None
) -> None:
    """Writes the native FMU of a model.

    platforms: names in PLATFORMS, compiled with zig; none: the platform it is built on, with its own compiler. extras:
    more files by their names in the archive. Raises CompilerError.
    """
    sources = generate(model)
    about = model_description(model, guid_of(sources), source_files=[*sources, *RUNTIME_SOURCES])
    binaries = _binaries(model, sources, platforms or [fmpy.platform], PLATFORMS if platforms else {})
    write_archive(path, _contents(sources, about) | pages(model, "native") | binaries | dict(extras or {}))


def build_native_fmu3(
    model: Model, path: Path, platforms: Sequence[str] = (), extras: Mapping[str, bytes] | None = None
) -> None:
    """The same for FMI 3.0; platforms: names in PLATFORMS3."""
    sources = generate(model)
    about = model_description3(model, guid_of(sources))
    binaries = _binaries(model, sources, platforms or [fmpy.platform_tuple], PLATFORMS3 if platforms else {})
    names = [*sources, *RUNTIME_SOURCES]
    build = {"sources/buildDescription.xml": build_description(model, names).encode()}
    contents = _contents(sources, about) | pages(model, "fmi3") | build
    write_archive(path, contents | binaries | dict(extras or {}))


def _contents(sources: Mapping[str, str], about: str) -> dict[str, bytes]:
    return {
        "modelDescription.xml": about.encode(),
        **{f"sources/{name}": text.encode() for name, text in sources.items()},
        **{f"sources/{name}": (RUNTIME / name).read_bytes() for name in (*RUNTIME_SOURCES, *RUNTIME_HEADERS)},
        **{f"sources/{name}": (FMI_HEADERS / name).read_bytes() for name in FMI_HEADER_FILES},
    }


def _binaries(
    model: Model,
    sources: Mapping[str, str],
    platforms: Sequence[str],
    known: Mapping[str, tuple[tuple[str, ...], str]],
) -> dict[str, bytes]:
    """Libraries by their names in the archive; a platform that is not `known` is this one, with its own compiler."""
    found = {}
    for name in platforms:
        targets, suffix = known.get(name, ((), library_suffix()))
        libraries = {target: library_of(sources, target=target).read_bytes() for target in targets}
        libraries = libraries or {"own": library_of(sources).read_bytes()}
        binary = universal(libraries) if len(libraries) > 1 else next(iter(libraries.values()))
        found[f"binaries/{name}/{model.name}{suffix}"] = binary
    return found


def build_description(model: Model, names: Sequence[str]) -> str:
    """How sources/ are compiled, FMI 3.0."""
    files = "\n".join(f'      <SourceFile name="{name}"/>' for name in names)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<fmiBuildDescription fmiVersion="3.0">\n'
        f'  <BuildConfiguration modelIdentifier="{model.name}">\n    <SourceFileSet language="C11">\n{files}\n'
        '    </SourceFileSet>\n    <Library name="m"/>\n  </BuildConfiguration>\n</fmiBuildDescription>\n'
    )


def universal(libraries: Mapping[str, bytes]) -> bytes:
    """One Mach-O file for several CPUs; each part begins on a page of 16 kB."""
    page = 1 << 14
    header, parts, offset = struct.pack(">II", 0xCAFEBABE, len(libraries)), b"", page
    for target, library in libraries.items():
        header += struct.pack(">IIIII", *MACHINES[target], offset, len(library), 14)
        padded = library + bytes(-len(library) % page)
        parts += padded
        offset += len(padded)
    return header + bytes(page - len(header)) + parts
