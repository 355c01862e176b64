"""All runs of the study of the macro step, with FMUs that are opened once."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass

from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.scenario import Options
from fmu_src.cosimulation.master import GAUSS_SEIDEL, JACOBI
from fmu_src.cosimulation.slave import FmuInstance
from scenarios.bench.open_fmus import open_bogie, open_brake
from scenarios.coupling import error as coupling_error
from scenarios.coupling import signed_torque
from scenarios.coupling.error import MASTERS, CoupledStop
from scenarios.coupling.feedback_boundary import ClosedLoop, Plant, boundary_on_paper, linear_bogie
from scenarios.coupling.signed_torque import Chatter

#: Macro step below which the error of second order is smaller than the solvers' own [s].
FIRST_OF_LINES = 2e-4


@dataclass(frozen=True)
class Findings:
    """By name and macro step [s]: errors of the stop, chatter of the signed torque, theoretical and measured
    boundaries.
    """

    stop: CoupledStop
    errors: dict[str, dict[float, CoupledStop]]
    capacity: Chatter
    stops: dict[float, Chatter]
    skids: dict[float, Chatter]
    width: float
    plant: Plant
    paper: dict[str, dict[float, float]]
    found: dict[str, dict[float, float]]
    guids: dict[str, str]


def find(steps: Sequence[float], shown: float) -> Findings:
    """Return all results at these macro steps; those that need only one, at `shown`."""
    options, plant, stop = Options(), linear_bogie(), coupling_error.reference()
    with open_brake(options) as brake, open_bogie(options) as bogie:
        brake.start()
        bogie.start()
        # The long steps first: the progress bar starts fast and slows down instead of seeming to stop.
        bar = counting(sorted(steps, reverse=True), "coupling-step", unit="macro step")
        errors: dict[str, dict[float, CoupledStop]] = {name: {} for name in MASTERS}
        found: dict[str, dict[float, float]] = {JACOBI: {}, GAUSS_SEIDEL: {}}
        stops, skids = {}, {}
        for step in bar:
            for name, error in errors_at(brake, bogie, stop, step).items():
                errors[name][step] = error
            stops[step] = signed_torque.signed_stop(bogie, step)
            skids[step] = signed_torque.signed_skid(bogie, step)
            with closing(ClosedLoop(brake, bogie, plant)) as loop:
                for method in found:
                    found[method][step] = loop.boundary(method, step)
        return Findings(
            *(stop, errors, signed_torque.capacity_stop(bogie, shown), stops, skids),
            width=signed_torque.width_that_stands(bogie, shown),
            plant=plant,
            paper={method: {step: boundary_on_paper(plant, method, step) for step in steps} for method in found},
            found=found,
            guids={slave.name: slave.guid for slave in (brake, bogie)},
        )


def errors_at(brake: FmuInstance, bogie: FmuInstance, exact: CoupledStop, step: float) -> dict[str, CoupledStop]:
    """Return the errors of the stop by master."""
    return {
        name: coupling_error.coupled_stop(brake, bogie, master, step).minus(exact)
        for name, master in MASTERS.items()
        if step >= FIRST_OF_LINES or not master.extrapolated
    }
