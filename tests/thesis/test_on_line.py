"""Chapter 3 on a line: its frame is inertial and its rails are surfaces, so curves need no turning axes."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from rbd_model.contact.geometry import thesis_pair
from rbd_model.contact.profiles import Profile
from rbd_model.thesis import mechanism as mechanisms
from rbd_model.thesis.constraints import quadratic_terms
from rbd_model.thesis.euler import composed, from_angles, from_matrix, g_bar
from rbd_model.thesis.forces import BodyMotion
from rbd_model.thesis.kinematic_analysis import Frame, Wheelset, drive_to, driving_constraints, frames_at_rest, rolling
from rbd_model.thesis.mechanism import FIRST_WHEELSET, Answer, Inputs, Mechanism, State
from rbd_model.thesis.program import run
from rbd_model.thesis.rails import STRAIGHT, Rails, SectionRails, SweptRails
from rbd_model.thesis.surfaces import profile_derivatives
from rbd_model.track.irregularity import derivatives_along, section_5_3
from rbd_model.track.line import ERRI_LOW, GAUGE, Line, arc, irregular, line_of, straight
from rbd_model.vehicle.parameters import as_printed, tables_4_1_and_4_2, tables_5_1_and_5_2
from thesis import correspondence
from thesis.correspondence import Snapshot, machine_on_line, mechanism_of, reach
from thesis.test_against_kernel import ACCELERATION_BAND, FORCE_BAND, differences, random_scene

STATES = 60
#: Lines reach from behind the vehicle at the start to where the fastest one gets [m]. The rows are so close that the
#: direction of what the runtime draws between them in the plan, a polynomial, is right to 1e-14 rad.
BEGIN, END, ROW_DISTANCE = -10.0, 65.0, 0.25
#: Lateral acceleration of the fastest on the tightest curve [m/s2]: beyond it most runs end before their state.
LATERAL = 1.5


def tightest_radius(wheelsets: int, seed: int) -> float:
    return random.Random(f"radius {wheelsets} {seed}").choice((150.0, 200.0, 400.0))


def random_line(wheelsets: int, seed: int) -> Line:
    """An arc, a transition or a winding line, with cant, gradient and their changes, wide gauge, irregular rails."""
    rng = random.Random(f"line {wheelsets} {seed}")
    tightest, kind = 1 / tightest_radius(wheelsets, seed), rng.choice(("arc", "transition", "winding"))
    distance = np.arange(BEGIN, END, ROW_DISTANCE)
    share = (distance - BEGIN) / (END - BEGIN)
    rows = {"distance": distance}
    for name, size in (("curvature", tightest), ("cant", 0.15), ("gradient", 0.05), ("gauge_widening", 0.02)):
        first, last, phase = (rng.uniform(-size, size) for _ in range(3))
        changing = first + (last - first) * share
        if kind == "winding":
            changing = first * np.cos(distance / 15.0 + 2 * math.pi * phase / size)
        rows[name] = np.full_like(distance, first) if kind == "arc" else changing
    rows["gauge_widening"] = np.abs(rows["gauge_widening"]) if kind != "winding" else rows["gauge_widening"] ** 2
    line = Line(rows)
    return irregular(line, ERRI_LOW, seed) if rng.random() < 0.5 else line


@lru_cache
def snapshots(wheelsets: int) -> list[tuple[Snapshot, Line]]:
    found: list[tuple[Snapshot, Line]] = []
    seed = 0
    with TemporaryDirectory() as folder:
        while len(found) < STATES:
            line = random_line(wheelsets, seed)
            path = str(line.write(Path(folder) / f"{seed}.csv"))
            scene, seconds = random_scene(wheelsets, seed)
            scene["initial_speed"] = min(scene["initial_speed"], math.sqrt(LATERAL * tightest_radius(wheelsets, seed)))
            snapshot = reach(machine_on_line(wheelsets), scene, seconds, path)
            seed += 1
            if snapshot is not None:
                found.append((snapshot, line))
    return found


def on_line(snapshot: Snapshot, line: Line) -> Mechanism:
    """The oracle of a state, on rails that are prisms at each wheelset's section, as the fast model has them."""
    rails = SectionRails(line, snapshot.value["frame_distance"])
    return mechanism_of(snapshot.machine, snapshot.scene, rails)


@pytest.mark.parametrize("wheelsets", [1, 2])
def test_accelerations_and_normal_forces_on_a_line_are_those_of_chapter_3(wheelsets: int) -> None:
    """Two ways to one mechanics: turning axes of the track, and an inertial frame that has never heard of them."""
    for snapshot, line in snapshots(wheelsets):
        acceleration, force = differences(snapshot, on_line(snapshot, line))
        assert acceleration < ACCELERATION_BAND, snapshot.scene
        assert force < FORCE_BAND, snapshot.scene


def test_random_lines_contain_what_they_are_meant_to() -> None:
    every = [*snapshots(1), *snapshots(2)]
    there = [on_line(s, line).rails.section(s.value["frame_distance"]) for s, line in every]
    curvature, twist, bending = (np.abs([section.turning[i] for section in there]) for i in (2, 0, 1))
    assert sum(curvature > 1 / 400) >= 20
    assert sum(twist > 1e-3) >= 20
    assert sum(bending > 5e-4) >= 20
    assert sum(abs(section.axes[0, 2, 0]) > 0.02 for section in there) >= 20
    assert sum(abs(section.axes[0, 2, 1]) > 0.03 for section in there) >= 20
    assert sum(abs(section.spread[0]) > 2e-3 for section in there) >= 20
    lost = [s for s, _ in every if any(s.locked)]
    pressed = [s for s, line in every if any(np.linalg.norm(force) > 0.0 for force in flanges(s, on_line(s, line)))]
    assert len(lost) >= 3
    assert len(pressed) >= 20


def flanges(snapshot: Snapshot, oracle: Mechanism) -> list[np.ndarray]:
    """Forces (3.106) on the wheelsets of a state."""
    state = correspondence.state_of(snapshot, oracle)
    bodies = oracle.motions(state.q, state.q_rate)
    return [oracle.flange(bodies[FIRST_WHEELSET + n]) for n in range(oracle.wheelsets)]


def without(term: str, patch: pytest.MonkeyPatch) -> Callable[[Snapshot, Line], Mechanism]:
    """The oracle, or its correspondence with the fast model, with one thing wrong."""
    if term == "turning of the axes":
        turning = correspondence.in_track_axes

        def forgotten(mechanism: Mechanism, number: int, state: State, answer: Answer):  # type: ignore[no-untyped-def]
            _, alpha, yawing = turning(mechanism, number, state, answer)
            columns = mechanism.body(number)
            _, section = mechanism.there(BodyMotion.of(state.q[columns], state.q_rate[columns]))
            return section.axes[0].T @ answer.q_second[columns][:3], alpha, yawing

        patch.setattr(correspondence, "in_track_axes", forgotten)
    elif term == "bend of the distance":
        own = SectionRails.distance
        patch.setattr(SectionRails, "distance", lambda self, at: replace(own(self, at), bend=np.zeros((3, 3))))
    elif term == "what flanges drag":
        own_flange = Mechanism.flange

        def across(self: Mechanism, body: BodyMotion) -> np.ndarray:
            lateral = self.there(body)[1].axes[0, :, 1]
            return np.asarray(lateral * (lateral @ own_flange(self, body)))

        patch.setattr(Mechanism, "flange", across)

    def made(snapshot: Snapshot, line: Line) -> Mechanism:
        if term == "sign of the twist":
            cant = np.interp(snapshot.value["frame_distance"], line.rows["distance"], line.rows["cant"])
            line = Line(line.rows | {"cant": 2 * cant - line.rows["cant"]})
        return on_line(snapshot, line)

    return made


@pytest.mark.parametrize(
    "term",
    [
        "turning of the axes",
        "bend of the distance",
        "what flanges drag",
        "sign of the twist",
    ],
)
def test_a_missing_term_of_the_line_is_found(term: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of every one the comparison above fails, of those that every line has in most states."""
    made = without(term, monkeypatch)
    worst = [max(differences(snapshot, made(snapshot, line))) for snapshot, line in snapshots(2)[:20]]
    assert max(worst) > 1e3 * ACCELERATION_BAND
    if term in ("turning of the axes", "bend of the distance"):
        assert np.median(worst) > ACCELERATION_BAND


# -- the oracle alone ------------------------------------------------------------------------------------------------

#: Centre line and axes against closed forms and against differences of the fourth order over 1 mm [m, 1].
CURVE_BAND, DIFFERENCE_BAND = 1e-13, 1e-9
#: Jacobian and Q_d of all constraints against such differences along a motion, relative to their largest entries.
MOTION_BAND = 1e-8
#: Energy over 0.03 s with steps of 1 ms of the fourth order, relative to the kinetic one.
ENERGY_BAND = 1e-9
RAILS = {"section": SectionRails, "swept": SweptRails}


def winding() -> Line:
    """Everything changes along it: curvature, cant, gradient, widening and both rails.

    No row lies from 0 to 0.45 m, where motions go along it: at a row the gradient's second derivative jumps, and a step
    that begins there would see the other side's by round-off.
    """
    distance = np.arange(-8.04, 12.0, 0.5)
    waves = {"curvature": 1 / 200, "cant": 0.1, "gradient": 0.03, "gauge_widening": 0.01, "left_vertical": 4e-3}
    waves |= {"right_vertical": 3e-3, "left_lateral": 5e-3}
    rows = {name: size * np.sin(distance / 11.0 + number) for number, (name, size) in enumerate(waves.items())}
    return Line({"distance": distance} | rows)


def differentiated(function: Callable[[float], np.ndarray], step: float) -> np.ndarray:
    """Slope at 0 by differences of the fourth order."""
    values = {k: function(k * step) for k in (-2, -1, 1, 2)}
    return np.asarray((values[-2] - 8 * values[-1] + 8 * values[1] - values[2]) / (12 * step))


def test_an_arc_on_a_gradient_is_a_helix() -> None:
    """Section 3.2.1 in closed form: radius of the plan, rise, tangent, and level across without cant."""
    radius, sine = 150.0, 0.04
    rails = SectionRails(line_of([arc(40.0, radius, gradient=sine)], -20.0), 0.0)
    level = math.sqrt(1 - sine**2)
    for distance in (-17.3, 0.0, 8.8):
        section, turned = rails.section(distance), distance / radius
        place = np.array([level * radius * math.sin(turned), level * radius * (1 - math.cos(turned)), sine * distance])
        assert np.abs(section.origin[0] - place).max() < CURVE_BAND * 20.0
        along = np.array([level * math.cos(turned), level * math.sin(turned), sine])
        assert np.abs(section.axes[0, :, 0] - along).max() < CURVE_BAND
        assert np.abs(section.axes[0, :, 1] - [-math.sin(turned), math.cos(turned), 0.0]).max() < CURVE_BAND
        assert section.turning == pytest.approx([sine / radius, 0.0, level / radius], rel=1e-12, abs=1e-15)


def test_sections_change_along_the_line_as_their_derivatives_say() -> None:
    """Derivatives up to the third of C, T and the rails' shifts; T is a rotation, and C goes along its first column."""
    rails = SectionRails(winding(), 0.0)
    for distance in (-3.3, 0.2, 7.1):
        section = rails.section(distance)
        assert np.abs(section.axes[0].T @ section.axes[0] - np.eye(3)).max() < CURVE_BAND
        assert np.linalg.det(section.axes[0]) == pytest.approx(1.0, abs=CURVE_BAND)
        for name in ("origin", "axes", "shifts", "spread"):
            found = differentiated(lambda x, d=distance, n=name: getattr(rails.section(d + x), n), 1e-3)  # type: ignore[misc]
            assert np.abs(found[:3] - getattr(section, name)[1:]).max() < DIFFERENCE_BAND, name


def test_distance_on_a_line_follows_a_place_as_its_derivatives_say() -> None:
    rails = SectionRails(winding(), 0.0)
    section = rails.section(1.7)
    place = section.origin[0] + section.axes[0] @ np.array([0.0, 0.4, 1.2])
    at = rails.distance(place)
    assert at.value == pytest.approx(1.7, abs=CURVE_BAND)
    for axis, direction in enumerate(np.eye(3)):

        def moved(x: float, direction: np.ndarray = direction) -> np.ndarray:
            found = rails.distance(place + x * direction)
            return np.array([found.value, *found.slope])

        expected = np.array([at.slope[axis], *at.bend[axis]])
        assert np.abs(differentiated(moved, 1e-2) - expected).max() < DIFFERENCE_BAND


@dataclass(frozen=True)
class Sweep:
    """A motion of all coordinates of a system, in which each is linear in time but Euler parameters keep length 1."""

    mechanism: Mechanism
    at: np.ndarray
    rates: np.ndarray

    @classmethod
    def of(cls, mechanism: Mechanism, state: State) -> Sweep:
        rng = np.random.default_rng(11)
        at, rates = np.concatenate([state.q, state.s]), 0.3 * rng.normal(size=mechanism.unknowns)
        rates[mechanism.q_count :] *= 0.03
        made = cls(mechanism, at, rates)
        for theta in made.thetas:
            rates[theta] -= at[theta] * (at[theta] @ rates[theta])
        return made

    @property
    def thetas(self) -> list[slice]:
        bodies = [self.mechanism.body(number) for number in range(self.mechanism.bodies)]
        return [slice(body.start + 3, body.stop) for body in bodies]

    def moved(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates and their rates."""
        place, rate = self.at + time * self.rates, self.rates.copy()
        for theta in self.thetas:
            one, length = place[theta].copy(), np.linalg.norm(place[theta])
            place[theta] = one / length
            rate[theta] = self.rates[theta] / length - one * (one @ self.rates[theta]) / length**3
        return place, rate

    def constraints(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """C, and its rate by its Jacobian."""
        place, rate = self.moved(time)
        c, jacobian = self.mechanism.constraints(0.0, *np.split(place, [self.mechanism.q_count]))
        return c, jacobian @ rate

    def second(self) -> np.ndarray:
        """Second derivative of C at the start, by the Jacobian and Q_d."""
        cut = self.mechanism.q_count
        (place, rate), (q, s) = self.moved(0.0), np.split(self.at, [cut])
        motions = self.mechanism.motions(q, rate[:cut])
        q_d = self.mechanism.quadratic(motions, self.mechanism.touches(motions, s), rate[cut:])
        jacobian = self.mechanism.constraints(0.0, *np.split(place, [cut]))[1]
        return np.asarray(jacobian @ differentiated(lambda time: self.moved(time)[1], 1e-3) - q_d)


@pytest.mark.parametrize("kind", RAILS)
@pytest.mark.parametrize("whole", [True, False])
def test_jacobian_and_q_d_on_a_line_are_those_of_a_motion(
    kind: str, whole: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Eqs (3.59)-(3.72) with irregularities (5.3); without third derivatives, which bend the normal, Q_d is another."""
    waves = replace(section_5_3(), lateral_irregularity=5e-3, lateral_wave_number=0.2, irregularity_start=-3.0)
    rails = RAILS[kind](winding(), 0.0)
    mechanism = Mechanism(as_printed(tables_5_1_and_5_2()), thesis_pair(), 2, derivatives_along(waves), rails=rails)
    sweep = Sweep.of(mechanism, rolling(mechanism, 15.0))
    if not whole:
        own = RAILS[kind].rail
        straight_normal = lambda *given: replace(own(*given), normal_bend=np.zeros((3, 3, 3)))  # noqa: E731
        monkeypatch.setattr(RAILS[kind], "rail", straight_normal)
    first = differentiated(lambda time: sweep.constraints(time)[0], 1e-3)
    second = differentiated(lambda time: sweep.constraints(time)[1], 1e-3)
    assert relative(first, sweep.constraints(0.0)[1]) < MOTION_BAND
    assert (relative(second, sweep.second()) < MOTION_BAND) == whole


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference over the largest entry."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("kind", RAILS)
@pytest.mark.parametrize("whole", [True, False])
def test_rails_of_a_line_do_no_work(kind: str, whole: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Energy of wheelset and frame less the suspension's work, without friction; not with a wrong Q_d of (3.72)."""
    parameters = replace(as_printed(tables_4_1_and_4_2()), rolling_resistance_torque=0.0)
    mechanism = Mechanism(parameters, thesis_pair(), 1, rails=RAILS[kind](winding(), 0.0))
    state = rolling(mechanism, 15.0)
    if not whole:
        monkeypatch.setattr(mechanisms, "quadratic_terms", lambda *given: 0.999 * quadratic_terms(*given))
    size, smooth = 1e-3, Inputs(friction=(0.0, 0.0))
    states = [state, *run(mechanism, state, 0.03, size, lambda time: smooth)]
    found = np.array([energy_and_power(mechanism, one) for one in states])
    energy = found[::2, 0] - size / 3 * np.concatenate(
        [[0.0], np.cumsum(found[:-2:2, 1] + 4 * found[1:-1:2, 1] + found[2::2, 1])]
    )
    assert (np.ptp(energy) < ENERGY_BAND * found[0, 0]) == whole, np.ptp(energy) / found[0, 0]


def energy_and_power(mechanism: Mechanism, state: State) -> tuple[float, float]:
    """Kinetic energy and height of all bodies [J], and what the suspension gives them [W]."""
    motions, p, pushed = mechanism.motions(state.q, state.q_rate), mechanism.parameters, np.zeros(mechanism.q_count)
    mechanism.suspend(pushed, motions)
    masses = [p.wheelset_mass] * mechanism.wheelsets + [body.mass for body in mechanism.layout.upper]
    inertias = [mechanism.wheelset_inertia] * mechanism.wheelsets + [body.inertia for body in mechanism.layout.upper]
    moving = 0.5 * state.q_rate @ mechanism.mass_matrix(motions, masses, inertias) @ state.q_rate
    heights = [motion.position[2] for motion in motions[FIRST_WHEELSET:]]
    return float(moving + p.gravity * np.dot(masses, heights)), float(pushed @ state.q_rate)


# -- the prism and the true surface ----------------------------------------------------------------------------------

#: A line without curves is straight track: round-off, relative to the largest acceleration or force.
STRAIGHT_BAND = 1e-11
#: What the prism leaves out in a curve of 150 m, of the largest acceleration and of the largest normal force, at most;
#: measured 1.6e-4 and 2.3e-5, docs/checking.md. It goes with the curvature.
LEFT_OUT, SHARPEST = (3e-4, 3e-5), 150.0
#: Unbalanced lateral acceleration and cant to go with it [m/s2, m], and how far wheelsets turn outwards [rad].
UNBALANCED, CANT, ATTACK = 0.35, 0.1, -5e-3


@pytest.mark.parametrize("angle", [0.0, 30.0, 69.0])
def test_the_prism_stands_for_the_true_surface_as_far_as_measured(angle: float) -> None:
    """On the tread and at two angles of flange contact [deg], with a contact that leads."""
    tight, wide = (what_the_prism_leaves_out(radius, angle) for radius in (SHARPEST, 20 * SHARPEST))
    for near, far, most in zip(tight, wide, LEFT_OUT, strict=True):
        assert 1e-7 < near < most
        assert far < near / 5


def what_the_prism_leaves_out(radius: float, angle: float) -> tuple[float, float]:
    """Differences of accelerations, linear or angular, and of normal forces in a curve [m], each of the largest one."""
    speed = math.sqrt(radius * (UNBALANCED + 9.81 * CANT / GAUGE))
    line = line_of([arc(40.0, radius, CANT)], -20.0)
    kinds = [felt(*curving(kind(line, 0.0), speed, ATTACK, math.radians(angle))) for kind in RAILS.values()]
    linear, turning, force = (relative(swept, section) for section, swept in zip(*kinds, strict=True))
    return max(linear, turning), force


def felt(mechanism: Mechanism, state: State, answer: Answer) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Accelerations of all bodies [m/s2, rad/s2], and normal forces [N]."""
    bodies = [mechanism.body(number) for number in range(FIRST_WHEELSET, mechanism.bodies)]
    linear = [answer.q_second[body][:3] for body in bodies]
    turning = [g_bar(state.q[body][3:]) @ answer.q_second[body][3:] for body in bodies]
    return np.array(linear), np.array(turning), answer.normal_forces


@pytest.mark.parametrize("kind", RAILS)
def test_a_line_without_curves_is_straight_track(kind: str) -> None:
    line = line_of([straight(40.0)], -20.0)
    one, other = (felt(*curving(rails, 20.0, ATTACK, 0.0)) for rails in (STRAIGHT, RAILS[kind](line, 0.0)))
    for found, expected in zip(one, other, strict=True):
        assert relative(found, expected) < STRAIGHT_BAND


def test_what_chapter_3_does_not_have_on_a_line_is_refused() -> None:
    rails = SectionRails(line_of([arc(40.0, 300.0)], -20.0), 0.0)
    with pytest.raises(ValueError, match="Leave the speed of 15 m/s free"):
        Mechanism(as_printed(tables_5_1_and_5_2()), thesis_pair(), 2, speed=15.0, rails=rails)
    with pytest.raises(ValueError, match="A wheel or body is at 21 m; the line goes from -20 to 20 m"):
        rails.section(21.0)


def curving(rails: Rails, speed: float, yaw: float, angle: float) -> tuple[Mechanism, State, Answer]:
    """The bogie of chapter 5 in a curve to the left, both wheelsets turned by `yaw` [rad] against it: on their treads,
    3 mm outside of the middle, or (angle [rad] above 0) on the flanges of the outer wheels at this angle of contact.

    The flange's spring (3.106) is off: the contact itself carries.
    """
    parameters = replace(as_printed(tables_5_1_and_5_2()), flange_clearance=1.0)
    mechanism = Mechanism(parameters, thesis_pair(), 2, rails=rails)
    state = rolling(mechanism, speed)
    near, lateral = np.concatenate([state.q, state.s]), [-3e-3, -3e-3]
    turning, rolls = speed * rails.section(0.0).turning, speed / parameters.wheel_radius
    frames = []
    for upper, frame in zip(mechanism.layout.upper, frames_at_rest(mechanism), strict=True):
        frames.append(replace(frame, velocity=speed * rails.section(upper.along).axes[0, :, 0], omega=turning))

    def wheelsets(share: float) -> list[Wheelset]:
        places = zip(mechanism.layout.wheelsets, lateral, strict=True)
        return [Wheelset(at, aside, share * yaw, 0.0, speed, 0.0, float(turning[2]), rolls) for at, aside in places]

    if angle > 0.0:
        lift(mechanism, near, angle)
        for share in np.linspace(0.0, 1.0, 5):  # the flange's contact goes ahead as it turns
            near, lateral = on_flanges(mechanism, wheelsets(share), frames, near, angle)
    state = drive_to(mechanism, wheelsets(1.0), frames, near)
    return mechanism, state, mechanism.solve(state, Inputs(), mechanism.constraints(0.0, state.q, state.s)[1])


def lift(mechanism: Mechanism, near: np.ndarray, angle: float) -> None:
    """Puts the right wheels about where their flanges touch at a contact angle [rad]."""
    pair, radius = mechanism.pair, mechanism.parameters.wheel_radius
    on_wheel, on_rail = (place_of_angle(profile, angle) for profile in (pair.wheel, pair.rail))
    height = float(profile_derivatives(pair.rail, on_rail)[0] - profile_derivatives(pair.wheel, on_wheel)[0])
    roll = -height / (2 * pair.rail_half_distance)
    lateral = pair.wheel_half_distance + on_wheel - pair.rail_half_distance - on_rail - roll * radius
    s = near[mechanism.q_count :]
    for number in range(mechanism.wheelsets):
        body = near[mechanism.body(FIRST_WHEELSET + number)]
        axes = mechanism.rails.section(mechanism.place(number)).axes[0]
        body[:3] += axes @ [0.0, lateral, height / 2]
        body[3:] = composed(from_matrix(axes), from_angles(0.0, roll, 0.0))
        s[mechanism.wheel_parameters(2 * number)][1] = on_wheel
        s[mechanism.rail_parameters(2 * number)][1] = on_rail


def on_flanges(
    mechanism: Mechanism, wheelsets: list[Wheelset], frames: list[Frame], near: np.ndarray, angle: float
) -> tuple[np.ndarray, list[float]]:
    """Coordinates (3.79) with the contacts of the right wheels driven to an angle [rad] in place of the lateral shifts;
    these [m].
    """
    found, on_wheel = near.copy(), place_of_angle(mechanism.pair.wheel, angle)
    for _ in range(30):
        c, jacobian = mechanism.constraints(0.0, *np.split(found, [mechanism.q_count]))
        errors, rows = driving_constraints(mechanism, wheelsets, frames, found)
        for number in range(mechanism.wheelsets):
            column = mechanism.q_count + mechanism.wheel_parameters(2 * number).start + 1
            errors[4 * number + 1], rows[4 * number + 1] = found[column] - on_wheel, np.eye(1, found.size, column)[0]
        found -= np.linalg.solve(np.vstack([jacobian, rows]), np.concatenate([c, errors]))
    places = [found[mechanism.body(FIRST_WHEELSET + number)][:3] for number in range(mechanism.wheelsets)]
    there = [mechanism.rails.section(at) for at in mechanism.layout.wheelsets]
    return found, [float(section.from_origin(place)[1]) for section, place in zip(there, places, strict=True)]


def place_of_angle(profile: Profile, angle: float) -> float:
    """Where a profile is this steep [m], next to the middle towards the gauge."""
    places = np.linspace(*profile.limits, 40001)
    slopes = np.abs([profile_derivatives(profile, y)[1] for y in places])
    inner = np.flatnonzero((places < 0.0) & (slopes > math.tan(angle)))
    return float(places[inner[-1]])
