"""The reader of TOML that this Python has: its own from 3.11 on, before that a package."""

import sys
from importlib import import_module

tomllib = import_module("tomllib" if sys.version_info >= (3, 11) else "tomli")
