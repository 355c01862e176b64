"""Checks of the registered distributors: each kind has a name and parameters of its own, and built-in sets of these."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields

from brake_controller.distributors.aar import OF_AAR, AarValve, FreightCar
from brake_controller.distributors.distributor import COMMANDED, Distributor, DistributorParameters
from brake_controller.distributors.ecp import EcpValve
from brake_controller.distributors.piped import PIPED
from brake_controller.distributors.uic import OF_UIC, UicDistributor
from brake_controller.distributors.vacuum import OF_VACUUM, VacuumBrake

#: Parameters that a column of a consist can set, by the column.
ADJUSTED: dict[str, tuple[type[DistributorParameters], ...]] = {
    "full_pressure": (DistributorParameters,),
    **dict.fromkeys(OF_UIC, (UicDistributor,)),
    **dict.fromkeys(("auxiliary", "cylinder"), (UicDistributor, VacuumBrake)),
    "fill_time": (UicDistributor, EcpValve, VacuumBrake),
    "release_time": (UicDistributor, FreightCar),
    **dict.fromkeys(OF_AAR, (AarValve,)),
    **dict.fromkeys(OF_VACUUM, (VacuumBrake,)),
}
#: Positions of a distributor.
POSITIONS = ("P", "G")


def check_kinds(kinds: Iterable[tuple[str, Distributor]]) -> None:
    """Check distributors by name before C is generated for them. Raises ValueError."""
    named, owner = dict[str, str](), dict[type, str]()
    for key, kind in kinds:
        if kind.name in named:
            raise ValueError(
                f"DISTRIBUTORS must have each kind once; got the name {kind.name} at {named[kind.name]!r} and {key!r}. "
                "Rename one."
            )
        if key != kind.name:
            raise ValueError(
                f"DISTRIBUTORS must have each kind by its name; got {key!r} for {kind.name}. Write {kind.name!r}."
            )
        if kind.parameters in owner:
            raise ValueError(
                f"Each distributor must have parameters of its own, as they determine the kind of a vehicle; got "
                f"{kind.parameters.__name__} for {owner[kind.parameters]} and {kind.name}. Derive a class for "
                f"{kind.name}."
            )
        named[kind.name], owner[kind.parameters] = key, kind.name
        check_kind(kind)


def check_kind(kind: Distributor) -> None:
    """Check the parameters, built-in sets, columns and pace of one kind. Raises ValueError."""
    _check_parameters(kind)
    _check_ready(kind)
    for name in kind.adjustable:
        if name not in ADJUSTED:
            raise ValueError(
                f"adjustable of the distributor {kind.name} must be among {', '.join(ADJUSTED)}; got {name!r}. "
                "Correct it."
            )
        if not issubclass(kind.parameters, ADJUSTED[name]):
            takers = " or ".join(one.__name__ for one in ADJUSTED[name])
            raise ValueError(
                f"{name} of the distributor {kind.name} must come with parameters of {takers}; got "
                f"{kind.parameters.__name__}. Derive them from it, or take {name} out of adjustable."
            )


def _check_parameters(kind: Distributor) -> None:
    if not issubclass(kind.parameters, DistributorParameters):
        raise ValueError(
            f"Parameters of the distributor {kind.name} must be a DistributorParameters; got "
            f"{kind.parameters.__name__}. Derive them from it."
        )
    for field in fields(kind.parameters):
        if field.name in COMMANDED:
            raise ValueError(
                f"Parameters of the distributor {kind.name} must not be called {', '.join(COMMANDED)}, which are "
                f"commands; got {field.name}. Rename it."
            )
        if "minimum" not in field.metadata:
            raise ValueError(
                f"{field.name} of the distributor {kind.name} must have a unit and limits. Write {field.name}: float = "
                'quantity("Pa", "What it is", 0.0).'
            )


def _check_ready(kind: Distributor) -> None:
    for position in POSITIONS:
        one = kind.ready(position)
        if type(one) is not kind.parameters:
            raise ValueError(
                f"ready of the distributor {kind.name} must return {kind.parameters.__name__} for position {position}; "
                f"got {type(one).__name__}. Correct it."
            )
        if one.full_pressure <= 0.0 and kind.name != PIPED.name:
            raise ValueError(
                f"ready of the distributor {kind.name} must have a full_pressure above 0 Pa for position {position}, "
                f"from which forces follow; got {one.full_pressure:g} Pa. Set it; a vehicle without a brake has "
                "brake = none."
            )
        kind.fastest(one, "whole")
