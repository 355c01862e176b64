"""Wall time, the least of several runs, because of noise."""

import time
from collections.abc import Callable

LEVELS = {1: "point", 2: "planar", 3: "spatial"}
REPEATS = 7


def least(action: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the time of the fastest of several runs, after one to warm up [s]."""
    action()
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        seconds.append(time.perf_counter() - begin)
    return min(seconds)
