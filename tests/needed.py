"""Programs and packages that some tests need, and what happens where they are not installed."""

from __future__ import annotations

import os
import shutil
from importlib.util import find_spec
from pathlib import Path

import pytest


def needed(*names: str, packages: str) -> str:
    """Path of the first of these programs that is here; PyPI does not have them.

    Where there is none the test is skipped, but for CI=true, which must have what it says that it tests (`.ci/run`
    installs it); packages: those of Debian.
    """
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None and os.environ.get("CI") != "true":
        pytest.skip(f"there is none of {', '.join(names)} here; on Debian: apt-get install {packages}")
    assert found, f"CI must have {' or '.join(names)}: apt-get install {packages}"
    return found


def needed_package(name: str) -> Path:
    """Folder of a Python package of the extra `test`; the test is skipped as by `needed` where it is not installed."""
    found = find_spec(name)
    advice = 'pip install -e ".[test]"'
    if found is None and os.environ.get("CI") != "true":
        pytest.skip(f"there is no Python package {name} here; {advice}")
    assert found, f"CI must have the Python package {name}: {advice}"
    assert found.origin
    return Path(found.origin).parent
