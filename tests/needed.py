"""Programs and packages that some tests need, and what happens where they are not installed."""

from __future__ import annotations

import os
import shutil
from importlib.util import find_spec
from pathlib import Path

import pytest


def needed(*names: str, packages: str) -> str:
    """Return the path of the first of these programs that is installed; PyPI does not have them.

    If none is installed, the test is skipped. With CI=true it fails, because CI must have everything that it tests with
    (`.ci/run` installs it). packages: names of the Debian packages.
    """
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None and os.environ.get("CI") != "true":
        pytest.skip(f"there is none of {', '.join(names)} here; on Debian: apt-get install {packages}")
    assert found, f"CI must have {' or '.join(names)}: apt-get install {packages}"
    return found


def needed_package(name: str) -> Path:
    """Return the folder of a Python package of the extra `test`; if it is not installed, skip as `needed` does."""
    found = find_spec(name)
    advice = 'pip install -e ".[test]"'
    if found is None and os.environ.get("CI") != "true":
        pytest.skip(f"there is no Python package {name} here; {advice}")
    assert found, f"CI must have the Python package {name}: {advice}"
    assert found.origin
    return Path(found.origin).parent
