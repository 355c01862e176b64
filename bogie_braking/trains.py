"""Trains from a consist: a file, its rows as dictionaries, or vehicles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.checks import line_or_none, shown
from bogie_braking.provenance import absent, encoded
from bogie_braking.train_controllers import Controller, encoded_controllers, with_controllers
from products.run_history import RunHistory
from products.train.brake_model import select_brake_model
from products.train.consist import Consist, TrainVehicle
from products.train.consist_file import consist_of
from products.train.imported_consist import consist_from
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import Line
from readers.import_account import Imported

#: Accepted forms, for messages.
FORMS = "the path of a file, a list of its rows as dictionaries or of vehicles, a Consist, or a number of wagons"


def train(
    consist: str | Path | Consist | Sequence[Mapping[str, Any]] | int = 20,
    *,
    speed: float = 0.0,
    line: Line | None = None,
    distance_error: float = 0.01,
    force_error: float = 0.05,
    releases: bool = True,
    settings: Settings | None = None,
    protection: Controller | Mapping[int, Controller] = None,
) -> Train:
    """Return a train to be driven: `drive("emergency")`, `advance(1.0)`, `record(60.0)`.

    Parameters
    ----------
    consist : str, Path, Consist, sequence of mapping or TrainVehicle, or int
        A file (CSV or TOML, or a train of another program, see docs/consists.md), a list of its rows, vehicles, or the
        number of loaded wagons behind a locomotive.
    speed : float
        Initial speed [m/s].
    line : Line, optional
        Line of the train; by default straight, level track.
    distance_error, force_error : float
        Allowed relative errors of the stopping distance and of the largest compression. The cheapest brake model within
        both is used, unless `settings` are given.
    releases : bool
        Whether the brake model must also describe brakes that are released.
    settings : Settings, optional
        Brake model and step size.
    protection : dict of int to controller, or controller
        Wheel-slide controllers by their vehicle, from 0, instead of those of the consist; or one for all vehicles with
        a brake. A controller is "built-in", a class whose objects have `step(time, wheel_speeds)`, a file (.c, a
        library, .fmu, FILE.py:CLASS), or None for no protection.

    Returns
    -------
    Train
        The train at its start. `imported` accounts for the fields of another program's file, otherwise it is None.

    Raises
    ------
    TypeError
        If an argument has a wrong type.
    ValueError
        If a value is out of its limits.
    OSError
        If the file cannot be read.
    """
    line = line_or_none(line)
    if not isinstance(releases, bool | np.bool_):
        raise TypeError(f"releases must be True or False; got {shown(releases)}. Write one of them.")
    for name, value, usual in (
        ("distance_error", distance_error, 0.01),
        ("force_error", force_error, 0.05),
        ("releases", releases, True),
    ):
        if settings is not None and value != usual:
            raise ValueError(f"{name} has no effect with settings, which state the brake model. Leave one out.")
    own, imported = consist_from_any(consist)
    own, controllers = with_controllers(own, protection)
    released = bool(releases) or any(one.protection.controller for one in own.vehicles)
    chosen = settings or select_brake_model(own, distance_error, force_error, released)
    found = Train(own, speed=speed, line=line, settings=chosen, controllers=controllers)
    found.imported = imported
    arguments = {
        **{
            "consist": _encoded_consist(consist),
            "speed": encoded(speed),
            "line": encoded(line),
            "settings": encoded(settings),
        },
        **({} if protection is None else {"protection": encoded_controllers(protection)}),
        **{"distance_error": encoded(distance_error), "force_error": encoded(force_error), "releases": bool(releases)},
    }
    found.run_history = RunHistory("train", arguments, found.mark)
    return found


def _encoded_consist(consist: Any) -> Any:
    """Return a consist as JSON."""
    if isinstance(consist, str | Path):
        return {**encoded(Path(consist)), "kind": "consist"}
    vehicles = isinstance(consist, Sequence) and any(isinstance(one, TrainVehicle) for one in consist)
    return absent("a list of vehicles") if vehicles else encoded(consist)


def consist_from_any(given: Any) -> tuple[Consist, Imported | None]:
    """Return a consist from a user's input, and the account of an import. Raises TypeError for another form."""
    if isinstance(given, int | np.integer) and not isinstance(given, bool):
        return consist_of([{"kind": "locomotive"}, {"kind": "wagon", "count": int(given)}]), None
    if isinstance(given, str | Path):
        return consist_from(Path(given))
    if isinstance(given, Consist):
        return _driven(given), None
    if not isinstance(given, Sequence) or isinstance(given, bytes | bytearray):
        raise TypeError(f"A consist must be {FORMS}; got {shown(given)}. Give one of these.")
    if given and all(isinstance(one, TrainVehicle) for one in given):
        return _driven(Consist(tuple(given))), None
    return consist_of(list(given)), None


def _driven(consist: Consist) -> Consist:
    """Return a consist with a driver's valve. Raises ValueError without one."""
    if not any(vehicle.valve is not None for vehicle in consist.vehicles):
        raise ValueError(
            f"A consist must have a vehicle with a driver's valve; got {len(consist.vehicles)} vehicles without one. "
            "Add a locomotive, or give one vehicle a valve."
        )
    return consist
