"""The same motion in both models: states of level 3 as coordinates of chapter 3, and accelerations in return."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np

from evidence.chapter3.creep import Ellipse
from evidence.chapter3.euler import cross, from_angles
from evidence.chapter3.forces import BodyMotion
from evidence.chapter3.kinematic_analysis import DrivenPosition, Frame, centred, drive_to
from evidence.chapter3.mechanism import FIRST_WHEELSET, Mechanism, MechanismInputs, MechanismState, Solution
from fmu_src.kernel import DISCARD, Kernel, Library, SimulationError
from fmu_src.system import System, model_of
from rbd_model.contact.creep.kalker import smooth_kalker_coefficients
from rbd_model.contact.geometry import Pair, synthetic_pair, thesis_pair
from rbd_model.contact.hertz import moving_ellipse
from rbd_model.levels.models import levels, wheelset_in_frame
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import derivatives_along, irregular_track, section_5_3
from rbd_model.vehicle.description import Springs
from rbd_model.vehicle.parameters import (
    BogieParameters,
    as_printed,
    manchester_vehicle_1,
    tables_4_1_and_4_2,
    tables_5_1_and_5_2,
)
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie
from tests.fmu_src.quick_library import quick_library

WORDS = ("right", "left")


def _fitted() -> ca.Function:
    given = ca.SX.sym("given", 4)  # A, B, load, shear modulus
    logarithm, mean = moving_ellipse(*ca.vertsplit(given))
    stretch, kalker = ca.exp(logarithm / 2), smooth_kalker_coefficients(logarithm)
    results = [mean * stretch, mean / stretch, kalker.c11, kalker.c22, kalker.c23]
    return ca.Function("ellipse", [given], [ca.vertcat(*results)])


_FITTED = _fitted()


def fitted_ellipse(a: float, b: float, normal_force: float, shear_modulus: float) -> Ellipse:
    """Return ellipse and coefficients by the fast model's polynomials, within 2e-4 and 0.5 % of exact values."""
    along, across, *kalker = np.array(_FITTED([a, b, normal_force, shear_modulus])).ravel().tolist()
    return Ellipse(along, across, (kalker[0], kalker[1], kalker[2]))


@dataclass(frozen=True)
class Machine:
    """One of the three test vehicles: equations and compiled kernel of the fast model, and its parameters."""

    wheelsets: int
    parameters: BogieParameters
    pair: Pair
    bodies: tuple[str, ...]
    system: System
    library: Library


@lru_cache
def machine(wheelsets: int) -> Machine:
    if wheelsets == 1:
        parameters = as_printed(tables_4_1_and_4_2())
        system = wheelset_in_frame(parameters)
    elif wheelsets == 2:
        parameters = as_printed(tables_5_1_and_5_2())
        system = levels(two_axle_bogie(parameters))[2]
    else:
        parameters = as_printed(manchester_vehicle_1())
        coach = passenger_coach()
        springs = tuple(one for one in coach.connections if isinstance(one, Springs))
        vehicle = replace(coach, parameters=parameters, connections=springs)
        system = spatial_vehicle(vehicle, irregular_track(section_5_3()))
    whole = wheelsets == 4
    bodies = ("body", "front_frame", "rear_frame") if whole else ("frame",)
    pair = synthetic_pair() if whole else thesis_pair()
    return Machine(wheelsets, parameters, pair, bodies, system, quick_library(model_of(system, 1e-7)))


@dataclass(frozen=True)
class Snapshot:
    """A state of the fast model with its slopes by name, and the inputs and parameters that led to it."""

    machine: Machine
    scene: Mapping[str, float]
    value: Mapping[str, float]
    slope: Mapping[str, float]
    locked: tuple[bool, ...]


def reach(of: Machine, scene: Mapping[str, float], seconds: float) -> Snapshot | None:
    """Run the fast model to a state; return None if the run ended before."""
    kernel = Kernel(of.library, tolerance=1e-7, **scene)
    try:
        kernel.advance(seconds)
    except SimulationError as error:
        if error.status == DISCARD:
            return None
        raise
    found = kernel.linearise()
    names = list(of.system.states)
    locked = tuple(kernel[f"angular_velocity_{n}"] == 0.0 for n in range(1, of.wheelsets + 1))
    return Snapshot(
        of, scene, dict(zip(names, found.state, strict=True)), dict(zip(names, found.slope, strict=True)), locked
    )


def mechanism_of(of: Machine, scene: Mapping[str, float]) -> Mechanism:
    """Return the oracle with these parameters and track."""
    own = {name: value for name, value in scene.items() if name in of.parameters.values()}
    track = section_5_3()
    irregular = {name: value for name, value in scene.items() if name in track.values()}
    return Mechanism(
        replace(of.parameters, **own),
        of.pair,
        of.wheelsets,
        derivatives_along(replace(track, **irregular)),
        ellipse=fitted_ellipse,
    )


def inputs_of(scene: Mapping[str, float]) -> MechanismInputs:
    rows = {"brake_torque": 0.0, "traction_torque": 0.0, "yaw_torque": 0.0, "friction": 0.3}
    return MechanismInputs(
        *[[scene.get(f"{name}_{n}", default) for n in (1, 2, 3, 4)] for name, default in rows.items()]
    )


def motion_of(of: Machine, body: str, motion: str) -> str:
    """Return the name of a body's motion in the fast model."""
    return motion if of.wheelsets < 4 and motion.startswith(("bounce", "pitch")) else f"{body}_{motion}"


def frames_of(snapshot: Snapshot, mechanism: Mechanism) -> list[Frame]:
    """Return position and motion of the bodies above the wheelsets."""
    v, of, found = snapshot.value, snapshot.machine, []
    first = of.bodies[0]
    for body, data in zip(of.bodies, mechanism.layout.upper, strict=True):

        def value(motion: str, body: str = body) -> float:
            return v.get(motion_of(of, body, motion), 0.0)

        own = ("shift", "shift_speed") if body != first else ("none", "none")
        distance, speed = v[f"{first}_distance"] + data.along + value(own[0]), v[f"{first}_speed"] + value(own[1])
        height = mechanism.parameters.wheel_radius + data.height + value("bounce")
        theta = from_angles(value("yaw"), value("roll"), value("pitch"))
        found.append(
            Frame(
                np.concatenate([[distance, value("lateral"), height], theta]),
                np.array([speed, value("lateral_rate"), value("bounce_rate")]),
                np.array([value("roll_rate"), value("pitch_rate"), value("yaw_rate")]),
            )
        )
    return found


def state_of(snapshot: Snapshot, mechanism: Mechanism) -> MechanismState:
    """Return the same state in the coordinates of chapter 3."""
    v = snapshot.value
    frames = frames_of(snapshot, mechanism)
    near = centred(mechanism)
    for number, frame in enumerate(frames, mechanism.frame):
        near[mechanism.body(number)] = frame.coordinates
    first = snapshot.machine.bodies[0]
    driven = []
    for number in range(1, mechanism.wheelsets + 1):
        one = DrivenPosition(
            v[f"{first}_distance"] + mechanism.place(number - 1) + v[f"shift_{number}"],
            *(v[f"{name}_{number}"] for name in ("lateral", "yaw", "rotation")),
            v[f"{first}_speed"] + v[f"shift_speed_{number}"],
            *(v[f"{name}_{number}"] for name in ("lateral_speed", "yaw_rate", "angular_velocity")),
        )
        driven.append(one)
        body = near[mechanism.body(FIRST_WHEELSET + number - 1)]
        body[:3] = one.distance, one.lateral, mechanism.parameters.wheel_radius
        body[3:] = from_angles(one.yaw, v[f"roll_{number}"], one.pitch)
        for side, word in enumerate(WORDS):
            contact = 2 * (number - 1) + side
            s = near[mechanism.q_count :]
            s[mechanism.rail_parameters(contact)][0] = one.distance
            s[mechanism.wheel_parameters(contact)] = one.pitch, v[f"contact_{number}_{word}"]
    state = drive_to(mechanism, driven, frames, near)
    state.direction = [0 if locked else 1 for locked in snapshot.locked]
    return state


def accelerations_of(of: Machine, state: MechanismState, answer: Solution, mechanism: Mechanism) -> dict[str, float]:
    """Return accelerations by the names of the fast model's states, absolute ones along the track [m/s2, rad/s2]."""
    out = {}
    for number, name in enumerate(of.bodies, mechanism.frame):
        linear, alpha, _ = rates_of(mechanism, number, state, answer)
        rates = ("lateral_rate", "bounce_rate", "roll_rate", "pitch_rate", "yaw_rate")
        out[f"along_{name}"] = linear[0]
        names = [motion_of(of, name, rate) for rate in rates]
        out |= dict(zip(names, (*linear[1:], *alpha), strict=True))
    if mechanism.layout.level:
        del out["pitch_rate"]
    for number in range(1, mechanism.wheelsets + 1):
        linear, alpha, yawing = rates_of(mechanism, FIRST_WHEELSET + number - 1, state, answer)
        out |= {f"axle_{number}": linear[0], f"lateral_speed_{number}": linear[1]}
        out |= {f"yaw_rate_{number}": yawing, f"angular_velocity_{number}": alpha[1]}
    return out


def rates_of(
    mechanism: Mechanism, number: int, state: MechanismState, answer: Solution
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return rates of a body's velocity [m/s2] and angular velocity [rad/s2].

    The angular rates are those in the body's own axes, and the third component in axes that do not pitch with it.
    """
    columns = mechanism.body(number)
    body, second = BodyMotion.of(state.q[columns], state.q_rate[columns]), answer.q_second[columns]
    alpha = body.g @ second[3:]
    return second[:3], alpha, in_yaw_roll_axes(body, alpha)


def in_yaw_roll_axes(body: BodyMotion, alpha: np.ndarray) -> float:
    """Return the rate of the third component of the angular velocity in axes that do not pitch with the wheelset."""
    axes = body.axes
    sine_roll = axes[2, 1]  # height of the axle's unit vector over the track
    cosine_roll = np.hypot(axes[2, 0], axes[2, 2])
    # The axes' first vector is level, which gives the pitch angle.
    sine, cosine = -axes[2, 0] / cosine_roll, axes[2, 2] / cosine_roll
    about = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    turned = about @ body.omega
    pitching = turned[1] - turned[2] * sine_roll / cosine_roll
    relative = cross(np.array([0.0, pitching, 0.0]), turned)
    return float(about[2] @ alpha + relative[2])


def slopes_of(snapshot: Snapshot) -> dict[str, float]:
    """Return the fast model's accelerations by the names of `accelerations_of`."""
    of = snapshot.machine
    first = snapshot.slope[f"{of.bodies[0]}_speed"]
    rates = ("lateral_rate", "bounce_rate", "roll_rate", "pitch_rate", "yaw_rate")
    kept = {motion_of(of, body, rate) for body in of.bodies for rate in rates}
    numbers = range(1, of.wheelsets + 1)
    kept |= {f"{name}_{n}" for name in ("lateral_speed", "yaw_rate", "angular_velocity") for n in numbers}
    out = {name: value for name, value in snapshot.slope.items() if name in kept}
    out |= {f"axle_{n}": first + snapshot.slope[f"shift_speed_{n}"] for n in numbers}
    return out | {f"along_{body}": first + snapshot.slope.get(f"{body}_shift_speed", 0.0) for body in of.bodies}
