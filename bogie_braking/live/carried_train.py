"""A train in a page or a link: the numbers of TrainDynamics.fmu, with names and limits of speed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.web.frame import packed
from brake_controller.distributors import keeps_pipe, kind_of
from products.train.consist import Consist, block_train
from products.train.imported_consist import consist_from
from products.train.layout import layout
from products.train.notches import notches_shown
from products.train.numbers import Settings, numbers_of, own_files
from rbd_model.track.line import Line
from rbd_model.track.line_files import line_from_file
from rbd_model.track.line_points import LineFromPoints


def layout_mark() -> str:
    """Return a mark of the meaning of the numbers, so that a page refuses those of another version."""
    meaning = [(group.name, group.of, [field.name for field in group.fields]) for group in layout()]
    return hashlib.sha256(repr(meaning).encode()).hexdigest()[:8]


@dataclass(frozen=True)
class CarriedTrain:
    """A consist on a line; limits: first and last place [m] and speed [m/s] of stretches.

    Raises ValueError if a vehicle is in detail or has a controller of a user, which a page cannot run.
    """

    name: str
    consist: Consist
    line: Line | None = None
    limits: Sequence[tuple[float, float, float]] = ()

    def __post_init__(self) -> None:
        if own := own_files(self.consist):
            raise ValueError(f"protection of a page must be built-in or none; got {own[0]}. Write built-in.")
        if any(vehicle.detail for vehicle in self.consist.vehicles):
            raise ValueError(
                "detail must be left out on a page, whose vehicles are points. Remove it from the consist."
            )

    def packed(self) -> str:
        """Return the text that consist.js unpacks: a count and as many numbers of 8 bytes, then a JSON object."""
        numbers = numbers_of(self.consist, Settings(), self.line)
        names = groupby(vehicle.name or vehicle.kind for vehicle in self.consist.vehicles)
        about: dict[str, Any] = {
            "name": self.name,
            "layout": layout_mark(),
            "vehicles": [[name, len(list(those))] for name, those in names],
            "limits": [list(limit) for limit in self.limits],
        }
        head = next(vehicle for vehicle in self.consist.vehicles if vehicle.valve)
        if head.valve and head.handle:
            wired = keeps_pipe([kind_of(vehicle.distributor) for vehicle in self.consist.vehicles])
            about["notches"] = notches_shown(head.valve, head.handle, wired)
        text = json.dumps(about, separators=(",", ":")).encode()
        return packed(np.asarray([numbers.size, *numbers], "<f8").tobytes() + text)


def carried_from(consist: Path | None, line: Path | None) -> CarriedTrain:
    """Return a train from files, by default 20 wagons or level track. Raises ValueError, OSError."""
    own, imported = consist_from(consist) if consist else (block_train(20), None)
    if imported:
        print(f"{consist}: {len(imported.assumed)} assumptions; bogie-braking consist import {consist} prints them.")
    along = line_from_file(line) if line else None
    limits = along.speed_limits if isinstance(along, LineFromPoints) else ()
    names = [path.stem for path in (consist, line) if path]
    return CarriedTrain(" on ".join(names), own, along, limits)
