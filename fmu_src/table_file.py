"""C of a table file: its description for the runtime, and the model's own C, with unique names."""

from __future__ import annotations

from fmu_src.c_literals import c_array, c_number, c_text
from fmu_src.unique_names_in_c import with_own_names
from fmu_src.user_files import TableFile
from readers.column_words import words_of
from readers.columns import Column
from readers.units import spellings_for, twins_of

#: In front of the names that the model's C has at the scope of its file: other C of the same unit may have them too.
PREFIX = "of_table_"


def table_file_source(file: TableFile, variable: int) -> str:
    """Return C of TABLE_FILE, a `table_file_description`; variable: place of the one that names the file."""
    columns = [*(column.name for column in file.columns), *file.added]
    places = [
        f"enum {{ {', '.join(f'{kind}_{name.upper()}' for name in names)} }};"
        for kind, names in (("COLUMN", columns), ("PIECE", [piece.name for piece in file.pieces]))
    ]
    [given] = with_own_names(["\n".join([*places, file.source])], PREFIX)
    words = (file.noun, file.preposition, f"/{file.resource}", file.known)
    members = [
        *(str(variable), *map(c_text, words), c_number(file.least_growth), c_number(file.rounding)),
        *(str(len(file.columns)), str(len(file.added)), "COLUMN_OF_FILE", "PIECE_OF_FILE"),
        *(PREFIX + name for name in ("parts_before", "complete", "piece_between")),
    ]
    units = list(dict.fromkeys(column.unit for column in file.columns))
    columns_in_c = [_column(column, units.index(column.unit), place) for place, column in enumerate(file.columns)]
    pieces = [f"{{{piece.degree}, {_truth(piece.goes_on)}}}" for piece in file.pieces]
    return "\n".join(
        [
            '#include <stdio.h>\n#include "table_file.h"',
            given,
            *(_units(unit, f"UNIT_OF_FILE_{place}") for place, unit in enumerate(units)),
            *(_words(column, place) for place, column in enumerate(file.columns) if words_of(column.name)),
            c_array("column_description", "COLUMN_OF_FILE", columns_in_c),
            c_array("piece_description", "PIECE_OF_FILE", pieces),
            f"static const table_file_description TABLE_FILE = {{{', '.join(members)}}};",
        ]
    )


def _units(unit: str, name: str) -> str:
    """Return the units that convert to `unit`, with their factors, as an array in C."""
    spellings = [(twin, both) for one, both in spellings_for(unit).items() for twin in twins_of(one)]
    return c_array("unit_description", name, (f"{{{c_text(one)}, {up!r}, {down!r}}}" for one, (up, down) in spellings))


def _words(column: Column, place: int) -> str:
    """Return the German and French names of a column as an array in C."""
    return c_array("char *const", f"WORD_OF_COLUMN_{place}", map(c_text, words_of(column.name)))


def _column(column: Column, unit: int, place: int) -> str:
    """Return a column in C; unit: place of its unit among those of the file."""
    shown = "" if column.unit == "1" else column.unit
    limits = f"{c_number(column.minimum)}, {c_number(column.maximum)}"
    units = f"UNIT_OF_FILE_{unit}, {sum(len(twins_of(spelling)) for spelling in spellings_for(column.unit))}"
    count = len(words_of(column.name))
    words = f"{f'WORD_OF_COLUMN_{place}' if count else 'NULL'}, {count}"
    return f"{{{c_text(column.name)}, {c_text(shown)}, {limits}, {_truth(column.required)}, {units}, {words}}}"


def _truth(value: bool) -> str:
    return "true" if value else "false"
