"""A train as a Python object: a consist on a line, driven by its brake valves; the computation is in C."""

from __future__ import annotations

import ctypes
import hashlib
import weakref
from collections.abc import Mapping
from operator import attrgetter
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brake_controller.air import AMBIENT
from brake_controller.distributors import DISTRIBUTORS, kind_of
from brake_controller.electric_brake import INTERLOCK
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.controller_kinds import Form, InC
from products.run_history import RunHistory
from products.train.consist import Consist
from products.train.detailed_kernel import compiled, functions_of, kernel_of, outputs_of, variables_in_c
from products.train.inputs import BY_NAME, Inputs, wrong_input
from products.train.layout import EQUIPMENT, HIGHEST, INITIAL, INPUTS, LOWEST_VACUUM, OF_WHEELS, OUTPUTS, SUMS, Array
from products.train.library import functions
from products.train.notches import driven
from products.train.numbers import Settings, numbers_of, volumes_of
from products.train.own_controllers import OwnControllers
from products.train.pipe import PipeAir
from rbd_model.track.line import Line
from readers.import_account import Imported
from readers.usual import almost_0, is_almost_0, likely_unit, note

#: Longest time of `advance` or `record` [s], and largest number of values [1].
LONGEST, MOST = 86400.0, 1e8
#: Attributes of a train that are set, beside its properties.
SETTABLE = ("consist", "settings", "imported", "inputs", "run_history")
#: Time of an event that has not occurred [s] (train.h).
NEVER = 1e300
#: Outputs that are recorded.
RECORDED = [one for one in (*OUTPUTS, *OF_WHEELS) if one.name != "mean_coupler_force"]
#: Outputs that are recorded only of trains with such a vehicle: its fields, and the values that they exceed.
ONLY_WITH: dict[tuple[str, ...], Mapping[str, float]] = {
    ("brake_temperature", "surface_temperature", "block_temperature", "brake_heat"): {"heat.heat_capacity": 0.0},
    ("track_brake_force",): EQUIPMENT["track_brake"].above,
    ("traction_force", "traction_energy"): EQUIPMENT["traction"].above,
    ("electric_brake_energy",): {**EQUIPMENT["traction"].above, **EQUIPMENT["dynamic_brake"].above},
    ("protection_state", "protection_air"): {"protection.controller": 0.0},
    ("main_reservoir_pressure", "compressor_on", "compressor_air"): {"main_reservoir.reservoir_volume": 0.0},
    ("vigilance_warning", "penalty_applied"): EQUIPMENT["vigilance"].above,
}
#: Inputs that a vehicle with a controller does not take, and why.
OF_CONTROLLED = {
    "protection": "which commands its valves",
    "external_vehicle": "whose sensor would show no slip",
}
#: `protection_state` of a controller that failed.
FAILED = 3.0
#: Places of outputs, and of the run's numbers.
OUTPUT, SUM = ({one.name: place for place, one in enumerate(of)} for of in (OUTPUTS, SUMS))


def within(name: str, value: float, least: float, most: float, unit: str) -> None:
    """Raise ValueError if it is not a number within the limits."""
    number = isinstance(value, (int, float, np.floating, np.integer)) and not isinstance(value, bool)
    if not (number and least <= value <= most):
        said = f"{name} must be a number from {least:g} to {most:g} {unit}".rstrip() + f"; got {value}."
        remedy = likely_unit(value, unit, least, most) if number else ""
        raise ValueError(said + (remedy or " Correct it."))
    if is_almost_0(value, unit):
        raise ValueError(almost_0(name, value, unit, most))


def _place(name: str, value: int, count: int) -> None:
    """Raise ValueError if it is not an integer from 0 to below `count`."""
    if not (isinstance(value, (int, np.integer)) and 0 <= value < count):
        raise ValueError(f"The number of a {name} must be an integer from 0 to {count - 1}; got {value}.")


def _exceeding(consist: Consist, above: Mapping[str, float]) -> NDArray[np.intp]:
    """Return the vehicles, from 0, a field of which exceeds its value."""
    fields = [(attrgetter(field), value) for field, value in above.items()]
    return np.flatnonzero([any(field(vehicle) > value for field, value in fields) for vehicle in consist.vehicles])


def _recorded_of(consist: Consist) -> list[Array]:
    """Return the outputs that are recorded of a consist."""
    left_out = {name for names, above in ONLY_WITH.items() if not _exceeding(consist, above).size for name in names}
    return [one for one in RECORDED if one.name not in left_out]


def start_limits(consist: Consist) -> dict[str, tuple[float, float]]:
    """Return the limits of initial gauge pressures [Pa]: vacuum brakes start with the pressure of the pipe alone."""
    if consist.charged_pressure < 0.0:
        return {"pipe": (LOWEST_VACUUM, 0.0), "cylinder": (0.0, 0.0)}
    return {"pipe": (0.0, HIGHEST)}


def idle_inputs(consist: Consist) -> dict[str, str]:
    """Return the inputs that no vehicle of a consist uses, and what it lacks."""
    return {name: one.text for name, one in EQUIPMENT.items() if not _exceeding(consist, one.above).size}


def partly_used(consist: Consist) -> dict[str, NDArray[np.intp]]:
    """Return the inputs that some vehicles of a consist use and others do not, and those that do, from 0."""
    of_vehicles = {name: one.above for name, one in EQUIPMENT.items() if BY_NAME[name].of == "vehicles"}
    used = {name: _exceeding(consist, above) for name, above in of_vehicles.items()}
    return {name: there for name, there in used.items() if 0 < there.size < len(consist.vehicles)}


class Train:
    """A train to be driven step by step.

    Inputs are arrays to write into, or to set as a whole: `driver_position` and `driver_step` of each driver's valve,
    with `penalty` and `vigilance`, `traction`, `direct_brake` [1], `pull` [N], `friction` [1], `bail_off` and
    `protection` of each vehicle, `coupling_closed` and `hose_state` of
    each coupling, `end_force` at both ends [N]. Outputs are attributes: OUTPUTS, an array of each, and SUMS. Pressures
    are gauge pressures [Pa].
    `imported` accounts for the fields of a file of another program (`bb.train`), otherwise it is None.

    Parameters
    ----------
    consist : Consist
        Vehicles from head to end.
    speed : float
        Initial speed [m/s].
    distance : float
        Initial distance along the line [m].
    pipe : float
        Initial gauge pressure of the pipe [Pa]; by default that of the charged pipe.
    cylinder : float
        Initial gauge pressure of the cylinders [Pa].
    line : Line, optional
        Line of the train; by default straight, level track.
    settings : Settings, optional
        Brake model and step size.
    controllers : mapping of int to Form, optional
        Wheel-slide controllers of users by the vehicle, from 0; their vehicles state a controller.

    Raises
    ------
    ValueError
        If a value is out of its limits.
    TypeError
        If `settings` are not Settings.
    """

    def __init__(
        self,
        consist: Consist,
        *,
        speed: float = 0.0,
        distance: float = 0.0,
        pipe: float | None = None,
        cylinder: float = 0.0,
        line: Line | None = None,
        settings: Settings | None = None,
        controllers: Mapping[int, Form] | None = None,
    ) -> None:
        if pipe is None:
            pipe = consist.charged_pressure
        limits = start_limits(consist)
        for one, value in zip(INITIAL, (speed, distance, pipe, cylinder), strict=True):
            within(one.name, value, *limits.get(one.name, (one.least, one.most)), one.unit)
        if settings is not None and not isinstance(settings, Settings):
            raise TypeError(f"settings must be a Settings of products.train.numbers, or None; got {settings!r}.")
        self.consist, self.settings = consist, settings or Settings()
        self.imported: Imported | None = None
        self._line = line
        self._notes = [said for said in [note("speed", speed, "m/s")] if said]
        numbers = numbers_of(consist, self.settings, line)
        self._call = functions()
        wrong = self._call.train_wrong(numbers.ctypes.data, numbers.size)
        if wrong:
            raise ValueError(f"These vehicles, settings or line make no train: {wrong.decode()} cannot be.")
        own = [one.path.read_bytes() for _, one in sorted((controllers or {}).items()) if isinstance(one, InC)]
        self._mark = hashlib.sha256(b"".join([numbers.tobytes(), *own])).digest()
        self.run_history: RunHistory | None = None
        self._noted_inputs: dict[str, bytes] = {}
        self._volumes = volumes_of(consist, self.settings)
        self._own = self._call.train_create(numbers.ctypes.data, numbers.size)
        if not self._own:
            raise MemoryError(f"There is no memory for a train of {len(consist.vehicles)} vehicles; take fewer.")
        weakref.finalize(self, self._call.train_free, self._own)
        self._controllers = OwnControllers(self._call, self._own, controllers or {}, consist)
        self._call.train_begin(self._own, 0.0, speed, distance, pipe + AMBIENT, cylinder + AMBIENT)
        self.inputs = Inputs(
            {input_.name: self._view(self._call.train_input, row) for row, input_ in enumerate(INPUTS)}
        )
        self._noted_inputs = {name: array.tobytes() for name, array in self.inputs.items()}
        self._outputs = {name: self._view(self._call.train_output, row) for name, row in OUTPUT.items()}
        self._sums = self._view(self._call.train_output, len(OUTPUTS))
        self._take_details(speed, distance, line)
        self._recorded = _recorded_of(consist)
        self._valves = [(one.valve, one.handle) for one in consist.vehicles if one.valve is not None]
        self._idle = {name: (self.inputs[name], lacks) for name, lacks in idle_inputs(consist).items()}
        self._partly = {name: (self.inputs[name], int(at[0]), at) for name, at in partly_used(consist).items()}

    def _view(self, call: Any, row: int) -> NDArray[np.float64]:
        count = ctypes.c_longlong()
        found = call(self._own, row, ctypes.byref(count))
        if not count.value:
            return np.empty(0)
        return np.ctypeslib.as_array(found, (count.value,))

    def _take_details(self, speed: float, distance: float, line: Line | None) -> None:
        """Make the kernels of vehicles in detail, and let them move their vehicles."""
        vehicles = self.consist.vehicles
        self._details: dict[int, Kernel] = {}
        self._kept: list[Any] = []  # tables that the C holds
        self._detailed_outputs: dict[str, tuple[Kernel, int, str]] = {}
        for n, vehicle in enumerate(vehicles):
            if vehicle.detail is None:
                continue
            middle = float(self._outputs["distance"][n])
            kernel = kernel_of(vehicle.detail, vehicle.motion(), speed, line, middle)
            tables = functions_of(kernel.library), variables_in_c(vehicle.detail, kernel.library.names)
            if not self._call.train_detail(self._own, n, kernel.handle, *map(ctypes.addressof, tables)):
                raise MemoryError(f"There is no memory for vehicle {n + 1} in detail; take fewer.")
            self._kept += tables
            self._notes += [f"Vehicle {n + 1}: {vehicle.detail.unused}"] if vehicle.detail.unused else []
            self._mark = hashlib.sha256(self._mark + repr(vehicle.detail.content).encode()).digest()
            self._details[n + 1] = kernel
            for one in outputs_of(compiled(vehicle.detail, line is not None)):
                column = f"vehicle_{n + 1}.{one.name}"
                self._detailed_outputs[column] = kernel, kernel.number_of(one.name), one.unit
        self._call.train_detail_step(self._own, self.settings.detail_step)
        self._call.train_detail_begin(self._own)

    @property
    def details(self) -> Mapping[int, Kernel]:
        """Kernels of vehicles in detail by the number of the vehicle from 1: `train.details[7]["axle_load_1"]`."""
        return MappingProxyType(self._details)

    def drive(self, position: str, step: float = 0.0, valve: int = 0, handle: str = "") -> None:
        """Set a driver's valve to a position, or to a notch of its handle.

        Parameters
        ----------
        position : str
            Position or notch.
        step : float
            Step of service, from 0 to 1.
        valve : int
            Its number, from 0.
        handle : str
            Handle of the notch, by default that of the vehicle.

        Raises
        ------
        ValueError
            If the name is unknown, a number is out of its limits, or service is by wire and has no such position.
        """
        within("A step of service, 0 the first and 1 full,", step, 0.0, 1.0, "")
        _place("valve", valve, self.inputs["driver_position"].size)
        own, named = self._valves[valve]
        number, step = driven(position, step, own, handle or named)
        self.inputs["driver_position"][valve], self.inputs["driver_step"][valve] = number, step

    def advance(self, time: float) -> None:
        """Advance by a time [s].

        Raises ValueError if an input or the state is not finite; the train keeps its last state then.
        """
        within("The time", time, 0.0, LONGEST, "s")
        self._note("advance", time)
        self._advance(time)

    @property
    def line(self) -> Line | None:
        """Line of the train; None: straight, level track."""
        return self._line

    @property
    def mark(self) -> str:
        """Digest of vehicles, settings and line."""
        return self._mark.hex()[:24]

    def _note(self, step: str, *arguments: float) -> None:
        """Add a step to the history, after the inputs that changed since the last one."""
        if self.run_history is None:
            return
        now = {name: array.tobytes() for name, array in self.inputs.items()}
        if now != self._noted_inputs:
            changed = {
                name: self.inputs[name].tolist() for name, those in now.items() if those != self._noted_inputs[name]
            }
            self.run_history.add("inputs", changed, numbers=sum(map(len, changed.values())))
            self._noted_inputs = now
        self.run_history.add(step, *map(float, arguments))

    def _advance(self, time: float) -> None:
        for name, (array, lacks) in self._idle.items():
            if np.count_nonzero(array):
                raise ValueError(f"inputs[{name!r}] must be 0: no vehicle has {lacks}, and it has no effect. Reset it.")
        for name, (array, first, there) in self._partly.items():
            if not array.item(first) and np.count_nonzero(array) and not np.count_nonzero(array[there]):
                self._note_idle(name)
                break  # the next advance looks at the others
        status = self._call.train_go(self._own, time)
        self._controllers.check()
        if status == -2:
            raise ValueError(self._wrong_input())
        for number, kernel in self._details.items():
            kernel.hear()
            self._notes += [f"Vehicle {number}: {said}" for said in kernel.messages]
            kernel.messages.clear()
        if status == -3:
            name = f"Vehicle {self._call.train_detail_failed(self._own) + 1}: "
            raise ValueError([said for said in self._notes if said.startswith(name)][-1])
        if status:
            raise ValueError(f"The train came to no finite state within {time:g} s; look at what was set.")

    def _note_idle(self, name: str) -> None:
        """Note once that an input is set at vehicles without its equipment alone."""
        array, first, _ = self._partly.pop(name)
        place, lacks = int(np.flatnonzero(array)[0]), EQUIPMENT[name].text
        said = f"inputs[{name!r}][{place}] has no effect without {lacks}."
        self.remark(f"{said} inputs[{name!r}][{first}] has {lacks}.")

    def _wrong_input(self) -> str:
        place = ctypes.c_longlong()
        name = INPUTS[self._call.train_input_wrong(self._own, ctypes.byref(place))].name
        value = float(self.inputs[name][place.value])
        own = self.consist.vehicles[place.value] if name in OF_CONTROLLED else None
        if own and own.detail and name == "external_vehicle" and value in (1.0, 2.0):
            return f"inputs['external_vehicle'][{place.value}] must be 0: this train computes that vehicle in detail."
        if own and value in (1.0, 2.0) and own.protection.controller:
            words = f"vehicle {place.value + 1} has a controller of its own, {OF_CONTROLLED[name]}"
            return f"inputs['{name}'][{place.value}] must be 0: {words}. Reset it, or leave out its protection."
        if name == "hose_state" and value in (1.0, 2.0):
            delay = self.settings.brake_model == "delay"
            where = "in the brake model delay" if delay else f"with {self.settings.cells:g} cells a vehicle"
            remedy = "another brake model" if delay else "one cell"
            return f"Leave inputs['hose_state'][{place.value}] at 0: {where} there is no cock or hose; take {remedy}."
        if name == "driver_position" and value in (5.0, 6.0):
            return (
                f"inputs['driver_position'][{place.value}] must be from 0 to 4, as service is by wire; got {value:g}. "
                "Write service with a step."
            )
        return wrong_input(name, place.value, value)

    def record(self, seconds: float, interval: float = 0.1) -> Recording:
        """Advance by `seconds`, or until all vehicles stand, and record every output of each vehicle.

        `speed[1]` is the head's.

        Parameters
        ----------
        seconds : float
            Time to advance [s].
        interval : float
            Recording interval [s].

        Returns
        -------
        Recording
            The outputs over time; pressures are gauge pressures.

        Raises
        ------
        ValueError
            If a time is out of its limits, or as in `advance`.
        """
        if not (0.0 < interval < np.inf and 0.0 <= seconds <= LONGEST):
            raise ValueError(
                f"The interval must be above 0 s, and the time at most {LONGEST:g} s; got {interval} s and {seconds} s."
            )
        units = {"time": "s"} | {name: one.unit for one in self._recorded for name in self._names(one.name)}
        units |= {name: unit for name, (_, _, unit) in self._detailed_outputs.items()}
        if seconds / interval * len(units) > MOST:
            raise ValueError(
                f"The interval must be longer; got {interval:g} s, more than {MOST:g} numbers in {seconds:g} s."
            )
        self._note("record", seconds, interval)
        rows = [self._row()]
        for _ in range(round(seconds / interval)):
            moving = bool(self.speed.any())
            self._advance(interval)
            rows.append(self._row())
            if moving and not self.speed.any():
                break
        return Recording(
            units, np.array(rows), self.messages, provenance=self.run_history.snapshot() if self.run_history else None
        )

    def _names(self, output: str) -> list[str]:
        return [f"{output}[{n + 1}]" for n in range(getattr(self, output).size)]

    def _row(self) -> NDArray[np.float64]:
        detailed = [kernel.get_number(number) for kernel, number, _ in self._detailed_outputs.values()]
        return np.concatenate([[self.time], *(getattr(self, one.name) for one in self._recorded), detailed])

    def __setattr__(self, name: str, value: Any) -> None:
        """Set what may be set: outputs, inputs and misspelt names would have no effect. Raises AttributeError."""
        inputs = [input_.name for input_ in INPUTS]
        if name in inputs and name not in OUTPUT:
            raise AttributeError(f"{name} must be set as an input. Write train.inputs[{name!r}] = ...")
        if name in OUTPUT or name in SUM:
            remedy = f" Write train.inputs[{name!r}] = ..." if name in inputs else " Set the inputs, or motion."
            raise AttributeError(f"{name} must be read, it is an output.{remedy}")
        if name == "inputs" and "inputs" in self.__dict__:
            raise AttributeError("inputs must be set by name. Write train.inputs['friction'] = ..., for example.")
        if not (name.startswith("_") or name in SETTABLE or isinstance(getattr(type(self), name, None), property)):
            raise AttributeError(f"A train must have the attribute that is set; got {name!r}. Correct the name.")
        super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        if name in OUTPUT:
            values = self._outputs[name]
            return values - AMBIENT if name.endswith("pressure") else values.copy()
        if name in SUM:
            return float(self._sums[SUM[name]])
        raise AttributeError(name)

    @property
    def controller_failures(self) -> list[str]:
        """Messages on wheel-slide controllers that failed; their brakes stay applied."""
        failed = np.flatnonzero(self.protection_state == FAILED).tolist()
        where = [number for number in failed if number not in self._controllers.called]
        words = "Its controller gave an invalid command or wrote beyond its memory; the brake stays applied."
        return [*self._controllers.failures, *(f"Vehicle {number + 1}: {words}" for number in where)]

    @property
    def locked(self) -> NDArray[np.int64]:
        """1 for each vehicle whose wheels are locked while it moves, otherwise 0."""
        return ((self.wheel_speed == 0.0) & (self.speed != 0.0)).astype(int)

    @property
    def locked_at(self) -> NDArray[np.float64]:
        """Time at which the wheels of each vehicle first locked while it moved [s], otherwise NaN."""
        times = self._times(self._call.train_locked_at)
        return np.where(times < NEVER, times, np.nan)

    def _times(self, call: Any) -> NDArray[np.float64]:
        return np.ctypeslib.as_array(call(self._own), (len(self.consist.vehicles),)).copy()

    @property
    def messages(self) -> list[str]:
        """Messages of the run: notes on its start, broken couplers, parted hoses, locked wheels, failed controllers."""
        times, ends = self.locked_at, {"coupler": ("broke", self._call.train_broken_at)}
        ends["hose"] = ("parted", self._call.train_parted_at)
        broken = (
            f"The rear {name} of vehicle {n} {verb} at {at:.2f} s."
            for name, (verb, call) in ends.items()
            for n, at in enumerate(self._times(call), 1)
            if at < NEVER
        )
        locked = (self._lock_message(int(n), times[n]) for n in np.flatnonzero(np.isfinite(times)))
        return [*self._notes, *broken, *locked, *self.controller_failures]

    def remark(self, message: str) -> None:
        """Add a text to `messages`, once; an empty one is none."""
        if message and message not in self._notes:
            self._notes.append(message)

    def _lock_message(self, vehicle: int, time: float) -> str:
        electric = self.consist.vehicles[vehicle].electric
        twice = electric.dynamic_force > 0.0 and electric.blended_pressure == 0.0 and electric.blending != INTERLOCK
        remedy = " Its electric brake adds to its air; blending = interlock keeps this air out." if twice else ""
        return f"The wheels of vehicle {vehicle + 1} locked at {time:.2f} s.{remedy}"

    @property
    def slip(self) -> NDArray[np.float64]:
        """(v - w) over the larger of both, of each vehicle's wheels [1]."""
        speed, wheel = self.speed, self.wheel_speed
        return (speed - wheel) / np.maximum(np.maximum(np.abs(speed), np.abs(wheel)), np.finfo(float).tiny)

    @property
    def state(self) -> NDArray[np.float64]:
        """Complete state of a run, to be restored later, with a checksum as its last number.

        Raises ValueError if a controller is in Python or in an FMU: its own state is not in this one.
        """
        self._check_saved()
        found = np.empty(self._call.train_numbers(self._own) + 1)
        self._call.train_save(self._own, found.ctypes.data)
        found[-1] = self._checksum(found[:-1])
        return found

    @state.setter
    def state(self, numbers: NDArray[np.float64]) -> None:
        """Restore a saved state. Raises ValueError if it belongs to another train."""
        self._check_saved()
        due = self._call.train_numbers(self._own) + 1
        if np.shape(numbers) != (due,):
            raise ValueError(
                f"The state must be one that this train has saved, {due} numbers; got the shape {np.shape(numbers)}."
            )
        given = np.ascontiguousarray(numbers, np.float64)
        if given[-1] != self._checksum(given[:-1]):
            raise ValueError(
                "The state must be one that this train has saved; got changed numbers, or the state of another train."
            )
        self._call.train_load(self._own, given.ctypes.data)
        self._discard_history("a saved state was restored")

    def _check_saved(self) -> None:
        if self._controllers.called:
            vehicle = min(self._controllers.called) + 1
            raise ValueError(
                f"The state must be of controllers in C; that of vehicle {vehicle} is in Python or in an FMU, with a "
                "state of its own. Write it in C, or begin the run again."
            )

    def _discard_history(self, reason: str) -> None:
        if self.run_history is not None:
            self.run_history.discard(reason)

    def _checksum(self, numbers: NDArray[np.float64]) -> float:
        """Return the checksum of a state of this train's vehicles, settings and line.

        It is between 0 and 1, a number as the others.
        """
        digest = hashlib.blake2b(numbers.tobytes(), key=self._mark, digest_size=8).digest()
        return float((int.from_bytes(digest, "little") >> 11) * 2.0**-53)

    @property
    def motion(self) -> NDArray[np.float64]:
        """Positions relative to neutral couplers [m], speeds, wheel speeds [m/s], coupler rest positions [m].

        The shape is (4, vehicles).
        """
        found = np.empty((4, len(self.consist.vehicles)))
        self._call.train_motion(self._own, found.ctypes.data)
        return found

    @motion.setter
    def motion(self, state: NDArray[np.float64]) -> None:
        """Set positions, speeds and rest positions. Raises ValueError for another speed of a vehicle in detail."""
        own = [number - 1 for number in self._details]
        if not np.array_equal(np.asarray(state)[1:3, own], self.motion[1:3, own]):
            raise ValueError("The speed of a vehicle in detail must be that of its kernel. Set positions alone there.")
        self._call.train_set_motion(self._own, np.ascontiguousarray(state, float).ctypes.data)
        self._discard_history("its motion was set")

    def lead(self, vehicle: int, speed: float) -> None:
        """Set the speed of a vehicle from outside [m/s] from now on."""
        _place("vehicle", vehicle, len(self.consist.vehicles))
        self.inputs["external_vehicle"][vehicle], self.inputs["external_vehicle_speed"][vehicle] = 1.0, speed

    @property
    def air(self) -> PipeAir:
        """The air of the pipe: its cells, and the mass and energy that have left since the start.

        `vehicle_pressures("auxiliary")` has the reservoirs of the vehicles [Pa, absolute].
        """
        known = list(DISTRIBUTORS.values())
        kinds = [known.index(kind_of(vehicle.distributor)) for vehicle in self.consist.vehicles]
        return PipeAir(self._call, self._call.train_air(self._own), self._volumes, kinds)

    @property
    def steps(self) -> tuple[int, int]:
        """Number of steps of the pipe, and of the couplers."""
        found = np.zeros(2, np.int64)
        self._call.train_steps(self._own, found.ctypes.data)
        return int(found[0]), int(found[1])
