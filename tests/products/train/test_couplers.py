"""Couplers and the motion of vehicles against closed forms: collisions, balances, statics, limits of explicit steps."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from products.train.consist import Consist, block_train, locomotive
from products.train.numbers import SHARE, Settings
from products.train.train import Train
from rbd_model.track.line import Line
from rbd_model.train.coupler import COUPLERS, Coupler, Curve, coupling, draft_gear, fastest, rigid
from tests.products.train.chains import MASS, chain, spring

GRAVITY = 9.80665
#: Tolerances: closed forms, momentum, energy, rigid couplers.
CLOSED, MOMENTUM, ENERGY, ONE_MASS = 1e-5, 1e-12, 1e-8, 1e-6
#: Share of the stable step at which the error of the method is below these tolerances.
FINE = 1e-4


def momentum(train: Train) -> float:
    masses = np.array([one.mass for one in train.consist.vehicles])
    return float(masses @ train.speed)


def moving(train: Train) -> float:
    masses = np.array([one.mass for one in train.consist.vehicles])
    return float(masses @ train.speed**2) / 2


def collide(coupler: Coupler, speed: float = 1.0, time: float = 0.6, **settings: object) -> Train:
    """Let the second vehicle run into the first, which is at rest; they are not coupled."""
    train = chain([MASS, MASS], coupler, brake_model="delay", share=FINE, **settings)
    train.inputs["coupling_closed"][:] = 0.0
    state = train.motion
    state[1:3, 1] = speed
    train.motion = state
    train.advance(time)
    return train


def test_two_vehicles_collide_as_on_a_spring() -> None:
    """The largest force is F = v sqrt(k m / 2); equal masses exchange their speeds."""
    stiffness, speed = 5e6, 1.3
    train = collide(spring(stiffness), speed)
    assert train.largest_compression == pytest.approx(speed * math.sqrt(stiffness * MASS / 2), rel=CLOSED)
    assert train.speed == pytest.approx([speed, 0.0], abs=1e-6 * speed)
    assert train.coupler_force[0] == 0.0


def test_a_collision_with_friction_gives_back_what_lies_below_the_line_of_unloading() -> None:
    """Loading k1 s, then the sticking stiffness K down to k2 s; v' = sqrt(2 E / (m / 2)), E: the area below both."""
    k1, k2, sticking, speed = 5e6, 1.5e6, 60e6, 1.0
    train = collide(spring(k1, k2 / k1, sticking), speed)
    most = speed * math.sqrt(MASS / 2 / k1)
    meets = (sticking * most - k1 * most) / (sticking - k2)
    back = (k1 * most + k2 * meets) / 2 * (most - meets) + k2 * meets**2 / 2
    assert train.speed[0] - train.speed[1] == pytest.approx(math.sqrt(4 * back / MASS), rel=CLOSED)
    assert train.largest_compression == pytest.approx(k1 * most, rel=CLOSED)


def test_friction_that_sticks_keeps_its_force() -> None:
    """Compressed to 100 kN and eased to 94 kN, the coupler sticks by friction indefinitely."""
    train = chain([MASS, MASS], spring(5e6, 0.3, 60e6), brake_model="delay", share=FINE)
    train.lead(0, 0.0)
    train.lead(1, 0.02)
    train.advance(1.0)
    loaded = train.coupler_force[0]
    assert loaded == pytest.approx(-5e6 * 0.02, rel=1e-9)
    train.lead(1, -0.001)
    train.advance(0.1)
    eased = train.coupler_force[0]
    assert eased == pytest.approx(loaded + 60e6 * 1e-4, rel=CLOSED)
    train.lead(1, 0.0)
    train.advance(10.0)
    assert train.coupler_force[0] == eased


@pytest.mark.parametrize("name", sorted(COUPLERS))
def test_momentum_stays_whatever_the_couplers_do(name: str) -> None:
    draw = np.random.default_rng(33)
    train = chain(list(draw.uniform(20e3, 90e3, 30)), COUPLERS[name](), brake_model="delay")
    state = train.motion
    state[0], state[1] = draw.normal(0.0, 0.02, 30), draw.normal(0.0, 1.0, 30)
    state[2] = state[1]
    train.motion = state
    before, size = momentum(train), float(np.abs(state[1]).sum()) * 50e3
    train.advance(5.0)
    assert abs(momentum(train) - before) < MOMENTUM * size


def test_energy_stays_where_there_is_no_friction() -> None:
    """The energy is that of the motion and k s^2 / 2 of each coupler. Its error falls with the square of the step."""
    draw = np.random.default_rng(34)
    lost = []
    for share in (FINE, 300 * FINE):
        train = chain(list(draw.uniform(40e3, 90e3, 8)), spring(5e6), brake_model="delay", share=share)
        state = train.motion
        state[1] = state[2] = np.linspace(0.0, 1.0, 8)
        train.motion = state
        first = moving(train)
        train.advance(2.0)
        ways = np.diff(train.motion[0])
        lost.append(abs(moving(train) + 5e6 / 2 * float(ways @ ways) - first) / first)
    assert lost[0] < ENERGY < lost[1]


def test_friction_takes_energy_and_never_gives_any() -> None:
    train = chain([MASS] * 10, draft_gear(), brake_model="delay")
    state = train.motion
    state[1] = state[2] = np.linspace(0.0, 3.0, 10)
    train.motion = state
    centre = momentum(train) / (10 * MASS)
    courses = [moving(train) - 5 * MASS * centre**2]
    for _ in range(20):
        train.advance(3.0)
        courses.append(moving(train) - 5 * MASS * centre**2)
    assert courses[-1] < 1e-2 * courses[0]
    assert max(b for _, b in pairwise(courses)) < courses[0]


#: Cycles of a coupler: range [m], far beyond each stroke; pieces between two turns; cycles; repetitions until they are
#: closed.
FAR, PIECES, CYCLES, REPEATED = 0.3, 40, 20, 2
#: Energy error by rounding in a cycle, relative to the largest force times the whole range.
ROUNDING = 1e-9


def scaled(coupler: Coupler, forces: float) -> Coupler:
    """Return the coupler with all stiffnesses times a factor."""

    def one(curve: Curve) -> Curve:
        return Curve(curve.ways, tuple(forces * force for force in curve.forces))

    tension, compression = (tuple(map(one, pair)) for pair in (coupler.tension, coupler.compression))
    return Coupler(coupler.name, forces * coupler.sticking_stiffness, tension, compression)  # type: ignore[arg-type]


def works_of_cycles(one: Coupler) -> np.ndarray:
    """Return the work of closed cycles over the largest force times the range, shape (CYCLES,).

    Random displacements to and fro, also far beyond the stroke, are made twice: the second cycle is closed in force and
    displacement. All cycles are evaluated at once. The work is integrated by the trapezoidal rule on small pieces.
    """
    draw = np.random.default_rng(51)
    turns = draw.uniform(-FAR, FAR, (CYCLES, 6)) * draw.uniform(0.1, 1.0, (CYCLES, 1))
    turns = np.tile(turns, REPEATED)
    ways = np.concatenate([np.linspace(a, b, PIECES, endpoint=False) for a, b in pairwise(turns.T)])
    given = np.tile(np.array(one.constants())[:, None], CYCLES)
    play, rest, forces = coupling().map(CYCLES), np.zeros(CYCLES), []
    for way in ways:
        force, rest = np.array(play(way[None], np.zeros((1, CYCLES)), rest[None], given))
        forces.append(force)
    lap = 6 * PIECES
    work = np.trapezoid(np.array(forces)[-lap - 1 :], ways[-lap - 1 :], axis=0)
    return np.asarray(work / (np.abs(forces).max() * FAR))


@pytest.mark.study
@pytest.mark.parametrize("factor", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("name", sorted(COUPLERS))
def test_a_closed_cycle_never_gives_energy(name: str, factor: float) -> None:
    work = works_of_cycles(scaled(COUPLERS[name](), factor))
    assert np.all(work > -ROUNDING)
    assert bool(work.max() > 1e3 * ROUNDING) is (name != "rigid")


@pytest.mark.parametrize("name", sorted(COUPLERS))
def test_unloading_lies_below_loading_behind_the_stroke(name: str) -> None:
    """Unloading forces are at most those of loading. Beyond the stroke the coupler is elastic.

    There the force is the loading curve plus steel from its own end on. Regression test: if each curve meets steel at
    its own end, the draft gear's unloading is 2583 kN at 131 mm, its loading 2509 kN, and compression returns 2583 kN.
    """
    coupler = COUPLERS[name]()
    play, given, loading = coupling(), coupler.constants(), coupler.compression[0]
    ways, rest, force = np.linspace(0.0, -0.25, 300), 0.0, []
    for way in (*ways, *ways[::-1]):
        found, rest = (float(one) for one in np.array(play(way, 0.0, rest, given)).ravel())
        force.append(-found)
    there, back = np.array(force[:300]), np.array(force[300:])[::-1]
    due = np.interp(-ways, loading.ways, loading.forces) + coupler.sticking_stiffness * np.maximum(
        -ways - loading.ways[-1], 0.0
    )
    behind = -ways > loading.ways[-2]
    assert there[behind] == pytest.approx(due[behind], rel=1e-12)
    assert np.all(back <= there * (1 + 1e-12))
    assert back[-20:] == pytest.approx(there[-20:], rel=1e-12)


def test_a_curve_that_unloads_above_its_loading_is_refused() -> None:
    low, high = Curve((0.0, 0.1), (0.0, 100e3)), Curve((0.0, 0.1), (0.0, 120e3))
    with pytest.raises(
        ValueError, match=r"in tension must be at most that of loading, 100000 N at 0\.1 m; got 120000 N"
    ):
        Coupler("odd", 50e6, (low, high), (low, low))


def test_equal_brakes_on_equal_vehicles_leave_couplers_without_force() -> None:
    train = chain([MASS] * 20, draft_gear(), braked=True, brake_model="delay", propagation=1e9)
    state = train.motion
    state[1:3] = 20.0
    train.motion = state
    train.drive("emergency")
    train.advance(10.0)
    assert train.speed[0] < 17.0
    assert max(train.largest_compression, train.largest_tension) < 1.0


def test_rigid_couplers_give_the_motion_of_one_mass() -> None:
    """x = F t^2 / (2 M) for each vehicle."""
    masses = [84e3, *[MASS] * 9]
    train = chain(masses, rigid(1e11), brake_model="delay")
    train.inputs["pull"][0] = 100e3
    train.advance(20.0)
    due = 100e3 * 20.0**2 / (2 * sum(masses))
    assert train.motion[0] == pytest.approx(np.full(10, due), rel=ONE_MASS)


def gradients(rows: list[tuple[float, float]]) -> Line:
    distance, gradient = np.array(rows).T
    return Line({"distance": distance, "gradient": gradient, "curvature": np.zeros(len(rows))})


@pytest.mark.parametrize(("slope", "sense"), [(0.01, 1.0), (-0.01, -1.0)])
def test_a_train_across_a_crest_or_a_sag_carries_the_weight_of_its_halves(slope: float, sense: float) -> None:
    """Tension on a crest, compression in a sag: m g sin of all vehicles beyond. Forces oscillate and are averaged."""
    consist = Consist(chain([MASS] * 10, spring(5e6), brake_model="delay").consist.vehicles)
    line = gradients([(-1000.0, slope), (-75.01, slope), (-74.99, -slope), (1000.0, -slope)])
    train = Train(consist, line=line, settings=Settings(brake_model="delay"))
    forces = []
    for _ in range(4000):
        train.advance(0.01)
        forces.append(train.coupler_force)
    due = MASS * GRAVITY * 0.01 * np.minimum(np.arange(1, 10), np.arange(9, 0, -1))
    assert np.mean(forces, axis=0) == pytest.approx(sense * due, rel=0.02)


def test_brakes_hold_a_train_on_a_gradient_and_it_stands() -> None:
    """Vehicles do not creep: speeds are exactly zero, and coupler forces are constant."""
    consist = chain([MASS] * 5, draft_gear(), braked=True).consist
    train = Train(consist, cylinder=380e3, pipe=350e3, line=gradients([(-1e4, 0.02), (1e4, 0.02)]))
    train.drive("service", 1.0)
    train.advance(30.0)
    assert (train.speed == 0.0).all()
    place, force = train.motion[0], train.coupler_force
    train.advance(60.0)
    assert np.array_equal(train.motion[0], place)
    assert np.array_equal(train.coupler_force, force)


# ---- wheels ----------------------------------------------------------------------------------------------------------


def lone(friction: float) -> Train:
    """Return a single locomotive at 20 m/s with full cylinders."""
    one = locomotive()
    brake = replace(one.brake, force_per_pressure=1.0, constant_friction=0.2)
    vehicle = replace(one, brake=brake, resistance=(0.0, 0.0, 0.0), friction_ratio=1.0)
    train = Train(Consist((vehicle,)), speed=20.0, cylinder=380e3, pipe=350e3)
    train.drive("service", 1.0)
    train.inputs["friction"][:] = friction
    return train


def test_wheels_that_roll_brake_mass_and_rotating_mass() -> None:
    train = lone(0.3)
    train.advance(5.0)
    held = 0.2 * 380e3
    assert train.speed[0] == pytest.approx(20.0 - held / (1.04 * 84e3) * 5.0, rel=1e-4)
    assert train.wheel_speed[0] == train.speed[0]
    assert train.rail_force[0] == pytest.approx(-held * (1 - 0.04 / 1.04), rel=1e-4)


def test_wheels_that_are_asked_too_much_lock_and_slide() -> None:
    """m_r dw/dt = mu m g - B until the wheels lock; then dv/dt = -mu g."""
    friction, brake, rotating = 0.05, 0.2 * 380e3, 0.04 * 84e3
    train = lone(friction)
    lock = 20.0 * rotating / (brake - friction * 84e3 * GRAVITY)
    train.advance(lock / 2)
    assert train.wheel_speed[0] == pytest.approx(10.0, abs=0.2)
    train.advance(5.0 - lock / 2)
    assert train.wheel_speed[0] == 0.0
    assert train.speed[0] == pytest.approx(20.0 - friction * GRAVITY * 5.0, rel=1e-4)


def test_a_locked_wheel_turns_again_when_its_cylinder_is_vented() -> None:
    train = lone(0.05)
    train.advance(2.5)
    assert train.wheel_speed[0] == 0.0
    train.inputs["protection"][0] = 2.0
    train.advance(3.0)
    assert train.wheel_speed[0] == train.speed[0] > 15.0
    assert train.cylinder_pressure[0] < 30e3
    train.inputs["protection"][0] = 0.0
    train.advance(5.0)
    assert train.cylinder_pressure[0] > 300e3


# ---- limits ----------------------------------------------------------------------------------------------------------


def run_in(share: float) -> float:
    """Return the largest compression [N] of 40 wagons of 20 t that run in behind a braking locomotive."""
    consist = block_train(40, load=0.0, coupler=draft_gear())
    train = Train(consist, speed=20.0, settings=Settings(brake_model="delay", share=share))
    train.drive("emergency")
    train.advance(12.0)
    return train.largest_compression


def test_steps_above_two_over_omega_lie_and_the_default_does_not() -> None:
    """Friction bounds the instability. The limit is 10.05 ms for draft gears of 198 MN/m between wagons of 20 t."""
    assert 2 / fastest([draft_gear()] * 5, [20e3] * 6) == pytest.approx(2 / math.sqrt(4 * 198e6 / 20e3), rel=1e-12)
    true = run_in(0.02)
    assert run_in(SHARE) == pytest.approx(true, rel=0.01)
    assert abs(run_in(2.5) / true - 1.0) > 0.05


# ---- input -----------------------------------------------------------------------------------------------------------


def test_curves_that_cannot_be_are_refused() -> None:
    with pytest.raises(ValueError, match="the first 0 m"):
        Curve((0.1, 0.2), (0.0, 1.0))
    with pytest.raises(ValueError, match="Ways of a coupler's curve must rise and its forces never fall"):
        Curve((0.0, 0.1), (2.0, 1.0))
    with pytest.raises(ValueError, match=r"at least the steepest slope of its curves, 5e\+06 N/m; got 1e\+06 N/m"):
        spring(5e6, 0.3, 1e6).constants()


def test_a_coupling_holds_from_when_vehicles_touch() -> None:
    train = chain([MASS, MASS], spring(5e6, 0.3, 60e6), brake_model="delay")
    train.inputs["coupling_closed"][:] = 0.0
    state = train.motion
    state[0, 1], state[1:3, 1] = -1.0, 0.5
    train.motion = state
    train.advance(1.0)
    assert train.coupler_force[0] == 0.0
    train.inputs["coupling_closed"][:] = 1.0
    train.advance(0.5)
    assert train.coupler_force[0] == 0.0
    train.advance(4.5)
    assert train.speed[0] == pytest.approx(train.speed[1], abs=0.2)
    assert train.largest_tension > 0.0


def test_backwards_forces_change_their_sign() -> None:
    """Draft gears are symmetric: compression forwards equals tension backwards, to rounding errors."""
    found = []
    for sense in (1.0, -1.0):
        train = Train(block_train(12, coupler=draft_gear()), speed=sense * 20.0)
        train.drive("emergency")
        train.advance(60.0)
        assert (train.speed == 0.0).all()
        found.append((train.largest_compression, train.largest_tension, float(train.motion[0, 0])))
    forwards, backwards = found
    assert backwards == pytest.approx((forwards[1], forwards[0], -forwards[2]), rel=1e-9)
