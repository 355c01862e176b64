"""A progress bar that moves with the clock, in addition to those that count (`fmu_src/progress.py`)."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from tqdm import tqdm

from fmu_src.progress import PATIENCE as PATIENCE
from fmu_src.progress import counting as counting
from fmu_src.progress import without_bars as without_bars

#: Interval between readings of the clock [s].
TICK = 0.5


@contextmanager
def ticking(text: str, expected: float | None) -> Iterator[None]:
    """Show a bar on a terminal that moves with the clock towards the expected time [s]; None: unknown.

    Bars that are made within are shown below it; it also moves while they have nothing to count.
    """
    begin, over, ticker = time.perf_counter(), threading.Event(), None
    towards = f" |{{bar}}| {{elapsed}} of about {tqdm.format_interval(expected)}" if expected else ": {elapsed}"
    with counting(text=text, total=expected, bar_format="{desc}" + towards) as bar:

        def tick() -> None:
            wait = PATIENCE
            while not over.wait(wait):
                bar.n, wait = min(time.perf_counter() - begin, expected or 0.0), TICK
                bar.refresh()

        if not bar.disable:
            ticker = threading.Thread(target=tick, daemon=True)
            ticker.start()
        try:
            yield
        finally:
            over.set()
            if ticker:
                ticker.join()
