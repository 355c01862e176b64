"""One braked train by several methods: the product's explicit steps, linearly implicit ones, CVODE and LSODA.

Work is counted and not timed: evaluations of all couplers and vehicles, and solutions of their tridiagonal equations.
The cost of each in C is measured in every run.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint

from bogie_braking.reporting.timing import least
from evidence.peers import sundials
from fmu_src.compile import loaded, plain_library
from products.train.consist import Consist, block_train
from products.train.library import sources
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.coupler import Coupler, draft_gear, fastest

SOURCE = Path(__file__).with_suffix(".c")
#: Speed at which the train brakes [m/s]; simulated time [s]; number of wagons; their loads by name [kg].
SPEED, LONG, WAGONS = 25.0, 12.0, 40
LOADS = {"loaded, 80 t": 60e3, "empty, 20 t": 0.0}
#: Recording interval of brake forces, and sampling interval of the states of CVODE and LSODA [s].
RECORDED, LOOKED = 0.01, 2.5e-4
#: Nominal values of tolerances: places, strokes and rest positions of couplers [m], speeds [m/s].
NOMINAL_PLACE, NOMINAL_WAY, NOMINAL_SPEED = 1.0, 0.1, 1.0
#: Timed solutions, and their repetitions.
TIMED, REPEATED = 20_000, 5
#: Least relative tolerances that LSODA and CVODE accept; limit of evaluations or steps.
LEAST, NONE, MOST = 1e-13, 1e-15, 500_000
#: Reference: tolerance of CVODE; step [s] of the midpoint method without CVODE.
REFERENCE, FINE = 1e-10, 2e-5
#: Largest number of vehicles in train_couplers.c.
MOST_VEHICLES = 256
Matrix = NDArray[np.float64]
_pointer = ctypes.POINTER(ctypes.c_double)


class Equations(ctypes.Structure):
    """`train_equations` of train_couplers.c."""

    _fields_ = [
        ("vehicles", ctypes.c_longlong),
        *((name, _pointer) for name in ("mass", "resistance", "coupler", "brake")),
        ("rows", ctypes.c_longlong),
        ("interval", ctypes.c_double),
        ("evaluations", ctypes.c_longlong),
        ("solves", ctypes.c_longlong),
        ("compression", ctypes.c_double),
    ]


@lru_cache
def functions() -> ctypes.CDLL:
    """Return the train's own C and train_couplers.c, compiled once."""
    library = loaded(plain_library(sources() | {SOURCE.name: SOURCE.read_text(encoding="utf-8")}))
    pointer, count, number = ctypes.c_void_p, ctypes.c_longlong, ctypes.c_double
    signatures: dict[str, tuple[Any, list[Any]]] = {
        "equations_laws": (None, [pointer, count, *[pointer] * 5]),
        "equations_slopes": (ctypes.c_int, [pointer, number, *[pointer] * 3]),
        "equations_solutions": (number, [count, count]),
        "equations_implicit": (None, [pointer, pointer, count, number, number, count]),
        "equations_explicit": (ctypes.c_int, [pointer, *[pointer] * 3, count, number]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


def rates(coupler: Coupler, way: Matrix, rest: Matrix, rate: Matrix) -> tuple[Matrix, Matrix]:
    """Evaluate the laws of equal couplers.

    Takes way, rest [m] (n,), rate [m/s] (n,); returns [N].
    """
    given = np.array(coupler.constants())
    force, yields = np.empty(len(way)), np.empty(len(way))
    arrays = [np.ascontiguousarray(one, float) for one in (way, rest, rate)]
    functions().equations_laws(given.ctypes.data, len(way), *(one.ctypes.data for one in (*arrays, force, yields)))
    return force, yields


@dataclass(frozen=True)
class CouplerRun:
    """Results of a run: largest compression [N], distance of the head [m], evaluations, solves; reason of a failure."""

    compression: float
    distance: float
    evaluations: int = 0
    solves: int = 0
    reason: str = ""


class TooManyEvaluationsError(Exception):
    """A run took more than MOST evaluations."""


class BrakedTrain:
    """A consist with equal couplers at SPEED, couplers without force, and the capacity of its brakes over time [N]."""

    def __init__(self, consist: Consist, long: float = LONG) -> None:
        if len(consist.vehicles) > MOST_VEHICLES:
            raise ValueError(f"A train must have at most {MOST_VEHICLES} vehicles; got {len(consist.vehicles)}.")
        self.consist, self.long, self.vehicles = consist, long, len(consist.vehicles)
        self.coupler = consist.vehicles[0].coupler
        self.brake, self.pipe_step = recorded(consist, long)
        self._motion = np.array([list(one.motion().values()) for one in consist.vehicles]).T.copy()
        self._constants = np.array(self.coupler.constants())
        self._couplers = np.repeat(self._constants[:, None], self.vehicles - 1, axis=1).copy()
        self._mass = self._motion[0] + self._motion[1]
        self._resistance = self._motion[5:8].copy()
        masses = [vehicle.mass for vehicle in consist.vehicles]
        #: Longest stable step of the couplers [s].
        self.bound = 2.0 / fastest([self.coupler] * (self.vehicles - 1), masses)

    def equations(self) -> Equations:
        """Return the equations as a C structure, with counters at zero."""
        own = {"mass": self._mass, "resistance": self._resistance, "coupler": self._constants, "brake": self.brake}
        arrays = {name: value.ctypes.data_as(_pointer) for name, value in own.items()}
        return Equations(vehicles=self.vehicles, rows=len(self.brake), interval=RECORDED, **arrays)

    def state(self) -> Matrix:
        """Return place of the head, strokes, speeds, rest positions."""
        n = self.vehicles
        return np.concatenate([np.zeros(n), np.full(n, SPEED), np.zeros(n - 1)])

    def nominal(self) -> Matrix:
        n = self.vehicles
        ways = np.full(n - 1, NOMINAL_WAY)
        return np.concatenate([[NOMINAL_PLACE], ways, np.full(n, NOMINAL_SPEED), ways])

    # ---- our own steps -----------------------------------------------------------------------------------------------

    def explicit(self, share: float) -> CouplerRun:
        """Run the product's motion alone, in steps of a share of the longest stable one."""
        equations, steps = self.equations(), math.ceil(self.long / (share * self.bound))
        moving = np.zeros((4, self.vehicles))
        moving[1:3] = SPEED
        given = (self._motion.ctypes.data, self._couplers.ctypes.data, moving.ctypes.data)
        if functions().equations_explicit(ctypes.byref(equations), *given, steps, self.long / steps):
            raise MemoryError("There is no memory for the motion of a train.")
        return CouplerRun(equations.compression, float(moving[0, 0]), equations.evaluations)

    def implicit(self, size: float, share: float = 1.0, held_for: int = 1) -> CouplerRun:
        """Run linearly implicit steps [s], forces at a share of them, 1 (Euler) or 1/2; brakes are constant for several
        steps.
        """
        equations, state = self.equations(), self.state()
        steps = math.ceil(self.long / size * (1 - 1e-12))
        functions().equations_implicit(
            ctypes.byref(equations), state.ctypes.data, steps, self.long / steps, share, held_for
        )
        return CouplerRun(equations.compression, float(state[0]), equations.evaluations, equations.solves)

    def split(self, count: int) -> CouplerRun:
        """Run Euler's implicit steps, `count` in a step of the pipe, in which brakes are constant."""
        return self.implicit(self.pipe_step / count, 1.0, count)

    def scatter(self, share: float, changes: Sequence[float]) -> float:
        """Return the relative scatter of the largest compression if all brakes change by these shares [1]; explicit
        steps.
        """
        kept, found = self.brake, []
        try:
            for change in (0.0, *changes):
                self.brake = kept * (1.0 + change)
                found.append(self.explicit(share).compression)
        finally:
            self.brake = kept
        return max(found) / min(found) - 1.0

    # ---- methods of others -------------------------------------------------------------------------------------------

    def _times(self) -> Matrix:
        return np.linspace(0.0, self.long, round(self.long / LOOKED) + 1)

    def forces(self, states: Matrix) -> Matrix:
        """Return the forces of all couplers [N], a row for each state."""
        n = self.vehicles
        ways, rests = states[:, 1:n].ravel(), states[:, 2 * n :].ravel()
        return rates(self.coupler, ways, rests, np.zeros(len(ways)))[0].reshape(len(states), n - 1)

    def _seen(self, states: Matrix, evaluations: int, solves: int) -> CouplerRun:
        return CouplerRun(-float(self.forces(states).min()), float(states[-1, 0]), evaluations, solves)

    def lsoda(self, tolerance: float) -> CouplerRun:
        """Run SciPy's LSODA.

        A Jacobian adds an evaluation and a solution; LSODA does not report Newton's iterations.
        """
        equations, call = self.equations(), functions().equations_slopes
        slopes, jacobian = np.empty(3 * self.vehicles - 1), np.empty((3 * self.vehicles - 1,) * 2)
        own, to, rows, counts = ctypes.byref(equations), slopes.ctypes.data, jacobian.ctypes.data, [0]

        def at(time: float, state: Matrix) -> Matrix:
            if equations.evaluations > MOST:
                raise TooManyEvaluationsError
            call(own, time, state.ctypes.data, to, None)
            return slopes

        def jacobian_at(time: float, state: Matrix) -> Matrix:
            counts[0] += 1
            call(own, time, state.ctypes.data, to, rows)
            return jacobian

        setting = {"rtol": LEAST, "atol": tolerance * self.nominal(), "mxstep": MOST, "full_output": True}
        try:
            states, told = odeint(at, self.state(), self._times(), Dfun=jacobian_at, tfirst=True, **setting)
        except TooManyEvaluationsError:
            return failed(equations, f"given up after {MOST} evaluations")
        if told["message"] != "Integration successful.":
            return failed(equations, told["message"])
        return self._seen(states, equations.evaluations, counts[0])

    def cvode(self, tolerance: float) -> CouplerRun:
        """Run CVODE by scikit-SUNDAE; each evaluation is one of Newton's and brings a solution, as a Jacobian does."""
        from sksundae.cvode import CVODE

        equations, call, state = self.equations(), functions().equations_slopes, self.state()
        own, spare, rows = ctypes.byref(equations), np.empty(len(state)), np.empty((len(state),) * 2)

        def at(time: float, place: Matrix, into: Matrix) -> None:
            call(own, time, place.ctypes.data, into.ctypes.data, None)

        def jacobian_at(time: float, place: Matrix, slopes: Matrix, into: Matrix) -> None:
            call(own, time, place.ctypes.data, spare.ctypes.data, rows.ctypes.data)
            into[:] = rows

        setting = {"rtol": NONE, "atol": tolerance * self.nominal(), "max_num_steps": MOST}
        found = CVODE(at, jacfn=jacobian_at, **setting).solve(self._times(), state)
        if not found.success:
            return failed(equations, found.message)
        return self._seen(found.y, equations.evaluations, equations.evaluations)

    def reference(self) -> tuple[CouplerRun, str]:
        """Return a run by a method that is independent of the product's, and its name."""
        if sundials.is_installed():
            return self.cvode(REFERENCE), f"CVODE, tolerance {REFERENCE:g}"
        return self.implicit(FINE, 0.5), f"implicit midpoint, {1e3 * FINE:g} ms"


def failed(equations: Equations, reason: str) -> CouplerRun:
    return CouplerRun(math.nan, math.nan, equations.evaluations, equations.solves, reason)


def recorded(consist: Consist, long: float) -> tuple[Matrix, float]:
    """Return the capacity of the brakes [N] in an emergency of the whole train, every RECORDED s; mean step of its pipe
    [s].
    """
    train = Train(consist, speed=SPEED)
    train.drive("emergency")
    rows = [np.zeros(len(consist.vehicles))]
    for _ in range(math.ceil(long / RECORDED) + 1):
        train.advance(RECORDED)
        rows.append(train.brake_force)
    return np.array(rows), RECORDED * (len(rows) - 1) / train.steps[0]


def braked_train(load: float, wagons: int = WAGONS, long: float = LONG, coupler: Coupler | None = None) -> BrakedTrain:
    """Return a locomotive and wagons.

    Takes load [kg], long [s].
    """
    own = coupler or draft_gear()
    vehicles = [replace(vehicle, coupler=own) for vehicle in block_train(wagons, load=load).vehicles]
    return BrakedTrain(Consist(tuple(vehicles)), long)


# ---- what work costs -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Costs:
    """Wall time of one evaluation of all couplers and vehicles, and of one solution of their equations [s]."""

    evaluation: float
    solve: float

    def of(self, found: CouplerRun) -> float:
        """Return the cost of the counted work [s]."""
        return found.evaluations * self.evaluation + found.solves * self.solve


def _step_cost(consist: Consist) -> float:
    """Return the cost of one step of the couplers [s], from two trains that differ only in the number of steps."""
    spent, steps = [], []
    for share in (0.1, 0.005):
        train = Train(consist, speed=SPEED, settings=Settings(brake_model="delay", share=share))
        spent.append(least(partial(train.advance, 1.0), REPEATED))
        steps.append(train.steps[1] / (REPEATED + 1))
    return (spent[1] - spent[0]) / (steps[1] - steps[0])


def measured_costs(consist: Consist) -> Costs:
    solutions = partial(functions().equations_solutions, len(consist.vehicles), TIMED)
    return Costs(_step_cost(consist), least(solutions, REPEATED) / TIMED)
