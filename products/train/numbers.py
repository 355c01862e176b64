"""A consist as the numbers that C takes (products/train/c/train.h): a head, then rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from brake_controller.distributors.uic import AMBIENT, EMPIRICAL_PACE, WALL, fastest_change
from products.train.consist import Consist
from products.train.pipe import COURANT
from rbd_model.track.line import Line
from rbd_model.train.coupler import fastest

#: Depths of the brake: flow of air and whole distributors; flow of air and empirical valves; a delay and those.
DEPTHS = {"whole": 0, "empirical": 1, "delay": 2}
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


def numbers_of(consist: Consist, settings: Settings, line: Line | None) -> NDArray[np.float64]:
    """All of it, in the order of train.c."""
    vehicles = consist.vehicles
    lengths, places, faces = cells_of(consist, settings.cells)
    cells, n = len(lengths), len(vehicles)
    if len({one.pipe_diameter for one in vehicles}) > 1:
        raise ValueError("Give all vehicles pipes of one inner diameter, such as 0.03175 m: they had several.")
    diameter = np.full(cells, vehicles[0].pipe_diameter)
    leak, branch = np.zeros(cells), branches_of(consist, places, cells)
    np.add.at(leak, places, [one.leak for one in vehicles])
    constants = [lengths, diameter, np.full(cells, WALL), np.full(cells, settings.friction)]
    constants += [np.full(cells, settings.heat), leak, np.full(cells, AMBIENT), branch]
    ends = np.concatenate([[0.0], -np.cumsum([one.length for one in vehicles])])
    centre = (ends[:-1] + ends[1:]) / 2
    valves = []
    for i, one in enumerate(vehicles):
        if one.valve is not None:
            face = 0 if i == 0 else (faces[i - 1] or places[i])
            face = cells if i == n - 1 and i > 0 else face
            valves.append(one.valve.numbers(face, float(ends[i]), one.valve_delay))
    bound = 2.0 / max(fastest([one.coupler for one in vehicles[:-1]], [one.mass for one in vehicles]), 1e-6)
    if settings.depth == "whole":
        pace = max(fastest_change(one) for one in dict.fromkeys(one.distributor for one in vehicles))
    else:
        pace = EMPIRICAL_PACE
    points = [[0.0], [0.0], [0.0]]
    if line is not None:
        count = len(line.rows["distance"])
        points = [list(line.rows.get(name, np.zeros(count))) for name in ("distance", "gradient", "curvature")]
    head = [n, cells, len(valves), len(points[0]), DEPTHS[settings.depth], pace, settings.courant, bound]
    head += [settings.share, settings.propagation]
    rows = [
        *constants,
        np.array(places),
        np.array(faces),
        *np.array([list(one.distributor.values().values()) for one in vehicles]).T,
        *np.array([list(one.brake.values().values()) for one in vehicles]).T,
        *np.array([one.motion() for one in vehicles]).T,
        centre,
        np.array([one.length for one in vehicles]),
        *np.array([one.coupler.constants() for one in vehicles[:-1]]).T,
        *valves,
        *points,
    ]
    return np.concatenate([np.asarray(row, float).ravel() for row in [head, *rows]])
