"""Rotations and rigid bodies in 3D. x forward, y left, z up; a body is turned by Rz(yaw) Rx(roll) Ry(pitch).

This differs from the thesis, which uses four Euler parameters (3.5). With the pitch last, a wheelset may turn without
limit and its rotation does not enter the geometry of the contact.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from fmu_src.symbols import ca
from rbd_model.track.frame import Pose, TrackFrame, here, level


def yaw_roll(yaw: ca.SX, roll: ca.SX) -> ca.SX:
    """Return the rotation matrix Rz(yaw) Rx(roll) from axes that yaw and roll with a body to the track's.

    Section 3.2.1.
    """
    return turned_by(direction_cosines(yaw, roll))


def direction_cosines(yaw: ca.SX, roll: ca.SX) -> ca.SX:
    """Return cosine and sine of yaw, cosine and sine of roll, the entries of the matrix of section 3.2.1."""
    return ca.vertcat(ca.cos(yaw), ca.sin(yaw), ca.cos(roll), ca.sin(roll))


def turned_by(cosines: ca.SX) -> ca.SX:
    """Return Rz(yaw) Rx(roll) of their `direction_cosines`, section 3.2.1."""
    c, s = cosines[0], cosines[1]
    about_z = ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))
    c, s = cosines[2], cosines[3]
    return about_z @ ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c, -s), ca.horzcat(0, s, c))


def pitch_rotation(pitch: ca.SX) -> ca.SX:
    """Return the rotation matrix Ry(pitch), section 3.2.1."""
    return about_y(ca.vertcat(ca.cos(pitch), ca.sin(pitch)))


def about_y(turn: ca.SX) -> ca.SX:
    """Return the rotation matrix Ry, section 3.2.1, of cosine and sine of its angle."""
    c, s = ca.vertsplit(turn)
    return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))


def turned_about_axes(roll: ca.SX, pitch: ca.SX, yaw: ca.SX) -> ca.SX:
    """Return Rz(yaw) Rx(roll) Ry(pitch), section 3.2.1, of cosine and sine of each."""
    return turned_by(ca.vertcat(yaw, roll)) @ about_y(pitch)


def axes_rate(tangent: ca.SX, rate: ca.SX) -> ca.SX:
    """Return the angular velocity of the yaw-roll axes, in these axes, for a body that turns with `rate` in them.

    This is section 3.2.2 for these angles; tangent: of the roll. The body's pitch adds to the second component only, so
    the first and the third are those of the body.
    """
    return ca.vertcat(rate[0], rate[2] * tangent, rate[2])


def angle_of(axes: ca.SX, angle: int) -> ca.SX:
    """Return roll, pitch or yaw, 0 to 2, of axes that are turned by Rz(yaw) Rx(roll) Ry(pitch), section 3.2.1."""
    if angle == 0:
        return ca.asin(axes[2, 1])
    return ca.atan2(-axes[2, 0], axes[2, 2]) if angle == 1 else ca.atan2(-axes[0, 1], axes[1, 1])


def axis_of(axes: ca.SX, angle: int) -> ca.SX:
    """Return the vector whose product with the axes' angular velocity is the rate of that angle.

    It is the inverse of section 3.2.2 for Rz(yaw) Rx(roll) Ry(pitch), row by row.
    """
    level = 1 - axes[2, 1] ** 2
    if angle == 0:
        return ca.vertcat(axes[1, 1], -axes[0, 1], 0) / ca.sqrt(level)
    pitching = ca.vertcat(axes[0, 1], axes[1, 1], 0) / level
    return pitching if angle == 1 else ca.vertcat(0, 0, 1) - axes[2, 1] * pitching


@dataclass(frozen=True)
class Body:
    """A rigid body: position and velocity of its centre in the axes of the track, its own axes (columns), own rate.

    `position` may be relative to any point that moves along the track. `own_rate` is the angular velocity in the own
    axes, as in the equations of motion. `angles` are roll, pitch and yaw, those of a wheelset without pitch. `track`
    holds the axes of the track at the body; velocities are inertial, in these axes.
    """

    position: ca.SX
    velocity: ca.SX
    axes: ca.SX
    own_rate: ca.SX
    angles: ca.SX
    track: TrackFrame = field(default_factory=level)

    @property
    def stretch(self) -> ca.SX:
        """Travel of the body per metre along the line [1]: larger outside of a curve's centre line, eq. (3.12)."""
        return 1 + ca.cross(self.track.turning, ca.vertcat(0, self.position[1:]))[0]

    @property
    def travel(self) -> ca.SX:
        """Rate of its place on the line [m/s]."""
        return self.velocity[0] / self.stretch

    @property
    def spin(self) -> ca.SX:
        """Angular velocity of the axes of the track that move along with it, in themselves [rad/s]."""
        return self.travel * self.track.turning

    @property
    def moving(self) -> ca.SX:
        """Rates of its lateral position and height in these axes [m/s], eq. (3.12)."""
        return (self.velocity - ca.cross(self.spin, ca.vertcat(0, self.position[1:])))[1:]

    @property
    def turning(self) -> ca.SX:
        """Angular velocity against the axes of the track, in the own axes [rad/s]: its angles follow from it."""
        return self.own_rate - self.axes.T @ self.spin

    def falling(self, gravity: ca.SX) -> ca.SX:
        """Return the change of velocity in these axes without force [m/s2]: by the axes' rotation, and by weight."""
        return -gravity * self.track.up - ca.cross(self.spin, self.velocity)

    @property
    def place(self) -> ca.SX:
        """Its centre relative to the origin of the track's axes here [m].

        Straight track has one origin for all bodies.
        """
        return self.position if self.track.plan is None else ca.vertcat(0, self.position[1:])

    def seen(self, pose: Pose) -> Body:
        """Return the same in other axes of the track, with inertial velocities and the place from their origin, (3.1).

        pose: of the track here relative to those axes.
        """
        if pose is here():
            return replace(self, position=self.place)
        axes = pose.axes @ self.axes
        position, velocity = pose.place + pose.axes @ self.place, pose.axes @ self.velocity
        return replace(self, position=position, velocity=velocity, axes=axes)

    @property
    def rate(self) -> ca.SX:
        """Angular velocity in the axes of the track [rad/s]."""
        return self.axes @ self.own_rate

    def arm(self, place: ca.SX) -> ca.SX:
        """Return the vector from the centre to a place given in the body's axes: A u of eq. (3.1)."""
        return self.axes @ place
