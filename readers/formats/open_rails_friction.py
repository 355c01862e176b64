"""Friction tables of Open Rails vehicles, ORTSBrakeShoeFriction, as a friction that changes with speed.

A consist has mu = fast + (standing - fast) V2 / (V + V2), the speed dependence of all published laws of blocks and pads
(Karwatzki). It is fitted to the table with the friction at standstill of the table, to which MaxBrakeForce belongs.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from readers.formats.open_rails_fields import Fields
from readers.formats.vehicle_rows import rounded
from readers.import_account import Notes, Row
from readers.text import FileError, quoted

#: Speeds V2 that are tried [km/h], the number of speeds at which a fit is compared, and its least friction.
HALF_SPEEDS, SAMPLES, LEAST = np.geomspace(1.0, 1000.0, 601), 201, 0.001
#: Relative deviation from a table below which its friction is constant.
CONSTANT = 1e-3
#: Relative deviation from which a table is told to be unusual.
FAR = 0.05


def friction_of_table(fields: Fields, notes: Notes, at_rims: bool) -> Row:
    """Return the friction of ORTSBrakeShoeFriction, a row without columns if the file has no such table."""
    table = _table(fields)
    if not table:
        return {}
    speeds, frictions = np.array(table).T
    standing = float(np.interp(0.0, speeds, frictions))
    if float(np.ptp(frictions)) <= CONSTANT * standing:
        notes.converted("ORTSBrakeShoeFriction: one value at all speeds -> friction = constant")
        return {"friction": "constant"} | ({} if at_rims else {"friction_value": rounded(standing)})
    fast, half, deviation = fitted(speeds, frictions)
    notes.converted(
        f"ORTSBrakeShoeFriction -> friction = speed: {standing:.3g} at standstill, fast {fast:.3g}, half of the change "
        f"at {half:.3g} km/h; largest deviation from the table {100 * deviation:.1f} %."
    )
    if deviation > FAR:
        notes.assumed(
            f"ORTSBrakeShoeFriction: friction = speed deviates by {100 * deviation:.0f} % from the table, which does "
            "not fall or rise as that of shoes does. Check it."
        )
    row = {"friction_value": standing, "friction_fast": fast, "friction_speed": half}
    return {"friction": "speed"} | {name: rounded(value) for name, value in row.items()}


def fitted(speeds: np.ndarray, frictions: np.ndarray) -> tuple[float, float, float]:
    """Return friction at a high speed, V2 [km/h] and the largest relative deviation of the fit to a table.

    Takes speeds, frictions [km/h] (rows,).
    """
    at = np.linspace(0.0, speeds[-1], SAMPLES)
    wanted = np.interp(at, speeds, frictions)
    left = HALF_SPEEDS[:, None] / (at + HALF_SPEEDS[:, None])  # share of the friction at standstill
    gains = (1.0 - left) / wanted
    fast = np.sum(gains * (1.0 - left * wanted[0] / wanted), axis=1) / np.sum(gains**2, axis=1)
    fast = np.clip(fast, LEAST, 1.0)
    off = np.max(np.abs((left * wanted[0] + (1.0 - left) * fast[:, None]) / wanted - 1.0), axis=1)
    best = int(np.argmin(off))
    return float(fast[best]), float(HALF_SPEEDS[best]), float(off[best])


def _table(fields: Fields) -> list[tuple[float, float]]:
    """Return speeds [km/h] that grow, and friction, none if the file has no such table. Raises FileError."""
    block = fields.blocks.get("ortsbrakeshoefriction")
    if block is None:
        return []
    numbers = [_number(word) for word in block.words]
    pairs = list(zip(numbers[::2], numbers[1::2], strict=False))
    good = len(pairs) >= 2 and len(numbers) % 2 == 0 and all(a >= 0.0 and 0.01 <= b <= 1.0 for a, b in pairs)
    if good and all(b[0] > a[0] for a, b in pairwise(pairs)):
        return pairs
    raise FileError(
        f"{block.source}, row {block.row}: ORTSBrakeShoeFriction must be pairs of a speed that grows, in km/h, and a "
        f"friction from 0.01 to 1; got {quoted(' '.join(block.words))}. Correct it."
    )


def _number(text: str) -> float:
    """Return the number of a word, NaN if it is not one."""
    try:
        return float(text)
    except ValueError:
        return math.nan
