"""Messages about a line from points: smoothing, bounds, outliers, radii and gradients within the error."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rbd_model.track.points import Points
from rbd_model.track.smoothing import Smooth
from readers.import_account import Account

Numbers = NDArray[np.float64]
#: Share of the distance of knots that a reach has at least in a bound: knots do not resolve more.
RESOLVED = 0.7
#: Times the noise from which a point is named as an outlier. Ratio of residuals to a given noise that is reported.
OUTLIER, MISMATCH = 5.0, 2.0
#: Gradient that railways rarely exceed. Length from which messages have metres instead of millimetres [m].
STEEP, METRES = 0.07, 0.0995


def tell_plan(account: Account, plan: Smooth, noise: float | None, error: Numbers) -> None:
    """Add smoothing and bounds of the plan, and a stated noise that does not fit."""
    origin = "estimated by generalised cross validation" if noise is None else "given"
    account.converted.append(
        f"curvature: x and y smoothed over {plan.reach:.1f} m by a penalised spline, noise {length_of(plan.noise)} "
        f"({origin}); features shorter than {4.0 * max(plan.reach, RESOLVED * plan.pitch):.0f} m are blurred"
    )
    account.converted.append(
        f"error of the curvature: at most {np.median(error):.2g} 1/m at half of the rows, {error.max():.2g} 1/m "
        "everywhere, unless curvature jumps without a transition, or changes that near to an end alone"
    )
    if noise is not None and not 1.0 / MISMATCH <= plan.residual / noise <= MISMATCH:
        account.assumed.append(
            f"the noise is {length_of(noise)} as given, although the points lie {length_of(plan.residual)} beside "
            "the line"
        )


def tell_resolved(account: Account, rows: dict[str, Numbers], error: Numbers, steepness: Numbers) -> None:
    """Add what noisy points do not resolve, and gradients that hint at another unit."""
    account.assumed.append(
        f"radii above {1.0 / np.median(error):.0f} m are within the error at half of the rows, "
        f"{1.0 / error.max():.0f} m everywhere: such curves may be straight"
    )
    bound, steepest = float(np.median(steepness)), float(np.max(np.abs(rows["gradient"])))
    if math.isfinite(bound) and bound > steepest / 2.0:
        sizes = [two_digits(1e3 * size) for size in (bound, steepest)]
        account.assumed.append(
            f"the gradient is not resolved: its error is up to {sizes[0]} per mille at half of the rows, and the "
            f"steepest gradient {sizes[1]} per mille"
        )
    if np.any(np.abs(rows["gradient"]) - steepness > STEEP) and math.isfinite(bound):
        account.assumed.append(f"gradients reach {1e3 * steepest:.3g} per mille: check that heights are in metres")


def tell_outliers(account: Account, given: Points, aside: Numbers, noise: float) -> None:
    """Add points that lie far beside the line."""
    far = np.flatnonzero(np.abs(aside) > OUTLIER * max(noise, 1e-4))
    if far.size:
        worst = int(np.argmax(np.abs(aside)))
        account.assumed.append(
            f"{far.size} points lie beyond {OUTLIER:g} times the noise beside the line and are used, the farthest in "
            f"{given.word} {given.places[worst]}, {abs(aside[worst]):.3g} m: check it"
        )


def two_digits(number: float) -> str:
    """Return a number above 0 with two digits, from 100 on without decimals."""
    return f"{number:.2g}" if number < 99.5 else f"{number:.0f}"


def length_of(size: float) -> str:
    """Return a small length [m] with its unit."""
    return f"{1e3 * size:.2g} mm" if size < METRES else f"{size:.2g} m"
