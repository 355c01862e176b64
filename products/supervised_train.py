"""SupervisedTrain.ssp: a train, its braking curves of ETCS and a driver, connected, towards an end of authority."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.ssp import Component, Wire, write_ssp
from products.braking_curves.fmu import NAME as CURVES
from products.braking_curves.train_data import data_in, fmu_parameters
from products.braking_curves.variables import FASTEST
from products.supervision import SupervisedTrain
from products.train.consist import Consist, block_train
from products.train.driver import direct_release
from products.train.driver_fmu import NAME as DRIVER
from products.train.fmu import NAME as TRAIN
from products.train.imported_consist import consist_from
from products.train.train import idle_inputs
from readers.text import BadInputError

NAME = "SupervisedTrain"
#: FMUs of the system, by their names in the registry.
NEEDED = ("train", "curves", "driver")
#: Communication step [s]; time of a run beyond that of the way to the target at half of the permitted speed [s].
STEP, LAST = 0.05, 120.0
#: Permitted speed of the line by default [m/s], as of the command etcs.
SPEED = 120.0 / 3.6
#: Largest difference of the lengths of a consist and of its train data [m]: these may be rounded.
SAME_LENGTH = 1.0


@dataclass(frozen=True)
class SupervisedRun:
    """The parts of a system: files, place of the target [m], permitted speed of the line and start speed [m/s].

    speed: None: the largest of the train data, or SPEED.
    """

    consist: Path | None
    train: Path
    target: float
    speed: float | None = None
    start_speed: float = 0.0
    national: Path | None = None


@dataclass(frozen=True)
class Supervised:
    """The content of a system: the train, parameters of its curves, permitted speed [m/s], vehicles with motors."""

    run: SupervisedRun
    consist: Consist
    curves: Mapping[str, Any]
    speed: float
    moved: tuple[int, ...]


def supervised(run: SupervisedRun) -> Supervised:
    """Read and check the content of a system. Raises ValueError, OSError."""
    consist = consist_from(run.consist)[0] if run.consist else block_train(20)
    data, country = data_in(run.train, run.national)
    moved = tuple(number for number, one in enumerate(consist.vehicles, 1) if one.traction.traction_force > 0.0)
    speed = permitted(run, data)
    check(run, consist, data, speed, bool(moved))
    return Supervised(run, consist, fmu_parameters(data, country), speed, moved)


def write_supervised_train(content: Supervised, out: Path) -> Path:
    """Write OUT/SupervisedTrain.ssp of the FMUs in OUT/native. Raises ValueError, OSError."""
    run, consist, own, speed = content.run, content.consist, content.curves, content.speed
    driver = {
        "target": run.target,
        "front": consist.vehicles[0].length / 2.0,
        "brake_time": own["T_brake_service"],
        "largest_traction": float(bool(content.moved)),
    }
    files = {name: out / "native" / f"{name}.fmu" for name in (TRAIN, CURVES, DRIVER)}
    components = [
        Component("train", files[TRAIN], {"start_speed": run.start_speed}, shown(len(consist.vehicles))),
        Component("curves", files[CURVES], {**own, "V_MRSP": speed}, ["V_SBI", "V_EBI", "indication"]),
        Component("driver", files[DRIVER], driver),
    ]
    path = out / f"{NAME}.ssp"
    write_ssp(path, NAME, components, wires_of(consist, content.moved), (round(2.0 * run.target / speed + LAST), STEP))
    return path


def wires_of(consist: Consist, moved: Sequence[int]) -> list[Wire]:
    """Return the connections; moved: numbers of the vehicles with motors, from 1."""
    count = len(consist.vehicles)
    valves = sum(vehicle.valve is not None for vehicle in consist.vehicles)
    speed, distance = (element(name, 1, count) for name in ("speed", "distance"))
    commands = ["driver_position", "driver_step"] + [VIGILANCE] * (VIGILANCE not in idle_inputs(consist))
    return [
        *joined("train", "driver", {speed: "speed", distance: "distance"}),
        *joined("train", "curves", {speed: "V_est"}),
        *joined("driver", "curves", {"place": "distance", "distance_to_target": "distance_to_target"}),
        *joined("curves", "driver", {name: name for name in COMMANDED}),
        *joined("driver", "train", {name: element(name, 1, valves) for name in commands}),
        *(Wire(("driver", "traction"), ("train", element("traction", number, count))) for number in moved),
    ]


#: Input of vigilance devices, which trains without one refuse.
VIGILANCE = "vigilance"
#: Outputs of the curves that the driver receives, by the names of his inputs.
COMMANDED = ("V_P", "distance_P", "traction_cut_off", "service_brake", "emergency_brake")


def shown(vehicles: int) -> list[str]:
    """Return outputs of the train to show: at both ends, and the largest forces of couplings."""
    ends = [element(name, n, vehicles) for name in ("pipe_pressure", "cylinder_pressure") for n in {1, vehicles}]
    return [*ends, "largest_tension", "largest_compression"]


def element(name: str, number: int, count: int) -> str:
    """Return the name of an element of an array in FMI 2.0."""
    return name if count == 1 else f"{name}[{number}]"


def joined(source: str, target: str, names: Mapping[str, str]) -> list[Wire]:
    """Return the connections of outputs of one component to inputs of another."""
    return [Wire((source, output), (target, given)) for output, given in names.items()]


def permitted(run: SupervisedRun, data: SupervisedTrain) -> float:
    """Return the permitted speed of the line [m/s]."""
    most = SPEED if data.maximum_speed is None else float(np.asarray(data.maximum_speed))
    if run.speed is not None and data.maximum_speed is not None and run.speed > most * (1.0 + 1e-9):
        raise BadInputError(
            f"--speed must be at most V_MAXTRAIN of the train data, {3.6 * most:g} km/h; got {3.6 * run.speed:g} km/h."
        )
    return min(most if run.speed is None else run.speed, FASTEST)


def check(run: SupervisedRun, consist: Consist, data: SupervisedTrain, speed: float, has_motors: bool) -> None:
    """Raise BadInputError for a train that the driver cannot drive, and for values that do not fit together."""
    length = float(np.asarray(data.length))
    if abs(length - consist.length) > SAME_LENGTH:
        raise BadInputError(
            f"--train must be the data of the consist, which is {consist.length:g} m long; got a train of {length:g} "
            "m. Let bogie-braking etcs make them."
        )
    if number := direct_release(consist):
        raise BadInputError(
            f"The driver of an .ssp needs brakes that release in part; got vehicle {number}, whose brake releases "
            "wholly. Give another distributor."
        )
    if not has_motors and run.start_speed == 0.0:
        raise BadInputError(
            "--start-speed must be above 0 for a train without motors; got 0. Give it, or traction_force of a vehicle."
        )
    if run.start_speed >= speed:
        raise BadInputError(
            f"--start-speed must be below --speed, {3.6 * speed:g} km/h; got {3.6 * run.start_speed:g} km/h. "
            "Correct one."
        )
