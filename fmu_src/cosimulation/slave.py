"""FMUs of FMI 2.0 and 3.0 through fmpy, with variables by name."""

from __future__ import annotations

import os
import secrets
import shutil
import tempfile
import weakref
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from fmu_src.archive import ArchiveError
from fmu_src.cosimulation import CosimulationError
from fmu_src.cosimulation.faces import EndedError, Face2, FMICallException, ModelDescription, face_of
from fmu_src.cosimulation.opening import unpacked
from fmu_src.suggestion import suggestion
from readers.storage import ANOTHER_TEMPORARY, writing

#: Value of a variable; a sequence for an array, row by row.
Value = float | str | Sequence[float]


class FmuInstance:
    """One instance of an FMU, with variables by name. A context manager: it cleans up after itself.

    Parameters
    ----------
    path : str or Path
        The FMU.
    instance : str, optional
        Its name if several of one FMU are coupled; by default that of the model.
    **parameters : float, str or array
        Parameters by name, in their units.

    Raises
    ------
    FileNotFoundError
        If the file does not exist.
    CosimulationError
        If the FMU is damaged, is not for co-simulation, has no binary for this platform, or cannot be instantiated.

    Examples
    --------
    >>> with FmuInstance("build/native/BogieDynamics.fmu", initial_speed=25.0) as bogie:
    ...     bogie.start(brake_torque_1=20e3)
    ...     bogie.step(0.0, 0.01)
    ...     bogie["speed"]
    """

    def __init__(self, path: str | Path, instance: str | None = None, /, **parameters: Value) -> None:
        if not Path(path).is_file():
            raise FileNotFoundError(f"There is no file {path}; give the path of an FMU.")
        self.messages: list[str] = []
        self._folder = str(Path(tempfile.gettempdir(), f"bogie-braking-{secrets.token_hex(8)}").absolute())
        # Registered before there is anything to remove.
        self._clear = weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        try:
            self._open(Path(path), instance)
        except BaseException:
            self._clear()
            raise
        self._parameters: dict[str, Value] = parameters

    def _open(self, path: Path, instance: str | None) -> None:
        """Unpack, load and instantiate the FMU. Raises CosimulationError."""
        with writing(Path(self._folder), ANOTHER_TEMPORARY):
            Path(self._folder).mkdir(mode=0o700)
        try:
            description = unpacked(path, Path(self._folder))
        except ArchiveError as error:
            raise CosimulationError(str(error)) from error
        self.name = instance or description.modelName
        self.guid = description.guid
        self._face = self._loaded(path, description)
        self.fmu = self._face.fmu
        known = [v for v in description.modelVariables if v.type in self._face.types]
        self._variables = {v.name: (v.valueReference, self._face.types[v.type]) for v in known}
        self._shapes = {v.name: tuple(v.shape) for v in known if v.shape}
        self.units = {v.name: v.unit or "1" for v in description.modelVariables}
        self._nominals = {v.name: float(v.nominal) if v.nominal else 1.0 for v in description.modelVariables}
        self._plans: dict[tuple[str, ...], list[tuple[str, list[int], list[int]]]] = {}
        try:
            self._face.instantiate()
        except Exception as error:  # FMPy has no class for it
            self.fmu.freeLibrary()
            raise CosimulationError(f"{self.name}: {self.messages[-1] if self.messages else error}") from error

    def _loaded(self, path: Path, description: ModelDescription) -> Face2:
        """Return the functions of the FMU's binary. Raises CosimulationError."""
        here = os.getcwd()
        try:
            return face_of(description, self._folder, self.name, self.messages.append)
        except Exception as error:  # FMPy has no class for it
            raise CosimulationError(f"{path} cannot be loaded: {str(error).rstrip('.')}.") from error
        finally:
            os.chdir(here)  # FMPy stays in the FMU's folder if a library cannot be loaded

    def __enter__(self) -> FmuInstance:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.fmu.freeInstance()
        self._clear()

    def start(self, time: float = 0.0, **inputs: Value) -> None:
        """Set parameters and first inputs, and initialise.

        Parameters
        ----------
        time : float
            Start time [s].
        **inputs : float, str or sequence
            First inputs by name, in their units.

        Raises
        ------
        CosimulationError
            If the FMU refuses a value or cannot be initialised.
        """
        self._call(self._face.begin, time, lambda: self.set(**self._parameters), lambda: self.set(**inputs))

    def restart(self, parameters: Mapping[str, Value], time: float = 0.0, **inputs: Value) -> None:
        """Reset the instance and start it with other parameters.

        Parameters
        ----------
        parameters : mapping
            Parameters by name, in their units.
        time : float
            Start time [s].
        **inputs : float, str or sequence
            First inputs by name, in their units.

        Raises
        ------
        CosimulationError
            If the FMU refuses a value or cannot be initialised.
        """
        self._call(self.fmu.reset)
        self.messages.clear()
        self._parameters = dict(parameters)
        self.start(time, **inputs)

    def set(self, **values: Value) -> None:
        """Set variables by name.

        Parameters
        ----------
        **values : float, str or array
            Values in the units of their variables.

        Raises
        ------
        CosimulationError
            With the FMU's message, if it refuses a value.
        """
        for name, value in values.items():
            reference, kind = self._reference(name)
            self._call(self._face.set, kind, reference, self._as(kind, name, value))

    def __getitem__(self, name: str) -> float:
        return self.get([name])[0]

    def array(self, name: str) -> np.ndarray:
        """Return the values of an array variable.

        Parameters
        ----------
        name : str
            Name of the variable.

        Returns
        -------
        ndarray
            Values in the unit of the variable, in its shape.

        Raises
        ------
        CosimulationError
            If the name is unknown.
        """
        reference, kind = self._reference(name)
        shape = self._shapes.get(name, ())
        return np.array(self._call(self._face.get, kind, [reference], self._size(name))).reshape(shape)

    def get(self, names: Sequence[str]) -> list[float]:
        """Return the values of scalar variables; one call for each type.

        Parameters
        ----------
        names : sequence of str
            Names of the variables.

        Returns
        -------
        list of float
            Values in the order of the names, each in the unit of its variable.

        Raises
        ------
        CosimulationError
            If a name is unknown, or if it is an array or a text.
        """
        key = tuple(names)
        found = [0.0] * len(key)
        for kind, references, places in self._plans.get(key) or self._plan(key):
            for place, value in zip(places, self._call(self._face.get, kind, references, len(references)), strict=True):
                found[place] = float(value)
        return found

    def _plan(self, names: tuple[str, ...]) -> list[tuple[str, list[int], list[int]]]:
        """Return the calls that read some variables: kind, value references, and their places among the names."""
        for name in names:
            if self._reference(name)[1] == "String" or self._size(name) != 1:
                raise CosimulationError(f"{name} of {self.name} is not a single number; use `array` for an array.")
        kinds = dict.fromkeys(self._reference(name)[1] for name in names)
        plan = []
        for kind in kinds:
            places = [place for place, name in enumerate(names) if self._reference(name)[1] == kind]
            plan.append((kind, [self._reference(names[place])[0] for place in places], places))
        self._plans[names] = plan
        return plan

    def _size(self, name: str) -> int:
        return int(np.prod(self._shapes.get(name, ())))

    def _as(self, kind: str, name: str, value: Value) -> list[Any]:
        """Return a value in the form of a call. Raises CosimulationError if an array has another length."""
        if kind == "String":
            return [value]
        given = np.ravel(value).tolist()
        if len(given) != self._size(name):
            raise CosimulationError(f"{name} of {self.name} must have {self._size(name)} numbers; got {len(given)}.")
        return given if kind in self._face.reals else [int(one) for one in given]

    def step(self, time: float, size: float) -> None:
        """Advance by one step.

        Parameters
        ----------
        time : float
            Start of the step [s].
        size : float
            Size of the step [s].

        Raises
        ------
        CosimulationError
            If the step fails.
        """
        self._call(self._face.step, time, size)

    def nominal(self, name: str) -> float:
        """Return the typical size of a variable.

        Parameters
        ----------
        name : str
            Name of the variable.

        Returns
        -------
        float
            Nominal value in its unit, from the FMU; 1 if the FMU has none.

        Raises
        ------
        CosimulationError
            If the name is unknown.
        """
        self._reference(name)
        return self._nominals[name]

    def rate(self, name: str) -> float:
        """Return the first derivative of an output by time.

        Parameters
        ----------
        name : str
            Name of the output.

        Returns
        -------
        float
            The derivative in its unit per second; 0 if the FMU provides none.

        Raises
        ------
        CosimulationError
            If the name is unknown.
        """
        if not self._face.provides_rates:
            return 0.0
        return float(self._call(self._face.rate, self._reference(name)[0]))

    def set_rate(self, name: str, rate: float) -> None:
        """Let an input change at a rate within the next step; without effect if the FMU takes no rates.

        Parameters
        ----------
        name : str
            Name of the input.
        rate : float
            Rate, in its unit per second.

        Raises
        ------
        CosimulationError
            If the name is unknown, or if the FMU refuses the rate.
        """
        if self._face.takes_rates:
            self._call(self._face.set_rate, self._reference(name)[0], rate)

    def save(self) -> object:
        """Return the FMU's state; `forget` it afterwards.

        Returns
        -------
        object
            The state, for `restore` and `forget`.

        Raises
        ------
        CosimulationError
            If the FMU cannot save its state.
        """
        if not self._face.saves:
            raise CosimulationError(f"{self.name} cannot save its state: give no tolerance, or take the native FMU.")
        return self._call(self._face.save)

    def restore(self, state: object) -> None:
        """Restore a saved state.

        Parameters
        ----------
        state : object
            A result of `save`.

        Raises
        ------
        CosimulationError
            If the FMU refuses it.
        """
        self._call(self._face.restore, state)

    def forget(self, state: object) -> None:
        """Free a saved state.

        Parameters
        ----------
        state : object
            A result of `save`.
        """
        self._call(self._face.forget, state)

    def _reference(self, name: str) -> tuple[int, str]:
        if name not in self._variables:
            raise CosimulationError(f"{self.name} has no variable {name}; {suggestion(name, self._variables)}")
        return self._variables[name]

    def _call(self, function: Callable, *arguments: object, **named: object):  # type: ignore[no-untyped-def]
        heard = len(self.messages)
        try:
            return function(*arguments, **named)
        except (FMICallException, EndedError) as error:
            # Only messages of this call: an older one is not the reason.
            sentence = self.messages[-1] if len(self.messages) > heard else str(error)
            raise CosimulationError(f"{self.name}: {sentence}") from error
