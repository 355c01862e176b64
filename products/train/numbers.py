"""A consist as the numbers that C takes, by the names of products/train/layout.py."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brake_controller.air import AMBIENT, WALL
from brake_controller.distributors import DISTRIBUTORS, kind_of
from brake_controller.drivers_valve import VALVE
from fmu_src.system import Field
from products.train.consist import Consist
from products.train.layout import DEPTHS, laid
from products.train.pipe import COURANT
from rbd_model.track.line import Line
from rbd_model.train.coupler import COUPLER, fastest
from rbd_model.train.vehicle import MOTION

#: Of the longest stable step of the couplers, what is taken.
SHARE = 0.4


#: From and to. Couplers lie in steps above their limit, and blow up above three times it.
SETTING_LIMITS = {
    "cells": (0.1, 32.0),
    "courant": (0.01, 1.0),
    "share": (1e-5, 2.5),
    "propagation": (1.0, 1e12),
    "friction": (0.0, 1e6),
    "heat": (0.0, 1e6),
}


@dataclass(frozen=True)
class Settings:
    """How a train is computed: depth of its brake, cells a vehicle, shares of longest steps, propagation [m/s].

    cells: below 1 a cell spans several vehicles. share: above 1 forces of couplers lie.
    """

    depth: str = "whole"
    cells: float = 2.0
    courant: float = COURANT
    share: float = SHARE
    propagation: float = 280.0
    friction: float = 1.0
    heat: float = 1.0

    def __post_init__(self) -> None:
        if self.depth not in DEPTHS:
            raise ValueError(f"Set the depth of a train's brake to one of {', '.join(DEPTHS)}: it was {self.depth}.")
        for name, (least, most) in SETTING_LIMITS.items():
            if not least <= getattr(self, name) <= most:
                raise ValueError(f"Set {name} to a number from {least:g} to {most:g}: it was {getattr(self, name)}.")
        count = self.cells if self.cells >= 1.0 else 1.0 / self.cells
        if abs(count - round(count)) > 1e-9:
            raise ValueError(f"Set cells to a whole number, or to one over a whole number: it was {self.cells}.")


def cells_of(consist: Consist, cells: float) -> tuple[NDArray[np.float64], list[int], list[int]]:
    """Length of each cell [m]; which cell each vehicle takes air from; and before which it ends, 0: before none."""
    lengths, places, faces = [], [], []
    if cells >= 1.0:
        count = round(cells)
        for one in consist.vehicles:
            lengths += [one.pipe_length / count] * count
            places.append(len(lengths) - count + min(int(one.distributor_at * count), count - 1))
            faces.append(len(lengths))
        return np.array(lengths), places, faces
    several = round(1.0 / cells)
    for first in range(0, len(consist.vehicles), several):
        group = consist.vehicles[first : first + several]
        places += [len(lengths)] * len(group)
        lengths.append(sum(one.pipe_length for one in group))
        faces += [0] * (len(group) - 1) + [len(lengths)]
    return np.array(lengths), places, faces


def branches_of(consist: Consist, places: list[int], cells: int) -> NDArray[np.float64]:
    """What branches of the pipe hold in each cell, as a length of the pipe [m]."""
    found = np.zeros(cells)
    np.add.at(found, places, [one.branch / (np.pi / 4 * one.pipe_diameter**2) for one in consist.vehicles])
    return found


def volumes_of(consist: Consist, settings: Settings) -> NDArray[np.float64]:
    """Of each cell with its branches [m3]."""
    lengths, places, _ = cells_of(consist, settings.cells)
    area = np.pi / 4 * consist.vehicles[0].pipe_diameter ** 2
    return area * (lengths + branches_of(consist, places, len(lengths)))


Columns = dict[str, ArrayLike]


def numbers_of(consist: Consist, settings: Settings, line: Line | None) -> NDArray[np.float64]:
    """Return all numbers of a train. Raises ValueError if its pipes have several diameters."""
    vehicles = consist.vehicles
    lengths, places, faces = cells_of(consist, settings.cells)
    cells, kinds = len(lengths), [kind_of(one.distributor) for one in vehicles]
    ends = np.concatenate([[0.0], -np.cumsum([one.length for one in vehicles])])
    bound = 2.0 / max(fastest([one.coupler for one in vehicles[:-1]], [one.mass for one in vehicles]), 1e-6)
    pairs = list(dict.fromkeys(zip(kinds, (one.distributor for one in vehicles), strict=True)))
    valves = _valves(consist, places, faces, cells, ends)
    points = _points(line)
    head: Columns = {
        "vehicles": len(vehicles),
        "cells": cells,
        "valves": len(valves),
        "points": len(points["distance"]),
    }
    head |= {f"distributor_{name}": kinds.count(kind) for name, kind in DISTRIBUTORS.items()}
    head |= {"depth": DEPTHS[settings.depth], "pace": max(kind.fastest(one, settings.depth) for kind, one in pairs)}
    head |= {"courant": settings.courant, "bound": bound, "share": settings.share, "propagation": settings.propagation}
    own = list(DISTRIBUTORS.values())
    return laid(
        {
            "head": head,
            "cell": _cells(consist, settings, lengths, places),
            "place": {"cell": places, "face": faces, "distributor": [own.index(kind) for kind in kinds]},
            **_distributors(consist),
            "brake": _columns([one.brake.values() for one in vehicles]),
            "motion": _named(MOTION, [one.motion() for one in vehicles]),
            "frame": {"centre": (ends[:-1] + ends[1:]) / 2, "length": [one.length for one in vehicles]},
            "coupler": _named(COUPLER, [one.coupler.constants() for one in vehicles[:-1]]),
            "valve": _named(VALVE, valves),
            "point": points,
        }
    )


def _columns(rows: Sequence[Mapping[str, float]]) -> Columns:
    """Return columns of rows that have the same names."""
    return {name: [row[name] for row in rows] for name in (rows[0] if rows else {})}


def _named(fields: Sequence[Field], rows: Sequence[Sequence[float]]) -> Columns:
    """Return columns of rows in the order of fields."""
    return {one.name: [row[place] for row in rows] for place, one in enumerate(fields)}


def _cells(consist: Consist, settings: Settings, lengths: NDArray[np.float64], places: list[int]) -> Columns:
    """Columns of the pipe's cells."""
    if len({one.pipe_diameter for one in consist.vehicles}) > 1:
        raise ValueError("Give all vehicles pipes of one inner diameter, such as 0.03175 m: they had several.")
    leak = np.zeros(len(lengths))
    np.add.at(leak, places, [one.leak for one in consist.vehicles])
    same = {"diameter": consist.vehicles[0].pipe_diameter, "wall_temperature": WALL, "ambient_pressure": AMBIENT}
    same |= {"friction": settings.friction, "heat": settings.heat}
    columns: Columns = {name: np.full(len(lengths), value) for name, value in same.items()}
    return columns | {"length": lengths, "leak_area": leak, "branch": branches_of(consist, places, len(lengths))}


def _distributors(consist: Consist) -> dict[str, Columns]:
    """Columns of each kind, of the vehicles that have it."""
    found: dict[str, Columns] = {}
    for name, kind in DISTRIBUTORS.items():
        own = [one.distributor for one in consist.vehicles if kind_of(one.distributor) is kind]
        found[f"distributor_{name}"] = {field: [getattr(one, field) for one in own] for field in kind.fields()}
    return found


def _valves(
    consist: Consist, places: list[int], faces: list[int], cells: int, ends: NDArray[np.float64]
) -> list[list[float]]:
    """Rows of the driver's valves."""
    found, last = [], len(consist.vehicles) - 1
    for i, one in enumerate(consist.vehicles):
        if one.valve is not None:
            face = 0 if i == 0 else (faces[i - 1] or places[i])
            face = cells if i == last and i > 0 else face
            found.append(one.valve.numbers(face, float(ends[i]), one.valve_delay))
    return found


def _points(line: Line | None) -> dict[str, NDArray[np.float64]]:
    """Columns of the line, one point of level straight track if there is none."""
    rows = line.rows if line is not None else {"distance": np.zeros(1)}
    none = np.zeros(len(rows["distance"]))
    return {name: np.asarray(rows.get(name, none)) for name in ("distance", "gradient", "curvature")}
