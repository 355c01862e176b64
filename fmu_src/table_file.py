"""C of a table file: its description for the runtime, and what the model gives in C, under names of its own."""

from __future__ import annotations

from fmu_src.c_literals import c_array, c_number, c_text
from fmu_src.own_names import with_own_names
from fmu_src.system import Column, TableFile

#: In front of the names that the model's C has at the scope of its file: other C of the same unit may have them too.
PREFIX = "of_table_"


def table_file_source(file: TableFile, variable: int) -> str:
    """C of TABLE_FILE, a `table_file_description`; variable: place of the one that names the file."""
    columns = [*(column.name for column in file.columns), *file.added]
    places = [
        f"enum {{ {', '.join(f'{kind}_{name.upper()}' for name in names)} }};"
        for kind, names in (("COLUMN", columns), ("PIECE", [piece.name for piece in file.pieces]))
    ]
    [given] = with_own_names(["\n".join([*places, file.source])], PREFIX)
    words = (file.noun, file.preposition, f"/{file.resource}", file.known)
    members = [
        *(str(variable), *map(c_text, words), c_number(file.least_growth), c_text(file.growth_text)),
        c_number(file.rounding),
        *(str(len(file.columns)), str(len(file.added)), "COLUMN_OF_FILE", "PIECE_OF_FILE"),
        *(PREFIX + name for name in ("check_row", "complete", "piece_between")),
    ]
    pieces = [f"{{{piece.degree}, {_truth(piece.goes_on)}}}" for piece in file.pieces]
    return "\n".join(
        [
            '#include <stdio.h>\n#include "table_file.h"',
            given,
            c_array("column_description", "COLUMN_OF_FILE", map(_column, file.columns)),
            c_array("piece_description", "PIECE_OF_FILE", pieces),
            f"static const table_file_description TABLE_FILE = {{{', '.join(members)}}};",
        ]
    )


def _column(column: Column) -> str:
    unit = "" if column.unit == "1" else column.unit
    limits = f"{c_number(column.minimum)}, {c_number(column.maximum)}"
    return f"{{{c_text(column.name)}, {c_text(unit)}, {limits}, {_truth(column.required)}}}"


def _truth(value: bool) -> str:
    return "true" if value else "false"
