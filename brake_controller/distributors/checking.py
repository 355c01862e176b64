"""Check of a distributor on a bench: the pipe charges, brakes, releases, and has an emergency.

It finds equations that a train would simulate without a message: a pace that is too small, flows with a wrong sign,
commands without effect, another pressure than the stated one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from brake_controller.air import AMBIENT, GAS_CONSTANT, HEAT_CAPACITY, HEAT_CAPACITY_RATIO
from brake_controller.distributors.distributor import ANSWERED, COMMANDED, CYLINDER, Distributor, DistributorParameters
from brake_controller.distributors.registered import POSITIONS, check_kind
from brake_controller.distributors.vacuum import VacuumBrake
from fmu_src.symbols import ca

Array = NDArray[np.float64]

#: Gauge pressure of the charged pipe [Pa] (UIC 540), and temperature of its air [K], which is not that of the walls.
CHARGED, PIPE_TEMPERATURE = 500e3, 270.0
#: Gauge pressure of the pipe in full service [Pa].
LOWERED = 340e3
#: Course of the pipe: times [s], gauge pressures [Pa]. Charged, service, full service, release, emergency, release.
COURSE = (
    (0.0, 10.0, 12.4, 30.0, 34.0, 80.0, 84.0, 145.0, 145.5, 190.0, 200.0, 260.0),
    (500e3, 500e3, 440e3, 440e3, 340e3, 340e3, 500e3, 500e3, 0.0, 0.0, 500e3, 500e3),
)
#: Commands `demanded` and `ordered` [1] from these times [s] on.
ORDERS = ((0.0, 10.0, 30.0, 80.0, 145.0, 190.0), (0.0, 0.4, 1.0, 0.0, 1.0, 0.0))
#: Step of the bench [s]. An eigenvalue that lasts no longer, as a relay closes, lets nothing grow.
STEP = 0.05
#: Pressure beside the states at which slopes are taken [Pa]: at rest two branches may meet.
BESIDE = 1.0
#: Times at which the cylinder has been applied for long [s].
APPLIED = (29.9, 79.9, 144.9, 189.9)
#: Share of the full pressure by which it may be missed; share of the fastest change below which the cylinder is held.
MISSED, HELD = 0.05, 0.01
#: Random states of the bench, up to this absolute pressure [Pa].
DRAWN, HIGHEST = 300, 1e6


@dataclass(frozen=True)
class Bench:
    """One form of a kind with its parameters, at a pipe whose pressure is given."""

    kind: Distributor
    form: str
    given: DistributorParameters

    @property
    def whose(self) -> str:
        """Its name in messages."""
        return f"{self.form} of the distributor {self.kind.name}"

    @cached_property
    def function(self) -> ca.Function:
        """Answers as a function of states, absolute pressure of the pipe, and commands (ideal gas at rest)."""
        states, line, command = ca.SX.sym("x", len(self.kind.states)), ca.SX.sym("line"), ca.SX.sym("c", len(COMMANDED))
        air = ca.vertcat(line / (GAS_CONSTANT * PIPE_TEMPERATURE), 0.0, line / (HEAT_CAPACITY_RATIO - 1))
        given = ca.DM(list(self.given.values().values()))
        return ca.Function(
            "bench", [states, line, command], [self.kind.function(self.form)(states, air, given, command)]
        )

    def answer(self, states: Array, line: Array | float, **commands: float) -> dict[str, Array]:
        """Return rates by state, and ANSWERED, for columns of states and pressures of the pipe [Pa, absolute]."""
        count = states.shape[1]
        command = np.repeat([[commands.get(name, 0.0)] for name in COMMANDED], count, axis=1)
        found = np.array(self.function(states, np.broadcast_to(line, count)[None, :], command))
        return dict(zip([*(name for name, _ in self.kind.states), *ANSWERED], found, strict=True))

    def line(self, pressures: Array) -> Array:
        """Return absolute pressures of the pipe [Pa] for gauge pressures of COURSE.

        A vacuum brake has lost its vacuum where another is in full service.
        """
        if not isinstance(self.given, VacuumBrake):
            return pressures + AMBIENT
        return AMBIENT - self.given.vacuum * np.clip((pressures - LOWERED) / (CHARGED - LOWERED), 0.0, 1.0)

    @cached_property
    def course(self) -> tuple[Array, Array, Array, Array]:
        """Times [s], pressure of the pipe, states [Pa, absolute], and slopes of rates by states [1/s] on COURSE.

        Linearly implicit Euler steps (Hairer and Wanner (1996), IV.7): stable with any pace.
        """
        times = np.arange(0.0, COURSE[0][-1], STEP)
        line = self.line(np.interp(times, *COURSE))
        orders = np.array(ORDERS[1])[np.searchsorted(ORDERS[0], times, side="right") - 1]
        command = np.array([orders if name in ("demanded", "ordered") else 0.0 * orders for name in COMMANDED])
        count = len(self.kind.states)
        states, pipe, now = ca.SX.sym("x", count), ca.SX.sym("line"), ca.SX.sym("c", len(COMMANDED))
        rates = self.function(states, pipe, now)[:count]
        slopes = ca.jacobian(rates, states)
        after = states + ca.solve(ca.SX.eye(count) / STEP - slopes, rates)
        step = ca.Function("step", [states, pipe, now], [ca.fmax(after, 1.0)])
        starts = {"charged": line[0], "around": AMBIENT, "cylinder": AMBIENT}
        start = np.array([starts[start] for _, start in self.kind.states])
        ends = np.array(step.mapaccum(len(times))(start, line[None, :], command))
        found = np.column_stack([start, ends[:, :-1]])
        slope = ca.Function("slopes", [states, pipe, now], [ca.densify(slopes)])
        flat = np.array(slope(found + BESIDE, line[None, :], command))
        return times, line, found, flat.reshape(count, len(times), count).transpose(1, 0, 2)

    @property
    def over(self) -> Array:
        """Gauge pressure of the cylinder on COURSE [Pa]."""
        states = self.course[2]
        if self.kind.pressing:
            return np.array(self.kind.pressing_function()(states, list(self.given.values().values())))[0] - AMBIENT
        return np.asarray(states[[name for name, _ in self.kind.states].index(CYLINDER)] - AMBIENT)


def check_distributor(kind: Distributor) -> None:
    """Check a distributor on a bench, in both positions and each form; it need not be registered."""
    check_kind(kind)
    sets = {position: kind.ready(position) for position in POSITIONS}
    for form in dict.fromkeys(kind.brake_models()):
        for position in POSITIONS[: 1 if sets["P"] == sets["G"] else 2]:
            bench = Bench(kind, form, sets[position])
            _check_finite(bench)
            _check_directions(bench)
            _check_pace(bench)
            if sets[position].full_pressure > 0.0:
                _check_pressure(bench)
                _check_protection(bench)


def _check_finite(bench: Bench) -> None:
    rng, count = np.random.default_rng(0), len(bench.kind.states)
    states, line = rng.uniform(1e3, HIGHEST, (count, DRAWN)), rng.uniform(1e3, HIGHEST, DRAWN)
    states[:, :10], line[5:15] = AMBIENT, AMBIENT
    states[:, 10:30] = line[10:30]
    for commands in ({}, {"held": 1.0, "vented": 1.0}, {"demanded": 1.0, "ordered": 1.0}):
        for name, found in bench.answer(states, line, **commands).items():
            if not np.isfinite(found).all():
                at = int(np.argmin(np.isfinite(found)))
                raise ValueError(
                    f"{name} of {bench.whose} must be finite; got {found[at]} at states of {_pressures(states[:, at])} "
                    f"and {line[at]:.6g} Pa in the pipe. Limit roots and quotients there, as choke_flow does."
                )


def _pressures(states: Array) -> str:
    return f"{', '.join(f'{state:.6g}' for state in states)} Pa"


def _check_directions(bench: Bench) -> None:
    """Air flows from the higher to the lower pressure (second law): first empty volumes, then an empty pipe."""
    count, full = len(bench.kind.states), CHARGED + AMBIENT
    empty = np.where(np.eye(count, count + 1, dtype=bool), AMBIENT, full)  # one of them, and all
    empty[:, -1] = AMBIENT
    names = [name for name, _ in bench.kind.states]
    out, back = bench.answer(empty, full), bench.answer(np.full((count, 1), full), AMBIENT)
    if out["taken"].min() < 0.0 or back["taken"].max() > 0.0:
        flow, where = (
            (out["taken"].min(), f"into volumes at ambient pressure, from {full:.6g} Pa in the pipe")
            if out["taken"].min() < 0.0
            else (back["taken"].max(), f"from volumes at {full:.6g} Pa, into a pipe at ambient pressure")
        )
        raise ValueError(
            f"taken of {bench.whose} must be positive out of the pipe and negative into it; got {flow:.3g} kg/s "
            f"{where}. Change its sign."
        )
    expected = HEAT_CAPACITY * PIPE_TEMPERATURE * out["taken"]
    if not np.allclose(out["enthalpy"], expected, rtol=1e-6, atol=1e-9):
        at = int(np.argmax(np.abs(out["enthalpy"] - expected)))
        raise ValueError(
            f"enthalpy of {bench.whose} must be HEAT_CAPACITY times taken times the temperature of the pipe for air "
            f"out of it, here {expected[at]:.6g} W; got {out['enthalpy'][at]:.6g} W. Correct it."
        )
    if not np.allclose(np.sign(back["enthalpy"]), np.sign(back["taken"])):
        raise ValueError(
            f"enthalpy of {bench.whose} must have the sign of taken, {back['taken'][0]:.3g} kg/s; got "
            f"{back['enthalpy'][0]:.6g} W. Correct it."
        )
    for line in (AMBIENT, full):
        rates = bench.answer(np.full((count, 1), AMBIENT), line, vented=1.0)
        for name in names:
            if rates[name][0] < 0.0:
                raise ValueError(
                    f"{name} of {bench.whose} must not fall below the surroundings; got a rate of {rates[name][0]:.3g} "
                    f"Pa/s at ambient pressure, with {line:.6g} Pa in the pipe. Change its sign."
                )


def _check_pace(bench: Bench) -> None:
    times, _, states, slopes = bench.course
    if not np.isfinite(slopes).all():
        at = int(np.argmin(np.isfinite(slopes).all(axis=(1, 2))))
        raise ValueError(
            f"Rates of {bench.whose} must have finite slopes; they are steep without limit at states of "
            f"{_pressures(states[:, at])}. Replace roots near equal pressures, as choke_flow does."
        )
    largest = np.abs(np.linalg.eigvals(slopes)).max(axis=1)
    largest = np.minimum(largest[1:], largest[:-1])
    at, pace = int(np.argmax(largest)), bench.kind.fastest(bench.given, bench.form)
    if largest[at] > pace:
        what = "pace" if bench.form == "whole" else "empirical_pace"
        raise ValueError(
            f"{what} of the distributor {bench.kind.name} must be at least {largest[at]:.4g} 1/s, an eigenvalue of "
            f"{bench.form} at {times[at]:.1f} s of the bench; got {pace:.4g} 1/s. Increase it: steps would be unstable."
        )


def _check_pressure(bench: Bench) -> None:
    benches = [bench]
    if "full_pressure" in bench.kind.adjustable:
        benches.append(replace(bench, given=replace(bench.given, full_pressure=0.8 * bench.given.full_pressure)))
    for one in benches:
        full, reached = one.given.full_pressure, np.interp(APPLIED, one.course[0], one.over)
        if np.abs(reached - full).min() > MISSED * full:
            remedy = "Correct it" if one is bench else "Use it in the equations, or take it out of adjustable"
            raise ValueError(
                f"The cylinder of {one.whose} must come to full_pressure, {full:.6g} Pa, from which forces follow; on "
                f"the bench it comes to {', '.join(f'{one:.6g}' for one in reached)} Pa. {remedy}."
            )


def _check_protection(bench: Bench) -> None:
    _, line, states, _ = bench.course
    braked = bench.over > 0.2 * bench.given.full_pressure
    orders: tuple[Mapping[str, float], ...] = ({}, {"demanded": 1.0, "ordered": 1.0})
    fastest = max(np.abs(bench.answer(states, line, **order)[CYLINDER]).max() for order in orders)
    for order in orders:
        held = bench.answer(states[:, braked], line[braked], held=1.0, **order)[CYLINDER]
        vented = bench.answer(states[:, braked], line[braked], held=1.0, vented=1.0, **order)[CYLINDER]
        if np.abs(held).max() > HELD * fastest:
            raise ValueError(
                f"held must hold the cylinder of {bench.whose}; its rate is {held[np.argmax(np.abs(held))]:.4g} Pa/s. "
                "Multiply its flows by 1 - held, other than vented."
            )
        if vented.max() > -HELD * fastest:
            raise ValueError(
                f"vented must empty the cylinder of {bench.whose}; its rate is {vented.max():.4g} Pa/s. Add a flow "
                "from it to the surroundings, times vented."
            )
