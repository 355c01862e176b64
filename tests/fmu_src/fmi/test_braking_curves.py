"""BrakingCurves.fmu against the curves of products/supervision in NumPy, at random trains, gradients and targets."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

import build_fmu
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.braking_curves.fmu import curves_fmu
from products.braking_curves.train_data import fmu_parameters
from products.building import write_in_c
from products.etcs_files.train_file import write_train
from products.supervision import FixedValues, Gradients, NationalValues, Steps, SupervisedTrain, supervise
from readers.text import BadInputError
from tests.products.supervision.random_trains import one_of, trains

#: The C code makes the same sums in another order, and solves for the speeds in closed form.
EQUAL = 1e-9
TRAINS = 20
#: Speed of the line [m/s]: above 215 km/h no train has a brake percentage.
FASTEST = 50.0
KMH = 1.0 / 3.6
HILLS = Gradients(np.array([0.0, 900.0, 1700.0, 2300.0, 3100.0]), np.array([2.0, -8.0, 5.0, -3.0, 6.0]))
PLAIN = SupervisedTrain(200.0, Steps.constant(1.0), Steps.constant(0.8), 3.0, 2.0, service_command=True)
PLACES = ("I", "P", "W", "SBI", "EBI", "EBD")
#: Margins of limits at a target that moves and at the line's speed, SUBSET-026, A.3.1, below 110 km/h [m/s].
MARGINS = {"P": 0.0, "W": 4.0 * KMH, "SBI": 5.5 * KMH, "EBI": 7.5 * KMH}


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    folder = tmp_path_factory.mktemp("curves")

    def built(version: int = 2, gradients: Gradients | None = None) -> Path:
        path = folder / f"{version}{'-line' if gradients else ''}.fmu"
        if not path.exists():
            write_in_c(curves_fmu(gradients), path, version)
        return path

    return built


@pytest.mark.study
@pytest.mark.parametrize("version", [2, 3])
def test_it_is_valid(fmu: Callable[..., Path], version: int) -> None:
    assert validate_fmu(str(fmu(version))) == []


def drawn(rng: np.random.Generator, n: int) -> tuple[SupervisedTrain, NationalValues, FixedValues]:
    """Return a random train with factors, or one of a brake percentage, with values of a country."""
    wet = Steps(np.sort(rng.uniform(5.0, 60.0, 2)), rng.uniform(0.6, 1.0, 3))
    if n % 3:
        own = {"Kdry_rst": Steps([rng.uniform(5.0, 60.0)], rng.uniform(0.5, 1.0, 2)), "Kwet_rst": wet}
        own |= {"traction_command": n % 2 == 0, "service_command": n % 4 < 2, "rotating": (None, 8.0)[n % 5 == 0]}
        train = one_of(trains(rng, 1), 0, **own)
    else:
        train = SupervisedTrain.of_percentage(
            rng.uniform(40.0, 200.0), ("passenger P", "freight G")[n % 2], rng.uniform(50.0, 800.0)
        )
    national = NationalValues(
        exact_speed=n % 2 == 1, M_NVAVADH=rng.uniform(), Kv_int=Steps([25.0], rng.uniform(0.6, 0.9, 2))
    )
    return train, national, FixedValues(T_indication_more=4.0 * (n % 2))


def situation(rng: np.random.Generator, on_line: bool) -> dict[str, Any]:
    """Return random inputs of the FMU."""
    kind = int(rng.integers(1, 4))
    found = {
        "V_MRSP": FASTEST,
        "V_est": rng.uniform(0.0, FASTEST),
        "A_est": rng.uniform(-0.5, 0.8),
        "target_kind": kind,
    }
    found |= {"distance_to_target": rng.uniform(-50.0, 3000.0), "reduced_adhesion": int(rng.integers(0, 2))}
    found |= {"beyond": rng.uniform(0.0, 200.0)} if kind == 1 else {"V_target": rng.uniform(0.0, 28.0)}
    slope = rng.choice((0.02, 0.15)) * rng.uniform(-1.0, 1.0)
    return found | ({"distance": rng.uniform(0.0, 3000.0)} if on_line else {"gradient": slope})


@pytest.mark.study
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("line", [None, HILLS], ids=["gradient", "line"])
def test_limits_are_those_of_the_curves_in_numpy(
    fmu: Callable[..., Path], version: int, line: Gradients | None
) -> None:
    """Distances at the speed of the train, and the speed of each limit at its place: 12 of each at each train."""
    rng, compared = np.random.default_rng(5 + version), 0
    with FmuInstance(fmu(version, line)) as curves:
        for n in range(TRAINS):
            train, national, fixed = drawn(rng, n)
            inputs: dict[str, Any] = {"V_target": 0.0, "beyond": 0.0} | situation(rng, line is not None)
            curves.restart(fmu_parameters(train, national, fixed, version=version), **inputs)
            place = inputs.get("distance", 0.0) + inputs["distance_to_target"]
            given = {
                "kind": ("EOA", "LOA", "MRSP")[inputs["target_kind"] - 1],
                "target_speed": inputs["V_target"],
                "gradients": line or Gradients(np.zeros(1), np.array([inputs.get("gradient", 0.0)]), "1"),
                "national": national,
                "fixed": fixed,
                "slippery": inputs["reduced_adhesion"] == 1,
            } | {name: inputs[name] for name in ("beyond", "A_est")}
            found = supervise(train, place, inputs["V_est"], **given)
            distances = [min(place - getattr(found, name)[0], 1e9) for name in PLACES]
            assert curves.get([f"distance_{name}" for name in PLACES]) == pytest.approx(
                distances, rel=EQUAL, abs=EQUAL * 1e3
            )
            in_order(curves)
            compared += speeds_fit(curves, train, place, inputs, given)
    assert compared > TRAINS


def in_order(curves: FmuInstance) -> None:
    """Check the order of the speeds of limits, and of their distances."""
    speeds = curves.get([f"V_{name}" for name in ("P", "W", "SBI", "EBI")])
    assert speeds == sorted(speeds)
    distances = curves.get([f"distance_{name}" for name in ("EBD", "EBI", "SBI", "W", "P", "I")])
    assert distances == sorted(distances)


def speeds_fit(
    curves: FmuInstance, train: SupervisedTrain, place: float, inputs: dict[str, Any], given: dict[str, Any]
) -> int:
    """Check that each limit has its speed at the train's place, or the next permitted one; return the count."""
    front, compared = place - inputs["distance_to_target"], 0
    for name in ("P", "W", "SBI", "EBI"):
        speed = curves[f"V_{name}"]
        least = 0.0 if given["kind"] == "EOA" else given["target_speed"] + MARGINS[name]
        near = speed * (1.0 + EQUAL * np.array([-1.0, 1.0]))
        slower, faster = getattr(supervise(train, place, near, **given), name)
        band = EQUAL * (1e3 + abs(front))
        if speed == pytest.approx(least, rel=1e-12):
            assert faster <= front + band
        elif speed < FASTEST:  # a limit ends at the speed from which the train cannot brake
            assert faster - band <= front <= slower + band
            compared += 1
    return compared


def test_commands_hold_until_the_permitted_speed_and_the_emergency_brake_until_rest(fmu: Callable[..., Path]) -> None:
    """Limits at 1000 m: speeds between them switch one command after the other, SUBSET-026, 3.13.10."""
    names = ("indication", "warning", "traction_cut_off", "service_brake", "emergency_brake")

    def commands(curves: FmuInstance, speeds: list[float]) -> list[list[float]]:
        found = []
        for n, speed in enumerate(speeds):
            curves.set(V_est=speed)
            curves.step(float(n), 1.0)
            found.append(curves.get(names))
        return found

    with FmuInstance(fmu()) as curves:
        own = fmu_parameters(replace(PLAIN, traction_command=True))
        curves.restart(own, distance_to_target=1000.0)
        p, w, s, e = curves.get(["V_P", "V_W", "V_SBI", "V_EBI"])
        assert p < w < s < e
        off, warns, brakes, stops = [1, 0, 0, 0, 0], [1, 1, 1, 0, 0], [1, 1, 1, 1, 0], [1, 1, 1, 1, 1]
        rises = [p - 0.01, p + 0.01, w + 0.01, w - 0.01, s + 0.01, p + 0.01, p - 0.01, e + 0.01, p - 0.01, 0.0]
        # The emergency brake ends at rest; the others have ended at the permitted speed.
        after = [1, 0, 1, 0, 1]
        assert commands(curves, rises) == [off, off, warns, warns, brakes, brakes, off, stops, after, [0] * 5]
        curves.restart(own | {"Q_NVEMRRLS": 1}, distance_to_target=1000.0)
        assert commands(curves, [e + 0.01, p + 0.01, p - 0.01]) == [stops, stops, off]
        curves.restart(own | {"service_command": 0}, distance_to_target=1000.0)
        above = curves["V_SBI"] + 0.01
        assert above < curves["V_EBI"]
        assert commands(curves, [above]) == [[1, 1, 1, 0, 1]]


def test_a_line_speed_and_a_release_speed_bound_the_limits(fmu: Callable[..., Path]) -> None:
    with FmuInstance(fmu()) as curves:
        curves.restart(fmu_parameters(PLAIN), distance_to_target=9000.0, V_MRSP=20.0)
        limits = ["V_P", "V_W", "V_SBI", "V_EBI"]
        assert curves.get(limits) == pytest.approx([20.0 + margin for margin in MARGINS.values()], rel=1e-12)
        curves.restart(fmu_parameters(PLAIN), distance_to_target=5.0, V_release=6.0, V_est=5.9)
        assert curves.get([*limits, "emergency_brake"]) == [6.0, 6.0, 6.0, 6.0, 0.0]
        curves.set(distance_to_target=-0.1)
        curves.step(0.0, 0.1)
        assert curves["emergency_brake"] == 1.0


OUTPUTS = [*(f"V_{name}" for name in PLACES[1:5]), *(f"distance_{name}" for name in PLACES)]


@pytest.mark.parametrize(
    ("inactive", "unless"),
    [
        ({"moving_target_factor": 1.2}, {"target_kind": 2, "V_target": 10.0}),
        ({"A_NVMAXREDADH": 0.3}, {"reduced_adhesion": 1}),
        ({"Kwet_rst[1]": 0.5}, {"M_NVAVADH": 0.0}),
        ({"A_brake_service[1]": 0.2}, None),
        ({"Kdry_rst[2]": 0.1}, {"Kdry_rst_speed[1]": 20.0}),
        ({"traction_command": 1}, {"T_traction_cut_off": 9.0, "A_est": 0.5}),
    ],
)
def test_a_parameter_acts_only_where_it_is_meant_to(
    fmu: Callable[..., Path], inactive: dict[str, float], unless: dict[str, float] | None
) -> None:
    """Towards a stop on a dry rail with the wet loss waived; the service brake acts at an end of authority alone."""
    inputs = {"V_est": 30.0, "distance_to_target": 900.0, "M_NVAVADH": 1.0}
    inputs |= {"target_kind": 2} if unless is None else {}

    def outputs(curves: FmuInstance, *more: dict[str, float]) -> list[float]:
        curves.restart(fmu_parameters(PLAIN) | inputs | {name: one for some in more for name, one in some.items()})
        return list(curves.get(OUTPUTS))

    with FmuInstance(fmu()) as curves:
        assert outputs(curves, inactive) == outputs(curves)
        active: dict[str, float] = unless or {"target_kind": 1}
        assert outputs(curves, active, inactive) != outputs(curves, active)


def test_of_several_targets_each_has_its_limits_in_turn(fmu: Callable[..., Path]) -> None:
    """Set during a run, a target leaves nothing behind but commands; the lowest of the limits is that of the train."""
    targets = ({"distance_to_target": 1500.0}, {"distance_to_target": 900.0, "target_kind": 3, "V_target": 12.0})
    neutral = {"target_kind": 1, "V_target": 0.0, "V_est": 20.0}
    with FmuInstance(fmu()) as turns, FmuInstance(fmu()) as alone:
        turns.restart(fmu_parameters(PLAIN), **(neutral | targets[0]))
        for n in range(4):
            turns.set(**(neutral | targets[n % 2]))
            turns.step(float(n), 1.0)
            alone.restart(fmu_parameters(PLAIN), **(neutral | targets[n % 2]))
            assert list(turns.get(OUTPUTS)) == list(alone.get(OUTPUTS))


@pytest.mark.parametrize("more", [0.5, 1.0, 1.5])
def test_before_a_target_that_a_train_cannot_slow_to_it_may_be_faster_by_the_margin(
    fmu: Callable[..., Path], more: float
) -> None:
    """The foot of EBD is dV_ebi above the target; a train below it needs the times of the brake and of the driver."""
    target, times = 20.0, PLAIN.T_brake_emergency + PLAIN.T_brake_service + 4.0
    exact = fmu_parameters(PLAIN, NationalValues(exact_speed=True))
    with FmuInstance(fmu()) as curves:
        inputs = {"gradient": -0.15, "target_kind": 2, "V_target": target, "V_est": target}
        curves.restart(exact, distance_to_target=(target + more) * times, **inputs)
        assert curves["V_P"] == pytest.approx(target + more, rel=1e-12)


def test_where_the_brake_cannot_hold_the_train_every_output_is_finite(fmu: Callable[..., Path]) -> None:
    names = [*(f"V_{name}" for name in PLACES[1:5]), *(f"distance_{name}" for name in PLACES), "emergency_brake"]
    with FmuInstance(fmu()) as curves:
        for steep, kind in ((-0.15, 1), (-0.15, 2), (0.0, 3)):
            given = {"gradient": steep, "target_kind": kind, "V_target": 0.0 if kind == 1 else 3.0}
            curves.restart(fmu_parameters(PLAIN), V_est=30.0, distance_to_target=900.0, **given)
            assert all(map(math.isfinite, curves.get(names)))
            assert curves["distance_P"] == (1e9 if steep else pytest.approx(curves["distance_P"]))
            assert curves["emergency_brake"] == (steep < 0.0)


def test_a_saved_state_has_the_commands_and_the_train(fmu: Callable[..., Path]) -> None:
    with FmuInstance(fmu(3, HILLS)) as curves:
        curves.restart(fmu_parameters(PLAIN, version=3), V_est=60.0, distance_to_target=800.0)
        state = curves.save()
        curves.restart({"length": 20.0}, V_est=60.0, distance_to_target=8e5)
        assert curves["emergency_brake"] == 0.0
        curves.restore(state)
        curves.set(V_est=20.0, distance=700.0, distance_to_target=2000.0)
        curves.step(0.0, 0.1)
        assert curves["emergency_brake"] == 1.0
        expected = supervise(PLAIN, 2700.0, 20.0, gradients=HILLS)
        assert curves["distance_I"] == pytest.approx(2700.0 - expected.I[0], rel=EQUAL)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"T_brake_emergency": 61.0}, "T_brake_emergency must be from 0 to 60 s; got 61"),
        ({"A_brake_service[3]": 0.0}, r"A_brake_service\[3\] must be from 0.001 to 9.99 m/s2; got 0"),
        ({"V_est": math.nan}, "V_est must be from -150 to 150 m/s; got nan"),
        ({"Kdry_rst_speed[2]": 10.0}, "Kdry_rst_speed must ascend"),
        ({"Kdry_rst_speed[1]": 160.0}, "Kdry_rst_speed must be at most 140 m/s, or 200 if it is not used; got 160"),
        ({"M_rotating_nom": 0.1}, "M_rotating_nom must be at most 0, or at least 0.3 %; got 0.1. Give 10 for 10 %"),
        ({"V_target": 5.0}, r"V_target must be 0 m/s at an end of authority \(EOA\); got 5"),
        ({"target_kind": 2, "beyond": 5.0}, "beyond must be 0 unless target_kind is 1"),
        ({"target_kind": 3, "V_release": 5.0}, "V_release must be 0 unless target_kind is 1"),
    ],
)
def test_numbers_that_cannot_be_are_refused(fmu: Callable[..., Path], values: dict[str, Any], message: str) -> None:
    def first_step(curves: FmuInstance) -> None:
        curves.start(**values)
        curves.step(0.0, 0.1)

    with FmuInstance(fmu()) as curves, pytest.raises(CosimulationError, match=message):
        first_step(curves)


def test_train_data_that_the_fmu_does_not_have_are_refused() -> None:
    many = replace(PLAIN, length=np.array([100.0, 200.0]))
    guided = replace(PLAIN, A_brake_normal_service=Steps.constant(0.5))
    with pytest.raises(BadInputError, match="length must be that of one train; got 2 values"):
        fmu_parameters(many)
    with pytest.raises(BadInputError, match="has no feedback"):
        fmu_parameters(replace(PLAIN, service_feedback=True))
    with pytest.raises(BadInputError, match="has no guidance curve"):
        fmu_parameters(guided, NationalValues(guidance=True))
    with pytest.raises(BadInputError, match=r"baselines 3\.3\.0 and 4\.0\.0"):
        fmu_parameters(PLAIN, fixed=FixedValues(T_driver=3.0))


def test_a_line_that_the_fmu_would_not_read_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    many = Gradients(np.arange(100_001.0), np.arange(100_001) % 2)
    with pytest.raises(BadInputError, match="at most 100000 gradients; got 100001"):
        write_in_c(curves_fmu(many), tmp_path / "many.fmu", 2)
    line = tmp_path / "line.csv"
    far, steep = "0,0,0,0\n2e6,0,0,0.01\n3e6,0,0,0.01", "0,0,0,0.5\n9,0,0,0"
    for rows, words in ((far, "got a gradient at 2e+06 m"), (steep, "got 0.5 at 0 m")):
        line.write_text(f"distance,curvature,cant,gradient\n{rows}\n")
        assert build_fmu.main(["curves", "--line", str(line), "--kind", "native", "--out", str(tmp_path)]) == 2
        assert words in capsys.readouterr().err


def test_the_command_line_builds_it_on_a_line(tmp_path: Path) -> None:
    line = tmp_path / "line.csv"
    line.write_text("distance,curvature,cant,gradient\n0,0,0,0.005\n1000,0,0,0.005\n1001,0,0,-0.01\n2000,0,0,-0.01\n")
    assert build_fmu.main(["curves", "--line", str(line), "--kind", "native", "--out", str(tmp_path)]) == 0
    with FmuInstance(tmp_path / "native" / "BrakingCurves.fmu") as curves:
        curves.start(V_est=30.0, distance=500.0, distance_to_target=1000.0)
        slopes = Gradients(np.array([0.0, 1000.0]), np.array([5.0, -10.0]))
        curves.restart(fmu_parameters(PLAIN), V_est=30.0, distance=500.0, distance_to_target=1000.0)
        expected = supervise(PLAIN, 1500.0, 30.0, gradients=slopes)
        assert curves["distance_EBI"] == pytest.approx(1500.0 - expected.EBI[0], rel=EQUAL)
        curves.set(gradient=0.01)
        with pytest.raises(CosimulationError, match="gradient must be 0 in an FMU with a line"):
            curves.step(0.0, 0.1)


@pytest.mark.parametrize("kind", ["native", "fmi3"])
def test_train_data_in_a_file_are_the_start_values(kind: str, tmp_path: Path) -> None:
    """They are those that fmu_parameters gives a host; of the confidence level of a country, and after a reset too."""
    levels = tuple(Steps.constant(0.7 + 0.02 * level) for level in range(10))
    write_train(tmp_path / "etcs-x.json", replace(PLAIN, rotating=8.0), levels)
    (tmp_path / "country.toml").write_text("M_NVEBCL = 3\nM_NVAVADH = 0.25\n")
    command = ["curves", "--train", str(tmp_path / "etcs-x.json"), "--national", str(tmp_path / "country.toml")]
    assert build_fmu.main([*command, "--kind", kind, "--out", str(tmp_path)]) == 0
    national = NationalValues(M_NVEBCL=3, M_NVAVADH=0.25)
    version = {"native": 2, "fmi3": 3}[kind]
    given = fmu_parameters(replace(PLAIN, rotating=8.0, Kdry_rst=levels[3], level=3), national, version=version)
    with FmuInstance(tmp_path / kind / "BrakingCurves.fmu") as curves:
        for _ in range(2):
            curves.start(V_est=30.0, distance_to_target=1500.0)
            found = curves.get(OUTPUTS)
            curves.restart(given, V_est=30.0, distance_to_target=1500.0)
            assert found == curves.get(OUTPUTS)
            curves.fmu.reset()
    about = read_model_description(str(tmp_path / kind / "BrakingCurves.fmu"))
    assert about.modelName == "etcs-x"
    assert {v.name: v.start for v in about.modelVariables}["M_NVAVADH"] == "0.25"
