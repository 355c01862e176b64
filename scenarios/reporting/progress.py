"""Bars of what takes longer than PATIENCE; and none where none are wanted."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partialmethod

from tqdm import tqdm

from fmu_src.progress import PATIENCE as PATIENCE


def hide_bars() -> None:
    """No bars from now on, wherever they are made."""
    tqdm.__init__ = partialmethod(tqdm.__init__, disable=True)


@contextmanager
def without_bars() -> Iterator[None]:
    """No bars within."""
    shown = tqdm.__init__
    hide_bars()
    try:
        yield
    finally:
        tqdm.__init__ = shown
