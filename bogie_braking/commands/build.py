"""The command `build`: builds FMUs."""

from __future__ import annotations

from build_fmu import add_arguments as add_arguments
from build_fmu import run as run
