"""Trains by a consist: a file, rows as in one, or vehicles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.checks import line_or_none, shown
from products.train.brake_depth import smallest
from products.train.consist import Consist
from products.train.consist_file import consist_of, read_consist
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import Line

#: What a message says of the forms that are read.
FORMS = "the path of a file, a list of its rows as dictionaries, a Consist, or a whole number of wagons"


def train(
    consist: str | Path | Consist | Sequence[Mapping[str, Any]] | int = 20,
    *,
    speed: float = 0.0,
    line: Line | None = None,
    distance_error: float = 0.01,
    force_error: float = 0.05,
    releases: bool = True,
    settings: Settings | None = None,
) -> Train:
    """A train that goes on as it is told: `drive("emergency")`, `advance(1.0)`, `record(60.0)`.

    consist: a file (CSV or TOML), a list of its rows, vehicles, or how many loaded wagons behind a locomotive. speed
    [m/s]. The depth of its brake is the cheapest that errs by no more than is asked of stopping distance and largest
    compression, unless settings are given; releases: whether the run looks at brakes that are released. Raises
    TypeError and ValueError with one sentence, OSError.
    """
    line = line_or_none(line)
    if not isinstance(releases, bool | np.bool_):
        raise TypeError(f"releases must be True or False; got {shown(releases)}. Write one of them.")
    own = _consist(consist)
    chosen = settings or smallest(own, distance_error, force_error, bool(releases))
    return Train(own, speed=speed, line=line, settings=chosen)


def _consist(given: Any) -> Consist:
    """Return a consist of what a user gave for one. Raises TypeError if it has none of the forms."""
    if isinstance(given, int | np.integer) and not isinstance(given, bool):
        return consist_of([{"kind": "locomotive"}, {"kind": "wagon", "count": int(given)}])
    if isinstance(given, str | Path):
        return read_consist(Path(given))
    if isinstance(given, Consist):
        return given
    if not isinstance(given, Sequence):
        raise TypeError(f"A consist must be {FORMS}; got {shown(given)}. Give one of these.")
    return consist_of(list(given))
