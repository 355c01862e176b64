"""Train data of ETCS from an OSRD rolling stock, and for one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from products.supervision.arguments import path_of
from products.supervision.steps import Steps
from products.supervision.train import SupervisedTrain, check_train
from readers.documents import LARGEST, document, number_in
from readers.formats.osrd_brake import BEFORE, brake_params_of
from readers.text import BadInputError, FileError, text_of

#: Step functions: attribute of `SupervisedTrain` by the name of OSRD.
CURVES = {
    "gamma_emergency": "A_brake_emergency",
    "gamma_service": "A_brake_service",
    "gamma_normal_service": "A_brake_normal_service",
    "k_dry": "Kdry_rst",
    "k_wet": "Kwet_rst",
    "k_n_pos": "Kn_plus",
    "k_n_neg": "Kn_minus",
}
#: Time from the warning to the end of the permitted time before the service brake, T_warning [s], A.3.1.
WARNED = 2.0


def read_osrd_train(path: str | Path) -> SupervisedTrain:
    """Return the ETCS train data of an OSRD rolling stock."""
    path = path_of(path)
    found = osrd_train_of(document(text_of(path, LARGEST).encode(), str(path)), str(path))
    if found is None:
        raise FileError(f"{path} must be an OSRD rolling stock with {BEFORE}; got none.")
    return found


def osrd_train_of(read: Any, source: str) -> SupervisedTrain | None:
    """Return the train of a rolling stock, as `read_osrd_train` does; None if it has no ETCS brake."""
    params = brake_params_of(read, source)
    if params is None:
        return None
    curves, times = params
    if times["t_bs1"] != times["t_bs2"]:
        raise FileError(
            f"{source}: t_bs1 and t_bs2 must be equal; got {times['t_bs1']:g} and {times['t_bs2']:g} s. They "
            "differ with feedback of the service brake alone, which OSRD does not model."
        )
    steps: dict[str, Any] = {}
    for name, of in CURVES.items():
        try:
            steps[of] = Steps(*(np.array(curve) for curve in curves[name]))
        except BadInputError as error:
            raise FileError(f"{source}, {name}: {error}") from None
    length = number_in(read, "length", source, 1.0, 4095.0)
    try:
        return SupervisedTrain(
            length,
            T_brake_emergency=times["t_be"],
            T_brake_service=times["t_bs1"],
            T_traction_cut_off=times["t_traction_cut_off"],
            traction_command=True,
            service_command=True,
            **steps,
        )
    except BadInputError as error:
        raise FileError(f"{source}: {error}") from None


def osrd_document(train: SupervisedTrain) -> dict[str, Any]:
    """Return length and `etcs_brake_params` of a train, to be put into a rolling stock of OSRD.

    Returns [m].
    """
    check_train(train)
    if train.position is not None:
        raise BadInputError("OSRD has decelerations, no brake percentages. Give a train by its decelerations.")
    if np.ndim(train.length) or train.A_brake_emergency.values.ndim > 1:
        raise BadInputError("A rolling stock of OSRD is one train; got several. Write one file for each.")
    if train.service_feedback or not train.service_command:
        raise BadInputError(
            "OSRD supposes that the on-board unit commands the service brake, without feedback. Give a train with "
            "service_command (--service on the command line) and without service_feedback."
        )
    params: dict[str, Any] = {}
    for name, of in CURVES.items():
        steps = getattr(train, of)
        steps = train.A_brake_service if steps is None else steps
        params[name] = {"boundaries": steps.boundaries.tolist(), "values": steps.values.tolist()}
    service, cut_off = (float(np.asarray(one)) for one in (train.T_brake_service, train.T_traction_cut_off))
    # OSRD subtracts the times from the warning on from the cut-off, which a train without its command does not.
    params["t_traction_cut_off"] = cut_off if train.traction_command or not cut_off else cut_off + WARNED + service
    params |= {"t_bs1": service, "t_bs2": service, "t_be": float(np.asarray(train.T_brake_emergency))}
    return {"length": float(np.asarray(train.length)), BEFORE: params}
