"""Sensors of the wheels' rotation: numbers of the toothed wheel whose edges are timed, and errors of its pitch.

Its C is rig/encoder.c.
"""

from random import Random

#: Teeth of the default wheel: real ones have 60 to 300 pulses a turn, mostly 80 to 128.
TEETH = 100
#: Least time over which edges are averaged, resolution of the timer [s], and edges a second below which the wheel is
#: treated as standing [Hz]. Assumed.
GATE, TIMER, LOWEST_FREQUENCY = 0.03, 1e-6, 5.0
#: Largest error of an edge, as a share of the pitch: edges keep their order.
LARGEST_ERROR = 0.45


def edge_errors(pulses: int, jitter: float, seed: int) -> list[float]:
    """Return errors of all edges' places, as shares of the pitch, with standard deviation `jitter`.

    Empty without it.
    """
    random = Random(seed)
    drawn = (random.gauss(0.0, jitter) for _ in range(pulses)) if jitter else ()
    return [min(max(error, -LARGEST_ERROR), LARGEST_ERROR) for error in drawn]
