"""Parameters of BrakingCurves.fmu from the train data and national values of products/supervision."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from products.braking_curves.variables import UNUSED
from products.etcs_files.national import read_national
from products.etcs_files.train_file import etcs_train_in
from products.supervision import BASELINES, FixedValues, NationalValues, Steps, SupervisedTrain
from products.supervision.conversion import MOVING_TARGET
from products.supervision.curves import checked_values
from products.supervision.train import MOST_STEPS, check_train
from readers.text import BadInputError, shown

#: Baselines by the time that they add to the indication [s].
_BASELINES = {BASELINES["3.3.0"]: 3, BASELINES["4.0.0"]: 4}


def fmu_parameters(
    train: SupervisedTrain,
    national: NationalValues | None = None,
    fixed: FixedValues | None = None,
    *,
    version: int = 2,
) -> dict[str, float | list[float]]:
    """Return the parameters of BrakingCurves.fmu for one train."""
    if not isinstance(version, int) or version not in (2, 3):
        raise BadInputError(f"version must be 2 or 3, that of FMI; got {shown(version)}.")
    check_train(train)
    national, fixed, _ = checked_values(national, fixed)
    _check(train, national, fixed)
    train.check_level(national.M_NVEBCL)
    found = _numbers(train, national) | {"baseline": float(_BASELINES[fixed.T_indication_more])}
    dry, wet = train.factors(national)
    steps = {"A_brake_emergency": train.A_brake_emergency, "A_brake_service": train.A_brake_service}
    for name, of_speed in (steps | {"Kdry_rst": dry, "Kwet_rst": wet}).items():
        found |= _filled(name, of_speed)
    return found if version == 3 else _elements(found)


def data_in(train: Path, national: Path | None) -> tuple[SupervisedTrain, NationalValues]:
    """Return train data at the confidence level of national values, both from files. Raises ValueError, OSError."""
    country = NationalValues() if national is None else read_national(national)
    data = etcs_train_in(train)
    if data is None:
        raise BadInputError(
            "--train must be train data of bogie-braking etcs, or an OSRD rolling stock with etcs_brake_params; got "
            f"{train}. Write: etcs CONSIST --target 2000, which makes results/etcs-CONSIST.json."
        )
    return data.at_level(country.M_NVEBCL), country


def _numbers(train: SupervisedTrain, national: NationalValues) -> dict[str, float | list[float]]:
    """Return all parameters but the steps and the baseline."""
    emergency_time, service_time = (float(time) for time in train.build_up_times(national, 0.0))
    return {
        "length": _one("length", train.length),
        "T_brake_emergency": emergency_time,
        "T_brake_service": service_time,
        "moving_target_factor": MOVING_TARGET.get(str(train.position), 1.0),
        "T_traction_cut_off": _one("T_traction_cut_off", train.T_traction_cut_off),
        "traction_command": float(train.traction_command),
        "service_command": float(train.service_command),
        "M_rotating_nom": -1.0 if train.rotating is None else _one("rotating", train.rotating),
        "M_NVAVADH": national.M_NVAVADH,
        "Q_NVINHSMICPERM": float(national.exact_speed),
        "A_NVMAXREDADH": national.reduced_adhesion[train.adhesion_number],
    }


def _check(train: SupervisedTrain, national: NationalValues, fixed: FixedValues) -> None:
    """Raise BadInputError for values that the FMU does not have."""
    if national.guidance and train.A_brake_normal_service is not None:
        raise BadInputError("BrakingCurves has no guidance curve; got guidance=True. Set guidance to False.")
    if train.service_feedback:
        raise BadInputError("BrakingCurves has no feedback of the service brake. Set service_feedback to False.")
    same = FixedValues(T_indication_more=fixed.T_indication_more)
    if fixed != same or fixed.T_indication_more not in _BASELINES:
        raise BadInputError(
            f"BrakingCurves has the fixed values of baselines {' and '.join(BASELINES)}; got {fixed}. Take one of both."
        )


def _one(name: str, value: float | np.ndarray) -> float:
    if np.size(value) != 1:
        raise BadInputError(
            f"{name} must be that of one train; got {np.size(value)} values. Give an FMU to each train."
        )
    return float(np.ravel(value)[0])


def _filled(name: str, steps: Steps) -> dict[str, float | list[float]]:
    """Return values and boundaries of a step function, with unused ones at its end."""
    holds = np.diff(steps.boundaries, prepend=-1.0, append=np.inf) > 0.0  # equal boundaries enclose no speed
    if steps.values.ndim != 1 or holds.sum() > MOST_STEPS:
        raise BadInputError(
            f"{name} must have at most {MOST_STEPS} steps, of one train; got {shown(steps.values.tolist())}. "
            "Unite some of them, with the lower value."
        )
    values, boundaries = steps.values[holds].tolist(), steps.boundaries[holds[:-1]].tolist()
    more = MOST_STEPS - len(values)
    return {name: values + values[-1:] * more, f"{name}_speed": boundaries + [UNUSED] * more}


def _elements(found: dict[str, float | list[float]]) -> dict[str, float | list[float]]:
    """Return an entry for each element of an array, with the names of FMI 2.0."""
    single: dict[str, float | list[float]] = {}
    for name, value in found.items():
        each = {f"{name}[{n}]": one for n, one in enumerate(value, 1)} if isinstance(value, list) else {name: value}
        single |= each
    return single
