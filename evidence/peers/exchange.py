"""Model exchange: FMPy's CVODE on the native FMU, at the level whose states it exchanges."""

import tempfile
import time as clock
from collections.abc import Mapping

from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Model
from fmpy.simulation import instantiate_fmu

from evidence.measuring.runs import SceneRun
from evidence.measuring.scenes import LOCK_UP, SMOOTH, Scene
from evidence.peers.scipy_methods import BUDGET
from products.building import up_to_date
from products.kernel_runs import History, value_at

#: Name of this method; planar cases; the level that the FMU's start values choose.
EXCHANGE, IN_THE_PLANE, LEVEL = "model exchange, FMPy's CVODE", (SMOOTH, LOCK_UP), 2


def drive(fmu: FMU2Model, histories: Mapping[int, History]) -> dict[str, int]:
    """Set the inputs of an instance for its present time, as FMPy's own are a step late, and count its work."""
    work = {"right_hand_sides": 0}
    set_time, get_derivatives = fmu.setTime, fmu.getDerivatives

    def set_time_and_inputs(time: float) -> None:
        set_time(time)
        fmu.setReal(list(histories), [value_at(history, time, after=True) for history in histories.values()])

    def count_derivatives(*arguments: object) -> None:
        work["right_hand_sides"] += 1
        get_derivatives(*arguments)

    fmu.setTime, fmu.getDerivatives = set_time_and_inputs, count_derivatives
    return work


def exchange(scene: Scene, tolerance: float) -> SceneRun:
    """Run a case through FMPy's CVODE with this relative tolerance, in nominal values absolute."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:  # Windows removes no loaded library
        return _exchanged(scene, tolerance, folder)


def _exchanged(scene: Scene, tolerance: float, folder: str) -> SceneRun:
    """Run the case; folder: into which the FMU is unpacked."""
    path = up_to_date(scene.fmu, "native")
    about, _ = read_model_description(str(path)), extract(str(path), folder)
    fmu = instantiate_fmu(folder, about, "ModelExchange")
    references = {v.name: v.valueReference for v in about.modelVariables}
    work = drive(fmu, {references[name]: history for name, history in scene.inputs.items()})
    begin, failure = clock.perf_counter(), ""
    try:
        table = simulate_fmu(
            folder,
            model_description=about,
            fmi_type="ModelExchange",
            fmu_instance=fmu,
            stop_time=scene.duration,
            output_interval=scene.interval,
            start_values={name: history[0][1] for name, history in scene.inputs.items()} | dict(scene.values),
            output=[f"state_{name}" for name in scene.read],
            relative_tolerance=tolerance,
            record_events=False,
            timeout=BUDGET,
        )
        failure = "" if len(table) == scene.times().size else f"given up at t = {table['time'][-1]:.3g} s"
    except RuntimeError as error:
        failure = str(error)
    seconds = clock.perf_counter() - begin
    fmu.freeInstance()
    samples = {} if failure else {"time": table["time"]} | {name: table[f"state_{name}"] for name in scene.read}
    return SceneRun(samples, seconds, work, failure)
