"""A consist as numbers for the C code, by the names in products/train/layout.py."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from brake_controller.air import AMBIENT, WALL
from brake_controller.distributors import DISTRIBUTORS, keeps_pipe, kind_of
from brake_controller.vehicle_protection import FIRST_OWN, MOST_OWN
from products.train.consist import Consist
from products.train.layout import BRAKE_MODELS, UNBREAKABLE, Rows, laid
from products.train.pipe import COURANT, pace_of
from products.train.unused_values import without_effect
from products.train.vacuum_trains import check_valves
from rbd_model.track.line import FRICTIONS, Line
from rbd_model.train.adhesion import ADHESIONS
from rbd_model.train.coupler import fastest

#: Step size relative to the longest stable step of the couplers.
SHARE = 0.4
#: Longest step of a train with vehicles in detail [s], by scenario `train-one-vehicle-in-detail`: forces have an
#: error of 0.7 % at most.
DETAIL_STEP = 1e-3


#: Lower and upper limits. Couplers are inaccurate in steps above their limit, and unstable above three times it.
SETTING_LIMITS = {
    "cells": (0.1, 32.0),
    "courant": (0.01, 1.0),
    "share": (1e-5, 2.5),
    "propagation": (1.0, 1e12),
    "friction": (0.0, 1e6),
    "heat": (0.0, 1e6),
    "detail_step": (1e-5, 0.05),
}


@dataclass(frozen=True)
class Settings:
    """Settings of a train's computation: brake model, cells per vehicle, relative step sizes, propagation [m/s].

    cells: below 1 a cell spans several vehicles. share: above 1 coupler forces are wrong. detail_step: longest step of
    a train with vehicles in detail [s].
    """

    brake_model: str = "whole"
    cells: float = 2.0
    courant: float = COURANT
    share: float = SHARE
    propagation: float = 280.0
    friction: float = 1.0
    heat: float = 1.0
    detail_step: float = DETAIL_STEP

    def __post_init__(self) -> None:
        if self.brake_model not in BRAKE_MODELS:
            raise ValueError(f"brake_model must be one of {', '.join(BRAKE_MODELS)}; got {self.brake_model}.")
        for name, (least, most) in SETTING_LIMITS.items():
            if not least <= getattr(self, name) <= most:
                raise ValueError(f"{name} must be a number from {least:g} to {most:g}; got {getattr(self, name)}.")
        count = self.cells if self.cells >= 1.0 else 1.0 / self.cells
        if abs(count - round(count)) > 1e-9:
            raise ValueError(f"cells must be an integer, or one over an integer; got {self.cells}.")


def cells_of(consist: Consist, cells: float) -> tuple[NDArray[np.float64], list[int], list[int]]:
    """Return the length of each cell [m], and two cells of each vehicle.

    They are the cell of its distributor, and the cell after its end, 0: none.
    """
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
    """Return the volume of the pipe's branches in each cell, as a length of the pipe [m]."""
    found = np.zeros(cells)
    np.add.at(found, places, [vehicle.branch / (np.pi / 4 * vehicle.pipe_diameter**2) for vehicle in consist.vehicles])
    return found


def volumes_of(consist: Consist, settings: Settings) -> NDArray[np.float64]:
    """Return the volume of each cell with its branches [m3]."""
    lengths, places, _ = cells_of(consist, settings.cells)
    area = np.pi / 4 * consist.vehicles[0].pipe_diameter ** 2
    return area * (lengths + branches_of(consist, places, len(lengths)))


def controllers_of(consist: Consist) -> list[float]:
    """Return the number of each vehicle's controller; files are numbered in their order. Raises ValueError."""
    files = own_files(consist)
    if len(files) > MOST_OWN:
        raise ValueError(f"A train must have at most {MOST_OWN} controllers of users; got {len(files)}. Take fewer.")
    return [
        float(FIRST_OWN + files.index(one.controller))
        if one.protection.controller >= FIRST_OWN
        else one.protection.controller
        for one in consist.vehicles
    ]


def own_files(consist: Consist) -> list[str]:
    """Return the names of users' controllers in the order of the vehicles, each once."""
    return list(dict.fromkeys(one.controller for one in consist.vehicles if one.protection.controller >= FIRST_OWN))


def numbers_of(consist: Consist, settings: Settings, line: Line | None) -> NDArray[np.float64]:
    """Return all numbers of a train. Raises ValueError if pipes have several diameters, or a value no effect."""
    check_valves(consist)
    unused = without_effect(consist, settings.brake_model, settings.cells)
    if unused:
        raise ValueError(unused)
    if settings.detail_step != DETAIL_STEP and not any(one.detail for one in consist.vehicles):
        raise ValueError("detail_step has no effect on a train without vehicles in detail. Leave it out.")
    vehicles = consist.vehicles
    lengths, places, faces = cells_of(consist, settings.cells)
    kinds, known = [kind_of(one.distributor) for one in vehicles], list(DISTRIBUTORS.values())
    ends = np.concatenate([[0.0], -np.cumsum([one.length for one in vehicles])])
    masses = [one.detail.pulled_mass if one.detail else one.mass for one in vehicles]
    bound = 2.0 / max(fastest([one.coupler for one in vehicles[:-1]], masses), 1e-6)
    pace = pace_of([one.distributor for one in vehicles], places, volumes_of(consist, settings), settings.brake_model)
    valves = [
        vehicle.valve.numbers(
            _face(i, places, faces, len(lengths)), float(ends[i]), vehicle.valve_delay, keeps_pipe(kinds)
        )
        for i, vehicle in enumerate(vehicles)
        if vehicle.valve is not None
    ]
    manned = [i for i, vehicle in enumerate(vehicles) if vehicle.valve is not None]
    rows = line.rows if line is not None else {"distance": np.zeros(1)}
    level = np.zeros(len(rows["distance"]))
    head = {"vehicles": len(vehicles), "cells": len(lengths), "valves": len(valves), "points": len(level)}
    head |= {f"distributor_{kind.name}": kinds.count(kind) for kind in known}
    shares = {"courant": settings.courant, "share": settings.share, "propagation": settings.propagation}
    if settings.brake_model == "delay":  # its pipe has no air flow
        faces = [0] * len(faces)
    groups: dict[str, Rows] = {
        "head": head | shares | {"brake_model": BRAKE_MODELS[settings.brake_model], "pace": pace, "bound": bound},
        "cell": _cells(consist, settings, lengths, places),
        "place": {"cell": places, "face": faces, "distributor": [known.index(kind) for kind in kinds]},
        "brake": [one.brake.values() for one in vehicles],
        "electric": [one.electric.values() for one in vehicles],
        "heat": [one.heat.values() for one in vehicles],
        "track": [one.track.values() for one in vehicles],
        "parking": [one.parking.values() for one in vehicles],
        "traction": [one.traction.values() for one in vehicles],
        "adhesion": {"law": [ADHESIONS[one.adhesion] for one in vehicles]},
        "motion": [one.motion() for one in vehicles],
        "frame": {"centre": (ends[:-1] + ends[1:]) / 2, "length": [one.length for one in vehicles]},
        "coupler": [one.coupler.values() for one in vehicles[:-1]],
        "strength": {"strength": [min(one.coupler.strength, UNBREAKABLE) for one in vehicles[:-1]]},
        "valve": valves,
        "direct": [one.direct.values() for one in vehicles],
        "main": [one.main_reservoir.values() for one in vehicles],
        "vigilance": [{"vehicle": i} | vehicles[i].vigilance.values() for i in manned],
        "point": {name: rows.get(name, level) for name in ("distance", "gradient", "curvature")}
        | {"friction": np.mean([rows.get(name, level + 1.0) for name in FRICTIONS], axis=0)},
        "slide": [
            one.sensed.values() | {"controller": number}
            for one, number in zip(vehicles, controllers_of(consist), strict=True)
        ],
    }
    for kind in known:
        own = [one.distributor.values() for one, its in zip(vehicles, kinds, strict=True) if its is kind]
        groups[f"distributor_{kind.name}"] = own
    return laid(groups)


def _cells(
    consist: Consist, settings: Settings, lengths: NDArray[np.float64], places: list[int]
) -> dict[str, NDArray[np.float64]]:
    """Return the columns of the pipe's cells."""
    if len({one.pipe_diameter for one in consist.vehicles}) > 1:
        raise ValueError("All vehicles must have pipes of one inner diameter, such as 0.03175 m; got several.")
    leak = np.zeros(len(lengths))
    np.add.at(leak, places, [vehicle.leak for vehicle in consist.vehicles])
    same = {"diameter": consist.vehicles[0].pipe_diameter, "wall_temperature": WALL, "ambient_pressure": AMBIENT}
    same |= {"friction": settings.friction, "heat": settings.heat}
    columns = {name: np.full(len(lengths), value) for name, value in same.items()}
    return columns | {"length": lengths, "leak_area": leak, "branch": branches_of(consist, places, len(lengths))}


def _face(vehicle: int, places: list[int], faces: list[int], cells: int) -> int:
    """Return the cell after the driver's valve of a vehicle, at its front end; in the last vehicle at its back end."""
    if vehicle == 0:
        return 0
    return cells if vehicle == len(places) - 1 else faces[vehicle - 1] or places[vehicle]
