"""One driven wheelset with torsion: frequencies, onset of self-excited torsion, spin, energy, by closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from brake_controller.motors import traction_inverter
from fmu_src.kernel import Kernel, Library, SimulationError
from products.building import kernel_of
from products.driven_wheelset import BOTH_ELASTIC, ELASTIC_AXLE, ELASTIC_DRIVE, RIGID, SHAFTS
from rbd_model.wheelset.driven import DrivenParameters, electric_locomotive
from scenarios.bench.ringing import modes_in

P, MOTOR = electric_locomotive(), traction_inverter()
#: Steel on steel (Hertz, Kalker) at G = 82 GPa and nu = 0.25; Kalker's c11 of a circle (1990, table E.3).
MODULUS, RATIO, C11, GRAVITY = 82e9, 0.25, 4.12, 9.81
#: Largest errors of frequencies and of the slip at which torsion begins to grow, as shares of the value.
FREQUENCY, ONSET = 1e-3, 0.02
#: Dry rail of Polach (2005), Table 2: mu0, A, B, k_A, k_S.
DRY = 0.55, 0.40, 0.60, 1.00, 0.40
#: Speed of the vehicle in the runs on the falling curve [m/s], and share by which friction differs left and right.
SPEED, UNEQUAL = 10.0, 1e-5
#: At rest creep is viscous below v_eps, so that an axle that a brake has wound up moves its free wheel [m/s].
UNWINDS = 1e-5
#: A rail's head as round as the wheel gives a circle of contact, whose closed form needs no elliptic integrals.
ROUND = {"rail_head_radius": P.wheel_radius}


@pytest.fixture(scope="module")
def library() -> Library:
    return Library(kernel_of("driven-wheelset"))


def polach(slip: float) -> float:
    """Return the force of one wheel on the dry rail that spins by `slip` [m/s], Polach (2005) on a circle [N]."""
    load, (mu0, ratio, decay, adhesion, area) = P.carried_mass * GRAVITY / 2, DRY
    axis = (3 * load * P.wheel_radius * (1 - RATIO) / (4 * MODULUS)) ** (1 / 3)
    limit = load * mu0 * ((1 - ratio) * math.exp(-decay * slip) + ratio)
    gradient = MODULUS * math.pi * axis**2 * C11 / (4 * limit) * slip / SPEED
    return 2 * limit / math.pi * (adhesion * gradient / (1 + (adhesion * gradient) ** 2) + math.atan(area * gradient))


def slope(slip: float) -> float:
    return (polach(slip + 1e-4) - polach(slip - 1e-4)) / 2e-4


def matrices(creep: float, shafts: int, p: DrivenParameters = P) -> np.ndarray:
    """Return the state matrix of rotor, wheels and twists whose creep forces have this slope [N.s/m], by hand."""
    inertia = np.diag([p.gear_ratio**2 * p.rotor_inertia, p.wheel_inertia_1, p.wheel_inertia_2])
    ends = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]])
    stiffness = ends.T @ np.diag([p.drive_stiffness, p.axle_stiffness]) @ ends
    damping = ends.T @ np.diag([p.drive_damping, p.axle_damping]) @ ends
    damping += creep * p.wheel_radius**2 * np.diag([0.0, 1.0, 1.0])
    joined = {ELASTIC_AXLE: [[1, 0], [1, 0], [0, 1]], ELASTIC_DRIVE: [[1, 0], [0, 1], [0, 1]]}
    join = np.array(joined.get(shafts, np.eye(3)), float)
    reduced = [join.T @ one @ join for one in (inertia, stiffness, damping)]
    size = join.shape[1]
    below = [-np.linalg.solve(reduced[0], one) for one in reduced[1:]]
    return np.block([[np.zeros((size, size)), np.eye(size)], below])


def torsion(creep: float, shafts: int, p: DrivenParameters = P) -> np.ndarray:
    """Return the eigenvalues of the torsional modes, lowest frequency first, the rigid motion left out."""
    values = np.linalg.eigvals(matrices(creep, shafts, p))
    return np.array(sorted(values[values.imag > 1.0], key=lambda one: one.imag))


def nearest(found: np.ndarray, wanted: complex) -> complex:
    return complex(found[np.argmin(np.abs(found.imag - wanted.imag))])


@pytest.mark.study
@pytest.mark.parametrize("shafts", [ELASTIC_DRIVE, ELASTIC_AXLE, BOTH_ELASTIC])
def test_free_wheels_turn_against_each_other_with_the_frequency_of_their_inertias(
    library: Library, shafts: int
) -> None:
    """Without friction a twisted wheelset rings: sqrt(k (1/J_1 + 1/J_2)); with the rotor by eigenvalues."""
    free = {"friction_1": 0.0, "friction_2": 0.0, "torque_time_constant": 1e-4, "tolerance": 1e-10}
    kernel = Kernel(library, shafts=shafts, initial_torque=3e3, **free)
    kernel.advance(0.02)  # the motor's torque has gone
    name = "drive_twist" if shafts == ELASTIC_DRIVE else "axle_twist"
    found = modes_in(np.array(kernel.record(0.5, 2e-3, [name])[name]), 2e-3, 4 if shafts == BOTH_ELASTIC else 2)
    wanted = torsion(0.0, shafts)
    assert len(found) == len(wanted)
    assert np.abs(found - wanted).max() < FREQUENCY * np.abs(wanted).min()
    if shafts == ELASTIC_AXLE:
        first = P.wheel_inertia_1 + P.gear_ratio**2 * P.rotor_inertia
        undamped = math.sqrt(P.axle_stiffness * (1 / first + 1 / P.wheel_inertia_2))
        assert abs(found[0]) == pytest.approx(undamped, rel=FREQUENCY)
    assert 10.0 < abs(wanted[0]) / 2 / math.pi < 80.0


@pytest.mark.parametrize("factor", [0.1, 10.0])
@pytest.mark.parametrize("name", sorted(P.values().keys() - {"carried_mass", "trailing_mass", "wheel_radius"}))
def test_torsion_is_that_of_the_eigenvalues_at_a_tenth_and_ten_times_of_each_value(
    library: Library, name: str, factor: float
) -> None:
    changed = replace(P, **{name: factor * P.values()[name]})
    free = {"friction_1": 0.0, "friction_2": 0.0, "torque_time_constant": 1e-4, "tolerance": 1e-10}
    kernel = Kernel(library, initial_torque=3e3, **free, **changed.values())
    kernel.advance(0.02)
    found = modes_in(np.array(kernel.record(0.5, 2e-3, ["axle_twist"])["axle_twist"]), 2e-3, 4)
    wanted = torsion(0.0, BOTH_ELASTIC, changed)
    assert np.abs(found - wanted).max() < FREQUENCY * np.abs(wanted).min()


def growth(library: Library, slip: float, wanted: complex, **values: float) -> complex:
    """Return the eigenvalue of torsion in a run that begins in a steady slip, from left and right unequal friction."""
    pull = polach(slip)
    torque = 2 * pull * P.wheel_radius / values.get("gear_ratio", P.gear_ratio)
    kernel = Kernel(
        library,
        **ROUND | {"initial_speed": SPEED, "initial_slip": -slip, "initial_torque": torque, "torque_demand": torque},
        **{"motor_torque": 1e6, "motor_power": 1e9, "resistance": 2 * pull, "tolerance": 1e-11},
        friction_1=DRY[0] * (1 + UNEQUAL),
        friction_2=DRY[0] * (1 - UNEQUAL),
        **values,
    )
    twist = np.array(kernel.record(0.25, 2e-3, ["axle_twist"])["axle_twist"])
    assert kernel["slip_1"] == pytest.approx(-slip, rel=1e-2)
    return nearest(modes_in(np.diff(twist), 2e-3, 6), wanted)


def onset(library: Library, slips: tuple[float, float], wanted: complex, **values: float) -> float:
    """Return the slip at which runs neither grow nor decay, from one run on each side."""
    rates = [growth(library, slip, wanted, **values).real for slip in slips]
    assert rates[0] < 0.0 < rates[1]
    return slips[0] - rates[0] * (slips[1] - slips[0]) / (rates[1] - rates[0])


def slip_of(wanted: float) -> float:
    """Return the slip beyond the peak at which the curve falls by `wanted` [N.s/m], by bisection."""
    low, high = 0.02, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if slope(middle) > wanted else (low, middle)
    return low


def test_torsion_of_equal_wheels_grows_where_the_curve_falls_by_more_than_their_damping(library: Library) -> None:
    """J u' = -2 k theta - 2 c u - s r^2 u for u = w_1 - w_2: it grows where -s r^2 > 2 c, for any J and k."""
    inertia, damping = 80.0, 1500.0
    limit = slip_of(-2 * damping / P.wheel_radius**2)
    equal = {"wheel_inertia_1": inertia, "wheel_inertia_2": inertia, "axle_damping": damping}
    alone = {"shafts": ELASTIC_AXLE, "gear_ratio": 1.0, "rotor_inertia": 1e-3}
    frequency = 1j * math.sqrt(2 * P.axle_stiffness / inertia)
    found = onset(library, (0.96 * limit, 1.04 * limit), frequency, **equal, **alone)
    assert found == pytest.approx(limit, rel=ONSET)


def test_torsion_of_the_whole_drive_grows_where_its_eigenvalue_changes_sign(library: Library) -> None:
    """Slope of the curve at which the wheels' mode has no damping left, by the eigenvalues of the three inertias."""
    low, high = -20e3, 0.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if torsion(middle, BOTH_ELASTIC)[-1].real > 0 else (low, middle)
    limit, wanted = slip_of(low), torsion(low, BOTH_ELASTIC)[-1]
    assert onset(library, (0.97 * limit, 1.03 * limit), wanted) == pytest.approx(limit, rel=ONSET)


def test_driving_beyond_adhesion_ends_at_power_over_the_force_of_sliding(library: Library) -> None:
    """P = F v_wheel in the steady state, F = mu m g; without the limit of power the wheel passes that speed."""
    friction = 0.2
    force = friction * P.carried_mass * GRAVITY
    even = {"friction_1": friction, "friction_2": friction, "friction_ratio": 1.0, "slip_reduction": 1.0}
    pull = even | {"initial_speed": 5.0, "torque_demand": 1e9, "resistance": force}
    bounded = Kernel(library, **pull)
    bounded.advance(30.0)
    ends = MOTOR.motor_power / force
    assert bounded["wheel_speed_1"] == pytest.approx(ends, rel=2e-3)
    assert bounded["rotor_power"] == pytest.approx(MOTOR.motor_power, rel=1e-3)
    bounded.advance(30.0)
    assert bounded["wheel_speed_1"] == pytest.approx(ends, rel=2e-3)
    free = Kernel(library, **pull, motor_power=1e9)
    free.advance(30.0)
    assert free["wheel_speed_1"] > 5 * ends


def test_wheels_that_spin_at_a_drop_of_friction_roll_again_after_it(library: Library) -> None:
    """Over the drop the rotor gains at most (i M - F r) / J of speed; afterwards the creepage is that from before."""
    kernel = Kernel(library, initial_speed=15.0, initial_torque=4e3, torque_demand=4e3)
    kernel.advance(1.0)
    before, duration, low = kernel["slip_1"] / kernel["speed"], 0.5, 0.02
    kernel.set(friction_1=low, friction_2=low)
    kernel.advance(duration)
    inertia = P.wheel_inertia_1 + P.wheel_inertia_2 + P.gear_ratio**2 * P.rotor_inertia
    most = P.wheel_radius * P.gear_ratio * 4e3 / inertia * duration
    assert 0.8 * most < -kernel["slip_1"] < most
    kernel.set(friction_1=DRY[0], friction_2=DRY[0])
    kernel.advance(3.0)
    assert kernel["slip_1"] / kernel["speed"] == pytest.approx(before, rel=5e-3)  # the same force, at 5 m/s more


def energy(state: dict[str, float], shafts: int) -> np.ndarray:
    """Return the derivatives of the energy by speed, rotor, both wheels and both twists."""
    wheels = [state["state_angular_velocity_1"]]
    wheels.append(state.get("state_angular_velocity_2", wheels[0]))
    rotor = state.get("state_rotor", wheels[0])
    stiffness = {"drive": P.drive_stiffness, "axle": P.axle_stiffness}
    twists = [k * state.get(f"state_{n}_twist", 0.0) for n, k in stiffness.items()]
    spin = [P.gear_ratio**2 * P.rotor_inertia * rotor, P.wheel_inertia_1 * wheels[0], P.wheel_inertia_2 * wheels[1]]
    return np.array([P.carried_mass * state["state_speed"], *spin, *twists])


@pytest.mark.parametrize("shafts", SHAFTS)
def test_energy_is_balanced_in_random_states(library: Library, shafts: int) -> None:
    """dE/dt = motor - brakes - sliding - shafts' damping - resistance, each by hand from forces and speeds."""
    rng = np.random.default_rng(shafts)
    for _ in range(20):
        inputs = {"brake_torque_1": rng.uniform(0, 2e4), "brake_torque_2": rng.uniform(0, 2e4)}
        inputs |= {"friction_1": rng.uniform(0.02, 0.6), "friction_2": rng.uniform(0.02, 0.6)}
        inputs |= {"resistance": rng.uniform(-5e4, 5e4), "torque_demand": rng.uniform(-2e4, 2e4)}
        kernel = Kernel(library, shafts=shafts, initial_speed=20.0, **inputs)
        kernel.initialise()
        place = np.array(kernel.linearise().state)
        names = [f"state_{one}" for one in STATES[shafts]]
        scale = np.array([{"twist": 5e-3, "torque": 5e3}.get(one.split("_")[-1], 0.0) for one in names])
        moved = place * rng.uniform(0.7, 1.3, len(place)) + scale * rng.uniform(-1, 1, len(place))
        kernel.arrive(0.0, moved)
        state = dict(zip(names, moved, strict=True))
        rates = dict(zip(names, kernel.slopes_at(0.0, moved), strict=True))
        wheel = [rates["state_angular_velocity_1"]]
        wheel.append(rates.get("state_angular_velocity_2", wheel[0]))
        change = [rates["state_speed"], rates.get("state_rotor", wheel[0]), *wheel]
        change += [rates.get(f"state_{one}_twist", 0.0) for one in ("drive", "axle")]
        gained = energy(state, shafts) @ np.array(change)
        speed, turning = kernel["speed"], [kernel["angular_velocity_1"], kernel["angular_velocity_2"]]
        damped = sum(c * change[4 + n] ** 2 for n, c in enumerate((P.drive_damping, P.axle_damping)))
        sliding = sum(kernel[f"creep_force_{n}"] * kernel[f"slip_{n}"] for n in (1, 2))
        braked = sum(inputs[f"brake_torque_{n}"] * abs(turning[n - 1]) for n in (1, 2))
        given = kernel["rotor_torque"] * kernel["rotor_speed"] - inputs["resistance"] * speed
        assert gained == pytest.approx(given - braked + sliding - damped, abs=1e-9 * (abs(given) + braked + 1e6))


#: States of each choice of shafts, in their order.
STATES = {
    RIGID: ("speed", "angular_velocity_1", "rotor_torque", "distance"),
    ELASTIC_DRIVE: ("speed", "rotor", "angular_velocity_1", "rotor_torque", "drive_twist", "distance"),
    ELASTIC_AXLE: ("speed", "angular_velocity_1", "angular_velocity_2", "rotor_torque", "axle_twist", "distance"),
    BOTH_ELASTIC: (
        *("speed", "rotor", "angular_velocity_1", "angular_velocity_2"),
        *("rotor_torque", "drive_twist", "axle_twist", "distance"),
    ),
}


@pytest.mark.parametrize("shafts", SHAFTS)
def test_brakes_stop_the_vehicle_and_hold_it(library: Library, shafts: int) -> None:
    """a = T / r / (m + J / r^2), all inertias at the axle; it stands, the brake of one wheel winding up the axle."""
    torque, inertia = 5e3, P.wheel_inertia_1 + P.wheel_inertia_2 + P.gear_ratio**2 * P.rotor_inertia
    kernel = Kernel(library, shafts=shafts, initial_speed=10.0, brake_torque_2=2 * torque)
    kernel.advance(5.0)
    mass = P.carried_mass + inertia / P.wheel_radius**2
    slower = 2 * torque / P.wheel_radius / mass
    assert kernel["speed"] == pytest.approx(10.0 - 5.0 * slower, rel=5e-3)
    assert kernel["axle_torque"] == pytest.approx(torque + _excess(slower), rel=5e-3)
    kernel.advance(20.0)
    assert abs(kernel["speed"]) < UNWINDS
    assert not kernel["locked_1"]
    assert not kernel["locked_2"]


def _excess(slower: float) -> float:
    """Torque of the axle over half of the brake's: each rail pulls alike, wheel 2 turns with less inertia [N.m]."""
    first = P.wheel_inertia_1 + P.gear_ratio**2 * P.rotor_inertia
    return (first - P.wheel_inertia_2) / 2 * slower / P.wheel_radius


@pytest.mark.parametrize("shafts", SHAFTS)
def test_a_brake_beyond_adhesion_locks_and_sliding_stops_the_vehicle(library: Library, shafts: int) -> None:
    """Locked on a low, constant friction the vehicle slows down by mu g."""
    low = {"friction_1": 0.05, "friction_2": 0.05, "friction_ratio": 1.0, "slip_reduction": 1.0}
    kernel = Kernel(library, shafts=shafts, initial_speed=10.0, brake_torque_1=3e4, brake_torque_2=3e4, **low)
    kernel.advance(3.0)
    assert kernel["locked_1"]
    assert kernel["locked_2"]
    start = kernel["speed"]
    kernel.advance(2.0)
    assert start - kernel["speed"] == pytest.approx(2.0 * 0.05 * GRAVITY, rel=5e-3)


def test_shafts_without_torsion_carry_what_elastic_ones_carry_slowly(library: Library) -> None:
    kernels = [Kernel(library, shafts=one, torque_demand=3e3, initial_torque=3e3) for one in (RIGID, BOTH_ELASTIC)]
    for kernel in kernels:
        kernel.advance(5.0)
    for name in ("speed", "axle_torque", "drive_torque", "slip_2", "rotor_power"):
        assert kernels[0][name] == pytest.approx(kernels[1][name], rel=1e-4), name


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"axle_stiffness": 0.0}, "axle_stiffness must be at least 1 N.m/rad; got 0 N.m/rad"),
        ({"friction_1": -0.1}, "friction_1 must be at least 0; got -0.1"),
        ({"resistance": math.nan}, "resistance must be a finite number"),
        ({"shafts": 5}, "shafts must be"),
        ({"rail_head_radius": 300.0}, "rail_head_radius must be below 30 times wheel_radius; it is 281.2"),
        ({"rail_head_radius": 0.3, "wheel_profile_curvature": -3.33}, "not a finite number at the start"),
    ],
)
def test_senseless_values_are_refused(library: Library, values: dict[str, float], sentence: str) -> None:
    with pytest.raises(SimulationError, match=sentence):
        Kernel(library, **values).advance(0.1)


@pytest.mark.parametrize("shafts", [RIGID, ELASTIC_DRIVE])
def test_a_braked_rigid_axle_holds_the_vehicle_up_to_the_least_of_brake_and_friction(
    library: Library, shafts: int
) -> None:
    """A brake of 5 kN at the rim holds 4.9 kN without creeping, both rails alike; 5.1 kN move the vehicle."""
    trailing = 10e3
    kernel = Kernel(
        library, shafts=shafts, initial_speed=0.0, brake_torque_1=5e3 * P.wheel_radius, trailing_mass=trailing
    )
    kernel.set(resistance=4.9e3)
    kernel.advance(100.0)
    assert kernel["distance"] == kernel["speed"] == kernel["angular_velocity_1"] == 0.0
    assert kernel["creep_force_1"] == pytest.approx(2.45e3)
    assert kernel["axle_torque"] == pytest.approx(2.45e3 * P.wheel_radius)
    assert kernel["drive_torque"] == pytest.approx(0.0, abs=1e-6)
    kernel.set(resistance=5.1e3)
    kernel.advance(10.0)
    inertia = P.wheel_inertia_1 + P.wheel_inertia_2 + P.gear_ratio**2 * P.rotor_inertia
    wanted = -100.0 / (P.carried_mass + trailing + inertia / P.wheel_radius**2)
    assert kernel["speed"] == pytest.approx(10.0 * wanted, rel=5e-2)  # an elastic drive rings


@pytest.mark.parametrize("sign", [1, -1])
def test_the_torque_of_the_motor_follows_in_its_time_constant_up_to_its_limit(library: Library, sign: int) -> None:
    """1 - exp(-t / T) of the smaller of demand and limit."""
    wheels = {"initial_speed": 5.0, "torque_time_constant": 0.05}
    for demand, limit in ((4e3, 4e3), (1e6, MOTOR.motor_torque)):
        kernel = Kernel(library, torque_demand=sign * demand, **wheels)
        kernel.advance(0.05)
        assert kernel["rotor_torque"] == pytest.approx(sign * limit * (1 - math.exp(-1)), rel=1e-4)
    kernel = Kernel(library, initial_torque=sign * 1e6)
    kernel.initialise()
    assert kernel["rotor_torque"] == sign * MOTOR.motor_torque


def test_a_lost_demand_is_no_torque(library: Library) -> None:
    kernel = Kernel(library, initial_torque=5e3, torque_demand=math.nan)
    kernel.advance(1.0)
    assert abs(kernel["rotor_torque"]) < 1e-3
