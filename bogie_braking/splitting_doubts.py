"""Reasons why an estimate by splitting is less certain than its interval, as messages."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bogie_braking.splitting import POPULATIONS, Numbers, Population

#: Ratio of the scatter of estimates to that of independent particles. With 200 seeds each, at 1e-4 and five normal
#: inputs, this scatter occurs for 1 % of the seeds with 5 moves, and for 90 % with 1 move, whose interval contains the
#: true value too seldom.
SCATTERED = 1.7
#: An interval as wide as this factor is reported.
WIDE = 10.0
#: A share of accepted moves that is too small, and a share of runs with the same output that is too large.
STUCK, SHARED = 0.1, 0.01


def doubts_about(
    populations: Sequence[Population], limit: float, moves: int, interval: Sequence[float], labels: Sequence[str]
) -> list[str]:
    """Return warnings about the first runs, the estimates and the chains; empty if all is well.

    labels: names of the inputs.
    """
    estimates = np.array([one.probability for one in populations])
    messages = _atom(np.concatenate([one.generations[0].outputs for one in populations]))
    climbed = [population for population in populations if population.accepted]
    if not np.any(estimates):
        highest = max(float(np.max(one.outputs)) for one in populations)
        messages.append(f"No run came above the limit: the highest came to {highest:g}.")
    elif climbed:
        messages += _spread(estimates, interval) + _chains(populations, estimates, moves)
    if climbed and (accepted := float(np.mean([one.accepted[-1] for one in climbed]))) < STUCK:
        messages.append(f"Chains stand still: of the last moves {100 * accepted:.1f} % were accepted.")
    return messages + _regions(climbed, limit, labels)


def _atom(outputs: Numbers) -> list[str]:
    """Warn of a value that many runs share, which no level can separate."""
    values, times = np.unique(outputs[np.isfinite(outputs)], return_counts=True)
    share = float(np.max(times)) / outputs.size
    if share <= SHARED:
        return []
    return [f"{100 * share:.0f} % of the first runs end at exactly {values[np.argmax(times)]:g}: no level parts them."]


def _spread(estimates: Numbers, interval: Sequence[float]) -> list[str]:
    """Warn of populations that are too small."""
    if none := int(np.sum(estimates == 0.0)):
        return [f"{none} of {POPULATIONS} populations found no run above the limit; give more particles."]
    if interval[1] > WIDE * interval[0]:
        return [f"The interval spans a factor of {interval[1] / interval[0]:.0f}; give more particles."]
    return []


def _chains(populations: Sequence[Population], estimates: Numbers, moves: int) -> list[str]:
    """Warn of too few moves: copies are still close to their parents."""
    alone = np.sqrt(np.mean([population.variance_if_independent() for population in populations]))
    times = float(np.std(estimates, ddof=1) / np.mean(estimates) / alone)
    if times <= SCATTERED:
        return []
    more = f"give more than {moves} move{'s' if moves > 1 else ''}"
    return [f"Estimates scatter {times:.1f} times as much as those of independent particles; {more}."]


def _regions(climbed: Sequence[Population], limit: float, labels: Sequence[str]) -> list[str]:
    """Warn of populations whose distance at the end exceeds their width."""
    there = [above for one in climbed if len(above := one.points[one.outputs > limit]) > 1]
    if len(there) < 2:
        return []
    between = np.var([np.mean(one, axis=0) for one in there], axis=0, ddof=1)
    within = np.mean([np.var(one, axis=0) for one in there], axis=0)
    apart = [label for label, far in zip(labels, between > within, strict=True) if far]
    if not apart:
        return []
    return [
        f"Populations ended apart in {' and in '.join(apart)}: several regions may lie above the limit, some of them "
        "found by few or none; give more particles and moves."
    ]
