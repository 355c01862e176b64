"""The master: order of its methods, adaptive steps by the coupling error, rollback, energy of the coupling."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise

import numpy as np
import pytest

from bogie_braking.__main__ import main
from fmu_src.cosimulation.master import GAUSS_SEIDEL, JACOBI, Connection, Coupling, Master, cosimulate
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance

#: A full application by the measured law, whose shoe friction falls with the force, and then a stop.
SECONDS = 1.2


@contextmanager
def train(fmus: dict, kind: str = "native") -> Iterator[tuple[FmuInstance, FmuInstance, list]]:
    """Yield brake and bogie, started: half of the QR30's cylinder force on the chapter 5 bogie's trailing wheelset."""
    with FmuInstance(fmus["brake", kind]) as brake, FmuInstance(fmus["bogie", kind], initial_speed=10.0) as bogie:
        brake.start(pressure_demand=150e3)
        bogie.start()
        connections = [
            Connection(brake, "brake_torque", bogie, "brake_torque_2"),
            Connection(bogie, "angular_velocity_2", brake, "angular_velocity"),
        ]
        yield brake, bogie, connections


def distance(fmus: dict, master: Master, step: float) -> tuple[float, Coupling]:
    with train(fmus) as (brake, bogie, connections):
        bond = (connections[0], (bogie, "angular_velocity_2"))
        coupling = Coupling([brake, bogie], connections, master, [bond])
        cosimulate([brake, bogie], connections, SECONDS, step, [(bogie, "speed")], coupling=coupling)
        return bogie["distance"], coupling


@pytest.mark.study
@pytest.mark.parametrize(
    ("master", "order"),
    [
        (Master(JACOBI), 1.0),
        (Master(GAUSS_SEIDEL), 1.0),
        (Master(JACOBI, extrapolated=True), 2.0),
        (Master(GAUSS_SEIDEL, extrapolated=True), 2.0),
    ],
)
def test_error_of_the_coupling_falls_with_its_order(fmus: dict, master: Master, order: float) -> None:
    """Distance against very small steps: a zero-order hold is of first order, linear extrapolation of second."""
    exact, _ = distance(fmus, Master(GAUSS_SEIDEL, extrapolated=True), 2e-4)
    sizes = np.array([0.1, 0.05, 0.025, 0.0125])
    errors = np.abs([distance(fmus, master, size)[0] - exact for size in sizes])
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.35)


def test_jacobi_does_not_depend_on_the_order_of_the_slaves(fmus: dict) -> None:
    """Every extrapolation starts with the rate at the start of the step, also for a slave that has already stepped."""
    found = []
    for turned in (False, True):
        with train(fmus) as (brake, bogie, connections):
            slaves = [bogie, brake] if turned else [brake, bogie]
            coupling = Coupling(slaves, connections, Master(JACOBI, extrapolated=True))
            assert len(list(coupling.run(SECONDS, 0.05))) == 24
            found.append(bogie.get(["distance", "speed", "rotation_2"]))
    assert found[0] == found[1]


@pytest.mark.study
def test_steps_are_chosen_by_the_coupling_error(fmus: dict) -> None:
    """A tighter tolerance gives more steps and a smaller error; steps that were too long are repeated."""
    exact, _ = distance(fmus, Master(GAUSS_SEIDEL, extrapolated=True), 2e-4)
    found = [distance(fmus, Master(JACOBI, True, tolerance), 0.1) for tolerance in (1e-2, 1e-3, 1e-4)]
    errors = [abs(value - exact) for value, _ in found]
    steps = [coupling.account.steps for _, coupling in found]
    assert errors[2] < errors[1] < errors[0]
    assert steps[0] < steps[1] < steps[2]
    assert found[2][1].account.repeated > 0
    assert found[2][1].account.smallest < 0.1


def test_rollback_leaves_no_trace(fmus: dict) -> None:
    """The accepted steps of an adaptive run, repeated one by one, give bit-identical results."""
    with train(fmus) as (brake, bogie, connections):
        coupling = Coupling([brake, bogie], connections, Master(JACOBI, True, 1e-4))
        times = [0.0, *coupling.run(SECONDS, 0.1)]
        adaptive = bogie.get(["distance", "speed", "rotation_2"])
        assert coupling.account.repeated > 0
    with train(fmus) as (brake, bogie, connections):
        coupling = Coupling([brake, bogie], connections, Master(JACOBI, True))
        for begin, end in pairwise(times):
            coupling.step(begin, end - begin)
        again = bogie.get(["distance", "speed", "rotation_2"])
    assert adaptive == pytest.approx(again, rel=1e-12)


def test_stale_torque_brings_energy_into_the_coupling_and_smaller_steps_less(fmus: dict) -> None:
    moved = [distance(fmus, Master(JACOBI), size)[1].account.energy_moved for size in (0.04, 0.02, 0.01)]
    assert moved[0] > 100.0
    assert moved[0] / moved[1] == pytest.approx(2.0, rel=0.2)
    assert moved[1] / moved[2] == pytest.approx(2.0, rel=0.2)


def test_no_step_crosses_a_given_instant(fmus: dict) -> None:
    with train(fmus) as (brake, bogie, connections):
        coupling = Coupling([brake, bogie], connections, Master(extrapolated=True, coupling_tolerance=1e-2))
        times = list(coupling.run(SECONDS, 0.05, instants=[0.3333]))
    assert 0.3333 in times
    assert times[-1] == SECONDS


def test_line_that_leads_below_zero_shortens_the_step(fmus: dict, monkeypatch: pytest.MonkeyPatch) -> None:
    """The brake is released. Its torque falls and would be negative at the end of a long extrapolation."""
    monkeypatch.setattr("fmu_src.cosimulation.master.LARGEST_TOLERANCE", 10.0)  # the error alone shortens no step
    with train(fmus) as (brake, bogie, connections):
        coupling = Coupling([bogie, brake], connections, Master(JACOBI, True, 10.0))

        def drive(time: float) -> None:
            brake.set(pressure_demand=150e3 if time < 2.0 else 0.0)

        for _ in coupling.run(8.0, 0.5, drive, [2.0]):
            assert brake["brake_torque"] >= 0.0
        assert coupling.account.repeated > 0
        assert brake["brake_torque"] < 50.0


@pytest.mark.study
def test_fmu_that_cannot_save_its_state_is_refused_with_a_sentence(fmus: dict) -> None:
    with train(fmus, "python") as (brake, bogie, connections):
        coupling = Coupling([brake, bogie], connections, Master(coupling_tolerance=1e-3))
        with pytest.raises(CosimulationError, match="BrakeCylinder cannot save its state"):
            list(coupling.run(0.1, 0.01))


def test_tolerance_that_cannot_be_met_is_told(fmus: dict) -> None:
    with train(fmus) as (brake, bogie, connections):
        coupling = Coupling([brake, bogie], connections, Master(JACOBI, coupling_tolerance=1e-15))
        with pytest.raises(CosimulationError, match="stays above the tolerance"):
            list(coupling.run(1.0, 0.01))


def test_columns_of_two_slaves_with_outputs_of_one_name_are_told_apart(fmus: dict) -> None:
    """Time is the first column and increases; each cylinder's pressure has the name of its instance."""
    path = fmus["brake", "native"]
    with FmuInstance(path, "front") as front, FmuInstance(path, "rear") as rear:
        front.start(pressure_demand=100e3)
        rear.start(pressure_demand=200e3)
        record = [(rear, "cylinder_pressure"), (front, "brake_torque"), (front, "cylinder_pressure")]
        series = cosimulate([front, rear], [], 5.0, 0.1, record)
    assert series.names == ["time", "brake_torque", "front.cylinder_pressure", "rear.cylinder_pressure"]
    assert np.all(np.diff(series["time"]) > 0.0)
    assert series["front.cylinder_pressure"][-1] == pytest.approx(100e3, rel=1e-3)
    assert series["rear.cylinder_pressure"][-1] == pytest.approx(200e3, rel=1e-3)


def test_two_slaves_of_one_name_cannot_share_a_column(fmus: dict) -> None:
    path = fmus["brake", "native"]
    with FmuInstance(path) as one, FmuInstance(path) as other:
        one.start()
        other.start()
        record = [(one, "brake_torque"), (other, "brake_torque")]
        with pytest.raises(CosimulationError, match=r"two are BrakeCylinder\.brake_torque\. Name"):
            cosimulate([one, other], [], 1.0, 0.1, record)


def test_connection_multiplies_with_its_factor(fmus: dict) -> None:
    """Twice the torque doubles the deceleration of the rolling bogie."""
    slowed = []
    for factor in (1.0, 2.0):
        with train(fmus) as (brake, bogie, _):
            connection = Connection(brake, "brake_torque", bogie, "brake_torque_2", factor)
            for _ in Coupling([brake, bogie], [connection]).run(SECONDS, 0.01):
                pass
            slowed.append(10.0 - bogie["speed"])
    assert slowed[1] == pytest.approx(2.0 * slowed[0], rel=1e-2)


@pytest.mark.parametrize(("method", "tolerance"), [("leapfrog", None), (JACOBI, -1.0), (JACOBI, float("nan"))])
def test_bad_master_gets_a_sentence(method: str, tolerance: float | None) -> None:
    with pytest.raises(CosimulationError, match=r"method must be jacobi or|coupling_tolerance must be above 0"):
        Master(method, coupling_tolerance=tolerance)


@pytest.mark.study
def test_scenario_chooses_its_macro_steps_by_tolerance(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def]
    assert main(["run", "qr30-180kpa", "--coupling-tolerance", "1e-4", "--out", str(tmp_path)]) == 0
    coupling = json.loads((tmp_path / "qr30-180kpa" / "summary.json").read_text())["coupling"]
    assert coupling["macro_steps"] < 1000
    assert main(["run", "qr30-180kpa", "--coupling-tolerance", "0", "--out", str(tmp_path)]) == 2
    assert "--coupling-tolerance must be from 1e-09 to 0.01" in capsys.readouterr().err
