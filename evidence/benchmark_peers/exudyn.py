"""Exudyn (J. Gerstmayr and others, PyPI `exudyn`): flexible multibody dynamics, here two masses and a connector.

Two bodies move along one line. Between them acts a user function of the connector `CoordinateSpringDamper`, whose force
rises along the curve of loading; Exudyn has no draft gear of its own.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from typing import Any

NAME = "Exudyn"
PACKAGE = "exudyn"
#: Time step [s], and end of the run [s], by which the vehicles have parted.
STEP, LONGEST = 1e-4, 2.0
#: Deflections [m] and forces [N].
Curve = tuple[Sequence[float], Sequence[float]]


def version() -> str:
    """Return the version of Exudyn. Raises ImportError if it is not installed."""
    try:
        return version_of(PACKAGE)
    except PackageNotFoundError:
        raise ImportError(f"install it by pip install {PACKAGE}") from None


def answer(question: str, inputs: Mapping[str, Any]) -> dict[str, float] | None:
    """Return force [N], deflection [m] and speeds [m/s] of an impact; None to other questions."""
    if question != "impact-of-two-vehicles":
        return None
    loading, unloading = (curve_of(name, inputs) for name in ("loading", "unloading"))
    coupling = CouplingForce(loading, unloading, inputs["sticking_stiffness"])
    return impact(inputs["mass_1"], inputs["mass_2"], inputs["speed"], coupling)


@dataclass
class CouplingForce:
    """A coupling: curves of loading and unloading [m], [N], sticking stiffness [N/m], and deflection [m] and force [N]
    at the last step.
    """

    loading: Curve
    unloading: Curve
    stiffness: float
    deflection: float = 0.0
    last: float = 0.0

    def force(self, deflection: float) -> float:
        """Return the compressive force at a deflection [N]."""
        tried = self.last + self.stiffness * (deflection - self.deflection)
        return min(max(tried, at(self.unloading, deflection)), at(self.loading, deflection))

    def step(self, deflection: float) -> None:
        """Begin a step at a deflection [m]."""
        self.last, self.deflection = self.force(deflection), deflection


def curve_of(name: str, inputs: Mapping[str, Any]) -> Curve:
    """Return a curve of a case, deflections [m] and forces [N]."""
    return inputs[f"{name}.deflection"], inputs[f"{name}.force"]


def at(curve: Curve, deflection: float) -> float:
    """Return the force of a curve at a deflection [N]; beyond its last point it goes on straight."""
    deflections, forces = curve
    if deflection <= 0.0:
        return 0.0
    last = min(bisect_left(deflections, deflection), len(deflections) - 1)
    share = (deflection - deflections[last - 1]) / (deflections[last] - deflections[last - 1])
    return float(forces[last - 1] + share * (forces[last] - forces[last - 1]))


def impact(mass_1: float, mass_2: float, speed: float, coupling: CouplingForce) -> dict[str, float]:
    """Return largest force [N] and deflection [m], and speeds afterwards [m/s]; vehicle 2 runs into vehicle 1."""
    import exudyn
    from exudyn.utilities import CoordinateSpringDamper, MarkerNodeCoordinate, Mass1D, Node1D

    system = exudyn.SystemContainer().AddSystem()
    nodes = [system.AddNode(Node1D(referenceCoordinates=[0.0], initialVelocities=[begin])) for begin in (0.0, speed)]
    for node, mass in zip(nodes, (mass_1, mass_2), strict=True):
        system.AddObject(Mass1D(mass=mass, nodeNumber=node))
    markers = [system.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=0)) for node in nodes]
    largest = [0.0, 0.0]

    def place(node: int) -> float:
        return float(system.GetNodeOutput(node, exudyn.OutputVariableType.Coordinates))

    def begin_step(system: Any, time: float) -> bool:
        shut = place(nodes[1]) - place(nodes[0])
        coupling.step(shut)
        largest[:] = max(largest[0], coupling.last), max(largest[1], shut)
        return True

    def pushes(system: Any, time: float, number: int, shut: float, *others: float) -> float:
        return coupling.force(shut)

    connector = CoordinateSpringDamper(markerNumbers=markers, springForceUserFunction=pushes)
    system.AddObject(connector)
    system.SetPreStepUserFunction(begin_step)
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = round(LONGEST / STEP), LONGEST
    settings.solution.file.write = False
    system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.RK44)
    if coupling.last != 0.0:
        raise ValueError(f"the vehicles have not parted after {LONGEST:g} s")
    one, other = (float(system.GetNodeOutput(n, exudyn.OutputVariableType.Coordinates_t)) for n in nodes)
    return {"force": largest[0], "deflection": largest[1], "speed_1": one, "speed_2": other}
