"""Options that have no effect beside others are refused."""

from __future__ import annotations

import pytest

import bogie_braking as bb
from bogie_braking.__main__ import main
from fmu_src.cosimulation.master import Master
from fmu_src.cosimulation.slave import CosimulationError
from products.train.numbers import Settings


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("run critical-speed --all --json", "--all has no effect with --json"),
        ("run critical-speed --all --quiet", "--all has no effect with --quiet"),
        ("benchmark --list --range 10", "--range has no effect with --list"),
        ("benchmark --list --program mine.py", "--program has no effect with --list"),
        ("build curves --wheelsets 4", "--wheelsets belongs to the sensor and to --controller; got curves"),
        ("build bogie --describe --kind fmi3", "--kind has no effect with --describe"),
        ("build bogie --describe --platforms all", "--platforms has no effect with --describe"),
        ("build --describe --controller pi.c", "--controller has no effect with --describe"),
        ("pace rail --integration-step 1ms --seconds 1 --set integration_step=1e-3", "state the same"),
        ("run qr30-180kpa --coupling-tolerance 0.1", "--coupling-tolerance must be from 1e-09 to 0.01; got 0.1"),
        ("run qr30-180kpa --coupling-tolerance 1e99", "--coupling-tolerance must be from 1e-09 to 0.01; got 1e99"),
    ],
)
def test_an_option_without_effect_is_refused(arguments: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments.split()) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("tolerance", [0.0, 0.1, float("nan")])
def test_a_tolerance_of_the_coupling_is_limited_like_that_of_the_integrators(tolerance: float) -> None:
    with pytest.raises(CosimulationError, match=r"coupling_tolerance must be above 0 and at most 0\.01"):
        Master(coupling_tolerance=tolerance)


@pytest.mark.parametrize("name", ["traction", "dynamic_brake", "track_brake", "parking_brake"])
def test_an_input_that_no_vehicle_uses_is_refused(name: str) -> None:
    one = bb.train([{"kind": "locomotive"}, {"kind": "wagon"}])
    one.inputs[name] = 1.0
    with pytest.raises(ValueError, match=rf"inputs\['{name}'\] must be 0: no vehicle has"):
        one.advance(0.1)


@pytest.mark.parametrize(("name", "column"), [("traction", "traction_force"), ("dynamic_brake", "dynamic_force")])
def test_an_input_is_noted_once_where_it_is_set_without_equipment_alone(name: str, column: str) -> None:
    engine = {"kind": "locomotive", column: 100, column.replace("force", "power"): 1000}
    one = bb.train([engine, {"kind": "wagon"}], speed=10.0)
    one.inputs[name] = 0.5
    one.advance(0.1)
    assert one.messages == []
    one.inputs[name] = [0.0, 0.5]
    one.advance(0.1)
    [said] = one.record(0.2).messages
    assert said.startswith(f"inputs['{name}'][1] has no effect without ")


def test_errors_beside_settings_are_refused() -> None:
    with pytest.raises(ValueError, match="distance_error has no effect with settings"):
        bb.train(2, settings=Settings(), distance_error=0.001)
    with pytest.raises(ValueError, match=r"must be a share from 0 to 0\.5; got 5\.0\. Did you mean 5 % = 0\.05\?"):
        bb.train(2, distance_error=5.0)


def test_numbers_of_a_train_in_another_unit_are_refused_or_noted() -> None:
    with pytest.raises(ValueError, match=r"speed must be .* to 112 m/s; got 120\.0\. Did you mean 120 km/h"):
        bb.TimetableDriver([bb.StationStop(500.0)], [(0.0, 120.0)])
    said = "speed is 120 m/s = 432 km/h. Did you mean 120 km/h = 33.33 m/s?"
    assert bb.train(2, speed=120.0).record(0.1).messages == [said]
    train = bb.train(2)
    bb.HoldingDriver(80.0).act(train)
    assert train.messages == ["speed of the driver is 80 m/s = 288 km/h. Did you mean 80 km/h = 22.22 m/s?"]
    rows = {"lambda": (1.15, "115 %"), "dynamic_power": (2.5, "2500 kW"), "rotating": (0.08, "8 %")}
    for name, (value, meant) in rows.items():
        force = {"dynamic_force": 100.0} if name == "dynamic_power" else {}
        with pytest.raises(ValueError, match=rf"{name} must be .*= {meant}\?"):
            bb.train([{"kind": "locomotive", name: value, **force}])
