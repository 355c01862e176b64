"""Trains by a consist: a file, rows as in one, or vehicles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from products.train.choice import smallest
from products.train.consist import Consist
from products.train.consist_file import consist_of, read_consist
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import Line


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
    ValueError with one sentence, OSError.
    """
    if isinstance(consist, int):
        own = consist_of([{"kind": "locomotive"}, {"kind": "wagon", "count": consist}])
    elif isinstance(consist, (str, Path)):
        own = read_consist(Path(consist))
    else:
        own = consist if isinstance(consist, Consist) else consist_of([dict(row) for row in consist])
    chosen = settings or smallest(own, distance_error, force_error, releases)
    return Train(own, speed=speed, line=line, settings=chosen)
