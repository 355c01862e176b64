"""Train data of ETCS as a JSON file in the field's names, each number with its unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.suggestion import suggestion
from products.etcs_files.osrd import osrd_train_of
from products.supervision.arguments import all_of_type, path_of
from products.supervision.conversion import BRAKE_POSITIONS
from products.supervision.steps import Steps
from products.supervision.train import SupervisedTrain, check_train
from products.supervision.values import checked_level
from readers.documents import LARGEST, document, document_text, is_number
from readers.storage import write_whole
from readers.text import BadInputError, FileError, quoted, shown, text_of
from readers.units import factor

#: Name and version of the format, and number of confidence levels.
FORMAT, VERSION, LEVELS = "ETCS train data", 1, 10
#: Numbers: attribute of `SupervisedTrain` and unit.
NUMBERS = {
    "L_TRAIN": ("length", "m"),
    "V_MAXTRAIN": ("maximum_speed", "m/s"),
    "T_brake_emergency": ("T_brake_emergency", "s"),
    "T_brake_service": ("T_brake_service", "s"),
    "T_traction_cut_off": ("T_traction_cut_off", "s"),
    "M_rotating_nom": ("rotating", "%"),
    "M_NVEBCL": ("level", "1"),
}
#: Step functions of speed, with the unit of their values.
STEPS = {
    "A_brake_emergency": "m/s2",
    "A_brake_service": "m/s2",
    "Kdry_rst": "1",
    "Kwet_rst": "1",
    "A_brake_normal_service": "m/s2",
    "Kn_plus": "m/s2 a permille",
    "Kn_minus": "m/s2 a permille",
}
#: Interfaces, names of SUBSET-027, 4.2.4.47: attribute of `SupervisedTrain`.
SWITCHES = {
    "Q_TRACTIONCUTOFFINTERFACE": "traction_command",
    "Q_SERVICEBRAKEINTERFACE": "service_command",
    "Q_SERVICEBRAKEFEEDBACK": "service_feedback",
    "Q_SPECADDBRAKEINDADH": "without_adhesion",
}
PERCENTAGE, POSITION = "M_BRAKE_PERCENTAGE", "M_BRAKE_POSITION"
#: Names that a train by decelerations must have, and names that exclude a brake percentage.
NEEDED = ("A_brake_emergency", "A_brake_service", "T_brake_emergency", "T_brake_service")
OF_DECELERATIONS = (*NEEDED, "Kdry_rst", "Kwet_rst", "M_NVEBCL")
NAMES = ("format", "version", "name", POSITION, PERCENTAGE, *NUMBERS, *STEPS, *SWITCHES)


@dataclass(frozen=True)
class EtcsTrain:
    """A train from a file of train data.

    Parameters
    ----------
    train : SupervisedTrain
        The train, with Kdry_rst of level 9 if the file states it by level.
    dry_by_level : tuple of Steps
        Kdry_rst of the confidence levels 0 to 9; empty if the file states one Kdry_rst.
    name : str
        Name of the train.
    """

    train: SupervisedTrain
    dry_by_level: tuple[Steps, ...] = ()
    name: str = ""

    def __post_init__(self) -> None:
        check_train(self.train)
        _check_others(self.dry_by_level, self.name)

    def at_level(self, level: int) -> SupervisedTrain:
        """Return the train at a confidence level (M_NVEBCL)."""
        number = checked_level("The confidence level", level)
        if self.dry_by_level:
            return replace(self.train, Kdry_rst=self.dry_by_level[number], level=number)
        self.train.check_level(number)
        return self.train


def train_document(train: SupervisedTrain, dry_by_level: Sequence[Steps] = (), name: str = "") -> dict[str, Any]:
    """Return train data as a JSON document."""
    check_train(train)
    _check_others(dry_by_level, name)
    if np.ndim(train.length) or train.A_brake_emergency.values.ndim > 1:
        raise BadInputError("A file of train data has one train; got several. Write one file for each.")
    by_percentage = train.percentage is not None
    if train.position is not None:
        _check_percentage(train)
    position = train.position or ("freight P" if train.freight else "passenger P")
    found: dict[str, Any] = {"format": FORMAT, "version": VERSION, "name": name, POSITION: position}
    if train.percentage is not None:
        found[PERCENTAGE] = _number(train.percentage, "%")
    for name_, (attribute, unit) in NUMBERS.items():
        value = getattr(train, attribute)
        if value is not None and not (by_percentage and name_ in OF_DECELERATIONS):
            found[name_] = _number(value, unit)
    for name_, unit in STEPS.items():
        steps = getattr(train, name_)
        if steps is not None and not (by_percentage and name_ in OF_DECELERATIONS):
            found[name_] = _steps(steps, unit)
    if dry_by_level:
        found["Kdry_rst"] = [_steps(one, "1") for one in dry_by_level]
        found.pop("M_NVEBCL", None)
    return found | {name_: getattr(train, attribute) for name_, attribute in SWITCHES.items()}


def _check_others(dry_by_level: Sequence[Steps], name: str) -> None:
    """Refuse factors that are not those of ten levels, and a name that is not text."""
    all_of_type("dry_by_level", dry_by_level, Steps, "Give Steps for each level, or ().")
    if len(dry_by_level) not in (0, LEVELS):
        raise BadInputError(f"dry_by_level must be {LEVELS} step functions, or (); got {len(dry_by_level)}.")
    if not isinstance(name, str):
        raise BadInputError(f"name must be text; got {type(name).__name__}.")


def write_train(path: str | Path, train: SupervisedTrain, dry_by_level: Sequence[Steps] = (), name: str = "") -> None:
    """Write train data as JSON; `read_train` gives the same train."""
    write_whole(path_of(path), document_text(train_document(train, dry_by_level, name)).encode())


def read_train(path: str | Path) -> EtcsTrain:
    """Return the train in a file of train data.

    Takes path [100, 160].
    """
    path = path_of(path)
    return train_of(document(text_of(path, LARGEST).encode(), str(path)), str(path))


def etcs_train_in(path: Path) -> EtcsTrain | None:
    """Return the train data in a file, of this format or of a rolling stock of OSRD; None if it has none."""
    if path.suffix.lower() != ".json":
        return None
    read = document(text_of(path, LARGEST).encode(), str(path))
    if isinstance(read, dict) and "format" in read:
        return train_of(read, str(path))
    train = osrd_train_of(read, str(path))
    return None if train is None else EtcsTrain(train, (), "etcs_brake_params of OSRD")


def train_of(read: Any, source: str) -> EtcsTrain:
    """Return the train of a document, as `read_train` does; source: its name in messages."""
    if not isinstance(read, dict) or read.get("format") != FORMAT or read.get("version") != VERSION:
        raise FileError(f'{source} must have "format": "{FORMAT}" and "version": {VERSION}; got {shown(read)}.')
    for name in read:
        if name not in NAMES:
            raise FileError(f"{source}: {shown(name)} is not a name of train data; {suggestion(name, NAMES)}")
    found: dict[str, Any] = {
        of: _number_in(read[name], unit, f"{source}: {name}") for name, (of, unit) in NUMBERS.items() if name in read
    }
    dry_by_level = _levels(read.get("Kdry_rst"), source)
    for name, unit in STEPS.items():
        if name in read and not (name == "Kdry_rst" and dry_by_level):
            found[name] = _steps_in(read[name], unit, f"{source}: {name}")
    for name, of in SWITCHES.items():
        if not isinstance(read.get(name, False), bool):
            raise FileError(f"{source}: {name} must be true or false; got {shown(read[name])}.")
        found[of] = read.get(name, False)
    if dry_by_level:
        if "level" in found:
            raise FileError(f"{source}: M_NVEBCL must be left out beside Kdry_rst of all levels; got both.")
        found |= {"Kdry_rst": dry_by_level[-1], "level": LEVELS - 1}
    try:
        train = _made(read, found, source)
    except BadInputError as error:
        raise FileError(f"{source}: {error}") from None
    return EtcsTrain(train, dry_by_level, str(read.get("name", "")))


def _made(read: dict[str, Any], found: dict[str, Any], source: str) -> SupervisedTrain:
    """Return the train of values by attribute."""
    position = read.get(POSITION, "passenger P")
    if position not in BRAKE_POSITIONS:
        raise BadInputError(f"{POSITION} must be one of {', '.join(BRAKE_POSITIONS)}; got {shown(position)}.")
    if "L_TRAIN" not in read:
        raise BadInputError("the file must have L_TRAIN; got none.")
    if PERCENTAGE in read:
        if double := [name for name in OF_DECELERATIONS if name in read]:
            raise BadInputError(f"{PERCENTAGE} stands for {', '.join(double)}; got both. Leave one out.")
        percentage = _number_in(read[PERCENTAGE], "%", f"{source}: {PERCENTAGE}")
        return SupervisedTrain.of_percentage(percentage, position, found.pop("length"), **found)
    if missing := [name for name in NEEDED if name not in read]:
        raise BadInputError(f"the file must have {', '.join(missing)}, or {PERCENTAGE} instead of all; got neither.")
    return SupervisedTrain(**found, freight=position.startswith("freight"))


def _check_percentage(train: SupervisedTrain) -> None:
    """Refuse a train of which the brake percentage does not give the decelerations."""
    if train.percentage is None:
        raise BadInputError(f"A train with position {train.position} must state its percentage; got none.")
    position = str(train.position)
    made = SupervisedTrain.of_percentage(train.percentage, position, train.length)
    same = all(
        np.array_equal(getattr(getattr(made, name), of), getattr(getattr(train, name), of))
        for name in ("A_brake_emergency", "A_brake_service")
        for of in ("boundaries", "values")
    )
    if not same:
        raise BadInputError(
            "The decelerations must be those of the brake percentage; got others. Give resolution=0, or a train "
            "without position."
        )


def _number(value: Any, unit: str) -> dict[str, Any]:
    return {"value": np.asarray(value, dtype=float).tolist(), "unit": unit}


def _steps(steps: Steps, unit: str) -> dict[str, Any]:
    return {"boundaries": _number(steps.boundaries, "m/s"), "values": _number(steps.values, unit)}


def _quantity(given: Any, unit: str, what: str) -> Any:
    """Return a value as it stands and the factor to its unit."""
    if not isinstance(given, dict) or set(given) != {"value", "unit"}:
        raise FileError(f'{what} must be {{"value": ..., "unit": "{unit}"}}; got {shown(given)}.')
    own = given["unit"]
    scale = ((1.0, 1.0) if own == unit else factor(own, unit)) if isinstance(own, str) else None
    if scale is None:
        raise FileError(f"{what} must have a unit that converts to {unit}; got {shown(own)}.")
    return given["value"], scale


def _number_in(given: Any, unit: str, what: str) -> float:
    value, (up, down) = _quantity(given, unit, what)
    if not is_number(value):
        text = " Remove the quotes." if isinstance(value, str) else ""
        raise FileError(f"{what} must be a number; got {quoted(value) if text else shown(value)}.{text}")
    return float(value) * up / down


def _steps_in(given: Any, unit: str, what: str) -> Steps:
    if not isinstance(given, dict) or set(given) != {"boundaries", "values"}:
        raise FileError(f"{what} must have boundaries and values; got {shown(given)}.")
    arrays = []
    for name, of in (("boundaries", "m/s"), ("values", unit)):
        values, (up, down) = _quantity(given[name], of, f"{what}, {name}")
        if not isinstance(values, list) or not all(is_number(value) for value in values):
            raise FileError(f"{what}, {name} must be a list of numbers; got {shown(values)}.")
        arrays.append(np.array(values, dtype=float) * up / down)
    try:
        return Steps(*arrays)
    except BadInputError as error:
        raise FileError(f"{what}: {error}") from None


def _levels(given: Any, source: str) -> tuple[Steps, ...]:
    """Return Kdry_rst of each confidence level, or nothing if it is one step function."""
    if not isinstance(given, list):
        return ()
    if len(given) != LEVELS:
        raise FileError(f"{source}: Kdry_rst must be one step function or a list of {LEVELS}; got {len(given)}.")
    found = tuple(_steps_in(one, "1", f"{source}: Kdry_rst of level {n}") for n, one in enumerate(given))
    for n, one in enumerate(found):
        if not np.all((one.values >= 0.0) & (one.values <= 1.55)):
            got = shown(one.values.tolist())
            raise FileError(f"{source}: Kdry_rst of level {n} must be 0 to 1.55; got {got}. Correct it.")
    return found
