"""The command `doctor`: reports missing parts of the installation. It imports no package that may be missing."""

from __future__ import annotations

import argparse

from bogie_braking import doctor


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add no option."""


def run(chosen: argparse.Namespace) -> int:
    """Print the findings; return exit status 0, or 1 if a required part is missing."""
    return doctor.main()
