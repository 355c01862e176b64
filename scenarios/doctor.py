"""Says what is there and what is missing, each with what to do.

It imports nothing but the standard library until it knows that the packages are there.
"""

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
#: How a finding is called that is as it should be, that is not and stops the work, and that is not but may be.
OK, MISSING, WITHOUT = "ok", "MISSING", "without"
#: What is compiled, and how many bytes are written, to see whether that works; names in a line.
PROBE_IN_C = "#include <math.h>\ndouble root(double);\ndouble root(double x) { return sqrt(x); }\n"
PROBE, MOST_NAMES = 1 << 16, 3


@dataclass(frozen=True)
class Finding:
    """One line: how it stands, what was looked at and found, and what to do where something is not there."""

    verdict: str
    text: str
    advice: str = ""

    def __str__(self) -> str:
        return f"{self.verdict:8} {self.text}" + (f"\n{'':8} -> {self.advice}" if self.advice else "")


def main() -> int:
    """Prints the findings; exit status 0, or 1 if something is missing that is needed."""
    complete = True
    for finding in findings():
        print(finding, flush=True)
        complete = complete and finding.verdict != MISSING
    return 0 if complete else 1


def findings() -> Iterator[Finding]:
    """From what all others need to what is a matter of taste; the last ones only where the packages are there."""
    yield python()
    installed = list(packages())
    yield from installed
    if all(one.verdict != MISSING for one in installed):
        shipped = prebuilt()
        compiles = compiler(shipped.verdict == OK)
        yield from (installation(), shipped, compiles, cache(compiles.verdict == OK))


def python() -> Finding:
    """The interpreter and the machine."""
    text = f"Python {platform.python_version()} on {platform.system()} {platform.machine()}"
    if sys.version_info < LEAST_PYTHON:
        return Finding(MISSING, text, f"Install Python {'.'.join(map(str, LEAST_PYTHON))} or later.")
    return Finding(OK, text)


def packages() -> Iterator[Finding]:
    """What the project asks for, and what each of its extras does."""
    try:
        about = metadata(PROJECT)
        from packaging.requirements import Requirement
    except (PackageNotFoundError, ImportError):
        yield Finding(MISSING, f"{PROJECT}: not installed", "Install its wheel, or in a checkout: pip install -e .")
        return
    asked = [Requirement(text) for text in about.get_all("Requires-Dist") or []]
    for extra in ("", *(about.get_all("Provides-Extra") or [])):
        yield group(extra, {one.name: one.specifier for one in asked if belongs(one.marker, extra)})


def belongs(marker: Any, extra: str) -> bool:
    """Whether what has this marker is asked for on this machine, by an extra or (empty) by all."""
    if marker is None:
        return not extra
    return marker.evaluate({"extra": extra}) and not (extra and marker.evaluate({"extra": ""}))


def group(extra: str, asked: Mapping[str, Any]) -> Finding:
    """Packages that are asked for together, by name with their versions."""
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
        return Finding(OK, f"{label}: {', '.join(here) or 'nothing on this machine'}")
    install = f"pip install '{PROJECT}[{extra}]'" if extra else f"pip install '{PROJECT}'"
    return Finding(WITHOUT if extra else MISSING, f"{label}: {', '.join(wrong)}", f"{install}, in a checkout with -e .")


def installation() -> Finding:
    """Whether the files of the package are those that were installed: tables, pages and code among them."""
    own = [one for one in distribution(PROJECT).files or [] if one.parts[0] == PACKAGE]
    listed = [one for one in own if one.hash and one.hash.mode == "sha256"]
    if not listed:
        return Finding(OK, "installation: a checkout, whose files have no checksums")
    wrong = [str(one) for one in listed if not unchanged(Path(str(one.locate())), str(one.hash and one.hash.value))]
    text = f"installation: {len(listed)} files"
    if wrong:
        return Finding(MISSING, f"{text}; damaged: {shortened(wrong)}", f"pip install --force-reinstall '{PROJECT}'")
    return Finding(OK, text)


def unchanged(path: Path, checksum: str) -> bool:
    """Whether a file has the SHA-256 that pip noted, in base64 without padding."""
    try:
        found = hashlib.sha256(path.read_bytes()).digest()
    except OSError:
        return False
    return base64.urlsafe_b64encode(found).decode().rstrip("=") == checksum


def shortened(names: Sequence[str]) -> str:
    """Names for one line."""
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more


def prebuilt() -> Finding:
    """What a wheel brings compiled."""
    from products.prebuilt import CONTENTS, PREBUILT, contents, damaged, sources_here

    about, wrong = contents(), damaged()
    if not about and (PREBUILT / CONTENTS).exists():
        wrong = [CONTENTS]
    if wrong:
        text = f"prebuilt FMUs: damaged: {shortened(wrong)}"
        return Finding(WITHOUT, text, "Install the package again; until then each is compiled when it is first needed.")
    if not about:
        return Finding(WITHOUT, "prebuilt FMUs: none", "Nothing to do: each is compiled when it is first needed.")
    text = f"prebuilt FMUs: {', '.join(about['contents'])} for {about['platform']}"
    if about["sources"] != sources_here():
        text += "; sources were changed since"
        return Finding(WITHOUT, text, "Nothing to do: what that touches is compiled when it is first needed.")
    return Finding(OK, text)


def compiler(spared: bool) -> Finding:
    """Whether C can be compiled; `spared`: the scenarios' FMUs are there without it."""
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
        return Finding(WITHOUT if spared else MISSING, f"C compiler: {command} does not work ({reason})", advice)
    return Finding(OK, f"C compiler: {command}")


def cache(compiles: bool) -> Finding:
    """Where compiled kernels and FMUs are kept, looked at as whoever loads them does; compiles: whether C can be."""
    from fmu_src import compile as compiling
    from fmu_src.kept import kept_files, whole
    from readers.storage import StorageError, write_whole

    try:
        probe = compiling.cache() / f"doctor-{os.getpid()}"
        write_whole(probe, bytes(PROBE), compiling.ANOTHER_CACHE)
        probe.unlink()
        if compiles:
            compiling.loaded(compiling.plain_library({"probe.c": PROBE_IN_C}))
    except (compiling.CompilerError, StorageError) as error:
        reason, _, advice = str(error).partition(". ")
        return Finding(MISSING, f"cache: {reason}", advice or compiling.sentence(compiling.ANOTHER_CACHE))
    size = sum(path.stat().st_size for path in compiling.CACHE.rglob("*") if path.is_file())
    text = f"cache: {compiling.CACHE}, {size / 1e6:.0f} MB"
    wrong = [one.name for one in kept_files(compiling.CACHE) if one.exists() and not whole(one)]
    if wrong:
        text += f"; not whole: {shortened(wrong)}"
        return Finding(WITHOUT, text, "Nothing to do: each is made again when it is next needed.")
    return Finding(OK, text)
