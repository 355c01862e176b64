"""The axes of the track at a place on the line, in which a body there is described: x along, y to the left, z up.

They turn by the heading about the vertical, then by the gradient, then by the cant about the track itself: Rz(heading)
Ry(-slope) Rx(cant), by section 3.2.1. On straight and level track they are the inertial axes of chapter 3. The axes
follow from the line's curvature, cant and gradient. Its place in the plan and its height are integrals of these, so
that nothing here is linearised.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from fmu_src.chain import Chain
from fmu_src.symbols import ca
from fmu_src.system import System
from rbd_model.track.line_table import along_line


@dataclass(frozen=True)
class Plan:
    """Position and direction of the axes: heading, height of their origin [m], tilt, whole metres and rest of the
    place.

    heading: its cosine and sine. tilt: the axes (columns) in level axes along the heading. `far` and `near`, shape
    (2,), are ahead and aside in the plan [m]. Differences of two places are exact far from the start.
    """

    heading: ca.SX
    height: ca.SX
    tilt: ca.SX
    far: ca.SX
    near: ca.SX
    turned: ca.SX  # the heading as an angle that counts whole turns [rad]
    distance: ca.SX  # along the line [m]

    def place(self, position: ca.SX) -> ca.SX:
        """Return the place of a position in the track's axes: ahead, aside and above the line's first row [m]."""
        level = self.tilt @ ca.vertcat(0, position[1:])
        (c, s), (x, y) = ca.vertsplit(self.heading), ca.vertsplit(level[:2])
        plan = (self.near + ca.vertcat(c * x - s * y, s * x + c * y)) + self.far
        return ca.vertcat(plan, self.height + level[2])


@dataclass(frozen=True)
class TrackFrame:
    """Axes of the track: their rotation, and the upward direction in them.

    turning: their angular velocity per m/s of speed along the line, in the axes themselves [rad/m]. up: unit vector.
    plan: None on straight track.
    """

    turning: ca.SX
    up: ca.SX
    plan: Plan | None = None

    def elevation(self, position: ca.SX) -> ca.SX:
        """Return the height of a position in these axes [m], for the energy of section 2.4.

        Straight track includes x.
        """
        if self.plan is None:
            return ca.dot(self.up, position)
        return self.plan.height + ca.dot(self.up[1:], position[1:])


@cache
def level() -> TrackFrame:
    """Return straight and level track: the axes of section 3.2.1 that are treated as inertial."""
    return TrackFrame(ca.SX.zeros(3), ca.SX([0, 0, 1]))


def on_gradient(gradient: ca.SX) -> TrackFrame:
    """Return straight track (section 5.2) that rises by `gradient` per metre along it: its sine."""
    return TrackFrame(ca.SX.zeros(3), ca.vertcat(gradient, 0, ca.sqrt(1 - gradient**2)))


@dataclass(frozen=True)
class Course:
    """A line's data at a place: curvature [1/m], sines of gradient and cant, and their slopes along it [1/m]."""

    curvature: ca.SX
    gradient: ca.SX
    cant: ca.SX
    steepening: ca.SX
    twisting: ca.SX

    @property
    def level(self) -> ca.SX:
        """Cosine of the gradient."""
        return ca.sqrt(1 - self.gradient**2)

    @property
    def upright(self) -> ca.SX:
        """Cosine of the cant."""
        return ca.sqrt(1 - self.cant**2)

    @property
    def turning(self) -> ca.SX:
        """Angular velocity as in TrackFrame, by section 3.2.2 for these angles."""
        rising, aside = self.steepening / self.level, self.curvature * self.level
        return ca.vertcat(
            self.twisting / self.upright + self.curvature * self.gradient,
            aside * self.cant - rising * self.upright,
            rising * self.cant + aside * self.upright,
        )

    @property
    def tilt(self) -> ca.SX:
        """Axes of the track (columns) in level axes along the heading: Ry(-slope) Rx(cant)."""
        level, sine, upright, cant = self.level, self.gradient, self.upright, self.cant
        return ca.vertcat(
            ca.horzcat(level, -sine * cant, -sine * upright),
            ca.horzcat(0, upright, -cant),
            ca.horzcat(sine, level * cant, level * upright),
        )


def on_line(system: System, distance: ca.SX) -> TrackFrame:
    """Return the axes at a distance [m] on the line of the instance (section 3.2.1).

    Cosine and sine of the heading are slopes of the line in the plan, not functions of an angle.
    """

    def look_up(column: str, order: int = 0) -> list[ca.SX]:
        return along_line(system, column, distance, order)

    height, sine, steepening = look_up("rise", 2)
    cant, twisting = look_up("cant", 1)
    turned, curvature = look_up("heading", 1)
    course = Course(curvature, sine, cant, steepening, twisting)
    (ahead, forwards), (aside, sideways) = look_up("ahead", 1), look_up("aside", 1)
    heading = ca.vertcat(forwards, sideways) / course.level
    far, near = ca.vertcat(look_up("ahead_far")[0], look_up("aside_far")[0]), ca.vertcat(ahead, aside)
    return frame_of(system, course, Plan(heading, height, course.tilt, far, near, turned, distance))


def on_profile(system: System, distance: ca.SX) -> TrackFrame:
    """Return the axes in the vertical plane alone (section 5.2), as of a line without curves."""
    height, sine, steepening = along_line(system, "rise", distance, 2)
    far, near = (ca.vertcat(along_line(system, f"level{which}", distance)[0], 0) for which in ("_far", ""))
    none = ca.SX(0)
    course = Course(none, sine, none, steepening, none)
    return frame_of(system, course, Plan(ca.SX([1, 0]), height, course.tilt, far, near, none, distance))


def frame_of(system: System, course: Course, plan: Plan) -> TrackFrame:
    """Return the axes at a place of a line, section 3.2.1."""
    up = course.tilt[2, :].T
    narrowed = system.narrow(ca.vertcat(course.turning, up))
    return TrackFrame(narrowed[:3], narrowed[3:], plan)


@dataclass(frozen=True)
class Pose:
    """Axes (columns) and place of the origin [m] of one track frame relative to another, section 3.2.1."""

    axes: ca.SX
    place: ca.SX

    @property
    def vector(self) -> ca.SX:
        """Both, one below the other, shape (12,)."""
        return ca.vertcat(ca.vec(self.axes), self.place)

    @classmethod
    def of(cls, vector: ca.SX) -> Pose:
        """The pose of a vector."""
        return cls(ca.reshape(vector[:9], 3, 3), vector[9:])

    def slope(self, turning: ca.SX, turning_there: ca.SX) -> ca.SX:
        """Return the derivative of its vector by the distances of the one and the other along the line [1/m].

        Equation (3.12).

        turning, turning_there: of the one's and the other's axes, as in TrackFrame. Origins move along x by 1 m per
        metre.
        """
        here = ca.vertcat(ca.vec(ca.skew(turning) @ self.axes), ca.cross(turning, self.place) + ca.vertcat(1, 0, 0))
        there = ca.vertcat(ca.vec(self.axes @ ca.skew(turning_there)), self.axes[:, 0])
        return ca.horzcat(-here, there)

    @property
    def back(self) -> Pose:
        """Return the pose of the one relative to the other."""
        return self if self is here() else Pose(self.axes.T, -self.axes.T @ self.place)


@cache
def here() -> Pose:
    """Return the pose of a frame relative to itself, and of all straight track."""
    return Pose(ca.SX.eye(3), ca.SX(3, 1))


def relative(chain: Chain, at: TrackFrame, other: TrackFrame) -> Pose:
    """Return the pose of `other` in the axes `at`, eq. (3.1).

    Heading and chord between them follow from differences alone.
    """
    if at.plan is None or other.plan is None or at is other:
        return here()
    (ahead, aside), (forwards, sideways) = ca.vertsplit(at.plan.heading), ca.vertsplit(other.plan.heading)
    c, s = ahead * forwards + aside * sideways, ahead * sideways - aside * forwards
    about_z = ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))
    way = (other.plan.far - at.plan.far) + (other.plan.near - at.plan.near)
    chord = ca.vertcat(
        ahead * way[0] + aside * way[1], ahead * way[1] - aside * way[0], other.plan.height - at.plan.height
    )
    back = at.plan.tilt.T
    axes, place = back @ about_z @ other.plan.tilt, back @ chord
    pose, distances = Pose(axes, place), ca.vertcat(at.plan.distance, other.plan.distance)
    return Pose.of(chain.narrow(pose.vector, (distances, pose.slope(at.turning, other.turning))))
