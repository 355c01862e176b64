"""The torque that must not cross the interface: a signed brake torque, from the wheel speed of the last macro step."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import bisect

from fmu_src.cosimulation.master import cosimulate
from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import FmuInstance
from products.bogie import BOGIE, FULL_TORQUE
from scenarios.bench.braked_bogie import acceleration_per_torque, bogie_values

WHEELSETS = (1, 2)
RECORDED = ("speed", "angular_velocity_1", "angular_velocity_2", "creep_force_1", "creep_force_2")
#: Initial speed of the stop, a walking pace [m/s]; time in which the suspension's swaying decays [s]; time of the
#: evaluation [s], and its least number of macro steps.
STOP_SPEED, SWAYING, LOOK, LOOK_STEPS = 0.5, 2.0, 0.4, 30
#: The skid: a friction at which the full brake locks the wheels at once.
SKID_SPEED, SKID_FRICTION, SKID_SECONDS, SKID_STEPS = 10.0, 0.1, 1.5, 150
#: Tested widths of a smoothed sign over the theoretical one, and resolution of the least one; largest jump at rest,
#: over that of a sharp sign (a residual swaying remains).
WIDTHS, WIDTH_RESOLUTION, STANDING = (0.5, 2.0), 0.01, 0.05


@dataclass(frozen=True)
class Chatter:
    """Jump of the wheels' rim speed in a macro step, largest speed of the bogie, largest rim speed backward [m/s].

    The jump is the mean of the mean rise and the mean fall. This is the effect of the torque alone: a constant force
    (adhesion in a skid, a stretched suspension) increases the one and decreases the other equally.

    standing: share of the time in which the angular velocity of every wheelset is exactly 0. adhesion: largest force of
    the rails, over that of the brake; at rest it balances the swaying suspension.
    """

    jump: float
    speed: float
    backward: float
    standing: float
    adhesion: float
    series: Recording


def judge(series: Recording, begin: float) -> Chatter:
    """Return the chatter of the wheels after a time [s]."""
    late = series["time"] >= begin
    rims = BOGIE.wheel_radius * np.array([series[f"angular_velocity_{number}"][late] for number in WHEELSETS])
    standing = (rims == 0.0).all(axis=0).mean()
    force = max(np.abs(series[f"creep_force_{number}"][late]).max() for number in WHEELSETS)
    change = np.diff(rims)
    moved = bool(change.any())
    jump = (change[change > 0.0].mean() - change[change < 0.0].mean()) / 2 if moved else 0.0
    speed = np.abs(series["speed"][late]).max()
    adhesion = force * BOGIE.wheel_radius / FULL_TORQUE
    return Chatter(float(jump), float(speed), float(-rims.min()), float(standing), float(adhesion), series)


def play_signed(bogie: FmuInstance, duration: float, step: float, width: float = 0.0) -> Recording:
    """Run with brake torques as traction torques against the rotation at the start of each macro step.

    Takes duration, step [s], width [rad/s].
    """

    def drive(_: float) -> None:
        turning = np.array(bogie.get([f"angular_velocity_{number}" for number in WHEELSETS]))
        torques = -FULL_TORQUE * (np.tanh(turning / width) if width else np.sign(turning))
        bogie.set(traction_torque_1=torques[0], traction_torque_2=torques[1])

    return cosimulate([bogie], [], duration, step, [(bogie, name) for name in RECORDED], drive)


def stop_time() -> float:
    return STOP_SPEED / (acceleration_per_torque() * FULL_TORQUE)


def signed_stop(bogie: FmuInstance, step: float, width: float = 0.0) -> Chatter:
    """Return the residual motion after a stop with a signed torque."""
    bogie.restart(bogie_values(STOP_SPEED))
    begin = stop_time() + SWAYING
    return judge(play_signed(bogie, begin + max(LOOK, LOOK_STEPS * step), step, width), begin)


def capacity_stop(bogie: FmuInstance, step: float) -> Chatter:
    """Return the same stop with the torque as a capacity."""
    bogie.restart(bogie_values(STOP_SPEED), brake_torque_1=FULL_TORQUE, brake_torque_2=FULL_TORQUE)
    begin = stop_time() + SWAYING
    series = cosimulate([bogie], [], begin + LOOK, step, [(bogie, name) for name in RECORDED])
    return judge(series, begin)


def signed_skid(bogie: FmuInstance, step: float) -> Chatter:
    """Return the chatter of wheels that should be locked while the bogie slides, over the second half."""
    bogie.restart(bogie_values(SKID_SPEED), friction_1=SKID_FRICTION, friction_2=SKID_FRICTION)
    duration = max(SKID_SECONDS, SKID_STEPS * step)
    return judge(play_signed(bogie, duration, step), duration / 2)


def width_that_stands(bogie: FmuInstance, step: float) -> float:
    """Return the least smoothing of the sign with which the bogie comes to rest, by bisection [rad/s]."""

    def stands(factor: float) -> float:
        found = signed_stop(bogie, step, factor * width_on_paper(step))
        return 1.0 if found.jump < STANDING * jump_at_rest(step) else -1.0

    return width_on_paper(step) * float(bisect(stands, *WIDTHS, xtol=WIDTH_RESOLUTION))


def rolling_inertia() -> float:
    """Return J + m r^2 of a rolling wheelset [kg.m2]."""
    return BOGIE.wheelset_pitch_inertia + BOGIE.wheelset_mass * BOGIE.wheel_radius**2


def width_on_paper(step: float) -> float:
    """Return h T / 2 (J + m r^2) [rad/s]: with more, a torque T w/w_eps constant over h removes less than twice the
    speed w.
    """
    return step * FULL_TORQUE / (2 * rolling_inertia())


def jump_at_rest(step: float) -> float:
    """Return the jump of a rolling wheelset that is free of its suspension, h T r / (J + m r^2), for h below its period
    [m/s].
    """
    return step * FULL_TORQUE * BOGIE.wheel_radius / rolling_inertia()


def jump_of_whole_bogie(step: float) -> float:
    """Return the jump of the bogie as one mass, for h above the periods of the suspension [m/s]."""
    return step * FULL_TORQUE * acceleration_per_torque()


def jump_in_skid(step: float) -> float:
    """Return the jump of a wheelset that turns freely under the sliding bogie, h T r / J [m/s]."""
    return step * FULL_TORQUE * BOGIE.wheel_radius / BOGIE.wheelset_pitch_inertia
