"""Vehicles in detail of the train's FMU: C sources of their kernel, the file details.bin, and their outputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fmu_src.arrays_fmu import ArrayVariable
from fmu_src.codegen import KERNEL_SOURCES, RUNTIME, generate
from fmu_src.system import Model, Variable
from products.building import variables_of
from products.one_level import model_at
from products.train.consist import Consist, TrainVehicle
from products.train.detail import Detail
from products.train.detailed_kernel import (
    OF_EACH,
    moved,
    own_model,
    place_in_fmu,
    reads_profiles,
    start_values,
    variables_in_c,
)
from products.train.library import FOLDER
from products.train.numbers import Settings
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.track.line import Line
from rbd_model.track.line_table import LINE
from readers.extras import need

#: Members of `detail_variables` before those of each wheelset.
SINGLE = ("wheelsets", "front", "rear", "place", "speed", "pitch", "pitch_rate", "axle_speed")


@dataclass(frozen=True)
class DetailsInC:
    """Vehicles in detail by number from 1, their middles on the line [m], the model of their kernels, step [s]."""

    vehicles: Mapping[int, TrainVehicle]
    middles: Mapping[int, float]
    line: Line | None
    model: Model
    step: float

    @property
    def details(self) -> dict[int, Detail]:
        """The details by the number of the vehicle."""
        return {number: one.detail for number, one in self.vehicles.items() if one.detail}

    @property
    def outputs(self) -> list[Variable]:
        """The outputs of a kernel."""
        return [variable for variable in self.model.variables if variable.causality == "output"]

    def sources(self) -> dict[str, str]:
        """Return C files by name: equations, runtime, and the object's part."""
        runtime = {name: (RUNTIME / name).read_text(encoding="utf-8") for name in KERNEL_SOURCES}
        return (
            generate(self.model) | runtime | {"details_fmu.c": (FOLDER / "details_fmu.c").read_text(encoding="utf-8")}
        )

    def arrays(self) -> tuple[ArrayVariable, ...]:
        """Return the outputs of all kernels as arrays of one number: `vehicle_7.axle_load_1`."""
        return tuple(
            ArrayVariable(f"vehicle_{number}.{one.name}", "output", one.unit, f"Vehicle {number}: {one.description}")
            for number in self.vehicles
            for one in self.outputs
        )

    def data(self) -> dict[str, bytes]:
        """Return the files of the object by name."""
        numbers = [
            float(len(self.vehicles)),
            self.step,
            *(one for number in self.vehicles for one in self._numbers(number)),
        ]
        found = {"details.bin": np.array(numbers, "<f8").tobytes()}
        for number, detail in self.details.items():
            if self.line is not None:
                found[f"line_{number}.csv"] = moved(self.line, self.middles[number]).text.encode()
            if reads_profiles(detail):
                found[f"profile_{number}.csv"] = detail.profile_files[0].read_bytes()
        return found

    def _numbers(self, number: int) -> Iterator[float]:
        """Yield the numbers of a vehicle in details.bin: details_fmu.c."""
        vehicle, detail = self.vehicles[number], self.details[number]
        names = [variable.name for variable in self.model.variables]
        places = {name: place for place, name in enumerate(names)}
        variables = variables_in_c(detail, names)
        yield number - 1
        yield from (getattr(variables, name) for name in SINGLE)
        yield from (getattr(variables, name)[n] for name in OF_EACH for n in range(variables.wheelsets))
        yield from (variables.radius, variables.height, places["initial_speed"])
        yield places[LINE.variable.name] if self.line is not None else -1
        yield places[PAIR_FILE.variable.name] if reads_profiles(detail) else -1
        values = start_values(detail, vehicle.motion(), 0.0, self.line is not None)
        pairs = [(places[name], value) for name, value in values.items() if name in places]
        yield len(pairs)
        yield from (one for pair in pairs for one in pair)
        yield len(self.outputs)
        yield from (places[one.name] for one in self.outputs)


def details_of(consist: Consist, settings: Settings, line: Line | None) -> DetailsInC | None:
    """Return the vehicles in detail of a consist, None without one. Raises ValueError, MissingExtraError."""
    vehicles = {number: one for number, one in enumerate(consist.vehicles, 1) if one.detail}
    if not vehicles:
        return None
    need("casadi")
    details = [one.detail for one in vehicles.values() if one.detail]
    if any(reads_profiles(one) and len(one.profile_files) > 1 for one in details):
        raise ValueError(
            "profile_file of a vehicle in an FMU must be one contact table for all wheelsets; got several."
        )
    ends = np.cumsum([0.0, *(one.length for one in consist.vehicles)])
    middles = {number: -float(ends[number - 1] + ends[number]) / 2 for number in vehicles}
    return DetailsInC(vehicles, middles, line, _model(details, line is not None), settings.detail_step)


def _model(details: Sequence[Detail], on_line: bool) -> Model:
    """Return the one model of all vehicles in detail. Raises ValueError if their equations differ."""
    first = details[0]
    if any((one.fmu, one.fmu is None and one) != (first.fmu, first.fmu is None and first) for one in details):
        got = ", ".join(dict.fromkeys(one.name for one in details))
        raise ValueError(
            f"Vehicles in detail of one FMU must have the same equations; got {got}. Leave all but one out."
        )
    if first.fmu is None:
        return own_model(first, on_line)
    places = dict.fromkeys(place_in_fmu(one, on_line) for one in details)
    return model_at(first.fmu, variables_of(first.fmu), *places)
