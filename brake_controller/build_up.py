"""Build-up of a brake at a constant rate."""

from __future__ import annotations

from fmu_src.symbols import ca

#: Least time [s] or speed [m/s] in a denominator.
LEAST = 1e-9


def ramped(before: ca.SX, wanted: ca.SX, rise: ca.SX, step: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the mean of a share in a step and its end, if it changes by 1 / rise in a second to its demand.

    Linear build-up, as EN 14531-1 takes it; the mean is exact where the end is reached within the step.
    """
    time = ca.fmin(ca.fabs(wanted - before) * rise, step)
    change = time / ca.fmax(rise, LEAST)
    ends = ca.if_else(time < step, wanted, ca.if_else(wanted > before, before + change, before - change))
    moved = time / ca.fmax(step, LEAST)
    return moved * (before + ends) / 2 + (1 - moved) * ends, ends
