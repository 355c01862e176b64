"""The command `doctor`: report each part of the installation, whether it is present, and the remedy if it is missing.

This module imports only the standard library until it has found the packages.
"""

import argparse
import base64
import hashlib
import os
import platform
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution, metadata, version
from pathlib import Path
from typing import Any

PROJECT, PACKAGE = "bogie-braking", "bogie_braking"
LEAST_PYTHON = (3, 10)
#: Names of the verdicts: in order, missing and required, missing and optional.
OK, MISSING, WITHOUT = "ok", "MISSING", "without"
#: C source and number of bytes that test the compiler and the cache; largest number of names in a line.
PROBE_IN_C = "#include <math.h>\ndouble root(double);\ndouble root(double x) { return sqrt(x); }\n"
PROBE, MOST_NAMES = 1 << 16, 3


@dataclass(frozen=True)
class PartFinding:
    """One line: its verdict, the part that was checked with the result, and the remedy if it is missing."""

    verdict: str
    text: str
    advice: str = ""

    def __str__(self) -> str:
        return f"{self.verdict:8} {self.text}" + (f"\n{'':8} -> {self.advice}" if self.advice else "")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add no option."""


def run(chosen: argparse.Namespace) -> int:
    """Print the findings; return exit status 0, or 1 if a required part is missing."""
    complete = True
    for finding in findings():
        print(finding, flush=True)
        complete = complete and finding.verdict != MISSING
    return 0 if complete else 1


def findings() -> Iterator[PartFinding]:
    """Yield the findings, the most general first; the last ones only if all packages are present."""
    yield python()
    installed = list(packages())
    yield from installed
    if all(one.verdict != MISSING for one in installed):
        shipped = prebuilt()
        compiles = compiler(shipped.verdict == OK)
        yield from (installation(), shipped, equations(shipped.verdict == OK))
        yield from (compiles, cache(compiles.verdict == OK))


def python() -> PartFinding:
    """Return the finding on the interpreter and the operating system."""
    text = f"Python {platform.python_version()} on {platform.system()} {platform.machine()}"
    if sys.version_info < LEAST_PYTHON:
        return PartFinding(MISSING, text, f"Install Python {'.'.join(map(str, LEAST_PYTHON))} or later.")
    return PartFinding(OK, text)


def packages() -> Iterator[PartFinding]:
    """Yield one finding for the required packages and one for each extra."""
    try:
        about = metadata(PROJECT)
        from packaging.requirements import Requirement
    except (PackageNotFoundError, ImportError):
        yield PartFinding(MISSING, f"{PROJECT}: not installed", "Install its wheel, or in a checkout: pip install -e .")
        return
    asked = [Requirement(text) for text in about.get_all("Requires-Dist") or []]
    for extra in ("", *(about.get_all("Provides-Extra") or [])):
        yield group(extra, {one.name: one.specifier for one in asked_by(extra, asked)})


def asked_by(extra: str, asked: Sequence[Any]) -> Iterator[Any]:
    """Yield the requirements of an extra, or (empty) of all, with those of the extras that it consists of."""
    for one in asked:
        if belongs(one.marker, extra) and one.name != PROJECT:
            yield one
        elif belongs(one.marker, extra):
            for other in sorted(one.extras):
                yield from asked_by(other, asked)


def belongs(marker: Any, extra: str) -> bool:
    """Return whether a package with this marker is required on this computer, by an extra or (empty) by all."""
    if marker is None:
        return not extra
    return marker.evaluate({"extra": extra}) and not (extra and marker.evaluate({"extra": ""}))


def group(extra: str, asked: Mapping[str, Any]) -> PartFinding:
    """Return the finding on a group of required packages; asked: versions by name."""
    here, wrong = [], []
    for name, versions in asked.items():
        try:
            here.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            wrong.append(f"{name} is missing")
            continue
        if not versions.contains(version(name), prereleases=True):
            wrong.append(f"{name} {version(name)} is not {versions}")
    label = f"extra {extra}" if extra else "packages"
    if not wrong:
        return PartFinding(OK, f"{label}: {', '.join(here) or 'nothing on this machine'}")
    install = f"pip install '{PROJECT}[{extra}]'" if extra else f"pip install '{PROJECT}'"
    return PartFinding(
        WITHOUT if extra else MISSING, f"{label}: {', '.join(wrong)}", f"{install}, in a checkout with -e ."
    )


def installation() -> PartFinding:
    """Return whether the files of the package are unchanged since installation, tables, pages and code among them."""
    own = [one for one in distribution(PROJECT).files or [] if one.parts[0] == PACKAGE]
    listed = [one for one in own if one.hash and one.hash.mode == "sha256"]
    if not listed:
        return PartFinding(OK, "installation: a checkout, whose files have no checksums")
    wrong = [str(one) for one in listed if not unchanged(Path(str(one.locate())), str(one.hash and one.hash.value))]
    text = f"installation: {len(listed)} files"
    if wrong:
        return PartFinding(
            MISSING, f"{text}; damaged: {shortened(wrong)}", f"pip install --force-reinstall '{PROJECT}'"
        )
    return PartFinding(OK, text)


def unchanged(path: Path, checksum: str) -> bool:
    """Return whether a file has the SHA-256 that pip recorded, in base64 without padding."""
    try:
        found = hashlib.sha256(path.read_bytes()).digest()
    except OSError:
        return False
    return base64.urlsafe_b64encode(found).decode().rstrip("=") == checksum


def shortened(names: Sequence[str]) -> str:
    """Return names, shortened to one line."""
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more


def prebuilt() -> PartFinding:
    """Return the finding on the prebuilt FMUs of a wheel."""
    from products.prebuilt import CONTENTS, PREBUILT, contents, damaged, sources_here

    about, wrong = contents(), damaged()
    if not about and (PREBUILT / CONTENTS).exists():
        wrong = [CONTENTS]
    if wrong:
        text = f"prebuilt FMUs: damaged: {shortened(wrong)}"
        return PartFinding(
            WITHOUT, text, "Install the package again; until then each is compiled when it is first needed."
        )
    if not about:
        return PartFinding(WITHOUT, "prebuilt FMUs: none", "Nothing to do: each is compiled when it is first needed.")
    text = f"prebuilt FMUs: {', '.join(about['contents'])} for {about['platform']}"
    if about["sources"] != sources_here():
        text += "; sources were changed since"
        return PartFinding(WITHOUT, text, "Nothing to do: what that touches is compiled when it is first needed.")
    return PartFinding(OK, text)


def equations(spared: bool) -> PartFinding:
    """Return whether equations can be written; `spared`: the scenarios' FMUs are prebuilt."""
    from readers.extras import has, install

    if has("casadi"):
        return PartFinding(OK, "equations: CasADi")
    advice = f"{install('build')}; until then ready machines alone run" if spared else install("build")
    return PartFinding(WITHOUT if spared else MISSING, "equations: CasADi is missing", advice)


def compiler(spared: bool) -> PartFinding:
    """Return whether C can be compiled; `spared`: the scenarios' FMUs are prebuilt."""
    from fmu_src import compile as compiling

    command = " ".join(compiling.compiler())
    try:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "probe.c").write_text(PROBE_IN_C)
            compiling.run(["-shared", "-fPIC", "-o", "probe", "probe.c", "-lm"], None, Path(folder))
    except (compiling.CompilerError, OSError) as error:
        reason = " ".join(str(error).split())
        advice = f"Install gcc or clang, name a compiler in $CC, or: {compiling.INSTALL_ZIG}"
        if spared:
            advice += "; without one changed equations cannot be run."
        return PartFinding(WITHOUT if spared else MISSING, f"C compiler: {command} does not work ({reason})", advice)
    return PartFinding(OK, f"C compiler: {command}")


def cache(compiles: bool) -> PartFinding:
    """Return the finding on the cache of compiled kernels and FMUs, found as their loader finds it; compiles:

    C can be compiled.
    """
    from fmu_src import compile as compiling
    from fmu_src.cached_files import kept_files, whole
    from readers.storage import StorageError, write_whole

    try:
        probe = compiling.cache() / f"doctor-{os.getpid()}"
        write_whole(probe, bytes(PROBE), compiling.ANOTHER_CACHE)
        probe.unlink()
        if compiles:
            compiling.loaded(compiling.plain_library({"probe.c": PROBE_IN_C}))
    except (compiling.CompilerError, StorageError) as error:
        reason, _, advice = str(error).partition(". ")
        return PartFinding(MISSING, f"cache: {reason}", advice or compiling.sentence(compiling.ANOTHER_CACHE))
    size = sum(path.stat().st_size for path in compiling.CACHE.rglob("*") if path.is_file())
    text = f"cache: {compiling.CACHE}, {size / 1e6:.0f} MB"
    wrong = [kept_file.name for kept_file in kept_files(compiling.CACHE) if kept_file.exists() and not whole(kept_file)]
    if wrong:
        text += f"; not whole: {shortened(wrong)}"
        return PartFinding(WITHOUT, text, "Nothing to do: each is made again when it is next needed.")
    return PartFinding(OK, text)
