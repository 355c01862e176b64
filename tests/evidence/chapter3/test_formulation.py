"""The parts of chapter 3: Euler parameters, forces, surfaces, constraints and their derivatives, contact laws."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from evidence.chapter3 import constraints, euler, forces
from evidence.chapter3.creep import Ellipse, flange_force, hertz_ellipse, polach
from evidence.chapter3.forces import BodyMotion
from evidence.chapter3.kinematic_analysis import rolling
from evidence.chapter3.mechanism import Mechanism
from evidence.chapter3.surfaces import OffTheProfileError, profile_derivatives, rail_surface, wheel_surface
from rbd_model.contact.creep.kalker import Kalker, kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.polach import polach as polach_forces
from rbd_model.contact.geometry import thesis_pair
from rbd_model.contact.hertz import ellipse_shape
from rbd_model.contact.profiles import Profile
from rbd_model.vehicle.parameters import as_printed, tables_4_1_and_4_2, tables_5_1_and_5_2

#: Tolerance by docs/checking.md of derivatives by hand against automatic differentiation.
DERIVATIVE_BAND = 1e-9
IDENTITY_BAND = 1e-13


def random_theta(rng: np.random.Generator) -> np.ndarray:
    theta = rng.normal(size=4)
    return np.asarray(theta / np.linalg.norm(theta))


def random_motion(rng: np.random.Generator) -> BodyMotion:
    theta = random_theta(rng)
    rate = rng.normal(size=4)
    rate -= theta * (theta @ rate)
    return BodyMotion.of(np.concatenate([rng.normal(size=3), theta]), np.concatenate([rng.normal(size=3), rate]))


# -- Euler parameters, eqs (3.1)-(3.28) --------------------------------------------------------------------------


def test_rotation_matrix_is_that_of_the_quaternion() -> None:
    """Eqs (3.2), (3.5), (3.6), against SciPy."""
    rng = np.random.default_rng(1)
    for _ in range(10):
        theta = random_theta(rng)
        other = Rotation.from_quat([*theta[1:], theta[0]]).as_matrix()
        assert np.abs(euler.rotation_matrix(theta) - other).max() < IDENTITY_BAND
        assert abs(euler.norm_error(theta)) < IDENTITY_BAND


def test_angles_are_yaw_then_roll_then_pitch() -> None:
    """Eq. (3.2) at Rz(yaw) Rx(roll) Ry(pitch), against SciPy."""
    found = euler.rotation_matrix(euler.from_angles(0.3, -0.2, 2.5))
    assert np.abs(found - Rotation.from_euler("ZXY", [0.3, -0.2, 2.5]).as_matrix()).max() < IDENTITY_BAND


def test_angular_velocity_is_that_of_the_rotation_matrix() -> None:
    """Eqs (3.7)-(3.14): dA/dt = A omega~, here by automatic differentiation of (3.2)."""
    rng = np.random.default_rng(2)
    symbol = ca.SX.sym("theta", 4)
    rotation = ca.Function("A", [symbol], [symbolic_rotation(symbol)])
    derivative = ca.Function("dA", [symbol], [ca.jacobian(ca.vec(symbolic_rotation(symbol)), symbol)])
    for _ in range(5):
        body = random_motion(rng)
        rate = np.array(derivative(body.theta) @ body.theta_rate).reshape(3, 3, order="F")
        assert np.abs(rate - np.array(rotation(body.theta)) @ euler.skew(body.omega)).max() < IDENTITY_BAND
        assert np.abs(euler.theta_rate_of(body.theta, body.omega) - body.theta_rate).max() < IDENTITY_BAND
        assert np.abs(euler.skew(body.omega) @ np.ones(3) - euler.cross(body.omega, np.ones(3))).max() < IDENTITY_BAND


def test_free_body_turns_as_euler_said() -> None:
    """Mass matrix (3.20)-(3.28), Q_v (3.74), (3.6) give I alpha = -omega x I omega. The published (3.74) does not."""
    rng = np.random.default_rng(3)
    inertia = np.array([720.0, 112.0, 300.0])
    for _ in range(5):
        body = random_motion(rng)
        matrix = np.zeros((8, 8))
        matrix[:7, :7] = euler.mass_matrix(1200.0, inertia, body.theta)
        matrix[7, 3:7] = matrix[3:7, 7] = 2 * body.theta

        def alpha(q_v: np.ndarray, body: BodyMotion = body, matrix: np.ndarray = matrix) -> np.ndarray:
            right = np.concatenate([q_v, [-2 * body.theta_rate @ body.theta_rate]])
            return np.asarray(body.g @ np.linalg.solve(matrix, right)[3:7])

        expected = -euler.cross(body.omega, inertia * body.omega) / inertia
        found = alpha(euler.quadratic_velocity(inertia, body.theta_rate, body.omega))
        assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()
        printed = np.concatenate([np.zeros(3), -2 * body.g.T @ (inertia * body.omega)])
        assert np.abs(alpha(printed) - expected).max() > 0.1 * np.abs(expected).max()
        energy = 0.5 * body.theta_rate @ matrix[3:7, 3:7] @ body.theta_rate
        assert energy == pytest.approx(0.5 * inertia @ body.omega**2, rel=1e-12)


# -- generalised forces, eqs (3.29)-(3.45) -----------------------------------------------------------------------


def test_generalised_forces_do_the_work_of_the_forces() -> None:
    """Eqs (3.29)-(3.36): the generalised force has the power of the force at its point, or of the moment."""
    rng = np.random.default_rng(4)
    for _ in range(5):
        body, force, place = random_motion(rng), rng.normal(size=3), rng.normal(size=3)
        rates = np.concatenate([body.velocity, body.theta_rate])
        assert forces.of_force(body, force, place) @ rates == pytest.approx(force @ body.velocity_of(place), rel=1e-12)
        assert forces.of_moment(body, force) @ rates == pytest.approx(force @ (body.axes @ body.omega), rel=1e-12)


def test_spring_forces_come_from_their_potential() -> None:
    """Eqs (3.1), (3.3), (3.4), (3.37)-(3.42): an element's power is the decrease of its energy, less the damping."""
    rng = np.random.default_rng(5)
    i, j, place_i, place_j = random_motion(rng), random_motion(rng), rng.normal(size=3), rng.normal(size=3)
    between = i.point(place_i) - j.point(place_j)
    length = np.linalg.norm(between)
    rate = between @ (i.velocity_of(place_i) - j.velocity_of(place_j)) / length
    for damping in (0.0, 30.0):
        on_i, on_j = forces.spring_damper(i, place_i, j, place_j, (1e3, damping, 0.4))
        power = on_i @ np.concatenate([i.velocity, i.theta_rate]) + on_j @ np.concatenate([j.velocity, j.theta_rate])
        assert power == pytest.approx(-(1e3 * (length - 0.4) + damping * rate) * rate, rel=1e-12)


def test_torsional_element_loses_what_its_spring_gains() -> None:
    """Eqs (3.43)-(3.45)."""
    rng = np.random.default_rng(6)
    i, j, axis = random_motion(rng), random_motion(rng), np.array([0.0, 0.6, 0.8])
    on_i, on_j = forces.torsional_spring_damper(i, j, axis, 0.01, (1e4, 50.0))
    power = on_i @ np.concatenate([i.velocity, i.theta_rate]) + on_j @ np.concatenate([j.velocity, j.theta_rate])
    rate = axis @ (i.axes @ i.omega - j.axes @ j.omega)
    assert power == pytest.approx(-(1e4 * 0.01 + 50.0 * rate) * rate, rel=1e-12)


def test_axle_box_is_three_long_springs_at_right_angles() -> None:
    """Tables 4.1 and 5.1 against three elements (3.37), 1 km long, anchored on the box; the error is stretch over
    length.

    Their moment about the axle acts on the frame, since the wheelset turns freely in its boxes.
    """
    rng = np.random.default_rng(7)
    wheelset = BodyMotion.of(np.array([0.0, 0.0, 0.425, 1.0, 0.0, 0.0, 0.0]), np.array([15, 0.1, 0, 0, 0.02, 0, 0.01]))
    frame = BodyMotion.of(np.array([0.0, 0.0, 1.2, 1.0, 0.0, 0.0, 0.0]), np.array([15.1, 0.0, 0.1, 0, 0, 0, 0]))
    place, in_frame = np.array([0.0, 0.7, 0.0]), np.array([0.0, 0.7, -0.775]) + 1e-3 * rng.normal(size=3)
    stiffness, damping = np.array([9.5e6, 6e6, 3.5e6]), np.array([8e4, 4e4, 2.5e4])
    boxes = forces.axle_box(wheelset, place, frame, in_frame, (stiffness, damping, 0.0))
    length, springs, about_axle = 1e3, [np.zeros(7), np.zeros(7)], np.zeros(3)
    for axis in range(3):
        anchor = place - length * np.eye(3)[axis]
        law = (stiffness[axis], damping[axis], length)
        pair = forces.spring_damper(wheelset, anchor, frame, in_frame, law)
        springs = [total + one for total, one in zip(springs, pair, strict=True)]
        about_axle[1] += np.cross(anchor, pair[0][:3])[1]
    expected = springs[0] - forces.of_moment(wheelset, about_axle), springs[1] + forces.of_moment(frame, about_axle)
    for box, total in zip(boxes, expected, strict=True):
        assert np.abs(total - box).max() < 1e-5 * np.abs(box).max()


# -- surfaces and constraints, eqs (3.46)-(3.78), Appendix I -----------------------------------------------------


def symbolic_rotation(theta: ca.SX) -> ca.SX:
    """Return the rotation by a quaternion of any length; its derivative along the quaternion is zero."""
    q = theta / ca.norm_2(theta)
    v = q[1:]
    return (q[0] ** 2 - ca.dot(v, v)) * ca.SX.eye(3) + 2 * v @ v.T + 2 * q[0] * ca.skew(v)


def symbolic_profile(profile: Profile, at: float, symbol: ca.SX) -> ca.SX:
    breakpoints, coefficients = profile.pieces
    piece = int(np.searchsorted(breakpoints, at, "right")) - 1
    return ca.polyval(ca.DM(coefficients[piece][::-1].copy()), symbol - breakpoints[piece])


def symbolic_contact(side: int, s_wheel: np.ndarray, s_rail: np.ndarray, wave: ca.SX, x: ca.SX) -> ca.SX:
    """Return C of (3.56), (3.58) for x = (q^i, q^j, s^i, s^j); wave: lateral and vertical irregularity over x[0]."""
    pair, radius = thesis_pair(), 0.425
    wheel_at, rail_at = x[14:16], x[16:18]
    r = radius - symbolic_profile(pair.wheel, s_wheel[1], wheel_at[1])
    outward = side * (pair.wheel_half_distance + wheel_at[1])
    wheel = ca.vertcat(r * ca.sin(wheel_at[0]), outward, -r * ca.cos(wheel_at[0]))
    height = symbolic_profile(pair.rail, s_rail[1], rail_at[1])
    shift = ca.substitute(wave, ca.symvar(wave)[0], x[0])
    rail = ca.vertcat(rail_at[0], side * (pair.rail_half_distance + rail_at[1]) + shift[0], height + shift[1])
    a_i, a_j = symbolic_rotation(x[3:7]), symbolic_rotation(x[10:14])
    tangents, edges = ca.jacobian(wheel, wheel_at), ca.jacobian(rail, rail_at)
    normal = ca.cross(edges[:, 0], edges[:, 1])
    point = x[:3] + a_i @ wheel - x[7:10] - a_j @ rail
    return ca.vertcat(point, (a_i @ tangents).T @ (a_j @ normal))


@pytest.mark.parametrize("side", [1, -1])
def test_sub_jacobians_and_q_d_are_those_of_automatic_differentiation(side: int) -> None:
    """Eqs (3.15)-(3.19), (3.46)-(3.72), (3.77), (3.78) at random states, with and without contact."""
    rng = np.random.default_rng(8)
    pair = thesis_pair()
    along = ca.SX.sym("along")
    wave = ca.vertcat(0.01 * ca.sin(0.3 * along), 0.005 * ca.cos(0.4 * along))
    waves = ca.horzcat(wave, ca.jacobian(wave, along), ca.jacobian(ca.jacobian(wave, along), along)).T
    irregularity = ca.Function("irregularity", [along], [waves])
    for _ in range(5):
        i, j = random_motion(rng), random_motion(rng)
        s_i, s_j = np.array([rng.uniform(0, 6), rng.uniform(-0.02, 0.02)]), np.array([3.0, rng.uniform(-0.02, 0.02)])
        s_rate_i, s_rate_j = rng.normal(size=2), rng.normal(size=2)
        x = ca.SX.sym("x", 18)
        c = symbolic_contact(side, s_i, s_j, wave, x)
        rate = ca.SX.sym("rate", 18)
        second = ca.jtimes(ca.jtimes(c, x, rate), x, rate)
        exact = ca.Function("exact", [x, rate], [c, ca.jacobian(c, x), second])
        at = np.concatenate([i.position, i.theta, j.position, j.theta, s_i, s_j])
        rates = np.concatenate([i.velocity, i.theta_rate, j.velocity, j.theta_rate, s_rate_i, s_rate_j])
        value, jacobian, quadratic = (np.array(m) for m in exact(at, rates))

        wheel, _ = wheel_surface(pair.wheel, 0.425, pair.wheel_half_distance, side, s_i)
        shift = np.array(irregularity(i.position[0]))
        rail = rail_surface(pair.rail, pair.rail_half_distance, side, s_j, shift)
        found = constraints.sub_jacobian(i, j, wheel, rail)
        blocks = np.hstack([found.wheel, found.rail, found.wheel_parameters, found.rail_parameters])
        assert np.abs(constraints.residual(i, j, wheel, rail) - value.ravel()).max() < DERIVATIVE_BAND
        assert np.abs(blocks - jacobian).max() < DERIVATIVE_BAND * np.abs(jacobian).max()
        terms = constraints.quadratic_terms(i, j, wheel, rail, (s_rate_i, s_rate_j))
        assert np.abs(terms + quadratic.ravel()).max() < DERIVATIVE_BAND * np.abs(quadratic).max()


def test_profile_without_a_point_is_no_surface() -> None:
    pair = thesis_pair()
    assert profile_derivatives(pair.wheel, 0.0)[0] == pytest.approx(float(pair.wheel.height(np.array(0.0))), abs=1e-15)
    with pytest.raises(OffTheProfileError, match="y = 90 mm has left the profile synthetic wheel 1:20"):
        profile_derivatives(pair.wheel, 0.09)


@pytest.mark.parametrize("wheelsets", [1, 2])
def test_jacobian_of_the_system_is_the_change_of_its_constraints(wheelsets: int) -> None:
    """Eqs (3.59), (3.60), (3.66)-(3.68): central differences along admissible directions."""
    rng = np.random.default_rng(9)
    parameters = as_printed(tables_4_1_and_4_2() if wheelsets == 1 else tables_5_1_and_5_2())
    mechanism = Mechanism(parameters, thesis_pair(), wheelsets, speed=15.0)
    state = rolling(Mechanism(parameters, thesis_pair(), wheelsets), 15.0)
    at, cut = np.concatenate([state.q, state.s]), mechanism.q_count
    direction = rng.normal(size=at.size) * 1e-2
    for body in range(mechanism.bodies):
        theta = mechanism.body(body).start + 3
        direction[theta : theta + 4] -= at[theta : theta + 4] * (at[theta : theta + 4] @ direction[theta : theta + 4])
    h = 1e-5
    ahead, back = (mechanism.constraints(t, *np.split(at + t * direction, [cut]))[0] for t in (h, -h))
    _, jacobian = mechanism.constraints(0.0, state.q, state.s)
    change = jacobian @ direction + mechanism.time_derivative
    assert np.abs((ahead - back) / (2 * h) - change).max() < 1e-8


# -- contact laws, eqs (3.82)-(3.106) ----------------------------------------------------------------------------


@pytest.mark.parametrize(("a", "b"), [(1.2, 1.7), (1.2, 0.3), (1.2, 9.0)])
def test_exact_ellipse_is_that_of_the_planar_level(a: float, b: float) -> None:
    """Eqs (3.82)-(3.88): SciPy's elliptic integrals against the arithmetic-geometric mean."""
    found = hertz_ellipse(a, b, 1.5e5, 82e9)
    other = ellipse_shape(0.5 / a, 0.0, 0.5 / b, 82e9)
    growth = 1.5e5 ** (1 / 3)
    assert found.along == pytest.approx(float(other.longitudinal) * growth, rel=1e-10)
    assert found.across == pytest.approx(float(other.lateral) * growth, rel=1e-10)
    kalker = kalker_coefficients(ca.SX(other.axis_ratio))
    assert found.kalker == pytest.approx([float(kalker.c11), float(kalker.c22), float(kalker.c23)], rel=1e-9)


def test_creep_forces_as_printed_are_those_of_the_fast_model() -> None:
    """Eqs (3.89)-(3.105) with roots and branches against the smooth form, at random creepages."""
    rng = np.random.default_rng(10)
    ellipse = Ellipse(6e-3, 5e-3, (4.1, 3.7, 1.5))
    for _ in range(200):
        size = 10.0 ** rng.uniform(-6, -1)
        x, y, spin = size * rng.normal(), size * rng.normal(), 100 * size * rng.normal()
        found = polach((x, y, spin), 1.5e5, 0.3, ellipse, 82e9)
        other = polach_forces(ContactPatch((x, y, spin), 1.5e5, 0.3, (6e-3, 5e-3), 82e9, Kalker(*ellipse.kalker)))
        assert found == pytest.approx([float(value) for value in other], rel=1e-9, abs=1e-5)


def test_small_creepages_give_kalkers_linear_forces() -> None:
    """Slopes of (3.97)-(3.103): -G a b c11, -G a b c22, and in pure spin -G (a b)^1.5 c23."""
    a, b, modulus, ellipse = 6e-3, 5e-3, 82e9, Ellipse(6e-3, 5e-3, (4.1, 3.7, 1.5))
    tiny = 1e-9
    assert polach((tiny, 0, 0), 1.5e5, 0.3, ellipse, modulus)[0] == pytest.approx(
        -modulus * a * b * 4.1 * tiny, rel=1e-5
    )
    assert polach((0, tiny, 0), 1.5e5, 0.3, ellipse, modulus)[1] == pytest.approx(
        -modulus * a * b * 3.7 * tiny, rel=1e-5
    )
    pure_spin = polach((0, 0, tiny), 1.5e5, 0.3, ellipse, modulus)[1]
    assert pure_spin == pytest.approx(-modulus * (a * b) ** 1.5 * 1.5 * tiny, rel=2e-2)
    assert polach((0, 0, 0), 1.5e5, 0.3, ellipse, modulus) == (0.0, 0.0)


def test_flange_pushes_back_beyond_the_clearance() -> None:
    """Eq. (3.106)."""
    assert flange_force(9e-3, 9.5e-3, 1e8) == 0.0
    assert flange_force(10e-3, 9.5e-3, 1e8) == pytest.approx(-5e4)
    assert flange_force(-10e-3, 9.5e-3, 1e8) == pytest.approx(5e4)
