"""Supervision limits of one target: places over the estimated speed, SUBSET-026, 3.13.8 and 3.13.9."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from products.supervision.arcs import Arcs, Eased, braking_arcs
from products.supervision.arguments import check_shapes, name_among, numbers, of_type, switch
from products.supervision.conversion import FASTEST, KMH
from products.supervision.feedback import service_times
from products.supervision.gradients import Gradients, acceleration_by
from products.supervision.steps import Steps
from products.supervision.train import SupervisedTrain, check_train
from products.supervision.values import FixedValues, NationalValues, check_national
from readers.text import BadInputError, shown

#: Kinds of targets: the end of authority, a limit of authority, a lower speed of the most restrictive speed profile.
KINDS = ("EOA", "LOA", "MRSP")
#: Remedy for gradients of another type.
GIVE_GRADIENTS = "Give Gradients(starts, permille)."
#: Largest speeds [m/s], 600 km/h as in the packets of SUBSET-026, 7.5.1, and accelerations [m/s2].
LARGEST = {
    "V_est": (600.0 * KMH, "m/s", "Give m/s: 100 / 3.6 for 100 km/h."),
    "target_speed": (600.0 * KMH, "m/s", "Give m/s: 40 / 3.6 for 40 km/h."),
    "V_ura": (600.0 * KMH, "m/s", "Give m/s: 2 / 3.6 for 2 km/h."),
    "A_est": (10.0, "m/s2", "Give m/s2."),
}
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
    others = {"V_est": V_est, "place": place, "A_est": A_est, "pipe_fall": pipe_fall}
    _check(kind, target_speed, beyond, **others, V_ura=0.0 if V_ura is None else V_ura)
    speeds = np.atleast_1d(np.asarray(V_est, dtype=float))
    of_trains = {"place": place, "target_speed": target_speed, "beyond": beyond, "A_est": A_est, "pipe_fall": pipe_fall}
    _check_shapes(train, speeds, V_ura, **of_trains)
    _check_converted(train, speeds)
    _check_target(target_speed, speeds)
    target, foot = np.asarray(target_speed, dtype=float), np.asarray(place, dtype=float)
    slopes = _slopes(train, gradients)
    if kind == "EOA":
        emergency = braking_arcs(foot + beyond, 0.0, train.safe_brake(national, slippery), slopes)
    else:
        emergency = braking_arcs(foot, target + fixed.dV_ebi(target), train.safe_brake(national, slippery), slopes)
    T_be, T_bs = (time[..., None] for time in map(np.asarray, train.build_up_times(national, target)))
    if V_ura is None and national.exact_speed:
        V_ura = 0.0
    error = speed_inaccuracy(speeds) if V_ura is None else np.asarray(V_ura, dtype=float)
    accelerates = np.asarray(A_est, dtype=float)[..., None]
    T_bs1, T_bs2 = service_times(T_bs, train, np.asarray(pipe_fall, dtype=float)[..., None], national.feedback)
    to_brake = _ToBrake.of(train, emergency, T_be, T_bs2 + fixed.T_warning)
    EBI = to_brake.begins(speeds, target[..., None], error, accelerates)
    SBI2, SBD, SBI1 = EBI - speeds * T_bs2, None, None
    if kind == "EOA":
        SBD = braking_arcs(foot, 0.0, train.A_brake_service, slopes).place_at(speeds)
        SBI1 = SBD - speeds * T_bs1
    SBI = SBI2 if SBI1 is None else np.minimum(SBI1, SBI2)
    P, GUI = SBI - speeds * fixed.T_driver, None
    if national.guidance and train.A_brake_normal_service is not None:
        start = foot
        if kind != "EOA":  # P at the target speed, 3.13.9.3.5.9
            at_target = target[..., None]
            still = to_brake.begins(at_target, at_target, predicted_error(V_ura, at_target), 0.0)
            start = (still - at_target * (T_bs2 + fixed.T_driver))[..., 0]
        GUI = _guidance(train, start, target, gradients).place_at(speeds)
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


def _check_shapes(train: SupervisedTrain, speeds: np.ndarray, V_ura: Any, **others: Any) -> None:
    """Refuse targets, speeds and errors that belong to different numbers of trains or of speeds."""
    check_shapes({"V_est": speeds.shape, "V_ura": () if V_ura is None else np.shape(V_ura)})
    of_trains = {name: np.shape(one) for name, one in others.items()}
    check_shapes({"train": train.shape} | of_trains | {"V_est": speeds.shape[:-1]})


def _check_converted(train: SupervisedTrain, speeds: np.ndarray) -> None:
    """Refuse speeds outside the range of the conversion model."""
    if train.position is not None and speeds.max(initial=0.0) > FASTEST_CONVERTED:
        raise BadInputError(
            f"V_est must be at most {FASTEST_CONVERTED / KMH:g} km/h for a train by its brake percentage (SUBSET-026, "
            f"3.13.3.2); got {speeds.max() / KMH:.1f} km/h. Give decelerations by speed instead."
        )


def _check_target(target_speed: object, speeds: np.ndarray) -> None:
    """Refuse a target that is faster than the train at each of several speeds. One speed is that of a moment."""
    target, fastest = np.asarray(target_speed, dtype=float), speeds.max(initial=0.0)
    if speeds.shape[-1] > 1 and np.any(target > fastest):
        raise BadInputError(
            f"target_speed must be at most the largest V_est, {fastest:g} m/s; got {target.max():g} m/s. Give "
            "m/s: 40 / 3.6 for 40 km/h."
        )


def checked_values(
    national: object, fixed: object = None, gradients: object = None
) -> tuple[NationalValues, FixedValues, Gradients]:
    """Return values of the country and of the baseline, and gradients, if they are of their types."""
    return (
        check_national(NationalValues() if national is None else national),
        of_type("fixed", FixedValues() if fixed is None else fixed, FixedValues, "Give FixedValues(...)."),
        of_type("gradients", Gradients.level() if gradients is None else gradients, Gradients, GIVE_GRADIENTS),
    )


def _check(kind: str, target_speed: object, beyond: object, **others: object) -> None:
    name_among("kind", kind, KINDS)
    for name, value in {"target_speed": target_speed, "beyond": beyond, **others}.items():
        array, signed = numbers(name, value), name in ("place", "A_est")
        if not np.all(np.isfinite(array) & (signed | (array >= 0.0))):
            limit = "finite" if signed else "finite and at least 0"
            raise BadInputError(f"{name} must be {limit}; got {shown(value)}. Correct it.")
        largest = LARGEST.get(name)
        if largest is not None and np.any(np.abs(array) > largest[0] * (1.0 + 1e-9)):
            most, unit, hint = largest
            raise BadInputError(f"{name} must be at most {most:.4g} {unit}; got {shown(value)}. {hint}")
    if kind == "EOA" and np.any(np.asarray(target_speed, dtype=float) > 0.0):
        raise BadInputError("target_speed must be 0 at an end of authority (EOA). Give kind='LOA' for a moving target.")
    if kind != "EOA" and np.any(np.asarray(beyond, dtype=float) != 0.0):
        raise BadInputError(f"beyond must be 0 for {kind}: only an end of authority (EOA) has an SvL behind it.")


def _slopes(train: SupervisedTrain, gradients: Gradients) -> tuple[np.ndarray, np.ndarray]:
    edges, permille = gradients.lowest_under(train.length)
    return edges, acceleration_by(permille, train.rotating)


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


def _guidance(train: SupervisedTrain, start: np.ndarray, target: np.ndarray, gradients: Gradients) -> Arcs:
    """Return GUI, the curve of a driver who brakes in comfort, 3.13.8.5."""
    brake = train.A_brake_normal_service
    assert brake is not None
    edges, permille = gradients.lowest_under(train.length)
    # On boundaries of their own: the walk finds all three by one number of a step.
    every = (brake, train.Kn_plus, train.Kn_minus)
    brake, up, down = (Steps.constant(0.0).with_others(_nth(n), *every) for n in range(len(every)))
    slopes = acceleration_by(permille, train.rotating)
    return braking_arcs(start, target, brake, (edges, slopes), Eased(up, down, permille))


def _nth(number: int) -> Callable[..., np.ndarray]:
    return lambda zero, *values: values[number] + zero
