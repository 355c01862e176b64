"""Surface of a slab that is heated on one side, above its mean temperature, by four modes.

A constant heat flux q enters a slab of thickness L, whose back is insulated. Its surface exceeds its mean by q L / k
times a series. This is the sum over n of 2 / (n pi)^2 (1 - exp(-n^2 pi^2 a t / L^2)) (Carslaw and Jaeger 1959). The
first mode is that of the series. Three others stand for the rest. Their rates and gains are fitted, and all gains sum
to 1/3, as those of the series do. The excess is exact after a long time. It is within 0.5 % from a t / L^2 = 0.001 on,
and too small before that.
"""

from __future__ import annotations

import math

from fmu_src.symbols import ca

#: Rates of the modes, in a / L^2. Fitted, except for the first.
RATES = (math.pi**2, 46.7, 261.0, 2180.0)
#: Their gains, in q L / k. Fitted, except for the first and for their sum.
GAINS = (2 / math.pi**2, 0.0702, 0.0369, 1 / 3 - 2 / math.pi**2 - 0.0702 - 0.0369)


def excesses(before: ca.SX, steady: ca.SX, fourier: ca.SX) -> ca.SX:
    """Return the modes of the surface after a step of constant heat [K], Carslaw and Jaeger (1959).

    Takes before [K], steady [K].
    """
    left = [ca.exp(-rate * fourier) for rate in RATES]
    parts = zip(ca.vertsplit(before), left, GAINS, strict=True)
    return ca.vertcat(*(own * kept + gain * steady * (1 - kept) for own, kept, gain in parts))
