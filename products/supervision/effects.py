"""National values that change no limit of a train, SUBSET-026, 3.13.6.2."""

from __future__ import annotations

from products.supervision.arguments import switch
from products.supervision.train import SupervisedTrain, check_train
from products.supervision.values import NationalValues, check_national

#: Values for brake percentages, and for passenger trains with two sets of them, by field of `NationalValues`.
OF_PERCENTAGES = {"Kv_int": "M_NVKVINT", "Kr_int": "M_NVKRINT", "Kt_int": "M_NVKTINT"}
OF_TWO_SETS = {"Kv_int_b": "M_NVKVINT_b", "A_NVP12": "A_NVP12", "A_NVP23": "A_NVP23"}


def without_effect(train: SupervisedTrain, national: NationalValues, slippery: bool = False) -> list[str]:
    """Return the national values that differ from their defaults but change no limit of a train."""
    check_train(train)
    check_national(national)
    switch("slippery", slippery)
    default = NationalValues()
    found = [
        f"{name} ({reason})"
        for of, name, reason in _reasons(train, national)
        if repr(getattr(national, of)) != repr(getattr(default, of))
    ]
    for number, (one, usual) in enumerate(zip(national.reduced_adhesion, default.reduced_adhesion, strict=True)):
        if one != usual and not (slippery and number == train.adhesion_number):
            found.append(f"A_NVMAXREDADH{number + 1} ({'another train' if slippery else 'no reduced adhesion'})")
    return found


def _reasons(train: SupervisedTrain, national: NationalValues) -> list[tuple[str, str, str]]:
    """Return field, name and reason of values that this train does not use."""
    found = []
    if train.position is None:
        reason = "it corrects brake percentages"
        found += [(of, name, reason) for of, name in (OF_PERCENTAGES | OF_TWO_SETS).items()]
        if train.level is None:
            found.append(("M_NVEBCL", "M_NVEBCL", "Kdry_rst has no levels"))
        if (train.Kwet_rst.values == 1.0).all():
            found.append(("M_NVAVADH", "M_NVAVADH", "Kwet_rst is 1"))
    else:
        found += [(name, name, "it corrects decelerations") for name in ("M_NVEBCL", "M_NVAVADH")]
        if national.Kv_int_b is None or not train.is_passenger:
            reason = "passenger trains with two sets of M_NVKVINT use it"
            found += [(of, name, reason) for of, name in OF_TWO_SETS.items()]
    if train.A_brake_normal_service is None:
        found.append(("guidance", "Q_NVGUIPERM", "no A_brake_normal_service"))
    if not train.service_feedback:
        found.append(("feedback", "Q_NVSBFBPERM", "no feedback of the service brake"))
    return found
