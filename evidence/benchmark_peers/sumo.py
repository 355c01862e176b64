"""Eclipse SUMO (German Aerospace Center and others, PyPI `eclipse-sumo` and `libsumo`): traffic of trains by `Rail`.

SUMO's car-following model `Rail` has the running resistance, rotating masses and gradient of a train. `decel` is the
deceleration by its brake. A train that is told to stop at once brakes by `decel`, resistance and gradient; one that
coasts has no traction, and a speed limit above its speed.
"""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

NAME = "SUMO"
PACKAGE = "eclipse-sumo"
#: Name of the train in SUMO.
ID = "train"
#: Time step [s]; SUMO's own is 1 s. Its steps are semi-implicit, so that a stop is short by half a step.
STEP = 0.1
#: Length of track and train [m], speed limit of the track [m/s]; longest run [s].
TRACK, LENGTH, LIMIT, LONGEST = 50e3, 100.0, 150.0, 7200.0
#: Traction that holds the speed until the train brakes [kN], and its power [kW].
TRACTION, POWER = 1e3, 1e5


def version() -> str:
    """Return the version of SUMO. Raises ImportError if it or `libsumo` is not installed."""
    try:
        return version_of("libsumo") and version_of(PACKAGE)
    except PackageNotFoundError:
        raise ImportError(f"install it by pip install {PACKAGE} libsumo") from None


@dataclass(frozen=True)
class SumoTrain:
    """A train: mass and rotating mass [kg], coefficients of its resistance [N], [N.s/m], [N.s2/m2], deceleration by its
    brake [m/s2], 0 to coast, and the gradient of the track.
    """

    mass: float
    rotating: float
    resistance: tuple[float, ...]
    deceleration: float
    gradient: float

    @property
    def coasts(self) -> bool:
        """Return whether the train has no brake."""
        return self.deceleration <= 0.0


def answer(question: str, inputs: Mapping[str, Any]) -> dict[str, float] | None:
    """Return distance [m] and time [s] of a run; None to other questions."""
    if question not in ("coasting", "stop-with-full-brakes"):
        return None
    resistance = tuple(inputs[f"resistance.{name}"] for name in ("constant", "linear", "square"))
    masses = inputs["mass"], inputs["rotating_mass"]
    deceleration = inputs.get("brake_force", 0.0) / sum(masses)
    train = SumoTrain(*masses, resistance, deceleration, inputs["gradient"])
    distance, time = run(train, inputs["speed"], inputs.get("end_speed", 0.0))
    return {"distance": distance, "time": time}


def run(train: SumoTrain, speed: float, last: float) -> tuple[float, float]:
    """Return distance [m] and time [s] from `speed` to `last`. Raises ValueError if the train does not slow down."""
    import libsumo

    earlier = begin = (0.0, 0.0, speed)
    with simulation(libsumo, train, speed):
        while earlier[0] < LONGEST:
            libsumo.simulationStep()
            if ID not in libsumo.vehicle.getIDList():
                break
            here = libsumo.vehicle.getLanePosition(ID), libsumo.vehicle.getSpeed(ID)
            later = (libsumo.simulation.getTime(), *here)
            if begin[0] == 0.0:
                begin = later
                if not train.coasts:
                    libsumo.vehicle.setSpeed(ID, 0.0)
            elif later[2] <= last:
                share = (earlier[2] - last) / (earlier[2] - later[2])
                time, place = (earlier[n] + share * (later[n] - earlier[n]) for n in range(2))
                return place - begin[1], time - begin[0]
            earlier = later
    raise ValueError(f"the train slows down to {earlier[2]:g} m/s only")


@contextmanager
def simulation(libsumo: Any, train: SumoTrain, speed: float) -> Iterator[None]:
    """Start SUMO with a train on a straight track of one gradient, and end it."""
    with tempfile.TemporaryDirectory() as folder:
        net, routes = write_track(Path(folder), train.gradient), Path(folder) / "train.rou.xml"
        write(routes, "routes", routes_of(train, speed))
        command = ["sumo", "--net-file", str(net), "--route-files", str(routes), "--step-length", str(STEP)]
        libsumo.start([*command, "--no-step-log", "--no-warnings", "--time-to-teleport", "-1"])
        try:
            yield
        finally:
            libsumo.close()


def routes_of(train: SumoTrain, speed: float) -> list[tuple[str, dict[str, Any]]]:
    """Return type, route and vehicle of a train in SUMO's units: kN, kW and kg."""
    coefficients = zip(("constant", "linear", "quadratic"), train.resistance, strict=True)
    slows = 1.0 if train.coasts else train.deceleration
    kind = {"id": "kind", "vClass": "rail", "carFollowModel": "Rail", "trainType": "custom", "length": LENGTH}
    kind |= {"maxSpeed": LIMIT if train.coasts else speed, "decel": slows, "emergencyDecel": slows}
    kind |= {"mass": train.mass, "massFactor": 1.0 + train.rotating / train.mass, "speedFactor": 1, "speedDev": 0}
    kind |= {"maxTraction": 0.0 if train.coasts else TRACTION, "maxPower": 0.0 if train.coasts else POWER}
    kind |= {f"resCoef_{name}": one / 1e3 for name, one in coefficients}
    vehicle = {"id": ID, "type": "kind", "route": "way", "depart": 0, "departPos": "base", "departSpeed": speed}
    return [("vType", kind), ("route", {"id": "way", "edges": "track"}), ("vehicle", vehicle)]


def write_track(folder: Path, gradient: float) -> Path:
    """Write a straight track of one gradient, and return the file of SUMO's network."""
    import sumo

    heights = max(0.0, -gradient * TRACK), max(0.0, gradient * TRACK)
    ends = zip("AB", (0.0, TRACK), heights, strict=True)
    nodes, edges, net = (folder / f"track.{kind}.xml" for kind in ("nod", "edg", "net"))
    write(nodes, "nodes", [("node", {"id": name, "x": x, "y": 0, "z": z}) for name, x, z in ends])
    edge = {"id": "track", "from": "A", "to": "B", "numLanes": 1, "speed": LIMIT, "allow": "rail"}
    write(edges, "edges", [("edge", edge)])
    words = [Path(sumo.SUMO_HOME) / "bin" / "netconvert", "--node-files", nodes, "--edge-files", edges]
    subprocess.run([*map(str, words), "--output-file", str(net)], check=True, capture_output=True)
    return net


def write(path: Path, name: str, parts: list[tuple[str, dict[str, Any]]]) -> None:
    """Write an XML file of elements without content."""
    root = ElementTree.Element(name)
    for kind, values in parts:
        ElementTree.SubElement(root, kind, {one: str(value) for one, value in values.items()})
    ElementTree.ElementTree(root).write(path, encoding="utf-8")
