"""The same motion in both models: states of the spatial level as coordinates of chapter 3, and accelerations back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np

from fmu_src.compile import build_library
from fmu_src.kernel import DISCARD, Kernel, KernelError, Library
from fmu_src.system import System, model_of
from rbd_model.bogie import levels, wheelset_in_frame
from rbd_model.contact import moving_ellipse
from rbd_model.contact_geometry import thesis_pair
from rbd_model.creep import smooth_kalker_coefficients
from rbd_model.parameters import BogieParameters, as_printed, tables_4_1_and_4_2, tables_5_1_and_5_2
from rbd_model.thesis.creep import Ellipse
from rbd_model.thesis.euler import angular_velocity, cross, from_angles, g_bar
from rbd_model.thesis.kinematic_analysis import Frame, Wheelset, centred, drive_to
from rbd_model.thesis.mechanism import FIRST_WHEELSET, Answer, Inputs, Mechanism, State
from rbd_model.track import derivatives_along, section_5_3
from rbd_model.vehicles import two_axle_bogie

WORDS = ("right", "left")


def _fitted() -> ca.Function:
    given = ca.SX.sym("given", 4)  # A, B, load, shear modulus
    logarithm, mean = moving_ellipse(*ca.vertsplit(given))
    stretch, kalker = ca.exp(logarithm / 2), smooth_kalker_coefficients(logarithm)
    results = [mean * stretch, mean / stretch, kalker.c11, kalker.c22, kalker.c23]
    return ca.Function("ellipse", [given], [ca.vertcat(*results)])


_FITTED = _fitted()


def fitted_ellipse(a: float, b: float, normal_force: float, shear_modulus: float) -> Ellipse:
    """The fast model's polynomials for ellipse and coefficients, within 2e-4 and 0.5 % of exact ones and table."""
    along, across, *kalker = np.array(_FITTED([a, b, normal_force, shear_modulus])).ravel().tolist()
    return Ellipse(along, across, (kalker[0], kalker[1], kalker[2]))


@dataclass(frozen=True)
class Machine:
    """One of the two systems: equations and compiled kernel of the fast model, and its parameters."""

    wheelsets: int
    parameters: BogieParameters
    system: System
    library: Library


@lru_cache
def machine(wheelsets: int) -> Machine:
    if wheelsets == 1:
        parameters = as_printed(tables_4_1_and_4_2())
        system = wheelset_in_frame(parameters)
    else:
        parameters = as_printed(tables_5_1_and_5_2())
        system = levels(two_axle_bogie(parameters))[2]
    return Machine(wheelsets, parameters, system, Library(build_library(model_of(system, 1e-7))))


@dataclass(frozen=True)
class Snapshot:
    """A state of the fast model with its slopes by name, and the scene that led there."""

    machine: Machine
    scene: Mapping[str, float]
    value: Mapping[str, float]
    slope: Mapping[str, float]
    locked: tuple[bool, ...]


def reach(of: Machine, scene: Mapping[str, float], seconds: float) -> Snapshot | None:
    """Runs the fast model to a state; None where the run ended before."""
    kernel = Kernel(of.library, tolerance=1e-9, **scene)
    try:
        kernel.advance(seconds)
    except KernelError as error:
        if error.status == DISCARD:
            return None
        raise
    found = kernel.linearise()
    names = list(of.system.states)
    locked = tuple(kernel[f"locked_{n}"] > 0.5 for n in range(1, of.wheelsets + 1))
    return Snapshot(
        of, scene, dict(zip(names, found.state, strict=True)), dict(zip(names, found.slope, strict=True)), locked
    )


def mechanism_of(of: Machine, scene: Mapping[str, float]) -> Mechanism:
    """The oracle with the parameters and the track of a scene."""
    own = {name: value for name, value in scene.items() if name in of.parameters.values()}
    track = section_5_3()
    irregular = {name: value for name, value in scene.items() if name in track.values()}
    return Mechanism(
        replace(of.parameters, **own),
        thesis_pair(),
        of.wheelsets,
        derivatives_along(replace(track, **irregular)),
        ellipse=fitted_ellipse,
    )


def inputs_of(scene: Mapping[str, float]) -> Inputs:
    rows = {"brake_torque": 0.0, "traction_torque": 0.0, "yaw_torque": 0.0, "friction": 0.3}
    return Inputs(*[[scene.get(f"{name}_{n}", default) for n in (1, 2)] for name, default in rows.items()])


def state_of(snapshot: Snapshot, mechanism: Mechanism) -> State:
    """The same state in the coordinates of chapter 3."""
    v, p = snapshot.value, mechanism.parameters
    frame = Frame(
        np.concatenate(
            [
                [v["frame_distance"], v["frame_lateral"], p.wheel_radius + p.frame_height + v["bounce"]],
                from_angles(v["frame_yaw"], v["frame_roll"], v.get("pitch", 0.0)),
            ]
        ),
        np.array([v["frame_speed"], v["frame_lateral_rate"], v["bounce_rate"]]),
        np.array([v["frame_roll_rate"], v.get("pitch_rate", 0.0), v["frame_yaw_rate"]]),
    )
    near = centred(mechanism)
    near[mechanism.body(mechanism.frame)] = frame.coordinates
    driven = []
    for number in range(1, mechanism.wheelsets + 1):
        one = Wheelset(
            v["frame_distance"] + mechanism.place(number - 1) + v[f"shift_{number}"],
            *(v[f"{name}_{number}"] for name in ("lateral", "yaw", "rotation")),
            v["frame_speed"] + v[f"shift_speed_{number}"],
            *(v[f"{name}_{number}"] for name in ("lateral_speed", "yaw_rate", "angular_velocity")),
        )
        driven.append(one)
        body = near[mechanism.body(FIRST_WHEELSET + number - 1)]
        body[:2] = one.distance, one.lateral
        body[3:] = from_angles(one.yaw, v[f"roll_{number}"], one.pitch)
        for side, word in enumerate(WORDS):
            contact = 2 * (number - 1) + side
            s = near[mechanism.q_count :]
            s[mechanism.rail_parameters(contact)][0] = one.distance
            s[mechanism.wheel_parameters(contact)] = one.pitch, v[f"contact_{number}_{word}"]
    state = drive_to(mechanism, driven, frame, near)
    state.direction = [0 if locked else 1 for locked in snapshot.locked]
    return state


def accelerations_of(state: State, answer: Answer, mechanism: Mechanism) -> dict[str, float]:
    """Accelerations by the names of the fast model's states, but absolute ones for the axles [m/s2, rad/s2]."""
    out = {}
    body = mechanism.body(mechanism.frame)
    alpha = g_bar(state.q[body][3:]) @ answer.q_second[body][3:]
    names = ("frame_speed", "frame_lateral_rate", "bounce_rate")
    out |= dict(zip(names, answer.q_second[body][:3], strict=True))
    out |= {"frame_roll_rate": alpha[0], "frame_yaw_rate": alpha[2]}
    if mechanism.wheelsets > 1:
        out["pitch_rate"] = alpha[1]
    for number in range(1, mechanism.wheelsets + 1):
        body = mechanism.body(FIRST_WHEELSET + number - 1)
        theta, second = state.q[body][3:], answer.q_second[body]
        alpha, omega = g_bar(theta) @ second[3:], angular_velocity(theta, state.q_rate[body][3:])
        yawing = in_yaw_roll_axes(theta, omega, alpha)
        out |= {f"axle_{number}": second[0], f"lateral_speed_{number}": second[1]}
        out |= {f"yaw_rate_{number}": yawing, f"angular_velocity_{number}": alpha[1]}
    return out


def in_yaw_roll_axes(theta: np.ndarray, omega: np.ndarray, alpha: np.ndarray) -> float:
    """Rate of the third component of the angular velocity in the axes that do not pitch with the wheelset."""
    t0, t1, t2, t3 = theta
    sine_roll = 2 * (t2 * t3 + t0 * t1)  # height of the axle's unit vector, from (3.2)
    # The axes' first vector is level, which gives the pitch angle.
    up = np.array([2 * (t1 * t3 - t0 * t2), 2 * (t2 * t3 + t0 * t1), 1 - 2 * (t1 * t1 + t2 * t2)])
    cosine_roll = np.hypot(up[0], up[2])
    sine, cosine = -up[0] / cosine_roll, up[2] / cosine_roll
    turned = np.array([cosine * omega[0] + sine * omega[2], omega[1], -sine * omega[0] + cosine * omega[2]])
    pitching = turned[1] - turned[2] * sine_roll / cosine_roll
    relative = cross(np.array([0.0, pitching, 0.0]), turned)
    return float(-sine * alpha[0] + cosine * alpha[2] + relative[2])


def slopes_of(snapshot: Snapshot) -> dict[str, float]:
    """The fast model's accelerations under the names of `accelerations_of`."""
    out = {name: value for name, value in snapshot.slope.items() if name in KEPT}
    for number in range(1, snapshot.machine.wheelsets + 1):
        out[f"axle_{number}"] = snapshot.slope["frame_speed"] + snapshot.slope[f"shift_speed_{number}"]
    return out


KEPT = {
    *("frame_speed", "frame_lateral_rate", "bounce_rate", "frame_roll_rate", "frame_yaw_rate", "pitch_rate"),
    *(f"{name}_{n}" for name in ("lateral_speed", "yaw_rate", "angular_velocity") for n in (1, 2)),
}
