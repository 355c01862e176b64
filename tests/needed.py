"""Programs that some tests need and that PyPI does not have."""

from __future__ import annotations

import os
import shutil

import pytest


def needed(*names: str, packages: str) -> str:
    """Path of the first of these programs that is here. Where there is none the test is skipped, but for CI=true, which
    must have what it says that it tests (`.ci/run` installs it); packages: those of Debian.
    """
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None and os.environ.get("CI") != "true":
        pytest.skip(f"there is none of {', '.join(names)} here; on Debian: apt-get install {packages}")
    assert found, f"CI must have {' or '.join(names)}: apt-get install {packages}"
    return found
