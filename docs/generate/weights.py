"""Prints the size of an installation, package by package, as in docs/installation.md.

Run it with the Python of a new environment with bogie-braking alone: python docs/generate/weights.py
"""

import sys
from importlib.metadata import Distribution, distribution, distributions
from pathlib import Path

from packaging.requirements import Requirement

PROJECT = "bogie-braking"


def megabytes(one: Distribution) -> float:
    """Return the disk space of a distribution's files, including compiled Python [MB]."""
    paths = [Path(str(file.locate())) for file in one.files or []]
    return sum(path.stat().st_size for path in paths if path.is_file()) / 1e6


def asked_by(name: str) -> list[str]:
    """Return the names of a distribution's requirements on this platform, without its extras."""
    asked = [Requirement(text) for text in distribution(name).requires or []]
    return [one.name for one in asked if one.marker is None or one.marker.evaluate({"extra": ""})]


def brought_by(name: str, known: set[str]) -> list[str]:
    """Return the new requirements of a distribution, with their own requirements, one after the other."""
    found: list[str] = []
    for one in asked_by(name):
        if one.lower() not in known:
            known.add(one.lower())
            found += [one, *brought_by(one, known)]
    return found


def main() -> int:
    asked = sorted(asked_by(PROJECT), key=lambda name: -megabytes(distribution(name)))
    known = {PROJECT, *(name.lower() for name in asked)}
    print("| package | MB | brings with it | MB |\n|---|---|---|---|")
    for name in asked:
        brought = sorted(brought_by(name, known), key=lambda one: -megabytes(distribution(one)))
        sizes = [megabytes(distribution(one)) for one in brought]
        words = ", ".join(f"{one} {size:.0f}" for one, size in zip(brought, sizes, strict=True) if size >= 1.0)
        print(f"| {name} | {megabytes(distribution(name)):.0f} | {words} | {sum(sizes):.0f} |")
    print(f"| all, with pip and {PROJECT} itself | {sum(map(megabytes, distributions())):.0f} | | |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
