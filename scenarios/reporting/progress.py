"""A progress bar that moves with the clock, beside those that count (`fmu_src/progress.py`)."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from tqdm import tqdm

from fmu_src.progress import PATIENCE as PATIENCE
from fmu_src.progress import counting as counting
from fmu_src.progress import without_bars as without_bars

#: Time between two looks at the clock [s].
TICK = 0.5


@contextmanager
def ticking(text: str, expected: float | None) -> Iterator[None]:
    """A bar that moves with the clock towards the time that is expected [s], on a terminal; None: nobody knows.

    Bars that are made within stand below it; it moves also where they have nothing to count for a while.
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
