"""Train data of ETCS from a train of this project: stops in emergency and full service braking, and stops at limits."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from brake_controller.electric_brake import FILLS
from brake_controller.shoe_friction import CONSTANT
from products.supervision import BrakedVehicles, BrakeUnits, SupervisedTrain
from products.supervision.of_run import LOWEST, BrakeOfRun, brake_of_run
from products.train.brake_model import select_brake_model
from products.train.consist import Consist
from products.train.summary import brake_force
from products.train.train import Train
from rbd_model.track.line import Line
from rbd_model.vehicle.variables import FASTEST
from readers.text import BadInputError

#: Longest stop, time between rows of a run and of a drawn stop, and of a part of a run [s]; speed of a train at rest.
LONGEST, ROW, DRAWN, LOOK, RESTS = 900.0, 0.05, 0.5, 5.0, 1e-3
#: First margin of the speed at which a run begins, what each further run adds [m/s], and the number of runs.
MARGIN, MORE, RUNS = 5.0, 1.0, 6
#: Kinds of braked vehicles up to which each is a group of its own.
MOST_KINDS = 40
#: Driver's valve of each brake.
COMMANDS = {"emergency": ("emergency", 0.0), "service": ("service", 1.0)}


@dataclass(frozen=True)
class FromRuns:
    """Train data, and the two stops from which they are."""

    train: SupervisedTrain
    emergency: BrakeOfRun
    service: BrakeOfRun


@dataclass(frozen=True)
class OwnStop:
    """A simulated emergency stop that begins at a limit: places of the front [m] and its speeds [m/s] up to rest.

    The last place is infinite if the train does not stop.
    """

    places: np.ndarray
    speeds: np.ndarray

    @property
    def ends(self) -> float:
        """Return the place where the train stops [m]."""
        return float(self.places[-1])


def supervised_train(consist: Consist, largest: float, **others: Any) -> FromRuns:
    """Return the ETCS train data of a train, from stops on level, dry track.

    Parameters
    ----------
    consist : Consist
        The train: `bogie_braking.train(...).consist`.
    largest : float
        Largest speed of the train [m/s].
    **others
        Further fields of `SupervisedTrain`.

    Returns
    -------
    FromRuns
        The train data, and the emergency and the full service stop from which they are.

    Raises
    ------
    BadInputError
        If a brake does not develop or the train does not stop.
    """
    emergency, service = (_brake(_by_air(consist), name, largest) for name in COMMANDS)
    train = SupervisedTrain(
        consist.length,
        emergency.deceleration,
        service.deceleration,
        emergency.build_up,
        service.build_up,
        rotating=others.pop("rotating", None),
        **others,
    )
    return FromRuns(train, emergency, service)


def _by_air(consist: Consist) -> Consist:
    """Return a train whose air brakes take the share of electric brakes: cylinder pressures show the build-up then."""
    vehicles = [
        replace(one, electric=replace(one.electric, dynamic_force=0.0, blending=float(FILLS)))
        if one.electric.blended_pressure > 0.0
        else one
        for one in consist.vehicles
    ]
    return replace(consist, vehicles=tuple(vehicles))


def _brake(consist: Consist, command: str, largest: float) -> BrakeOfRun:
    """Return the brake of a run that begins as fast as it must."""
    begin = largest + MARGIN
    for _ in range(RUNS):
        time, speed, pressure = _run(consist, command, begin, LOWEST * largest)
        if pressure.max() <= 0.0:
            raise BadInputError("The train has no pressure in any brake cylinder; ETCS data need a pneumatic brake.")
        share = pressure / pressure.max()
        late = largest - float(np.interp(time[np.argmax(share >= 0.95)], time, speed))
        if late <= 0.0:
            return brake_of_run(time, speed, share, largest)
        begin += late + MORE
        if begin > FASTEST:
            break
    raise BadInputError(f"The {command} brake is not developed at {largest:.1f} m/s in any run. Give a lower speed.")


def _run(consist: Consist, command: str, speed: float, lowest: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, speed of the mass centre and sum of cylinder pressures of a stop, until a vehicle stands.

    It goes on to the lowest speed that is read. Once a vehicle stands, couplers push others back: the brakes do not.
    """
    train = Train(consist.unprotected, speed=speed, settings=select_brake_model(consist))
    train.drive(*COMMANDS[command])
    masses = np.array([vehicle.mass for vehicle in consist.vehicles])
    parts: list[np.ndarray] = []
    count, past = masses.size, 0.0
    while past < LONGEST:
        record = train.record(LOOK, ROW)
        speeds, pressures = (_columns(record, name, count) for name in ("speed", "cylinder_pressure"))
        rows = np.stack([record["time"], speeds @ masses / masses.sum(), pressures.sum(axis=1), speeds.min(axis=1)])
        parts.append(rows[:, 1:] if parts else rows)
        past += LOOK
        if float(np.abs(train.speed).max()) < RESTS:
            rows = np.concatenate(parts, axis=1)
            end = max(int(np.argmax(rows[3] <= 0.0)), int(np.argmax(rows[1] <= lowest)) + 1)
            times, mean, pressure = rows[:3, :end]
            return times, mean, pressure
    raise BadInputError(f"The train does not stop within {LONGEST:g} s in {command} braking. Check its brakes.")


def _columns(record: Any, name: str, count: int) -> np.ndarray:
    names = [name] if count == 1 and name in record.units else [f"{name}[{n}]" for n in range(1, count + 1)]
    return np.stack([record[one] for one in names], axis=1)


def own_stops(consist: Consist, speeds: np.ndarray, places: np.ndarray, line: Line | None) -> list[OwnStop]:
    """Return emergency stops of the train itself.

    Parameters
    ----------
    consist : Consist
        The train: `bogie_braking.train(...).consist`.
    speeds : numpy.ndarray
        Speed at the start of each stop [m/s], shape (stops,).
    places : numpy.ndarray
        Place of the front there [m], shape (stops,).
    line : Line or None
        Line of the train; None: straight, level track.

    Returns
    -------
    list of OwnStop
        The stops, with places and speeds over time.
    """
    settings, stops = select_brake_model(consist), []
    for speed, place in zip(speeds.tolist(), places.tolist(), strict=True):
        train = Train(consist.unprotected, speed=speed, distance=place, line=line, settings=settings)
        start, rows, rests = float(train.distance[0]), [(place, speed)], False
        train.drive("emergency")
        while not rests and len(rows) <= LONGEST / DRAWN:
            train.advance(DRAWN)
            rows.append((place + float(train.distance[0]) - start, float(train.speed[0])))
            rests = float(np.abs(train.speed).max()) < RESTS
        if not rests:
            rows.append((np.inf, rows[-1][1]))
        stops.append(OwnStop(*np.array(rows).T))
    return stops


def brake_units(consist: Consist, speed: float, failure: float, spread: float) -> list[BrakeUnits]:
    """Return the braked vehicles of a train as units that fail independently, equal ones in one group.

    Takes speed [m/s].
    """
    forces = [round(brake_force(vehicle, speed), 3) for vehicle in consist.vehicles]
    groups = Counter(force for force in forces if force > 0.0)
    return [BrakeUnits(count, force, failure, spread) for force, count in groups.items()]


def braked_vehicles(consist: Consist, speed: float) -> list[BrakedVehicles]:
    """Return the vehicles of a train for `factors_of`, equal ones in one group.

    Takes speed [m/s]; returns [N].
    """
    kinds = [
        (brake_force(vehicle, speed), vehicle.mass, vehicle.brake.friction_law == CONSTANT)
        for vehicle in consist.vehicles
    ]
    if len(set(kinds)) > MOST_KINDS:
        keys: list[Any] = [(round(np.log(force) / 0.02) if force > 0.0 else None, discs) for force, _, discs in kinds]
    else:
        keys = kinds
    groups: dict[Any, list[tuple[float, float, bool]]] = {}
    for key, kind in zip(keys, kinds, strict=True):
        groups.setdefault(key, []).append(kind)
    means = [(len(those), *np.mean(those, axis=0)) for those in groups.values()]
    return [BrakedVehicles(count, float(force), float(mass), bool(discs)) for count, force, mass, discs in means]
