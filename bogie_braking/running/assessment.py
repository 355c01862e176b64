"""Quantities of EN 14363 from a recording: forces between wheel and rail, filtered, in sections of a line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bogie_braking.checks import number, shown
from bogie_braking.running.filters import band_pass, finite, interval_of, low_pass, sliding_mean
from fmu_src.cosimulation.recording import Recording

#: Cut-off frequency of the forces [Hz], window of the sliding mean and the distance of its places [m].
CUT_OFF, WINDOW, PITCH = 20.0, 2.0, 0.5
#: Frequencies of accelerations of the car body that passengers feel [Hz].
RIDE = (0.4, 10.0)
#: Percentiles of extreme and of quasi-static values.
LOWER, UPPER, MIDDLE = 0.15, 99.85, 50.0
#: Limit of the sum of guiding forces: 10 kN and a third of the static axle load. Limits of Y/Q, and of quasi-static Y
#: (edition of 2005) and Q [N]. They are those of EN 14363 and UIC 518 in secondary sources. The standard's text was
#: not at hand.
TRACK_SHIFT, TRACK_SHIFT_SHARE = 10e3, 1 / 3
DERAILMENT, GUIDING, LOAD = 0.8, 60e3, 145e3
#: Largest number of sections.
MOST_SECTIONS = 10_000


@dataclass(frozen=True)
class Filtered:
    """A column after the low-pass, and the distance of its rows [m]."""

    values: np.ndarray
    distance: np.ndarray

    def mean_in(self, section: tuple[float, float]) -> np.ndarray:
        """Return the sliding means whose windows lie in a section."""
        begin, end = section[0] + WINDOW / 2, section[1] - WINDOW / 2
        places = begin + PITCH * np.arange(int((end - begin) / PITCH + 1e-9) + 1)
        return sliding_mean(self.values, self.distance, WINDOW, places)

    def rows_in(self, section: tuple[float, float]) -> np.ndarray:
        """Return the values of the rows in a section."""
        return self.values[(self.distance >= section[0]) & (self.distance <= section[1])]


@dataclass(frozen=True)
class Assessed:
    """An assessed quantity: column, name in the table, unit, limit (None: none here) and the value of a section."""

    column: str
    name: str
    unit: str
    limit: float | None
    value: Callable[[Filtered, tuple[float, float]], float]


def _extreme(column: Filtered, section: tuple[float, float]) -> float:
    """Return the percentile of either sign that is larger in size."""
    return _larger(column.mean_in(section))


def _larger(values: np.ndarray) -> float:
    """Return that of both extreme percentiles which is larger in size."""
    low, high = np.percentile(values, [LOWER, UPPER])
    return float(high if abs(high) >= abs(low) else low)


def _largest_mean(column: Filtered, section: tuple[float, float]) -> float:
    return float(np.percentile(column.mean_in(section), UPPER))


def _largest(column: Filtered, section: tuple[float, float]) -> float:
    return float(np.percentile(column.rows_in(section), UPPER))


def _middle(column: Filtered, section: tuple[float, float]) -> float:
    return float(np.percentile(column.rows_in(section), MIDDLE))


def en14363(
    recording: Recording,
    sections: Sequence[tuple[float, float]] | None = None,
    static_axle_loads: Sequence[float] | None = None,
) -> Recording:
    """Return quantities of EN 14363 for running safety and track loading, in each section of a run.

    Forces are filtered by a low-pass of 20 Hz (Butterworth, 24 dB an octave). Sum of guiding forces and Y/Q are sliding
    means over 2 m, every 0.5 m. Extreme values are percentiles of 0.15 and 99.85 %, quasi-static values of 50 %.

    Parameters
    ----------
    recording : Recording
        Run at level 3 with a row every 5 ms or more often, of a vehicle that moves forward. Its columns are `distance`,
        `axle_load` and `guiding_force` of each wheelset. Each wheel has `wheel_load`, `lateral_force` and
        `derailment_quotient`.
    sections : sequence of (float, float), optional
        Begin and end of each section [m]. It is at least 2 m long; by default the whole run is one.
    static_axle_loads : sequence of float, optional
        Static load of each axle [N]. The limit of the guiding forces has it; by default it is that of the first row.

    Returns
    -------
    Recording
        A row for each section: `section`, `begin`, `end`, and for each wheelset or wheel

        * `guiding_force_1_2m`: the percentile of the sum of guiding forces that is larger in size [N]
        * `derailment_quotient_1_left_2m`: Y/Q, 99.85 %
        * `wheel_load_1_left_largest`: Q, 99.85 % [N]
        * `lateral_force_1_left_quasi_static`, `wheel_load_1_left_quasi_static`: Y and Q, 50 % [N]

        The messages compare the largest of each with its limit.

    Raises
    ------
    KeyError
        If a column is missing.
    ValueError
        If the run is not at level 3 or the vehicle does not move forward. Also if a section is not within the run or
        shorter than 2 m, or rows are uneven or more than 5 ms apart.
    """
    interval, distance = interval_of(recording), _growing(recording)
    places = _sections(sections, distance)
    assessed = _assessed(_static_loads(recording, static_axle_loads))
    _check_level(recording, [one.column for one in assessed if one.column.startswith("wheel_load")])
    columns = {
        name: Filtered(low_pass(finite(recording, name), interval, CUT_OFF), distance)
        for name in {one.column for one in assessed}
    }
    rows = [
        [n, *place, *(one.value(columns[one.column], place) for one in assessed)] for n, place in enumerate(places, 1)
    ]
    units = {"section": "1", "begin": "m", "end": "m"} | {one.name: one.unit for one in assessed}
    table = Recording(units, rows)
    table.messages += _verdicts(table, assessed)
    return table


def ride_accelerations(accelerations: Recording, sections: Sequence[tuple[float, float]] | None = None) -> Recording:
    """Return accelerations of EN 14363 for the ride characteristics of a car body, in each section of a run.

    Extreme and r.m.s. values are those of a band-pass of 0.4 to 10 Hz, quasi-static ones of a low-pass of 20 Hz.

    Parameters
    ----------
    accelerations : Recording
        `time`, `distance`, `acceleration_y` and `acceleration_z` [m/s2], as from `floor_accelerations`.
    sections : sequence of (float, float), optional
        As in `en14363`.

    Returns
    -------
    Recording
        A row for each section: `section`, `begin`, `end`, and values in the directions y and z [m/s2].
        `acceleration_y_extreme` is the percentile of 0.15 or 99.85 % that is larger in size. `acceleration_y_rms`
        follows, and for y `acceleration_y_quasi_static`, 50 %.

    Raises
    ------
    KeyError
        If a column is missing.
    ValueError
        As in `en14363`.
    """
    interval, distance = interval_of(accelerations), _growing(accelerations)
    passed = {
        axis: Filtered(band_pass(finite(accelerations, f"acceleration_{axis}"), interval, RIDE), distance)
        for axis in ("y", "z")
    }
    slow = Filtered(low_pass(accelerations["acceleration_y"], interval, CUT_OFF), distance)
    names = [f"acceleration_{axis}_{kind}" for axis in passed for kind in ("extreme", "rms")]
    rows = []
    for number_of, section in enumerate(_sections(sections, distance), 1):
        inside = [column.rows_in(section) for column in passed.values()]
        values = [value for one in inside for value in (_larger(one), float(np.sqrt(np.mean(one**2))))]
        rows.append([number_of, *section, *values, _middle(slow, section)])
    units = {"section": "1", "begin": "m", "end": "m"}
    return Recording(units | dict.fromkeys([*names, "acceleration_y_quasi_static"], "m/s2"), rows)


def _growing(recording: Recording) -> np.ndarray:
    """Return the distance of the rows [m]. Raises ValueError if it does not grow."""
    distance = finite(recording, "distance")
    if not np.all(np.diff(distance) > 0.0):
        row = int(np.flatnonzero(np.diff(distance) <= 0.0)[0])
        raise ValueError(
            f"distance must grow from row to row; got {distance[row + 1]:g} m after {distance[row]:g} m. "
            "Leave out rows in which the vehicle stands or rolls back."
        )
    return distance


def _sections(sections: Sequence[tuple[float, float]] | None, distance: np.ndarray) -> list[tuple[float, float]]:
    """Return the sections as pairs of numbers. Raises ValueError."""
    first, last = float(distance[0]), float(distance[-1])
    found = [(first, last)] if sections is None else list(sections)
    if not 0 < len(found) <= MOST_SECTIONS:
        raise ValueError(f"sections must be 1 to {MOST_SECTIONS} pairs of distances; got {len(found)}.")
    pairs = []
    for one in found:
        try:
            begin, end = (number(each) for each in one)
        except (TypeError, ValueError):
            raise ValueError(f"A section must be a pair of distances [m]; got {shown(one)}.") from None
        if not (first <= begin and begin + WINDOW <= end <= last):
            raise ValueError(
                f"A section must be at least {WINDOW:g} m long and within the run, {first:g} to {last:g} m; got "
                f"{begin:g} to {end:g} m."
            )
        pairs.append((begin, end))
    return pairs


def _static_loads(recording: Recording, loads: Sequence[float] | None) -> list[float]:
    """Return the static load of each axle [N]. Raises KeyError if the run has none, ValueError."""
    names = [name for name in recording.names if name.removeprefix("axle_load_").isdigit()]
    if not names:
        names = ["axle_load_1"]  # raises KeyError, which names what there is
    here = [float(finite(recording, name)[0]) for name in names]
    found = here if loads is None else [number(one) for one in loads]
    if len(found) != len(here) or not all(one > 0.0 for one in found):
        raise ValueError(f"static_axle_loads must be {len(here)} numbers above 0 N; got {shown(loads or found)}.")
    return found


def _assessed(loads: Sequence[float]) -> list[Assessed]:
    """Return the quantities of all wheelsets and wheels."""
    found = []
    for axle, load in enumerate(loads, 1):
        column = f"guiding_force_{axle}"
        limit = TRACK_SHIFT + TRACK_SHIFT_SHARE * load
        found.append(Assessed(column, f"{column}_2m", "N", limit, _extreme))
        for side in ("left", "right"):
            wheel = f"{axle}_{side}"
            quotient, lateral, vertical = (
                f"{name}_{wheel}" for name in ("derailment_quotient", "lateral_force", "wheel_load")
            )
            found += [
                Assessed(quotient, f"{quotient}_2m", "1", DERAILMENT, _largest_mean),
                Assessed(vertical, f"{vertical}_largest", "N", None, _largest),
                Assessed(lateral, f"{lateral}_quasi_static", "N", GUIDING, _middle),
                Assessed(vertical, f"{vertical}_quasi_static", "N", LOAD, _middle),
            ]
    return found


#: Quantities in words, by the begin and the end of their names.
WORDS = {
    ("guiding_force", "2m"): "Sum of guiding forces, mean over 2 m",
    ("derailment_quotient", "2m"): "Y/Q, mean over 2 m",
    ("lateral_force", "quasi_static"): "Quasi-static guiding force Y",
    ("wheel_load", "quasi_static"): "Quasi-static wheel load Q",
}


def _check_level(recording: Recording, columns: Sequence[str]) -> None:
    """Raise ValueError for a run at level 1 or 2, where all wheel loads are 0."""
    if not any(np.any(recording[name]) for name in columns):
        raise ValueError(
            "The wheel loads must be above 0; got 0 N in all rows, as at levels 1 and 2. Run with level=3."
        )


def _verdicts(table: Recording, assessed: Sequence[Assessed]) -> list[str]:
    """Return a message for each kind of quantity with a limit: the value that is nearest to it or beyond."""
    found = []
    for (begin, end), words in WORDS.items():
        shares = {
            one: np.abs(table[one.name]) / one.limit
            for one in assessed
            if one.limit and one.name.startswith(begin) and one.name.endswith(end)
        }
        worst = max(shares, key=lambda one: float(np.max(shares[one])))
        row, limit = int(np.argmax(shares[worst])), worst.limit or 0.0
        value = abs(float(table[worst.name][row]))
        texts = [f"{one:.2f}" if worst.unit == "1" else f"{one / 1e3:.1f} kN" for one in (value, limit)]
        where = worst.column.removeprefix(f"{begin}_").replace("_", " ")
        verdict = "within" if value <= limit else "ABOVE"
        found.append(f"{words}: {texts[0]}, {verdict} the limit of {texts[1]} (wheelset {where}, section {row + 1}).")
    return found
