"""Draw random states of a vehicle on its rails, in the model's coordinates: all wheels are loaded."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from random import Random

from rbd_model.vehicle.description import Vehicle, wheelset_name
from tests.evidence.maximal.correspondence import bodies_of
from tests.evidence.maximal.oracle import FLANGE_SLOPE, GivenWay, Oracle, Scene
from tests.evidence.maximal.rails import Course
from tests.evidence.maximal.touch import touches

#: Largest displacements [m] and angles [rad] of bodies.
WAYS = 0.02
#: Largest displacements of rails, to either side, up and down [m].
GIVE = 1e-3
#: Ranges of the approaches of treads and flanges [m]; grid [m] and rounds of laying a wheelset on its rails.
TREAD, FLANGE = (0.04e-3, 0.16e-3), (0.02e-3, 0.12e-3)
COARSE, ROUNDS = 0.2e-3, 9
#: Share of the lines with changing curvature, cant and gradient.
TRANSITIONS = 0.6


@dataclass(frozen=True)
class Snapshot:
    """States by name and external inputs."""

    value: dict[str, float]
    scene: Scene
    course: Course


def random_course(rng: Random) -> Course:
    """Draw an arc or transition: radius 200 to 1500 m to either side, cant to 150 mm, gradient, with their changes."""
    radius = rng.choice((-1, 1)) * rng.choice((200.0, 300.0, 500.0, 800.0, 1500.0))
    cant, gradient = rng.uniform(-0.03, 0.1), rng.uniform(-0.04, 0.04)
    changes = (0.0, 0.0, 0.0)
    if rng.random() < TRANSITIONS:
        changes = 1 / radius / rng.uniform(30.0, 90.0), rng.uniform(-1, 1) / 600, rng.uniform(-1, 1) / 2000
    side = math.copysign(1.0, radius)
    return Course((1 / radius, changes[0]), (-side * cant, changes[1]), (gradient, changes[2]))


def random_state(vehicle: Vehicle, oracle: Oracle, course: Course, names: list[str], rng: Random) -> Snapshot:
    """Draw values of these states; `oracle` of the same vehicle is used to lay the wheelsets on the rails."""
    radius = vehicle.number(vehicle.wheelsets[0].mean_radius)
    speed = rng.uniform(3.0, 40.0)
    value = dict.fromkeys(names, 0.0)
    for name in names:
        if name.endswith(("_rate", "_speed")) or "_speed_" in name or "_rate_" in name:
            value[name] = rng.uniform(-0.1, 0.1)
        elif "shift" in name:
            value[name] = rng.uniform(-0.01, 0.01)
        elif name.startswith("track_"):
            value[name] = rng.uniform(-GIVE, GIVE)
        else:
            value[name] = rng.uniform(-WAYS, WAYS)
    first = vehicle.bodies[0].name
    value[f"{first}_distance"], value[f"{first}_speed"] = rng.uniform(0.0, 2.0), speed
    # In a curve the middle of a body on two bogies lies inside of the track.
    ends = max(abs(vehicle.number(body.along)) for body in vehicle.bodies)
    value[vehicle.bodies[0].variable("lateral")] += course.curvature[0] * ends**2 / 2
    for number, _ in vehicle.numbered:
        flanging = rng.choice((0, 0, 1, -1))
        value[f"lateral_{number}"] = flanging * 9.6e-3 or rng.uniform(-6e-3, 6e-3)
        value[f"yaw_{number}"] = rng.uniform(-0.01, 0.01)
        value[f"angular_velocity_{number}"] = speed / radius * (1 + rng.choice((1e-3, 1e-2, 0.3)) * rng.uniform(-1, 1))
        value[f"rotation_{number}"] = rng.uniform(0.0, 100.0)
        for name in ("rise_speed", "roll_rate"):
            value[f"{name}_{number}"] = rng.uniform(-0.02, 0.02)
        lay_on_rails(vehicle, oracle, course, value, number, flanging, rng)
    count = len(vehicle.wheelsets)
    frictions, brakes, tractions = (
        [rng.uniform(*limits) for _ in range(count)] for limits in ((0.05, 0.5), (0.0, 2e4), (0.0, 5e3))
    )
    return Snapshot(value, Scene(frictions, brakes, tractions), course)


def lay_on_rails(
    vehicle: Vehicle, oracle: Oracle, course: Course, value: dict[str, float], number: int, flanging: int, rng: Random
) -> None:
    """Set rise, roll and, with a loaded flange, lateral position so that both treads have their drawn approaches."""
    asked = {side: rng.uniform(*TREAD) for side in (1, -1)}
    value[f"rise_{number}"] = value[f"roll_{number}"] = 0.0
    flange = rng.uniform(*FLANGE)
    for _ in range(ROUNDS):
        found = approaches(vehicle, oracle, course, value, number)
        missing = {side: asked[side] - found[side, False] for side in (1, -1)}
        half = vehicle.wheelsets[number - 1].pair.left.wheel_half_distance
        value[f"rise_{number}"] -= (missing[1] + missing[-1]) / 2
        value[f"roll_{number}"] -= (missing[1] - missing[-1]) / (2 * half)
        if flanging:
            value[f"lateral_{number}"] += flanging * (flange - found.get((flanging, True), -1e-3))


def approaches(
    vehicle: Vehicle, oracle: Oracle, course: Course, value: Mapping[str, float], number: int
) -> dict[tuple[int, bool], float]:
    """Return the approaches of treads (False) and flanges (True) of both wheels [m]."""
    body = bodies_of(vehicle, course, value)[wheelset_name(number)]
    found: dict[tuple[int, bool], float] = {}
    for index, side in enumerate((1, -1)):
        rail = GivenWay(oracle, index, oracle.give(number, value))
        for one in touches(body, oracle.wheel_of(number, index), rail, COARSE):
            key = side, one.slope > FLANGE_SLOPE
            found[key] = max(one.approach, found.get(key, -1.0))
    return found
