"""The oracle as a program: dimensions, constraints over time, partition, skid, and loss of contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evidence.chapter3 import mechanism as mechanisms
from evidence.chapter3 import program
from evidence.chapter3.constraints import quadratic_terms
from evidence.chapter3.euler import norm_error
from evidence.chapter3.kinematic_analysis import (
    DrivenPosition,
    centred,
    drive_to,
    frames_at_rest,
    rolling,
    rolling_radii,
)
from evidence.chapter3.mechanism import FIRST_WHEELSET, Mechanism, MechanismInputs, MechanismState
from evidence.chapter3.partition import NoSolutionError, choose
from evidence.chapter3.program import run, spin, step
from fmu_src.kernel import Kernel, SimulationError
from rbd_model.contact.geometry import last_tread_contact, rolling_radius_difference, thesis_pair
from rbd_model.track.irregularity import derivatives_along, section_5_3
from rbd_model.vehicle.parameters import as_printed, tables_4_1_and_4_2, tables_5_1_and_5_2
from tests.evidence.chapter3.correspondence import fitted_ellipse, machine

#: Tolerances by docs/checking.md: constraints [m, 1], norm of the Euler parameters, position of the fold [m].
RESIDUAL_BAND, NORM_BAND, FOLD_BAND = 1e-12, 1e-12, 1e-4
#: Error of the energy over 0.03 s, relative to the kinetic energy, with fourth-order steps of 1 ms. Measured: 1.5e-14,
#: and 4e-10 if a thousandth of Q_d (3.72) is missing.
ENERGY_BAND = 1e-12


@pytest.mark.parametrize(
    ("wheelsets", "speed", "size", "free"), [(1, None, 63, 9), (1, 15.0, 64, 8), (2, None, 88, 14), (2, 15.0, 89, 13)]
)
def test_dimensions_are_those_printed(wheelsets: int, speed: float | None, size: int, free: int) -> None:
    """Sections 4.2 and 5.2, eqs (4.1), (4.2), (5.1), (5.2)."""
    parameters = as_printed(tables_4_1_and_4_2() if wheelsets == 1 else tables_5_1_and_5_2())
    mechanism = Mechanism(parameters, thesis_pair(), wheelsets, speed=speed)
    assert mechanism.unknowns + mechanism.equations == size
    assert mechanism.degrees_of_freedom == free
    state = rolling(Mechanism(parameters, thesis_pair(), wheelsets), 15.0)
    _, jacobian = mechanism.constraints(0.0, state.q, state.s)
    assert jacobian.shape == (mechanism.equations, mechanism.unknowns)
    assert np.linalg.matrix_rank(jacobian) == mechanism.equations
    chosen = choose(jacobian)
    assert (chosen.dependent.size, chosen.independent.size) == (mechanism.equations, free)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"torque_reaction": 0.5}, r"torque_reaction must be 0 in chapter 3; got 0\.5"),
        ({"flange_at_rail": 1.0}, "flange_at_rail must be 0 in chapter 3; got 1"),
        ({"vertical_half_spacing": 0.9}, r"vertical_half_spacing must equal .*, 0\.7 m, in chapter 3; got 0\.9 m"),
    ],
)
def test_what_chapter_3_does_not_have_is_refused_with_a_sentence(values: dict[str, float], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        Mechanism(replace(as_printed(tables_5_1_and_5_2()), **values), thesis_pair(), 2)


#: Speed of the wheelset on a wave [m/s]: a revolution takes 67 steps of 1 ms.
SPEED = 40.0


def wheelset_on_a_wave() -> tuple[Mechanism, MechanismState]:
    track = derivatives_along(
        replace(section_5_3(), lateral_irregularity=2e-3, lateral_wave_number=0.2, irregularity_start=0.0)
    )
    mechanism = Mechanism(as_printed(tables_4_1_and_4_2()), thesis_pair(), 1, track)
    return mechanism, rolling(mechanism, SPEED)


@pytest.mark.study
def test_constraints_hold_and_euler_parameters_keep_their_norm() -> None:
    """Eqs (3.6), (3.107)-(3.124): at every step, over more than one revolution of the wheel."""
    mechanism, begin = wheelset_on_a_wave()
    residuals, norms = [], []
    for state in run(mechanism, begin, 0.075, 1e-3, lambda time: MechanismInputs()):
        c, jacobian = mechanism.constraints(state.time, state.q, state.s)
        rates = np.concatenate([state.q_rate, state.s_rate])
        residuals.append(max(np.abs(c).max(), np.abs(jacobian @ rates).max()))
        norms += [abs(norm_error(state.q[mechanism.body(n)][3:])) for n in range(mechanism.bodies)]
    assert state.s[mechanism.wheel_parameters(0)][0] > 2 * np.pi
    assert max(residuals) < RESIDUAL_BAND
    assert max(norms) < NORM_BAND


@pytest.mark.study
@pytest.mark.parametrize("whole", [True, False])
def test_rails_with_irregularities_do_no_work(whole: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Energy of wheelset and frame less the suspension's work, without friction. A wrong Q_d of (3.72) violates it."""
    waves = {"lateral_irregularity": 4e-3, "vertical_irregularity": 5e-3, "cross_level": 5e-3}
    waves |= {"lateral_wave_number": 0.4, "vertical_wave_number": 0.4}
    track = derivatives_along(replace(section_5_3(), irregularity_start=-1.0, cross_level_centre=5.0, **waves))
    parameters = replace(as_printed(tables_4_1_and_4_2()), rolling_resistance_torque=0.0)
    mechanism = Mechanism(parameters, thesis_pair(), 1, track)
    state, size, smooth = rolling(mechanism, 15.0), 1e-3, MechanismInputs(friction=(0.0, 0.0))
    if not whole:
        monkeypatch.setattr(mechanisms, "quadratic_terms", lambda *given: 0.999 * quadratic_terms(*given))
    states = [state, *run(mechanism, state, 0.03, size, lambda time: smooth)]
    found, power = np.array([energy_and_power(mechanism, one) for one in states]).T
    given = size / 3 * np.cumsum(power[:-2:2] + 4 * power[1:-1:2] + power[2::2])
    assert (np.ptp(found[::2] - np.append(0.0, given)) < ENERGY_BAND * found[0]) == whole


def energy_and_power(mechanism: Mechanism, state: MechanismState) -> tuple[float, float]:
    """Return kinetic and potential energy of all bodies [J], and the power of the suspension [W]."""
    motions, p, pushed = mechanism.motions(state.q, state.q_rate), mechanism.parameters, np.zeros(mechanism.q_count)
    mechanism.suspend(pushed, motions)
    masses = [p.wheelset_mass] * mechanism.wheelsets + [body.mass for body in mechanism.layout.upper]
    inertias = [mechanism.wheelset_inertia] * mechanism.wheelsets + [body.inertia for body in mechanism.layout.upper]
    moving = 0.5 * state.q_rate @ mechanism.mass_matrix(motions, masses, inertias) @ state.q_rate
    heights = [motion.position[2] for motion in motions[FIRST_WHEELSET:]]
    return float(moving + p.gravity * np.dot(masses, heights)), float(pushed @ state.q_rate)


@pytest.mark.study
def test_fixed_partition_fails_near_half_a_turn_and_a_new_one_passes() -> None:
    """Eqs (3.107)-(3.114), with generalised coordinates alone as independent ones.

    Half a turn gives the Euler parameter of pitch its maximum, where it does not determine the further rotation.
    """
    mechanism, begin = wheelset_on_a_wave()
    preferred = np.repeat([1.0, 1e9], [mechanism.q_count, mechanism.s_count])  # s is eliminated first
    fixed = choose(mechanism.constraints(0.0, begin.q, begin.s)[1] * preferred)
    assert fixed.independent.max() < mechanism.q_count
    half_turn, reached = np.pi * 0.425 / SPEED, [begin]

    def go_on() -> None:
        while reached[-1].time < 2 * half_turn:
            reached.append(step(mechanism, reached[-1], 1e-3, lambda time: MechanismInputs(), fixed))

    with pytest.raises(NoSolutionError, match="badly partitioned"):
        go_on()
    assert 0.9 * half_turn < reached[-1].time < 1.1 * half_turn
    *_, last = run(mechanism, begin, 2 * half_turn, 1e-3, lambda time: MechanismInputs())
    assert last.time == pytest.approx(2 * half_turn, abs=1e-3)


@pytest.mark.study
def test_held_speed_stays() -> None:
    """C_t of (3.67), (3.68): the frame moves with the prescribed speed."""
    track = derivatives_along(replace(section_5_3(), vertical_irregularity=5e-3, irregularity_start=0.0))
    mechanism = Mechanism(as_printed(tables_4_1_and_4_2()), thesis_pair(), 1, track, speed=15.0)
    begin = rolling(Mechanism(as_printed(tables_4_1_and_4_2()), thesis_pair(), 1, track), 15.0)
    *_, state = run(mechanism, begin, 0.05, 1e-3, lambda time: MechanismInputs(brake_torque=(3e3,)))
    frame = mechanism.body(mechanism.frame)
    assert state.q[frame][0] == pytest.approx(0.75, abs=1e-12)
    assert state.q_rate[frame][0] == pytest.approx(15.0, abs=1e-11)


@pytest.mark.study
def test_locked_wheelset_is_that_of_the_fast_model() -> None:
    """25 kN.m on the wheelset of chapter 4 at friction 0.1: time of locking, and sliding afterwards."""
    fast = Kernel(machine(1).library, initial_speed=2.5, friction_1=0.1, brake_torque_1=25e3, tolerance=1e-9)
    table = fast.record(0.05, 1e-4, ["locked_1", "speed", "distance"])
    locked_at = table["time"][int(np.argmax(table["locked_1"]))]
    mechanism = Mechanism(as_printed(tables_4_1_and_4_2()), thesis_pair(), 1, ellipse=fitted_ellipse)
    inputs = MechanismInputs(brake_torque=(25e3,), friction=(0.1,))
    states = list(run(mechanism, rolling(mechanism, 2.5), 0.05, 1e-4, lambda time: inputs))
    first = next(state for state in states if state.direction[0] == 0)
    assert 0.01 < locked_at < 0.04
    assert first.time == pytest.approx(locked_at, abs=1.1e-4)
    assert abs(spin(mechanism, states[-1], 0)) < 1e-6
    axle = mechanism.body(FIRST_WHEELSET).start
    assert states[-1].q_rate[axle] == pytest.approx(table["speed"][-1], abs=1e-5)
    assert states[-1].q[axle] == pytest.approx(table["distance"][-1], abs=1e-6)


def test_first_of_two_wheelsets_that_stop_within_a_step_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The step ends at the earlier stop of either wheelset; here after 0.5 and 0.8 of the step."""
    mechanism = Mechanism(as_printed(tables_5_1_and_5_2()), thesis_pair(), 2)
    begin = rolling(mechanism, 3.0)

    def after(mechanism: Mechanism, state: MechanismState, size: float, drive: object) -> MechanismState:
        return replace(state, time=state.time + size)

    monkeypatch.setattr(program, "step", after)
    for stops in ((0.5, 0.8), (0.8, 0.5)):
        monkeypatch.setattr(program, "spin", lambda m, state, n, stops=stops: stops[n] ** 3 - state.time**3)
        found = program.until_a_wheel_stops(
            mechanism, begin, 1.0, lambda time: MechanismInputs(brake_torque=(1e4, 1e4))
        )
        assert found.time == pytest.approx(0.5, abs=1e-5)


@pytest.mark.study
def test_weak_brake_lets_a_standing_wheelset_go() -> None:
    """A locked wheelset turns again if its brake is reduced below the torque of the rail."""
    mechanism = Mechanism(as_printed(tables_4_1_and_4_2()), thesis_pair(), 1)
    strong, weak = MechanismInputs(brake_torque=(25e3,)), MechanismInputs(brake_torque=(100.0,))
    *_, state = run(mechanism, rolling(mechanism, 3.0), 0.11, 5e-4, lambda time: strong if time < 0.08 else weak)
    assert state.direction[0] == 1
    assert spin(mechanism, state, 0) > 1.0


# -- kinematic analysis, eqs (3.79), (3.80) ----------------------------------------------------------------------


def shifted(mechanism: Mechanism, lateral: float, near: np.ndarray) -> MechanismState:
    return drive_to(mechanism, [DrivenPosition(lateral=lateral)], frames_at_rest(mechanism), near)


def test_rolling_radius_difference_is_that_of_the_contact_search() -> None:
    """Fig. 4.8 by (3.79), (3.80) against a search over the contours for the first point of contact."""
    mechanism = Mechanism(as_printed(tables_4_1_and_4_2()), thesis_pair(), 1)
    shifts = np.array([0.0, 2e-3, 5e-3, 8e-3, -6e-3])
    searched = rolling_radius_difference(thesis_pair(), shifts)
    for shift, expected in zip(shifts, searched, strict=True):
        right, left = rolling_radii(mechanism, shifted(mechanism, float(shift), centred(mechanism)))
        assert left - right == pytest.approx(expected, abs=2e-6)


@pytest.mark.study
def test_newton_raphson_diverges_where_the_fast_model_reports_the_fold() -> None:
    """Section 9.4.1: tread contact is lost at 11.5 mm, the shift from which (3.79) has no solution."""
    mechanism = Mechanism(as_printed(tables_4_1_and_4_2()), thesis_pair(), 1)
    reached = [(0.0, centred(mechanism))]

    def go_on() -> None:
        for shift in np.arange(1e-3, 13e-3, 2e-5).tolist():
            state = shifted(mechanism, shift, reached[-1][1])
            reached.append((shift, np.concatenate([state.q, state.s])))

    with pytest.raises(NoSolutionError, match="No contact of all treads exists at a lateral shift of 11"):
        go_on()
    last = reached[-1][0]
    assert last == pytest.approx(last_tread_contact(thesis_pair()).shift, abs=FOLD_BAND)
    # A slowly growing yaw torque moves the fast model sideways on straight track; it also reports "derailed" there.
    assert derailed_shift() == pytest.approx(last, abs=FOLD_BAND)


def derailed_shift() -> float:
    kernel = Kernel(machine(2).library, initial_speed=10.0, constant_speed=1, wheel_lift_ends=0, flange_stiffness=1e6)
    kernel.set_rate(yaw_torque_1=2e5)
    with pytest.raises(SimulationError, match="lost its tread contact"):
        kernel.advance(20.0)
    return abs(kernel["lateral_1"])
