"""Run one kernel through a history of inputs and record it: the basis of the studies in 3D."""

import re
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from fmu_src.chosen import alone
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System
from products.building import kernel_at, kernel_of, units_of, variables_of, whole_kernel
from products.one_level import model_at, place_of
from products.registry import model_of
from rbd_model.levels.models import recommend_level
from rbd_model.track.line import Line

#: Points (time [s], value) of an input: linear between them, constant after the last, a jump at a repeated time.
History = Sequence[tuple[float, float]]
#: 3D with the contact of the thesis, one rigid contact a wheel: for comparisons with it or with rigid profiles, and for
#: cases without flange contact, where it is the cheapest model.
RIGID = {"level": 3.0, "contact_model": 1.0}
#: A wheelset that locks below this speed [m/s] has stopped with the bogie.
AT_REST = 0.05
#: Rolling resistance of each wheelset for a linearisation, that of section 8.3 [N.m], and time in which wheels come to
#: roll freely and contacts to their loads [s].
DRAG, SETTLED = 65.0, 1.0
#: Ratio of the padded length of a spectrum to that of the recording.
PADDING = 8


def library(name: str, **values: float | str) -> Library:
    """Return the compiled kernel inside the FMU of this name; of a vehicle the one system that the values choose."""
    return _library(name, place_of(name, variables_of(name), values))


@lru_cache
def _library(name: str, place: int | None) -> Library:
    return Library(whole_kernel(name) or (kernel_of(name) if place is None else kernel_at(name, place)))


def prepare(name: str, **values: float | str) -> Kernel:
    """Return a kernel with parameters and initial inputs; it contains only the system that they choose."""
    return Kernel(library(name, **values), **values)


def settled(name: str, **values: float) -> Kernel:
    """Return the same after the wheels roll freely on settled contacts, for its linearisation.

    Polach's law has no unique slope at zero creepage: its stiffness is a mean of c11 and c22 in the direction of the
    creepage, (3.92). Each wheelset has a rolling resistance of at least DRAG: otherwise round-off gives the direction.
    """
    torque = max(values.get("rolling_resistance_torque", 0.0), DRAG)
    kernel = prepare(name, **values | {"rolling_resistance_torque": torque})
    kernel.advance(SETTLED)
    return kernel


def prepare_on_line(name: str, line: Line, **values: float) -> Kernel:
    """Return the same on a line, which the kernel reads from a file and keeps."""
    with tempfile.TemporaryDirectory() as folder:
        return prepare(name, line_file=str(line.write(Path(folder) / "line.csv")), **values)


def in_space(name: str) -> dict[str, float]:
    """Return the parameters of 3D and the thesis's contact, RIGID; none for chapter 4, which has only this contact."""
    return {} if name == "wheelset" else RIGID


def system_of(name: str, **values: float) -> System:
    """Return the equations that a kernel with these parameters solves."""
    place = place_of(name, variables_of(name), values)
    return alone(model_of(name), values).systems[0] if place is None else _system(name, place)


@lru_cache
def _system(name: str, place: int) -> System:
    return model_at(name, variables_of(name), place).systems[0]


def bogie(driven: Iterable[str], read: Iterable[str], **values: float) -> Kernel:
    """Return the bogie of chapter 5 at the lowest level that has these inputs, values and outputs.

    It has one rigid contact a wheel unless `values` have another `contact_model`.
    """
    asked = (name for name in values if name != "contact_model")
    return prepare("bogie", **RIGID | {"level": recommend_level((*driven, *asked), read).level} | values)


def play(
    name: str, kernel: Kernel, duration: float, interval: float, record: Sequence[str], inputs: Mapping[str, History]
) -> Recording:
    """Run a kernel and record it every `interval` s and at each corner of an input.

    Takes duration [s], interval [s].
    """
    corners = {time for history in inputs.values() for time, _ in history if 0.0 < time < duration}
    edges = [0.0, *sorted(corners), duration]
    kernel.set(**{key: history[0][1] for key, history in inputs.items()})
    kernel.initialise()
    pieces = [_present(kernel, record)]
    for begin, end in pairwise(edges):
        for key, history in inputs.items():
            first, last = value_at(history, begin, after=True), value_at(history, end, after=False)
            kernel.set(**{key: first})
            kernel.set_rate(**{key: (last - first) / (end - begin)})
        table = kernel.record(end - begin, interval, record)
        pieces.append(np.column_stack([table[column] for column in ("time", *record)])[1:])
        if kernel.time > table["time"][-1] + 1e-9:
            pieces.append(_present(kernel, record))
        if kernel.ended:
            break
    return Recording({"time": "s"} | {column: units_of(name)[column] for column in record}, np.concatenate(pieces))


def _present(kernel: Kernel, record: Sequence[str]) -> np.ndarray:
    """Return time and present values of a kernel, shape (1, 1 + values)."""
    return np.array([[kernel.time, *(kernel[column] for column in record)]])


def value_at(history: History, time: float, after: bool) -> float:
    """Return the value at a time; at a jump, the value before or after it."""
    times, values = np.array(history).T
    found = np.searchsorted(times, time, "right" if after else "left")
    if found == 0 or found == times.size:
        return float(values[min(found, times.size - 1)])
    share = (time - times[found - 1]) / (times[found] - times[found - 1])
    return float(values[found - 1] + share * (values[found] - values[found - 1]))


def peaks(values: np.ndarray) -> np.ndarray:
    """Return the indices of the local maxima."""
    inner = values[1:-1]
    return 1 + np.flatnonzero((inner > values[:-2]) & (inner >= values[2:]))


def period(time: np.ndarray, values: np.ndarray) -> float | None:
    """Return the mean time between rising zero crossings [s]; None with fewer than two."""
    rising = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    if rising.size < 2:
        return None
    share = -values[rising] / (values[rising + 1] - values[rising])
    return float(np.diff(time[rising] + share * (time[rising + 1] - time[rising])).mean())


def spectrum(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies [Hz] and power density [unit^2/Hz] of evenly sampled values, mean removed, padded to a fine
    grid.
    """
    step, count = time[1] - time[0], values.size * PADDING
    transform = np.fft.rfft((values - values.mean()) * np.hanning(values.size), count)
    return np.fft.rfftfreq(count, step), np.abs(transform) ** 2 * 2 * step / np.sum(np.hanning(values.size) ** 2)


def located_lock_time(kernel: Kernel, series: Recording, number: int) -> float | None:
    """Return the time at which a wheelset first locked while the bogie moved [s], as located by the kernel, to six
    digits.
    """
    for time in re.findall(rf"Wheelset {number} locked at (\S+) s\.", " ".join(kernel.messages)):
        if np.interp(float(time), series["time"], series["speed"]) > AT_REST:
            return float(time)
    return None
