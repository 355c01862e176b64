"""Bars of what takes longer than PATIENCE; one that moves with the clock; and none where none are wanted."""

import sys
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from tqdm import tqdm

from fmu_src.progress import PATIENCE as PATIENCE
from fmu_src.progress import hide_bars

#: Time between two looks at the clock [s].
TICK = 0.5


def counting(
    items: Iterable[Any] | None = None, text: str | None = None, total: float | None = None, unit: str = "it"
) -> tqdm:
    """A bar over items, or up to a total of what `update` counts, that is gone at the end."""
    return tqdm(items, text, total, delay=PATIENCE, leave=False, unit=unit)


@contextmanager
def without_bars() -> Iterator[None]:
    """No bars within."""
    shown = tqdm.__init__
    hide_bars()
    try:
        yield
    finally:
        tqdm.__init__ = shown


@contextmanager
def ticking(text: str, expected: float | None) -> Iterator[None]:
    """A bar that moves with the clock towards the time that is expected [s], on a terminal; None: nobody knows.

    Bars that are made within stand below it; it moves also where they have nothing to count for a while.
    """
    begin, over, ticker = time.perf_counter(), threading.Event(), None
    towards = f" |{{bar}}| {{elapsed}} of about {tqdm.format_interval(expected)}" if expected else ": {elapsed}"
    with tqdm(total=expected, desc=text, leave=False, delay=PATIENCE, bar_format="{desc}" + towards) as bar:

        def tick() -> None:
            wait = PATIENCE
            while not over.wait(wait):
                bar.n, wait = min(time.perf_counter() - begin, expected or 0.0), TICK
                bar.refresh()

        if sys.stderr.isatty():
            ticker = threading.Thread(target=tick, daemon=True)
            ticker.start()
        try:
            yield
        finally:
            over.set()
            if ticker:
                ticker.join()
