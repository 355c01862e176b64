"""Prints what an installation weighs, package by package, as docs/installation.md shows it.

Run it with the Python of a new environment that holds nothing but bogie-braking: python docs/generate/weights.py
"""

import sys
from importlib.metadata import Distribution, distribution, distributions
from pathlib import Path

from packaging.requirements import Requirement

PROJECT = "bogie-braking"


def megabytes(one: Distribution) -> float:
    """What the files of a distribution take on the disk, compiled Python among them."""
    paths = [Path(str(file.locate())) for file in one.files or []]
    return sum(path.stat().st_size for path in paths if path.is_file()) / 1e6


def asked_by(name: str) -> list[str]:
    """Names of what a distribution needs on this machine, without its extras."""
    asked = [Requirement(text) for text in distribution(name).requires or []]
    return [one.name for one in asked if one.marker is None or one.marker.evaluate({"extra": ""})]


def brought_by(name: str, known: set[str]) -> list[str]:
    """What a distribution needs and none before it did, with what these need, one after the other."""
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
