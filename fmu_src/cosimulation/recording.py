"""Time series by name, with units: the result of every run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fmu_src.suggestion import suggestion
from readers.extras import named_extras
from readers.formats.table_files import write_columns
from readers.logs import read_columns
from readers.renamed import FormerNames

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Recording(FormerNames):
    """Time series by name, each with its unit; `time` is the first.

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
    ) -> None:
        self.units = dict(units)
        self.messages, self.counts = list(messages), dict(counts or {})
        if np.ma.is_masked(rows):
            raise ValueError("Rows must have all their values; some are masked. Write NaN in their place.")
        table = np.array(rows, dtype=float)
        if table.size and (table.ndim != 2 or table.shape[1] != len(self.units)):
            raise ValueError(
                f"Rows must have {len(self.units)} values, one for each name; got an array of shape {table.shape}. "
                "Give each column a name of its own."
            )
        table = table.reshape(-1, len(self.units))
        self._columns = dict(zip(self.units, table.T, strict=True))

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a column, shape (rows,), in its unit. Raises KeyError."""
        return self._columns[self._known(name)]

    def _known(self, name: str) -> str:
        if name not in self._columns:
            raise KeyError(f"The recording has no column {name}; {suggestion(name, self._columns)}")
        return name

    def __repr__(self) -> str:
        columns = ", ".join(f"{name} [{unit}]" for name, unit in self.units.items())
        return f"<Recording of {len(next(iter(self._columns.values())))} rows: {columns}>"

    @property
    def names(self) -> list[str]:
        """Return the names of the columns, in their order."""
        return list(self.units)

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

    def plot(self, *names: str) -> Figure:
        """Plot columns over the first one: a chart for each unit, in their order.

        Parameters
        ----------
        *names : str
            The columns; by default all.

        Returns
        -------
        Figure
            A Matplotlib figure.

        Raises
        ------
        KeyError
            If a column does not exist.
        """
        with named_extras():
            from matplotlib.figure import Figure  # heavy

        first, *others = self.names
        shown = [self._known(name) for name in names or others]
        units = list(dict.fromkeys(self.units[name] for name in shown))
        figure = Figure(figsize=(8.0, 1.0 + 2.2 * len(units)), layout="constrained")
        charts = figure.subplots(len(units), sharex=True, squeeze=False)[:, 0]
        for chart, unit in zip(charts, units, strict=True):
            for name in (one for one in shown if self.units[one] == unit):
                chart.plot(self[first], self[name], label=name)
            chart.set_ylabel(f"[{unit}]")
            chart.legend(loc="best")
            chart.grid(True, linewidth=0.3)
        charts[-1].set_xlabel(f"{first} [{self.units[first]}]")
        return figure

    def write(self, path: str | Path, metadata: Mapping[str, str] | None = None) -> Path:
        """Write the table to a file that logs are read from; a failed write leaves the file that was there.

        Parameters
        ----------
        path : str or Path
            Its end is .csv, .parquet, .mat (MATLAB), .mf4 (MDF) or .h5 (HDF5). All digits are kept.
        metadata : mapping of str to str, optional
            Strings that describe the table, by name: remarks in a CSV, metadata in other formats.

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
        return write_columns(Path(path), self._columns, self.units, metadata)

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
            The columns; `attrs["units"]` has the units.

        Raises
        ------
        ImportError
            If pandas is not installed.
        """
        try:
            import pandas
        except ImportError as error:
            raise ImportError("A data frame needs pandas: pip install pandas") from error
        frame = pandas.DataFrame(self._columns)
        frame.attrs["units"] = dict(self.units)
        return frame
