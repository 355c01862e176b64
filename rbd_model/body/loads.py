"""Loads on bodies and wheelsets while they are added up, and the relative positions of bodies."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace

from fmu_src.chain import Chain
from fmu_src.symbols import ca
from rbd_model.body.effect import Effect, Load
from rbd_model.body.kinematics import Body
from rbd_model.body.relation import Box, End, Relation, narrow
from rbd_model.track.frame import Pose, here, relative
from rbd_model.vehicle.description import Wheelset, wheelset_name


@dataclass
class Loads:
    """Loads on each body while they are added up, and energies of connections: stored [J] and dissipated [W].

    boxes, axles: those of each wheelset by the body that it pitches with, in the axes of that body.
    """

    chain: Chain
    ends: dict[str, End]
    poses: dict[tuple[str, str], Pose] = field(default_factory=dict)
    boxes: dict[tuple[str, str], Box] = field(default_factory=dict)
    axles: dict[tuple[str, str], ca.SX] = field(default_factory=dict)
    of: defaultdict[str, list[Load]] = field(default_factory=lambda: defaultdict(list))
    stored: ca.SX = field(default_factory=lambda: ca.SX(0))
    lost: ca.SX = field(default_factory=lambda: ca.SX(0))

    @property
    def bodies(self) -> dict[str, Body]:
        """All bodies and wheelsets by name."""
        return {name: end.body for name, end in self.ends.items()}

    def on(self, name: str) -> Load:
        """Return the sum of all loads on one body, eqs (3.35), (3.36)."""
        total = sum(self.of[name], Load(ca.SX.zeros(3), ca.SX.zeros(3)))
        return replace(total, force=self.chain.narrow(total.force))

    def pose(self, seat: str, name: str) -> Pose:
        """Return the track's pose at a body relative to that at `seat`, section 3.2.1."""
        if (seat, name) not in self.poses:
            pose = relative(self.chain, self.ends[seat].body.track, self.ends[name].body.track)
            self.poses |= {(seat, name): pose, (name, seat): pose.back}
        return self.poses[seat, name]

    def seen(self, seat: str, name: str) -> Body:
        """Return a body in the axes of the track at `seat`, eq. (3.1)."""
        return self.ends[name].body.seen(self.pose(seat, name))

    def box(self, seat: str, wheelset: str) -> Box:
        """Return the axle boxes of a wheelset that pitch with the body `seat`."""
        if (seat, wheelset) not in self.boxes:
            body, wheels = self.ends[seat].body, self.seen(seat, wheelset)
            rate = wheels.axes[:, 0] * wheels.own_rate[0] + wheels.axes[:, 2] * wheels.own_rate[2]
            (axle,) = narrow(self.chain, body.axes.T @ wheels.axes[:, 1])
            self.boxes[seat, wheelset] = Box.of(self.chain, axle, body.axes.T @ rate - body.own_rate)
        return self.boxes[seat, wheelset]

    def axle(self, number: int, wheelset: Wheelset) -> ca.SX:
        """Return the unit vector along an axle in the axes of the body on which its torque reacts (section 9.2)."""
        pair = wheelset.reacts_on, wheelset_name(number)
        return self.axles[pair] if pair in self.axles else self.box(*pair).axle

    def relation(self, upper: str, lower: str) -> Relation:
        """Return the relative position and motion of two ends, eqs (3.1), (3.12)."""
        if self.ends[upper].boxed:
            return self.relation_of_box(upper, lower)
        centres = self.ends[upper].centre, self.ends[lower].centre
        body, beside = self.ends[upper].body, self.seen(upper, lower)
        way, moving = narrow(self.chain, body.place - beside.position, body.velocity - beside.velocity)
        apart = body.axes.T @ way
        velocity = body.axes.T @ moving - ca.cross(body.own_rate, apart)
        if self.ends[lower].boxed:
            box = self.box(upper, lower)
            return Relation(box.axes, apart, velocity, box.spin, centres)
        axes = beside.axes.T @ body.axes
        spin = axes.T @ beside.own_rate - body.own_rate
        axes, spin = narrow(self.chain, axes, spin)
        (roll, pitch, yaw) = ca.vertsplit(body.angles - beside.angles)
        in_plane = self.pose(upper, lower) is here() and roll.is_zero() and yaw.is_zero()
        return Relation(axes, apart, velocity, spin, centres, pitch if in_plane else None)

    def relation_of_box(self, upper: str, lower: str) -> Relation:
        """Return the same for axle boxes that are the upper end."""
        body, beside, box = self.ends[lower].body, self.seen(lower, upper), self.box(lower, upper)
        apart = body.axes.T @ (beside.position - body.place)
        velocity = body.axes.T @ (beside.velocity - body.velocity) - ca.cross(body.own_rate + box.spin, apart)
        apart, velocity, spin = (box.axes @ one for one in (apart, velocity, -box.spin))
        return Relation(box.axes.T, apart, velocity, spin, (self.ends[upper].centre, self.ends[lower].centre))

    def push(self, upper: str, lower: str, relation: Relation, effect: Effect) -> None:
        """Add the effect of connections on both ends, eqs (3.35), (3.36): together no force and no moment."""
        self.stored, self.lost = self.stored + effect.potential, self.lost + effect.power
        moments = {upper: effect.raised, lower: effect.lowered}
        seat, other = (lower, upper) if self.ends[upper].boxed else (upper, lower)
        if self.ends[other].boxed:
            box = self.box(seat, other)
            passed = box.passed_on(moments[other])
            moments[seat] += box.axes.T @ passed
            moments[other] = self.turned_to(seat, other) @ (moments[other] - passed)
        body = self.ends[seat].body
        force = body.axes @ (effect.force if seat == lower else relation.axes.T @ effect.force)
        (force,) = narrow(self.chain, force if seat == lower else -force)
        self.of[seat].append(Load(force, moments[seat]))
        self.of[other].append(Load(-self.pose(seat, other).axes.T @ force, moments[other]))

    def turned_to(self, seat: str, wheelset: str) -> ca.SX:
        """Return the rotation from axes of boxes that pitch with `seat` to those of their wheelset (section 3.2.1)."""
        axes = self.seen(seat, wheelset).axes
        upright, leaning = (ca.dot(axes[:, i], self.ends[seat].body.axes[:, 2]) for i in (2, 0))
        c, s = (one / self.box(seat, wheelset).axes[2, 2] for one in (upright, leaning))
        return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 0, 0), ca.horzcat(-s, 0, c))
