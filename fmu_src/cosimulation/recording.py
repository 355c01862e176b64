"""Time series by name, with units: the result of every run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fmu_src.cosimulation.provenance_text import KEY, json_of, metadata_of
from fmu_src.cosimulation.quantities import quantities_with_units
from fmu_src.cosimulation.recording_html import html_of
from fmu_src.suggestion import suggestion
from readers.extras import named_extras
from readers.formats.table_files import write_columns
from readers.logs import read_columns
from readers.renamed import FormerNames

if TYPE_CHECKING:
    from fmu_src.figure import NotebookFigure


#: Provenance as JSON, or a function that returns it.
Provenance = Mapping[str, Any] | Callable[[], Mapping[str, Any]]


class Recording(FormerNames, Mapping[str, np.ndarray]):
    """Time series by name, each with its unit; `time` is the first.

    A recording is a mapping of columns: `"speed" in stop`, `list(stop)`, `dict(stop)`, `stop.items()`. Its length is
    the number of columns. `np.asarray(stop)` is a structured array of shape (rows,) with a field for each column.
    Recordings are equal if names, units and values are; NaN equals NaN. A notebook shows size, first rows, units and
    messages.

    Parameters
    ----------
    units : mapping of str to str
        Unit of each column by its name, in their order.
    rows : array, shape (rows, columns)
        Values, each in the unit of its column.
    messages : sequence of str
        Messages of the run in their order; empty if unknown.
    counts : mapping of str to int, optional
        Work of the run, such as steps.
    coordinates : sequence of str, optional
        Names of the columns that were chosen and not computed; by default the first one. A sweep has the number of the
        run and the varied values.
    provenance : mapping, or function that returns one, optional
        What was run: function, version, digest of the sources, and arguments, as JSON. `bogie_braking.repeat` runs it
        again. Empty if it is unknown.

    Raises
    ------
    ValueError
        If values are masked, or if a row does not have one value for each column.
    """

    def __init__(
        self,
        units: Mapping[str, str],
        rows: Sequence[Sequence[float]] | np.ndarray,
        messages: Sequence[str] = (),
        counts: Mapping[str, int] | None = None,
        coordinates: Sequence[str] = (),
        provenance: Provenance | None = None,
    ) -> None:
        self.units = dict(units)
        self.coordinates = tuple(coordinates) or tuple(self.units)[:1]
        if unknown := [name for name in self.coordinates if name not in self.units]:
            raise ValueError(f"Coordinates must be columns; got {unknown[0]}. Give names of the units.")
        self.messages, self.counts = list(messages), dict(counts or {})
        self._provenance = provenance or {}
        if np.ma.is_masked(rows):
            raise ValueError("Rows must have all their values; some are masked. Write NaN in their place.")
        table = np.array(rows, dtype=float)
        if table.size and (table.ndim != 2 or table.shape[1] != len(self.units)):
            raise ValueError(
                f"Rows must have {len(self.units)} values, one for each name; got an array of shape {table.shape}. "
                "Give each column a name of its own."
            )
        table = table if table.size else np.empty((0, len(self.units)))
        self._columns = dict(zip(self.units, table.T, strict=True))

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a column, shape (rows,), in its unit. Raises KeyError."""
        return self._columns[self._known(name)]

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Recording):
            return NotImplemented
        same = list(self.units.items()) == list(other.units.items())
        return same and all(np.array_equal(self[name], other[name], equal_nan=True) for name in self)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """Return a structured array, shape (rows,), with a field for each column."""
        if copy is False:
            raise ValueError("copy must be None or True, as columns are stored apart; got False. Leave it out.")
        table = np.empty(self.rows, [(name, float) for name in self])
        for name, values in self.items():
            table[name] = values
        return table if dtype is None else table.astype(dtype)

    def _known(self, name: str) -> str:
        if name not in self._columns:
            raise KeyError(f"The recording has no column {name}; {suggestion(name, self._columns)}")
        return name

    def __repr__(self) -> str:
        return f"<Recording of {self.rows} rows: {', '.join(quantities_with_units(self.units))}>"

    def _repr_html_(self) -> str:
        return html_of(self)

    @property
    def rows(self) -> int:
        """Return the number of rows."""
        return len(next(iter(self._columns.values()), ()))

    @property
    def names(self) -> list[str]:
        """Return the names of the columns, in their order."""
        return list(self.units)

    @property
    def provenance(self) -> dict[str, Any]:
        """Return what was run: function, version, digest of the sources, arguments; empty if it is unknown."""
        return dict(self._provenance() if callable(self._provenance) else self._provenance)

    @provenance.setter
    def provenance(self, provenance: Provenance) -> None:
        self._provenance = provenance

    @property
    def status(self) -> str:
        """Return the messages of the run, in one line."""
        return " ".join(self.messages)

    def add(self, name: str, unit: str, values: np.ndarray) -> None:
        """Add a column, for example of a second run.

        Parameters
        ----------
        name, unit : str
            Name and unit of the column.
        values : array, shape (rows,)
            As many values as `time` has.
        """
        self.units[name] = unit
        self._columns[name] = values

    def add_from(self, name: str, other: Recording, column: str) -> None:
        """Add a column of another run at the times of this one; NaN after that run's end.

        Parameters
        ----------
        name : str
            Name of the new column.
        other : Recording
            The other run.
        column : str
            Name of its column.

        Raises
        ------
        KeyError
            If the other run does not have the column.
        """
        values = np.interp(self["time"], other["time"], other[column], right=math.nan)
        self.add(name, other.units[column], values)

    def first_time(self, condition: np.ndarray) -> float | None:
        """Return the time of the first row that meets a condition.

        Parameters
        ----------
        condition : array of bool, shape (rows,)
            Whether each row meets it.

        Returns
        -------
        float or None
            The time [s]; None if no row does.
        """
        rows = np.flatnonzero(condition)
        return float(self["time"][rows[0]]) if rows.size else None

    def plot(self, *names: str) -> NotebookFigure:
        """Plot columns over time, or over the first varied value of a table: a panel for each unit, in their order.

        Numbered columns, such as `speed[1]` to `speed[40]`, are one quantity. Seven or more of them have a scale of
        colours, and the legend names the first and the last.

        Parameters
        ----------
        *names : str
            The columns. By default those of the first four units that change: the first quantity of each, and further
            ones that can be seen beside it while a panel has at most six lines.

        Returns
        -------
        Figure
            A Matplotlib figure, which a notebook shows.

        Raises
        ------
        KeyError
            If a column does not exist.
        ImportError
            If Matplotlib is not installed.
        """
        with named_extras():
            from fmu_src.cosimulation.recording_chart import chosen_columns, draw  # heavy

        return draw(self, [self._known(name) for name in names] or chosen_columns(self))

    def write(self, path: str | Path, metadata: Mapping[str, str] | None = None, provenance: bool = True) -> Path:
        """Write the table to a file that logs are read from; a failed write leaves the file that was there.

        Parameters
        ----------
        path : str or Path
            Its end is .csv, .parquet, .mat (MATLAB), .mf4 (MDF) or .h5 (HDF5). All digits are kept.
        metadata : mapping of str to str, optional
            Strings that describe the table, by name: remarks in a CSV, metadata in other formats.
        provenance : bool
            Whether the file has the provenance: comment lines (`#`) at the head of a CSV, metadata in other formats.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        FileError
            If the name has another end.
        MissingExtraError
            If the package of the format is not installed.
        StorageError
            If the file cannot be written.
        """
        about = metadata_of(self.provenance, Path(path).name) if provenance else {}
        return write_columns(Path(path), self._columns, self.units, about | dict(metadata or {}))

    @classmethod
    def read(cls, path: str | Path) -> Recording:
        """Return a table as `write` and sweeps write it: all columns of numbers, in the units of the file.

        Parameters
        ----------
        path : str or Path
            A file of text, or one whose name ends as those of `write`. Logs of others need `measured_from`.

        Returns
        -------
        Recording
            The table; a message names columns of text, which are left out.

        Raises
        ------
        FileError
            If the file cannot be read.
        MissingExtraError
            If the package of the format is not installed.
        """
        table = read_columns(path)
        return cls(table.units, np.column_stack(list(table.numbers.values())), table.messages)

    def to_pandas(self) -> Any:
        """Return a data frame.

        Returns
        -------
        pandas.DataFrame
            The columns; `attrs` has `units` by name, `messages` and `provenance`.

        Raises
        ------
        ImportError
            If pandas is not installed.
        """
        with named_extras():
            import pandas

        frame = pandas.DataFrame(self._columns)
        frame.attrs |= {"units": dict(self.units), "messages": list(self.messages), "provenance": self.provenance}
        return frame

    def to_xarray(self) -> Any:
        """Return a data set.

        Returns
        -------
        xarray.Dataset
            A variable for each column over the first one, with its unit as the attribute `units`. `coordinates` are
            coordinates. Attributes are `messages`, a line for each, and `provenance`, a JSON text.

        Raises
        ------
        ImportError
            If xarray is not installed.
        """
        first = self.names[0]
        columns = {name: (first, values, {"units": self.units[name]}) for name, values in self.items()}
        places = {name: columns.pop(name) for name in self.coordinates}
        attributes = {"messages": "\n".join(self.messages), KEY: json_of(self.provenance)}
        with named_extras():
            import xarray

        return xarray.Dataset(columns, coords=places, attrs=attributes)
