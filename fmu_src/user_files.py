"""Files of a user that an instance reads before the start, and their values in equations: tables and records."""

from __future__ import annotations

from dataclasses import dataclass

from fmu_src.records import OwnRecord, RecordKind
from fmu_src.symbols import ca
from fmu_src.variables import Variable
from readers.columns import Column


@dataclass(frozen=True)
class TablePiece:
    """Polynomials between two rows of a table file, of a degree of at most 5.

    Beyond the ends of the table it keeps its last value or, if `goes_on`, its last slope.
    """

    name: str
    unit: str
    degree: int
    goes_on: bool = False


#: Columns of a table file, those that the model adds included, and degree of its pieces, as table_file.h has room for.
MOST_COLUMNS, HIGHEST_DEGREE = 32, 5


@dataclass(frozen=True)
class TableFile:
    """A table that an instance reads before the start, from the CSV file that `variable`, a string, names.

    Messages call it `noun`, "line", with the word `preposition` before it: a vehicle runs "on" a line. If the variable
    is not set, the file `resource` in an FMU's resources is read. The file contains only numbers, in `columns`. The
    first one grows by at least `least_growth` from row to row. A corner between straight lines is rounded over the
    length `rounding` on either side of a row; 0: none is. A message about an unknown column lists those of `known`. The
    model computes the columns `added`. Equations can look up `pieces`.

    The C in `source` has the functions `parts_before`, `complete` and `piece_between` of `table_file_description`
    (model.h). It may call the functions of table_file.h. COLUMN_NAME and PIECE_NAME are the places of columns and
    pieces.
    """

    variable: Variable
    noun: str
    preposition: str
    resource: str
    columns: tuple[Column, ...]
    least_growth: float
    rounding: float
    known: str
    added: tuple[str, ...]
    pieces: tuple[TablePiece, ...]
    source: str

    def __post_init__(self) -> None:
        columns, degree = len(self.columns) + len(self.added), max(piece.degree for piece in self.pieces)
        if columns > MOST_COLUMNS or degree > HIGHEST_DEGREE:
            raise ValueError(
                f"Table file {self.noun}: it has {columns} columns and pieces of degree {degree}; give at most "
                f"{MOST_COLUMNS} columns, those added included, and degrees up to {HIGHEST_DEGREE}."
            )

        odd = [column.name for column in self.columns if column.words or column.whole or not column.filled]
        if odd:
            raise ValueError(f"Table file {self.noun}: columns must be numbers, one in each row; got {', '.join(odd)}.")

    def piece(self, name: str) -> TablePiece:
        """Return one of the pieces by its name."""
        return next(piece for piece in self.pieces if piece.name == name)

    def column(self, name: str) -> Column:
        """Return one of the columns by its name."""
        return next(column for column in self.columns if column.name == name)


@dataclass(frozen=True)
class RecordFile:
    """Records that an instance reads before the start, from the file that `variable`, a string, names.

    Messages call it `noun`, "contact table"; that about a damaged file ends with `remedy`. If the variable is not set,
    the file `resource` in an FMU's resources is read. The first row of a file has the format `version`. The root record
    is of `kind`; each `owner`, "wheelset", has one of its own.

    The C in `source` has the function `check_record` of `record_file_description` (model.h). KIND_NAME and
    NUMBER_KIND_NAME are the places of kinds and numbers.
    """

    variable: Variable
    noun: str
    resource: str
    remedy: str
    version: int
    kind: RecordKind
    source: str
    owner: str


@dataclass(frozen=True)
class OfRecord:
    """A number of a record, or the record itself, which is the same during a run; `symbol` has it in equations.

    Without a file an instance has the root record `own`. `root` is the place of the root record among those of the
    files; a single one is that of all. `path` has the places of lists and of the records in them, from the root. A
    single record of a shared list is that of all places. `number` is the place of the number; -1: the record, which is
    0 if a file does not have it.
    """

    symbol: ca.SX
    file: RecordFile
    own: OwnRecord
    root: int
    path: tuple[tuple[int, int], ...]
    number: int

    @property
    def value(self) -> float:
        """Return the number without a file; 0 for a record."""
        found = self.own.record
        for place, entry in self.path:
            shared = found.kind.lists[place].shared and len(found.lists[place]) == 1
            found = found.lists[place][0 if shared else entry]
        return found.numbers[self.number] if self.number >= 0 else 0.0


@dataclass(frozen=True)
class FileTable:
    """The `pieces` of a table file at one place, found by one search.

    `symbols` are one origin and the coefficients of each piece, lowest power first, supplied by the runtime. The
    argument may contain values of other tables: those of a lower `rank` are looked up first.
    """

    name: str
    file: TableFile
    argument: ca.SX
    symbols: ca.SX
    rank: int
    pieces: tuple[TablePiece, ...] = ()
