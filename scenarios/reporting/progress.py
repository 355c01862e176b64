"""When a run owes its user a sign of progress, and when none is wanted."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partialmethod

from tqdm import tqdm

from fmu_src.compile import PATIENCE as PATIENCE


@contextmanager
def without_bars() -> Iterator[None]:
    """No bars within, wherever they are made."""
    shown = tqdm.__init__
    tqdm.__init__ = partialmethod(shown, disable=True)
    try:
        yield
    finally:
        tqdm.__init__ = shown
