"""A vehicle of the registry with one of its systems and all variables of its FMU, so that its runs say the same."""

from collections.abc import Mapping
from dataclasses import replace
from numbers import Real
from typing import Any

from fmu_src.chosen import place_in
from fmu_src.system import NONE, Model, Variable
from products.registry import FMUS
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.track.line_table import LINE
from rbd_model.vehicle.description import relations_of


def place_of(name: str, table: Mapping[str, Variable], values: Mapping[str, Any], on_line: bool = False) -> int | None:
    """Return the number in `Fmu.choice` of the system that the values select; NONE if it does not exist.

    None: the FMU is not a vehicle with several levels. An invalid value, which a run will refuse, is replaced by the
    start value. table: variables of the FMU; without the variable of a line's file, it runs without a line. on_line:
    whether it runs on a line whose file is not among the values.
    """
    fmu = FMUS[name]
    if fmu.vehicle is None:
        return None
    selectors = [table[selector] for selector in fmu.selectors]
    given = {one.name: value for one in selectors if isinstance(value := values.get(one.name), Real)}
    good = {one.name: given[one.name] for one in selectors if given.get(one.name) in range(1, int(one.maximum) + 1)}
    there = LINE.variable.name in table and (on_line or bool(values.get(LINE.variable.name)))
    return place_in(fmu.choice, selectors, good, there)


def model_at(name: str, table: Mapping[str, Variable], place: int, *more: int) -> Model:
    """Return the model of an FMU with the systems of these numbers alone; any other cannot be chosen.

    place, more: as `place_of` gives them; with NONE the model refuses the start, as the FMU does. table: variables of
    the FMU.
    """
    fmu = FMUS[name]
    assert fmu.vehicle is not None
    places = sorted({max(number, 0) for number in (place, *more)})
    one = fmu.model(places=tuple(places))
    reads = LINE if LINE.variable.name in table else None
    records = PAIR_FILE if PAIR_FILE.variable.name in table else None
    whole = fmu.choice if reads else fmu.choice[: len(fmu.choice) // 2]
    choice = tuple(
        places.index(number) if number in places else 0 if number != NONE and place == NONE else NONE
        for number in whole
    )
    relations = relations_of(fmu.vehicle(), list(table))
    files: dict[str, Any] = {"reads": reads, "reads_records": records}
    return replace(one, variables=tuple(table.values()), choice=choice, relations=relations, **files)
