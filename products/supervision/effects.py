"""National values that change no limit of a train, SUBSET-026, 3.13.6.2."""

from __future__ import annotations

from collections.abc import Iterator

from products.supervision.arguments import switch
from products.supervision.train import SupervisedTrain, check_train
from products.supervision.values import NationalValues, check_national

#: Fields of `NationalValues` that belong together, with the names of their values.
OF_DECELERATIONS = {"M_NVEBCL": "M_NVEBCL", "M_NVAVADH": "M_NVAVADH"}
OF_PERCENTAGES = {"Kv_int": "M_NVKVINT", "Kr_int": "M_NVKRINT", "Kt_int": "M_NVKTINT"}
OF_TWO_SETS = {"Kv_int_b": "M_NVKVINT_b", "A_NVP12": "A_NVP12", "A_NVP23": "A_NVP23"}


def without_effect(train: SupervisedTrain, national: NationalValues, slippery: bool = False) -> list[str]:
    """Return the national values that differ from their defaults but change no limit of a train."""
    check_train(train)
    check_national(national)
    switch("slippery", slippery)
    default, silent = NationalValues(), []
    for values, reason in _reasons(train, national):
        for field, name in values.items():
            if repr(getattr(national, field)) != repr(getattr(default, field)):
                silent.append(f"{name} ({reason})")
    for number, (most, usual) in enumerate(zip(national.reduced_adhesion, default.reduced_adhesion, strict=True)):
        if most != usual and not (slippery and number == train.adhesion_number):
            silent.append(f"A_NVMAXREDADH{number + 1} ({'another train' if slippery else 'no reduced adhesion'})")
    return silent


def _reasons(train: SupervisedTrain, national: NationalValues) -> Iterator[tuple[dict[str, str], str]]:
    """Yield values that this train does not use, and the reason."""
    if train.position is None:
        yield OF_PERCENTAGES | OF_TWO_SETS, "it corrects brake percentages"
        if train.level is None:
            yield {"M_NVEBCL": "M_NVEBCL"}, "Kdry_rst has no levels"
        if (train.Kwet_rst.values == 1.0).all():
            yield {"M_NVAVADH": "M_NVAVADH"}, "Kwet_rst is 1"
    else:
        yield OF_DECELERATIONS, "it corrects decelerations"
        if national.Kv_int_b is None or not train.is_passenger:
            yield OF_TWO_SETS, "passenger trains with two sets of M_NVKVINT use it"
    if train.A_brake_normal_service is None:
        yield {"guidance": "Q_NVGUIPERM"}, "no A_brake_normal_service"
    if not train.service_feedback:
        yield {"feedback": "Q_NVSBFBPERM"}, "no feedback of the service brake"
