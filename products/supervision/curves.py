"""Supervision limits of one target: places over the estimated speed, SUBSET-026, 3.13.8 and 3.13.9."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from products.supervision.arcs import Arcs, Eased, braking_arcs
from products.supervision.arguments import check_shapes, name_among, numbers, of_type, switch
from products.supervision.conversion import FASTEST, KMH
from products.supervision.gradients import Gradients, acceleration_by
from products.supervision.steps import Steps
from products.supervision.train import SupervisedTrain, check_train
from products.supervision.values import FixedValues, NationalValues, check_national
from readers.text import BadInputError, shown

#: Kinds of targets: the end of authority, a limit of authority, a lower speed of the most restrictive speed profile.
KINDS = ("EOA", "LOA", "MRSP")
#: Largest speeds [m/s], 600 km/h as in the packets of SUBSET-026, 7.5.1, and accelerations [m/s2].
LARGEST = {
    "V_est": (600.0 * KMH, "m/s", "Give m/s: 100 / 3.6 for 100 km/h."),
    "target_speed": (600.0 * KMH, "m/s", "Give m/s: 40 / 3.6 for 40 km/h."),
    "V_ura": (600.0 * KMH, "m/s", "Give m/s: 2 / 3.6 for 2 km/h."),
    "A_est": (10.0, "m/s2", "Give m/s2."),
}
#: Falls of the brake pipe's pressure at which the brake begins, at which times are locked, and of a full service brake
#: [Pa], A.3.10.4; locked times of SBI1 and SBI2 [s].
BEGINS, LOCKS, FULL = 30e3, 60e3, 150e3
LOCKED_1, LOCKED_2 = 0.0, 2.0
#: Largest acceleration that counts while the brake builds up [m/s2], 3.13.9.3.2.9.
BUILDING_UP = 0.4
#: Largest estimated speed of a train by its brake percentage [m/s]: 200 km/h, and the margin of the emergency brake.
FASTEST_CONVERTED = FASTEST + 15.0 * KMH


@dataclass(frozen=True)
class Curves:
    """Places of the train's front at which each limit has the speeds of `V_est` [m], shape (..., m).

    Parameters
    ----------
    V_est : ndarray
        Speeds [m/s].
    EBD, EBI, SBI2, W, P, I : ndarray
        Deceleration and intervention of the emergency brake, second intervention of the service brake, warning,
        permitted speed and indication.
    SBD, SBI1 : ndarray or None
        Deceleration of the service brake and its first intervention, for the end of authority.
    GUI : ndarray or None
        Guidance, where the country and the train have it.
    """

    V_est: np.ndarray
    EBD: np.ndarray
    EBI: np.ndarray
    SBI2: np.ndarray
    W: np.ndarray
    P: np.ndarray
    I: np.ndarray  # noqa: E741  (name of the standard)
    SBD: np.ndarray | None = None
    SBI1: np.ndarray | None = None
    GUI: np.ndarray | None = None

    @property
    def SBI(self) -> np.ndarray:
        """Return the first intervention of the service brake that the train meets [m]."""
        return self.SBI2 if self.SBI1 is None else np.minimum(self.SBI1, self.SBI2)


def speed_inaccuracy(speed: np.ndarray | float) -> np.ndarray:
    """Return the largest error of the speed that an on-board unit may have, SUBSET-041, 5.3.1.2.

    Takes speed [m/s]; returns [m/s].
    """
    return np.asarray(np.interp(speed, (30.0 * KMH, 500.0 * KMH), (2.0 * KMH, 12.0 * KMH)))


def supervise(
    train: SupervisedTrain,
    place: float | np.ndarray,
    V_est: np.ndarray | float,
    *,
    kind: str = "EOA",
    target_speed: float | np.ndarray = 0.0,
    beyond: float | np.ndarray = 0.0,
    gradients: Gradients | None = None,
    national: NationalValues | None = None,
    fixed: FixedValues | None = None,
    A_est: float | np.ndarray = 0.0,
    V_ura: np.ndarray | float | None = None,
    slippery: bool = False,
    pipe_fall: float | np.ndarray = 0.0,
) -> Curves:
    """Return the supervision limits of one target for a train or many trains.

    Takes place [m] (...), V_est [m/s] (m), target_speed [m/s], beyond [m], A_est [m/s2], V_ura [m/s], pipe_fall [Pa].
    """
    check_train(train)
    national, fixed, gradients = checked_values(national, fixed, gradients)
    switch("slippery", slippery)
    of_trains = {"target_speed": target_speed, "beyond": beyond, "place": place, "A_est": A_est, "pipe_fall": pipe_fall}
    speeds = _checked_speeds(train, kind, V_est, V_ura, of_trains)
    target, foot = np.asarray(target_speed, dtype=float), np.asarray(place, dtype=float)
    edges, permille = gradients.lowest_under(train.length)
    slopes = edges, acceleration_by(permille, train.rotating)
    end, end_speed = (foot + beyond, target) if kind == "EOA" else (foot, target + fixed.dV_ebi(target))
    emergency = braking_arcs(end, end_speed, train.safe_brake(national, slippery), slopes)
    T_be, T_bs = (time[..., None] for time in map(np.asarray, train.build_up_times(national, target)))
    if V_ura is None and national.exact_speed:
        V_ura = 0.0
    error = speed_inaccuracy(speeds) if V_ura is None else np.asarray(V_ura, dtype=float)
    accelerates = np.asarray(A_est, dtype=float)[..., None]
    T_bs1, T_bs2 = _service_times(T_bs, train, np.asarray(pipe_fall, dtype=float)[..., None], national.feedback)
    to_brake = _ToBrake.of(train, emergency, T_be, T_bs2 + fixed.T_warning)
    EBI = to_brake.begins(speeds, target[..., None], error, accelerates)
    SBI = SBI2 = EBI - speeds * T_bs2
    SBD = SBI1 = GUI = None
    if kind == "EOA":
        SBD = braking_arcs(foot, 0.0, train.A_brake_service, slopes).place_at(speeds)
        SBI1 = SBD - speeds * T_bs1
        SBI = np.minimum(SBI1, SBI2)
    P = SBI - speeds * fixed.T_driver
    if national.guidance and train.A_brake_normal_service is not None:
        start = foot
        if kind != "EOA":  # P at the target speed, 3.13.9.3.5.9
            at_target = target[..., None]
            still = to_brake.begins(at_target, at_target, predicted_error(V_ura, at_target), 0.0)
            start = (still - at_target * (T_bs2 + fixed.T_driver))[..., 0]
        # On boundaries of their own: the walk finds all three by one number of a step.
        every = (train.A_brake_normal_service, train.Kn_plus, train.Kn_minus)
        brake, up, down = (
            Steps.constant(0.0).with_others(lambda zero, *of, n=n: of[n] + zero, *every) for n in range(3)
        )
        GUI = braking_arcs(start, target, brake, slopes, Eased(up, down, permille)).place_at(speeds)
        P = np.minimum(P, GUI)
    share = 0.0 if train.service_feedback and national.feedback else 0.8  # 3.13.9.3.6
    T_indication = np.maximum(share * T_bs, fixed.T_indication_least) + fixed.T_indication_more
    EBD = emergency.place_at(speeds)
    return Curves(speeds, EBD, EBI, SBI2, SBI - speeds * fixed.T_warning, P, P - speeds * T_indication, SBD, SBI1, GUI)


def predicted_error(V_ura: np.ndarray | float | None, speed: np.ndarray | float) -> np.ndarray:
    """Return the error of the speed that the standard assumes at a speed which the train does not have yet.

    Takes speed [m/s]; returns [m/s].
    """
    inhibited = V_ura is not None and not np.any(V_ura)
    return np.zeros_like(speed, dtype=float) if inhibited else speed_inaccuracy(speed)


def _checked_speeds(
    train: SupervisedTrain, kind: str, V_est: Any, V_ura: Any, of_trains: Mapping[str, Any]
) -> np.ndarray:
    """Return the estimated speeds, if they, the target and the train go together."""
    name_among("kind", kind, KINDS)
    V_ura = 0.0 if V_ura is None else V_ura
    for name, value in {**of_trains, "V_est": V_est, "V_ura": V_ura}.items():
        array, signed = numbers(name, value), name in ("place", "A_est")
        if not np.all(np.isfinite(array) & (signed | (array >= 0.0))):
            limit = "finite" if signed else "finite and at least 0"
            raise BadInputError(f"{name} must be {limit}; got {shown(value)}. Correct it.")
        most, unit, hint = LARGEST.get(name, (np.inf, "", ""))
        if np.any(np.abs(array) > most * (1.0 + 1e-9)):
            raise BadInputError(f"{name} must be at most {most:.4g} {unit}; got {shown(value)}. {hint}")
    target, beyond = (np.asarray(of_trains[name], dtype=float) for name in ("target_speed", "beyond"))
    if kind == "EOA" and np.any(target > 0.0):
        raise BadInputError("target_speed must be 0 at an end of authority (EOA). Give kind='LOA' for a moving target.")
    if kind != "EOA" and np.any(beyond != 0.0):
        raise BadInputError(f"beyond must be 0 for {kind}: only an end of authority (EOA) has an SvL behind it.")
    speeds = np.atleast_1d(np.asarray(V_est, dtype=float))
    fastest = speeds.max(initial=0.0)
    check_shapes({"V_est": speeds.shape, "V_ura": np.shape(V_ura)})
    shapes = {name: np.shape(value) for name, value in of_trains.items()}
    check_shapes({"train": train.shape, **shapes, "V_est": speeds.shape[:-1]})
    if train.position is not None and fastest > FASTEST_CONVERTED:
        raise BadInputError(
            f"V_est must be at most {FASTEST_CONVERTED / KMH:g} km/h for a train by its brake percentage (SUBSET-026, "
            f"3.13.3.2); got {fastest / KMH:.1f} km/h. Give decelerations by speed instead."
        )
    # One speed is that of a moment, which may be below the target's.
    if speeds.shape[-1] > 1 and np.any(target > fastest):
        raise BadInputError(
            f"target_speed must be at most the largest V_est, {fastest:g} m/s; got {target.max():g} m/s. Give "
            "m/s: 40 / 3.6 for 40 km/h."
        )
    return speeds


def checked_values(
    national: object, fixed: object = None, gradients: object = None
) -> tuple[NationalValues, FixedValues, Gradients]:
    """Return values of the country and of the baseline, and gradients, if they are of their types."""
    remedy = "Give Gradients(starts, permille)."
    return (
        check_national(NationalValues() if national is None else national),
        of_type("fixed", FixedValues() if fixed is None else fixed, FixedValues, "Give FixedValues(...)."),
        of_type("gradients", Gradients.level() if gradients is None else gradients, Gradients, remedy),
    )


def _service_times(
    T_bs: np.ndarray, train: SupervisedTrain, pipe_fall: np.ndarray, permitted: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return T_bs1 and T_bs2: times from both interventions to SBD and to EBI, 3.13.9.3.3 and A.3.10.

    Takes T_bs [s], pipe_fall [Pa]; returns T_bs1, T_bs2 [s].
    """
    if not train.service_command:
        return np.zeros_like(T_bs), np.zeros_like(T_bs)
    if not (train.service_feedback and permitted):
        return T_bs, T_bs
    reduced = np.where(pipe_fall < BEGINS, T_bs, T_bs * (FULL - pipe_fall) / FULL)
    first = np.where(pipe_fall < LOCKS, reduced, LOCKED_1)
    return first, np.maximum(np.where(pipe_fall < LOCKS, reduced, LOCKED_2), LOCKED_2)


@dataclass(frozen=True)
class _ToBrake:
    """Times from the command of the emergency brake to its full force, with and without traction [s]."""

    emergency: Arcs
    traction: np.ndarray
    building: np.ndarray

    @classmethod
    def of(cls, train: SupervisedTrain, emergency: Arcs, T_be: np.ndarray, warned: np.ndarray) -> _ToBrake:
        """`warned`: time from the warning, at which traction is cut off, to the emergency brake [s], 3.13.9.3.2.3."""
        cut_off = np.asarray(train.T_traction_cut_off, dtype=float)[..., None]
        if train.traction_command:
            cut_off = np.maximum(cut_off - warned, 0.0)
        return cls(emergency, cut_off, np.maximum(T_be - cut_off, 0.0))

    def begins(
        self, V_est: np.ndarray, V_target: np.ndarray, error: np.ndarray, A_est: np.ndarray | float
    ) -> np.ndarray:
        """Return EBI: from there the train reaches EBD as traction is cut off and the brake builds up, 3.13.9.3.2."""
        pulled = np.maximum(A_est, 0.0) * self.traction
        crept = np.clip(A_est, 0.0, BUILDING_UP) * self.building
        after = np.maximum(V_est + error + pulled, V_target)
        with_traction = np.maximum(V_est + error + pulled / 2.0, V_target) * self.traction
        return self.emergency.place_at(after + crept) - with_traction - (after + crept / 2.0) * self.building
