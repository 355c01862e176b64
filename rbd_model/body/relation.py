"""The relative position and motion of two bodies joined by connections, and the axle boxes that hold a wheelset."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fmu_src.chain import Chain
from fmu_src.symbols import ca
from rbd_model.body.kinematics import Body, angle_of
from rbd_model.vehicle.assembly import Sizes
from rbd_model.vehicle.description import Place


@dataclass(frozen=True)
class End:
    """One end of connections: the body's name, its symbols, and the place of its centre in the vehicle at rest [m].

    boxed: true for a wheelset, which connections hold by its axle boxes.
    """

    name: str
    body: Body
    centre: ca.SX
    boxed: bool


@dataclass(frozen=True)
class Box:
    """The axle boxes of a wheelset, whose pitch follows a body: y along the axle, x square to it and to the body's z.

    All are in the body's axes. axle: unit vector; axes: the box's, its rows; spin [rad/s]: of the box relative to the
    body.
    """

    axle: ca.SX
    axes: ca.SX
    spin: ca.SX

    @classmethod
    def of(cls, chain: Chain, axle: ca.SX, rate: ca.SX) -> Box:
        """rate [rad/s]: of the wheelset relative to the body; its component about the axle is not used.

        The box turns only about its own x and the body's z axis.
        """
        ahead = ca.vertcat(axle[1], -axle[0], 0) / ca.sqrt(1 - axle[2] ** 2)
        upright = ca.cross(ahead, axle)
        rolling, yawing = narrow(chain, ca.dot(ahead, rate), ca.dot(upright, rate) / upright[2])
        return cls(axle, ca.vertcat(ahead.T, axle.T, upright.T), rolling * ahead + ca.vertcat(0, 0, yawing))

    def passed_on(self, moment: ca.SX) -> ca.SX:
        """Return the body's share of a moment on the boxes [N.m], both in the box's axes: the wheelset turns freely.

        It is square to both axes about which the box turns relative to the body, because only the body holds it there.
        """
        return moment[1] * ca.vertcat(0, 1, -self.axle[2] / self.axes[2, 2])


@dataclass(frozen=True)
class Relation:
    """Position and motion of the lower end's axes, which define directions, relative to the upper end, in its axes.

    `axes` are the lower's, its rows. `apart` [m] is the vector from the lower centre to the upper one. `velocity` [m/s]
    is its rate relative to the upper end. `spin` [rad/s] is that of the lower's axes. `centres` [m] are those of the
    (upper, lower) end in the vehicle at rest. `pitch` [rad] is that of the upper end relative to the lower one, if both
    can only pitch. `found` holds stretches by their place.
    """

    axes: ca.SX
    apart: ca.SX
    velocity: ca.SX
    spin: ca.SX
    centres: tuple[ca.SX, ca.SX]
    pitch: ca.SX | None = None
    found: dict[Place, Stretch] = field(default_factory=dict)

    def angle(self, angle: int) -> ca.SX:
        """Return roll, pitch or yaw, 0 to 2, of the upper end relative to the lower one's axes [rad]."""
        return self.pitch if angle == 1 and self.pitch is not None else angle_of(self.axes, angle)

    def stretch(self, sizes: Sizes, place: Place) -> Stretch:
        """Return the stretch between the points of both ends at one place of the vehicle at rest, eqs (3.1), (3.12)."""
        if place not in self.found:
            at = ca.vertcat(*[ca.SX(sizes.value(size)) for size in place])
            upper, lower = (at - centre for centre in self.centres)
            reach = self.apart + upper
            rate = self.velocity - ca.cross(self.spin, reach)
            both = narrow(sizes.chain, self.axes @ reach - lower, self.axes @ rate)
            self.found[place] = Stretch(upper, lower, *both)
        return self.found[place]

    def spread(self, place: ca.SX) -> Stretch:
        """Return half of the difference between the stretches of two points, at `place` [m] and opposite to it."""
        return Stretch(place, place, self.axes @ place - place, self.axes @ ca.cross(place, self.spin))


@dataclass(frozen=True)
class Stretch:
    """Upper end less lower end of a single connection, in the axes of the lower one; `way` is in m, `rate` in m/s.

    upper, lower [m]: its points, from the centre of each end in its own axes.
    """

    upper: ca.SX
    lower: ca.SX
    way: ca.SX
    rate: ca.SX


def narrow(chain: Chain, *values: ca.SX) -> list[ca.SX]:
    """Return the values as shared intermediate variables of the chain rule."""
    every = chain.narrow(ca.vertcat(*[ca.vec(value) for value in values]))
    ends = np.cumsum([0, *(value.numel() for value in values)]).tolist()
    return [ca.reshape(one, value.shape) for one, value in zip(ca.vertsplit(every, ends), values, strict=True)]
