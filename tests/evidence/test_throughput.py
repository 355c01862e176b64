"""Error against throughput: the best method at an error, and the figure's messages and rows."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from evidence.comparisons import throughput
from evidence.measuring import throughput as rates
from evidence.measuring.runs import SceneRun
from evidence.peers import ensembles
from evidence.peers.ensembles import ALONE, BATCH, IN_THREADS, EnsembleStudy, Rate
from fmu_src.batch import Instances, library_of_batch
from rbd_model.levels.models import DEFAULT_TOLERANCE


def found() -> EnsembleStudy:
    """Return a batch with 40 times the stops of CVODE at a good error in the planar model, and 20 times in 3D."""
    rates = []
    for level, stops in (("planar", 400.0), ("spatial", 200.0)):
        rates += [
            Rate(level, BATCH, DEFAULT_TOLERANCE, 1e-7, stops),
            Rate(level, BATCH, 1e-3, 5e-5, 2 * stops),  # also good, but not the one in the title
            Rate(level, ALONE, DEFAULT_TOLERANCE, 1e-7, stops / 8),
            Rate(level, IN_THREADS, 1e-3, 2e-4, 50.0),
            Rate(level, IN_THREADS, 1e-5, 1e-5, 10.0),
            Rate(level, "Radau (SciPy), processes", 1e-5, None, 30.0, "given up"),
        ]
    return EnsembleStudy(rates, dict.fromkeys(ensembles.LEVELS, 1e-10), {"planar": 0.0, "spatial": 1e-9})


def test_the_best_of_others_is_the_fastest_whose_error_is_good() -> None:
    best = found().fastest("planar", ensembles.PEERS, 1e-4)
    assert best is not None
    assert (best.way, best.setting, best.stops) == (IN_THREADS, 1e-5, 10.0)
    assert found().fastest("planar", ensembles.PEERS, 1e-6) is None
    assert [one.setting for one in found().of("planar", BATCH)] == [1e-3, DEFAULT_TOLERANCE]


def test_the_title_is_what_was_measured() -> None:
    assert throughput.message(found()) == "A default batch makes 40 (planar) and 20 (spatial) times others' stops"
    without = EnsembleStudy([one for one in found().rates if one.way not in ensembles.PEERS], {}, {})
    assert throughput.message(without) == "A default batch makes 8 (planar) and 8 (spatial) times one instance's stops"


def test_errors_and_bits_are_judged_and_the_clock_is_not() -> None:
    rows = {row.quantity: row for level in ensembles.LEVELS for row in throughput.level_rows(found(), level)}
    judged = {name: row.holds for name, row in rows.items() if row.holds is not None}
    assert judged == {
        "planar: error of a batch at the default": True,
        "planar: largest difference of a batch and single runs": True,
        "spatial: error of a batch at the default": True,
        "spatial: largest difference of a batch and single runs": False,
    }
    assert rows["spatial: batch at the default over the best of others to 0.0001"].simulated == 20.0


def test_all_stops_of_a_pool_count_and_one_that_fails_is_told() -> None:
    exact = np.full(4, 200.0)
    asked: list[float] = []

    def work(torque: float) -> SceneRun:
        asked.append(torque)
        return SceneRun({"frame_distance": np.array([0.0, 200.2])}, 1.0)

    with ThreadPoolExecutor(1) as pool:
        good = ensembles.rate_of("planar", IN_THREADS, 1e-5, exact, pool, work, 5)
        bad = ensembles.rate_of("planar", IN_THREADS, 1e-5, exact, pool, lambda _: SceneRun({}, 1.0, failure="no"), 1)
    assert asked == 2 * np.linspace(*ensembles.TORQUES, 4).tolist()
    assert good.error == pytest.approx(1e-3)
    assert (bad.error, bad.reason) == (None, "no")


def test_failures_are_on_the_picture_and_in_no_line() -> None:
    figure = throughput.draw(found())
    lines = [line for line in figure.axes[0].lines if line.get_marker() == "D"]
    assert [list(line.get_ydata()) for line in lines] == [[], [throughput.FAILED]]
    throughput.plt.close(figure)


#: Seconds in which any wheelset is pushed forwards, by method and fixed step: docs/real_time.md.
PUSHED = [({}, 0.0, 0.0), ((2, 5e-4), 0.0, 0.0), ((1, 1e-3), 0.5, 4.0)]


@pytest.mark.study
@pytest.mark.parametrize(("chosen", "least", "most"), PUSHED, ids=["default", "method 2", "method 1"])
def test_the_rail_pushes_no_braked_wheelset_forwards(chosen: tuple[int, float], least: float, most: float) -> None:
    """The sign of the force decides, regardless of the tolerance; method 1 behaves as its page states."""
    model = rates.braked_bogie()
    inputs = [f"{name}_{number}" for name in ("pressure_demand", "valve") for number in (1, 2)]
    read = [
        "speed",
        *(f"{name}_{number}" for name in ("wheel_speed", "creep_force", "brake_torque") for number in (1, 2)),
    ]
    given = dict.fromkeys(inputs[:2], rates.FULL_PRESSURE) | {name: np.full(2, rates.APPLY) for name in inputs[2:]}
    start = {"initial_speed": [20.0, 26.0], "friction_1": 0.08, "friction_2": 0.08}
    start |= dict(zip(("integration_method", "integration_step"), chosen, strict=False))
    pushed, braked = np.zeros(2), np.zeros(2)
    with Instances(library_of_batch(model, model.systems[0].name), 2, inputs, read, **start) as instances:
        for _ in range(round(45.0 / rates.CONTROL_STEP)):
            found = instances.step(rates.CONTROL_STEP, given)
            for number in (1, 2):
                given[f"valve_{number}"] = rates.valves_of(found, number, given[f"valve_{number}"])
                brakes = (found[f"brake_torque_{number}"] > 1e3) & (found["speed"] > 0.05)
                braked += brakes
                pushed += brakes & (found[f"creep_force_{number}"] > 0.0)
    assert (rates.CONTROL_STEP * braked > 30.0).all()
    assert ((least <= rates.CONTROL_STEP * pushed) & (rates.CONTROL_STEP * pushed <= most)).all()
