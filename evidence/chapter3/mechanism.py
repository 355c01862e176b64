"""The systems of sections 4.2, 5.2 and chapter 10: coordinates, constraints, forces, augmented equations (3.75)."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from evidence.chapter3.constraints import EQUATIONS, quadratic_terms, residual, sub_jacobian
from evidence.chapter3.creep import EllipseLaw, flange_force, hertz_ellipse, polach
from evidence.chapter3.euler import cross, mass_matrix, norm_error, quadratic_velocity
from evidence.chapter3.forces import BodyMotion, axle_box, between_frames, of_body_moment, of_force
from evidence.chapter3.layout import bogie_layout, inertia, vehicle_layout
from evidence.chapter3.surfaces import RailSurface, SurfacePoint, rail_surface, wheel_surface
from rbd_model.contact.geometry import Pair
from rbd_model.vehicle.parameters import AS_PRINTED, BogieParameters, VehicleParameters

#: Bodies in the order of (4.1), (5.1): right rail, left rail, wheelsets, bodies above. Contacts: right, then left, of
#: each wheelset.
RIGHT_RAIL, LEFT_RAIL, FIRST_WHEELSET = range(3)
SIDES = (-1, 1)
COORDINATES, PARAMETERS = 7, 2
#: Relative change of the normal forces at which their iteration ends, and its largest number of rounds.
NORMAL_FORCE_TOLERANCE, MAXIMUM_ROUNDS = 1e-14, 100

#: Lateral shift, heights of left and right rail [m], at a distance [m]: shape (3, 3), values and two derivatives.
Irregularity = Callable[[float], np.ndarray]


def perfect_track(distance: float) -> np.ndarray:
    """No irregularity, as section 4.2 has it; shape (3, 3)."""
    return np.zeros((3, 3))


@dataclass(frozen=True)
class MechanismInputs:
    """Inputs of the system, one value for each wheelset; a brake torque is a capacity [N.m]."""

    brake_torque: Sequence[float] = (0.0, 0.0)
    traction_torque: Sequence[float] = (0.0, 0.0)
    yaw_torque: Sequence[float] = (0.0, 0.0)
    friction: Sequence[float] = (0.3, 0.3)
    drawbar_force: float = 0.0


@dataclass
class MechanismState:
    """All coordinates and rates: q, s and their first derivatives, at a time [s].

    direction: of each wheelset's brake, 1 or -1 while it turns and 0 while it is locked.
    """

    time: float
    q: np.ndarray
    s: np.ndarray
    q_rate: np.ndarray
    s_rate: np.ndarray
    direction: list[int] = field(default_factory=lambda: [1, 1])


@dataclass(frozen=True)
class Solution:
    """Solution of (3.75): accelerations, normal forces [N] of the contacts, torque [N.m] of locked brakes (else 0)."""

    q_second: np.ndarray
    s_second: np.ndarray
    normal_forces: np.ndarray
    holding_torques: np.ndarray


@dataclass(frozen=True)
class ContactMotion:
    """One contact: the bodies' motions and surfaces at it."""

    number: int
    wheel_body: BodyMotion
    rail_body: BodyMotion
    wheel: SurfacePoint
    rail: RailSurface
    radius: np.ndarray  # r and its derivatives by the position on the profile

    @property
    def normal(self) -> np.ndarray:
        """Unit normal of the rail, upwards, in inertial axes."""
        return np.asarray(self.rail_body.axes @ self.rail.upwards)


class Mechanism:
    """One wheelset in a frame (wheelsets = 1, chapter 4), the two-axle bogie (2, chapter 5), or the vehicle (4).

    speed [m/s]: if given, held by a constraint, as for the comparison with VAMPIRE.

    Raises
    ------
    ValueError
        If the parameters need features that chapter 3 does not have: torques that react on the frame (3.36), a flange's
        force at the rail (3.106), two half spacings.
    """

    def __init__(
        self,
        parameters: BogieParameters,
        pair: Pair,
        wheelsets: int,
        irregularity: Irregularity = perfect_track,
        speed: float | None = None,
        ellipse: EllipseLaw = hertz_ellipse,
    ) -> None:
        for name, value in AS_PRINTED.items():
            if getattr(parameters, name) != value:
                got = getattr(parameters, name)
                raise ValueError(f"{name} must be {value:g} in chapter 3; got {got:g}. Use `as_printed`.")
        if parameters.longitudinal_half_spacing != parameters.vertical_half_spacing:
            raise ValueError(
                f"vertical_half_spacing must equal longitudinal_half_spacing, {parameters.longitudinal_half_spacing:g}"
                f" m, in chapter 3; got {parameters.vertical_half_spacing:g} m. Set both to one value."
            )
        self.parameters, self.pair, self.irregularity, self.ellipse = parameters, pair, irregularity, ellipse
        self.wheelsets, self.speed = wheelsets, speed
        if isinstance(parameters, VehicleParameters):
            self.layout = vehicle_layout(parameters)
        else:
            self.layout = bogie_layout(parameters, wheelsets)
        self.frame = FIRST_WHEELSET + wheelsets
        self.bodies = self.frame + len(self.layout.upper)
        self.contacts = 2 * wheelsets
        self.q_count, self.s_count = COORDINATES * self.bodies, 2 * PARAMETERS * self.contacts
        self.unknowns = self.q_count + self.s_count
        # Euler parameters (3.6), contacts, six for each rail on the ground, the frame's pitch in chapter 4, the speed.
        self.equations = self.bodies + EQUATIONS * self.contacts + 12 + self.layout.level + (speed is not None)
        self.wheelset_inertia = inertia(parameters, "wheelset")
        carried = sum(body.mass for body in self.layout.upper) + wheelsets * parameters.wheelset_mass
        self.normal_guess = np.full(self.contacts, carried * parameters.gravity / self.contacts)

    @property
    def degrees_of_freedom(self) -> int:
        """Coordinates that no constraint holds."""
        return self.unknowns - self.equations

    def place(self, wheelset: int) -> float:
        """Place of a wheelset along the vehicle [m]; one alone is below the frame's centre."""
        return self.layout.wheelsets[wheelset]

    # -- coordinates ---------------------------------------------------------------------------------------------

    def body(self, number: int) -> slice:
        """Return the indices of a body's coordinates in q, eqs (4.1), (5.1)."""
        return slice(COORDINATES * number, COORDINATES * (number + 1))

    def rail_parameters(self, contact: int) -> slice:
        """Return the indices of a contact's parameters on the rail in s, eqs (4.2), (5.2)."""
        return slice(PARAMETERS * contact, PARAMETERS * (contact + 1))

    def wheel_parameters(self, contact: int) -> slice:
        """Return the indices of a contact's parameters on the wheel in s, eqs (4.2), (5.2)."""
        return self.rail_parameters(self.contacts + contact)

    def shift_of(self, side: int, distance: float) -> np.ndarray:
        """Return the shift of one rail, to the left and upwards (5.3), (5.4): shape (3, 2) [m]."""
        return self.irregularity(distance)[:, [0, 2 if side < 0 else 1]]

    def motions(self, q: np.ndarray, q_rate: np.ndarray) -> list[BodyMotion]:
        """Motions of all bodies from their coordinates and rates, shapes (q_count,)."""
        return [BodyMotion.of(q[self.body(n)], q_rate[self.body(n)]) for n in range(self.bodies)]

    def touches(self, motions: Sequence[BodyMotion], s: np.ndarray) -> list[ContactMotion]:
        """All contacts: right and left rail with the wheels of each wheelset."""
        made = []
        half, rail_half = self.pair.wheel_half_distance, self.pair.rail_half_distance
        for wheelset in range(self.wheelsets):
            wheel_body = motions[FIRST_WHEELSET + wheelset]
            distance = float(wheel_body.position[0])
            for rail_number, side in enumerate(SIDES):
                number = 2 * wheelset + rail_number
                wheel, radius = wheel_surface(
                    self.pair.wheel, self.parameters.wheel_radius, half, side, s[self.wheel_parameters(number)]
                )
                parameters, shift = s[self.rail_parameters(number)], self.shift_of(side, distance)
                rail = rail_surface(self.pair.rail, rail_half, side, parameters, shift)
                made.append(ContactMotion(number, wheel_body, motions[rail_number], wheel, rail, radius))
        return made

    # -- constraints ---------------------------------------------------------------------------------------------

    def constraints(self, time: float, q: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """C (equations,) and its Jacobian by (q, s) (equations, unknowns), eqs (3.59), (3.60), (3.66)."""
        motions = self.motions(q, np.zeros(self.q_count))
        c, jacobian = np.zeros(self.equations), np.zeros((self.equations, self.unknowns))
        row = 0
        for number, body in enumerate(motions):  # (3.6)
            c[row] = norm_error(body.theta)
            jacobian[row, self.body(number)][3:] = 2.0 * body.theta
            row += 1
        for touch in self.touches(motions, s):
            c[row : row + EQUATIONS] = residual(touch.wheel_body, touch.rail_body, touch.wheel, touch.rail)
            blocks = sub_jacobian(touch.wheel_body, touch.rail_body, touch.wheel, touch.rail)
            rows = jacobian[row : row + EQUATIONS]
            rows[:, self.body(FIRST_WHEELSET + touch.number // 2)] = blocks.wheel
            rows[:, self.body(touch.number % 2)] = blocks.rail
            columns = self.rail_parameters(touch.number)
            rows[:, self.q_count + columns.start : self.q_count + columns.stop] = blocks.rail_parameters
            columns = self.wheel_parameters(touch.number)
            rows[:, self.q_count + columns.start : self.q_count + columns.stop] = blocks.wheel_parameters
            row += EQUATIONS
        for rail in (RIGHT_RAIL, LEFT_RAIL):  # the ground holds R = 0 and the last three Euler parameters = 0
            held = [COORDINATES * rail + i for i in (0, 1, 2, 4, 5, 6)]
            c[row : row + 6] = q[held]
            jacobian[range(row, row + 6), held] = 1.0
            row += 6
        frame = motions[self.frame]
        if self.layout.level:  # the frame's longitudinal axis stays level: no pitch, section 4.2
            c[row] = frame.axes[2, 0]
            jacobian[row, self.body(self.frame)][3:] = -cross(frame.axes[2], np.array([1.0, 0.0, 0.0])) @ frame.g
            row += 1
        if self.speed is not None:
            c[row] = frame.position[0] - self.speed * time
            jacobian[row, COORDINATES * self.frame] = 1.0
        return c, jacobian

    @property
    def time_derivative(self) -> np.ndarray:
        """C_t, eq. (3.68): only a held speed depends on time."""
        out = np.zeros(self.equations)
        if self.speed is not None:
            out[-1] = -self.speed
        return out

    def quadratic(
        self, motions: Sequence[BodyMotion], touches: Sequence[ContactMotion], s_rate: np.ndarray
    ) -> np.ndarray:
        """Q_d, shape (equations,), eq. (3.72)."""
        out = np.zeros(self.equations)
        out[: self.bodies] = [-2.0 * float(body.theta_rate @ body.theta_rate) for body in motions]
        row = self.bodies
        for touch in touches:
            rates = s_rate[self.wheel_parameters(touch.number)], s_rate[self.rail_parameters(touch.number)]
            out[row : row + EQUATIONS] = quadratic_terms(
                touch.wheel_body, touch.rail_body, touch.wheel, touch.rail, rates
            )
            row += EQUATIONS
        if self.layout.level:
            frame, x = motions[self.frame], np.array([1.0, 0.0, 0.0])
            out[row + 12] = -float(frame.axes[2] @ cross(frame.omega, cross(frame.omega, x)))
        return out

    # -- forces --------------------------------------------------------------------------------------------------

    def applied(self, state: MechanismState, inputs: MechanismInputs, motions: Sequence[BodyMotion]) -> np.ndarray:
        """Q_e + Q_v of (3.73), (3.76) without creep forces, shape (q_count,)."""
        p = self.parameters
        q = np.zeros(self.q_count)
        for number, upper in enumerate(self.layout.upper, self.frame):
            body = motions[number]
            total = quadratic_velocity(upper.inertia, body.theta_rate, body.omega)
            total[2] -= upper.mass * p.gravity
            q[self.body(number)] = total
        q[self.body(self.frame)][0] += inputs.drawbar_force
        for number in range(self.wheelsets):
            body = motions[FIRST_WHEELSET + number]
            total = quadratic_velocity(self.wheelset_inertia, body.theta_rate, body.omega)
            total[2] -= p.wheelset_mass * p.gravity
            total[1] += self.flange(body)
            total += self.torques(number, state, inputs, body)
            q[self.body(FIRST_WHEELSET + number)] = total
        self.suspend(q, motions)
        return q

    def flange(self, body: BodyMotion) -> float:
        """Force of the rails on the flanges of a wheelset to the left, eq. (3.106) [N]."""
        offset = float(body.position[1] - self.irregularity(float(body.position[0]))[0, 0])
        return float(flange_force(offset, self.parameters.flange_clearance, self.parameters.flange_stiffness))

    def suspend(self, q: np.ndarray, motions: Sequence[BodyMotion]) -> None:
        """Adds the generalised forces of all suspension elements, (3.33), (3.34)."""
        for element in self.layout.elements:
            number = FIRST_WHEELSET + element.lower if element.on_wheelset else self.frame + element.lower
            below = np.array([self.place(element.lower), 0.0, 0.0])
            lower = below if element.on_wheelset else self.layout.upper[element.lower].centre
            above = self.frame + element.upper
            upper = self.layout.upper[element.upper].centre
            act = axle_box if element.on_wheelset else between_frames
            pull, reaction = act(
                *(motions[number], element.place - lower, motions[above], element.place - upper),
                (element.stiffness, element.damping, element.load),
            )
            q[self.body(number)] += pull
            q[self.body(above)] += reaction

    def torques(self, number: int, state: MechanismState, inputs: MechanismInputs, body: BodyMotion) -> np.ndarray:
        """Return brake, traction, rolling resistance and yaw torque on a wheelset, eq. (3.36).

        This differs from the thesis. The yaw torque of chapter 9 acts about the axis at right angles to the axle, in
        the upright longitudinal section of the track through it. Shoe forces at the height of the axle have this
        effect. With yaw_torque_rotates it acts about the third axis of the body, which turns with the wheel: G bar
        instead of G in (3.36).
        """
        capacity = inputs.brake_torque[number] + self.parameters.rolling_resistance_torque
        axle = inputs.traction_torque[number] - state.direction[number] * capacity
        moment = np.array([0.0, axle, 0.0])
        yaw = inputs.yaw_torque[number]
        if self.parameters.yaw_torque_rotates:
            moment[2] += yaw
        else:
            up = body.axes[2].copy()
            up[1] = 0.0
            moment += yaw * up / math.hypot(up[0], up[2])
        return of_body_moment(body, moment)

    def creepages(self, touch: ContactMotion) -> tuple[float, float, float, np.ndarray, np.ndarray]:
        """Return longitudinal, lateral and spin creepage, and the directions of the first two, in inertial axes.

        This differs from the thesis: they are divided by sqrt(V^2 + v_eps^2), because V is 0 at rest.
        """
        body = touch.wheel_body
        along = touch.rail_body.axes @ touch.rail.tangents[:, 0]
        sideways = cross(touch.normal, along)
        sliding = body.velocity_of(touch.wheel.point)
        omega = body.axes @ body.omega
        slowness = 1.0 / math.hypot(float(body.velocity[0]), self.parameters.creepage_speed)
        return (
            float(sliding @ along) * slowness,
            float(sliding @ sideways) * slowness,
            float(omega @ touch.normal) * slowness,
            along,
            sideways,
        )

    def curvatures(self, touch: ContactMotion) -> tuple[float, float]:
        """A and B of (3.83) [1/m]; a rail that is a prism has no curvature along the track."""
        r = touch.radius
        slope = math.hypot(1.0, r[1])
        return 0.5 / (r[0] * slope), (touch.rail.curvature - r[2] / slope**3) / 2

    # -- the augmented equations ---------------------------------------------------------------------------------

    def solve(self, state: MechanismState, inputs: MechanismInputs, jacobian: np.ndarray) -> Solution:
        """Return accelerations and multipliers from (3.75); jacobian: (C_q C_s) at the state.

        The creep forces depend on the normal forces, which are multipliers (3.81): both are iterated to round-off. The
        thesis does not give the instant at which it takes them.
        """
        motions = self.motions(state.q, state.q_rate)
        touches = self.touches(motions, state.s)
        locked = [n for n in range(self.wheelsets) if state.direction[n] == 0]
        size = self.unknowns + self.equations + len(locked)
        matrix = np.zeros((size, size), order="F")
        inertias = [self.wheelset_inertia] * self.wheelsets + [body.inertia for body in self.layout.upper]
        masses = [self.parameters.wheelset_mass] * self.wheelsets + [body.mass for body in self.layout.upper]
        matrix[: self.q_count, : self.q_count] = self.mass_matrix(motions, masses, inertias)
        rows = slice(self.unknowns, self.unknowns + self.equations)
        matrix[rows, : self.unknowns] = jacobian
        matrix[: self.unknowns, rows] = jacobian.T
        for extra, number in enumerate(locked, self.unknowns + self.equations):
            body = motions[FIRST_WHEELSET + number]
            start = COORDINATES * (FIRST_WHEELSET + number) + 3
            matrix[extra, start : start + 4] = matrix[start : start + 4, extra] = body.g[1]

        creep = [self.creepages(touch) for touch in touches]
        right = np.zeros((size, 1 + 2 * self.contacts), order="F")
        right[: self.q_count, 0] = self.applied(state, inputs, motions)
        right[rows, 0] = self.quadratic(motions, touches, state.s_rate)
        for touch, (*_, along, sideways) in zip(touches, creep, strict=True):
            columns = self.body(FIRST_WHEELSET + touch.number // 2)
            for i, direction in enumerate((along, sideways)):
                right[columns, 1 + 2 * touch.number + i] = of_force(touch.wheel_body, direction, touch.wheel.point)
        factors, pivots, failed = dgetrf(matrix, overwrite_a=True)
        if failed:
            raise ArithmeticError(f"The augmented matrix (3.75) is singular at {state.time:.6g} s.")
        solution, _ = dgetrs(factors, pivots, right)
        return self._balance(touches, creep, inputs, solution, locked)

    def mass_matrix(
        self, motions: Sequence[BodyMotion], masses: Sequence[float], inertias: Sequence[np.ndarray]
    ) -> np.ndarray:
        """Return M of (3.73). The rails stand on the ground: their mass has no effect, here 1 kg and 1 kg.m2."""
        matrix = np.zeros((self.q_count, self.q_count))
        every = [1.0, 1.0, *masses], [np.ones(3), np.ones(3), *inertias]
        for number, (body, mass, moments) in enumerate(zip(motions, *every, strict=True)):
            columns = self.body(number)
            matrix[columns, columns] = mass_matrix(mass, moments, body.theta)
        return matrix

    def _balance(
        self,
        touches: Sequence[ContactMotion],
        creep: Sequence[tuple],
        inputs: MechanismInputs,
        solution: np.ndarray,
        locked: list[int],
    ) -> Solution:
        """Return the creep forces that match the normal forces; solution: of the loads, and of unit creep forces."""
        first = self.unknowns + self.bodies
        # The multipliers of a contact's point are the force of the wheel on the rail, eq. (3.81).
        starts = range(first, first + EQUATIONS * self.contacts, EQUATIONS)
        response = -np.array([t.normal @ solution[at : at + 3] for t, at in zip(touches, starts, strict=True)])
        load = self.normal_guess
        p = self.parameters
        for _ in range(MAXIMUM_ROUNDS):
            forces = [1.0]
            for touch, (x, y, spin, _, _) in zip(touches, creep, strict=True):
                a, b = self.curvatures(touch)
                carried = max(float(load[touch.number]), 1.0)
                ellipse = self.ellipse(a, b, carried, p.shear_modulus)
                friction = max(inputs.friction[touch.number // 2], 1e-9)
                forces += polach((x, y, spin), carried, friction, ellipse, p.shear_modulus)
            previous, load = load, response @ np.array(forces)
            if np.abs(load - previous).max() <= NORMAL_FORCE_TOLERANCE * np.abs(load).max():
                break
        else:
            raise ArithmeticError("Normal and creep forces do not settle; reduce the step.")
        self.normal_guess = load
        found = solution @ np.array(forces)
        torques = np.zeros(self.wheelsets)
        torques[locked] = -found[self.unknowns + self.equations :]
        return Solution(found[: self.q_count], found[self.q_count : self.unknowns], load, torques)
