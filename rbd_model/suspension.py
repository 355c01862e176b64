"""The suspension in space: springs and dampers between axle boxes and sprung mass."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import casadi as ca

from rbd_model.kinematics import Body

DIRECTIONS = ("longitudinal", "lateral", "vertical")


@dataclass(frozen=True)
class Load:
    """Force [N] and moment about the centre of mass [N.m] on a body, in the axes of the track."""

    force: ca.SX
    moment: ca.SX


@dataclass(frozen=True)
class Suspension:
    """Loads of all elements of one wheelset on it and on the sprung mass; energy stored [J] and lost [W]."""

    on_wheelset: Load
    on_frame: Load
    potential: ca.SX
    damping_power: ca.SX


def suspend(
    parameter: Mapping[str, ca.SX], wheelset: Body, frame: Body, place: tuple[ca.SX, ca.SX], preload: ca.SX
) -> Suspension:
    """Two elements, left and right, eqs (3.38), (3.41), (3.42), with a stiffness and a damping in each direction.

    place [m]: of the axle in the frame's axes (x, z); preload [N]: static vertical force of one element. The vertical
    springs, which resist roll, may stand further apart than the level ones, which resist yaw; the lateral ones have no
    arm across the track.
    Differs from the thesis, which prints (3.37) for an element along one line: three springs in the axes of the track,
    as its Tables 4.1 and 5.1 list them, each force at its own attachment point.
    """
    stiffness = ca.vertcat(*[parameter[f"{direction}_stiffness"] for direction in DIRECTIONS])
    damping = ca.vertcat(*[parameter[f"{direction}_damping"] for direction in DIRECTIONS])
    weight = ca.vertcat(0, 0, preload)
    nothing = ca.SX.zeros(3)
    force, wheelset_moment, frame_moment, potential, power = nothing, nothing, nothing, ca.SX(0), ca.SX(0)
    springs = {"longitudinal": ca.DM([1, 1, 0]), "vertical": ca.DM([0, 0, 1])}
    for side, (spacing, acting) in product((1, -1), springs.items()):
        across = side * parameter[f"{spacing}_half_spacing"]
        wheelset_arm = wheelset.arm(ca.vertcat(0, across, 0))
        frame_arm = frame.arm(ca.vertcat(place[0], across, place[1]))
        stretch = acting * (frame.position + frame_arm - wheelset.position - wheelset_arm)
        rate = acting * (frame.velocity_at(frame_arm) - wheelset.velocity_at(wheelset_arm))
        pull = stiffness * stretch + damping * rate - acting * weight  # on the wheelset
        force = force + pull
        wheelset_moment = wheelset_moment + ca.cross(wheelset_arm, pull)
        frame_moment = frame_moment - ca.cross(frame_arm, pull)
        potential = potential + ca.dot(stiffness, stretch**2) / 2 - ca.dot(weight, stretch)
        power = power + ca.dot(damping, rate**2)
    return Suspension(Load(force, wheelset_moment), Load(-force, frame_moment), potential, power)


def total(loads: Sequence[Load]) -> Load:
    """Sum of loads on one body, eqs (3.35), (3.36)."""
    force, moment = ca.SX.zeros(3), ca.SX.zeros(3)
    for load in loads:
        force, moment = force + load.force, moment + load.moment
    return Load(force, moment)
