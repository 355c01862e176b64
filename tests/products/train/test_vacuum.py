"""Vacuum brakes against closed forms: Boyle, a constant displacement, choked inflow, and the mass of all air."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import astuple, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import bogie_braking as bb
from brake_controller.distributors.vacuum import VacuumBrake, vacuum_brake
from brake_controller.drivers_valve import drivers_valve
from brake_controller.vacuum_valve import VacuumValve
from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.train.consist import Consist
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import rows_of, write_consist
from products.train.fmu import train_fmu
from products.train.numbers import Settings
from products.train.pipe import EndConditions, Pipe
from products.train.train import Train

AMBIENT, GAS, WALL, INCH = 101325.0, 287.05287, 293.15, 3386.389
VACUUM, WEIGHT = 21 * INCH, 3e3
KEPT = AMBIENT - VACUUM
#: Mass flow of a choked restriction over C A p / sqrt(R T), and the ratio of pressures below which it is choked.
CHOKED, CRITICAL = 0.6847, 0.5283
LOCOMOTIVE = {"kind": "locomotive", "brake": "none"}
COACH: dict[str, Any] = {"kind": "coach", "distributor": "vacuum", "lambda": 80}


def rows(count: int, **more: Any) -> list[dict[str, Any]]:
    """Return a locomotive that carries the pipe, and coaches."""
    return [LOCOMOTIVE, {**COACH, "count": count, **more}]


def with_brakes(consist: Consist, change: Callable[[VacuumBrake], VacuumBrake]) -> Consist:
    """Return a consist with changed brakes."""
    return Consist(
        tuple(
            replace(v, distributor=change(v.distributor)) if isinstance(v.distributor, VacuumBrake) else v
            for v in consist.vehicles
        )
    )


def pressing(chamber: float, swept: float, line: float) -> float:
    """Return what presses [Pa] with `line` below the piston and a chamber [m3] that held the whole vacuum (Boyle)."""
    return max(line - KEPT * chamber / (chamber - swept) - WEIGHT, 0.0)


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("step", [0.3, 0.7, 1.0])
def test_the_force_is_the_difference_of_both_sides_of_the_piston(scale: float, step: float) -> None:
    """At rest the pipe is below the piston; the air above it is compressed by the stroke."""
    chamber, swept = scale * 0.12, scale * 0.04
    train = Train(
        with_brakes(
            consist_of(rows(2)),
            lambda one: replace(vacuum_brake(VACUUM, chamber, swept, 3.0), lower_volume=scale * 0.01),
        )
    )
    train.drive("service", step)
    train.advance(300.0)
    fallen = VACUUM * (0.4 / 1.5 + step * (1 - 0.4 / 1.5))
    assert train.pipe_pressure == pytest.approx(np.full(3, fallen - VACUUM), abs=1e3)  # the band of the valve
    expected = pressing(chamber, swept, AMBIENT + float(train.pipe_pressure[1]))
    assert train.cylinder_pressure[1:] == pytest.approx(expected, rel=1e-4)
    forces = train.consist.vehicles[1].brake.force_per_pressure
    assert train.brake_force[1] == pytest.approx(0.3 * forces * train.cylinder_pressure[1], rel=1e-9)


def test_cylinders_of_a_stated_diameter_press_by_their_area_without_a_spring() -> None:
    """Two pistons of 18 inches, 4.5 of stroke, at the whole pressure of the air."""
    own = {
        "cylinder_diameter": 457.2,
        "cylinders": 2,
        "rigging_ratio": 4,
        "friction": "constant",
        "friction_value": 0.2,
    }
    vehicle = consist_of(
        [LOCOMOTIVE, {"kind": "wagon", "distributor": "vacuum", "rigging_efficiency": 1, **own}]
    ).vehicles[1]
    area = 2 * math.pi / 4 * 0.4572**2
    full = pressing(7238 * 0.0254**3, area * 4.5 * 0.0254, AMBIENT)
    assert vehicle.distributor.full_pressure == pytest.approx(full, rel=1e-3)
    assert vehicle.brake.force_per_pressure * vehicle.distributor.full_pressure == pytest.approx(
        4 * area * full, rel=1e-3
    )


@pytest.mark.parametrize(("kind", "percentage"), [("coach", 135.0), ("locomotive", 85.0)])
def test_a_kind_has_its_brake_weight_at_the_pressure_of_a_vacuum(kind: str, percentage: float) -> None:
    vehicle = consist_of([{"kind": "locomotive", "distributor": "vacuum"}, {"kind": kind, "distributor": "vacuum"}])
    assert vehicle.vehicles[1].percentage == pytest.approx(percentage, rel=1e-3)


def emptied(settings: Settings, exhauster: float, **row: Any) -> Train:
    """Return a short train without a vacuum: after an emergency, release valves join both sides of the pistons."""
    consist = with_brakes(consist_of(rows(1, **row)), lambda one: replace(one, ball_choke=0.02, release_choke=0.02))
    head = consist.vehicles[0]
    assert isinstance(head.valve, VacuumValve)
    valve = replace(head.valve, exhauster=exhauster, ejector=9 * exhauster)
    train = Train(Consist((replace(head, valve=valve), *consist.vehicles[1:])), settings=settings)
    train.drive("emergency")
    for _ in range(60):  # cylinders fill, and their air enters the chamber
        for protection in (0, 2):
            train.inputs["protection"] = protection
            train.advance(5.0)
    train.inputs["protection"] = 0
    assert train.pipe_pressure == pytest.approx(np.zeros(2), abs=20.0)
    assert train.air.vehicle_pressures("chamber")[1] == pytest.approx(AMBIENT, rel=2e-3)
    return train


@pytest.mark.parametrize(("position", "times"), [("running", 1), ("overcharge", 10)])
def test_an_exhauster_creates_the_vacuum_in_the_time_of_its_displacement(position: str, times: int) -> None:
    """V / S ln(p0 / p) of pipe, chambers and cylinders as one volume, isothermal; the ejector adds to the exhauster."""
    displaced = 2e-4
    train = emptied(Settings(heat=1e6), displaced)
    volume = float(train.air.volume.sum()) + 7238 * 0.0254**3 + 0.01
    train.drive(position)
    train.advance(2.0)  # until the valve's pressure is below that of the pipe
    begin, time = float(train.pipe_pressure[1]) + AMBIENT, 0.0
    while train.pipe_pressure[1] > -60e3:
        train.advance(0.25)
        time += 0.25
    end = float(train.pipe_pressure[1]) + AMBIENT
    assert time == pytest.approx(volume / (times * displaced) * math.log(begin / end), rel=5e-3)


def test_cylinders_fill_as_choked_flow_and_boyle_have_it() -> None:
    """A pipe that is at ambient pressure at once. First choked: a constant flow; then an integration of its own."""
    brake = replace(vacuum_brake(filling=6.0), ball_choke=0.0)
    pipe = Pipe(2, pressure=AMBIENT, length=10.0, diameter=0.3, heat=1e6)
    pipe.open_to(0, EndConditions(1.0, AMBIENT))
    pipe.connect([1], [brake], KEPT)
    area, above, below, stroke = 0.8 * math.pi / 4 * brake.choke**2, brake.chamber_volume, brake.lower_volume, 0.0375264

    def pressures(mass: float) -> tuple[float, float]:
        """Return those above and below the piston: it rests below, hangs by its weight, or has risen."""

        def over(x: float) -> float:
            return mass / (below + x) - KEPT * above / (above - x) - WEIGHT

        x = 0.0 if over(0.0) < 0.0 else stroke if over(stroke) > 0.0 else brentq(over, 0.0, stroke)
        return KEPT * above / (above - x), mass / (below + x)

    def rate(_: float, mass: np.ndarray) -> list[float]:
        ratio = min(max(pressures(mass[0])[1] / AMBIENT, CRITICAL), 1.0)
        shape = math.sqrt(7.0 * (ratio ** (2 / 1.4) - ratio ** (2.4 / 1.4)))  # isentropic flow, St. Venant and Wantzel
        return [GAS * WALL * area * AMBIENT / math.sqrt(GAS * WALL) * shape]

    pipe.advance(0.5)
    early = CHOKED * area * AMBIENT / math.sqrt(GAS * WALL) * 0.5
    assert pipe.passed.vehicle_mass == pytest.approx(early, rel=2e-3)
    pipe.advance(3.5)
    mass = solve_ivp(rate, (0.0, 4.0), [KEPT * below], rtol=1e-8, max_step=0.01).y[0, -1]
    low = float(pipe.vehicle_pressures("cylinder")[0]) * below
    assert low == pytest.approx(mass, rel=5e-3)  # ISO 6358-1 is within 0.31 % of isentropic flow
    pipe.advance(2.0)
    own = pressures(float(pipe.vehicle_pressures("cylinder")[0]) * below)
    assert own[1] - own[0] - WEIGHT == pytest.approx(0.95 * brake.full_pressure, rel=0.01)


def test_leaks_let_air_in_at_a_choked_rate() -> None:
    """Below half of the ambient pressure the inflow is constant, and the valve, which is shut off, does not help."""
    train = bb.train(rows(4, leak=2.0))
    train.drive("shut-off")
    train.advance(20.0)
    area = 0.8 * math.pi / 4 * 0.002**2
    assert train.pipe_pressure.max() + AMBIENT < CRITICAL * AMBIENT
    expected = -4 * CHOKED * area * AMBIENT / math.sqrt(GAS * WALL) * 20.0
    assert train.air.passed.leak_mass == pytest.approx(expected, rel=1e-3)
    assert train.cylinder_pressure[1:].max() < 30e3


def test_an_exhauster_holds_the_vacuum_against_leaks_and_a_valve_that_is_shut_loses_it() -> None:
    held, lost = bb.train(rows(4, leak=2.0)), bb.train(rows(4, leak=2.0))
    lost.drive("shut-off")
    for train in (held, lost):
        train.advance(200.0)
    assert held.pipe_pressure.max() < -VACUUM + 3e3
    assert held.cylinder_pressure.max() == 0.0
    assert lost.pipe_pressure.min() > -40e3
    assert (lost.cylinder_pressure[1:] > 20e3).all()


def test_no_air_is_lost_at_random_inputs() -> None:
    """Air of the pipe, above and below all pistons, against what came through valves, leaks and parted hoses."""
    draw = np.random.default_rng(5)
    train = bb.train(rows(6, leak=0.5))
    brake = train.consist.vehicles[1].distributor
    assert isinstance(brake, VacuumBrake)

    def air() -> float:
        found = [train.air.vehicle_pressures(name)[1:].sum() for name in ("chamber", "cylinder")]
        return float(train.air.mass + (found[0] * brake.chamber_volume + found[1] * brake.lower_volume) / (GAS * WALL))

    before, pipe_before = air(), train.air.mass
    for _ in range(60):
        train.drive(
            str(draw.choice(["running", "overcharge", "service", "emergency", "shut-off", "hold"])), draw.random()
        )
        train.inputs["protection"] = draw.integers(0, 3, 7)
        train.inputs["hose_state"] = draw.choice([0, 0, 0, 0, 1, 2], 6)
        train.advance(draw.uniform(0.1, 4.0))
        passed = train.air.passed
        out = passed.valve_mass + passed.leak_mass
        assert air() - before == pytest.approx(-out, abs=1e-9)
        assert train.air.mass - pipe_before == pytest.approx(-out - passed.vehicle_mass, abs=1e-9)
        assert train.air.pressure.min() > 5e3


def test_brakes_release_after_a_full_application() -> None:
    train = bb.train(rows(20))
    train.drive("emergency")
    train.advance(60.0)
    assert train.cylinder_pressure[1:] == pytest.approx(train.consist.vehicles[1].distributor.full_pressure, rel=2e-3)
    train.drive("overcharge")
    train.advance(120.0)
    assert train.cylinder_pressure.max() == 0.0
    assert train.pipe_pressure.max() < -VACUUM + 3e3
    assert train.air.vehicle_pressures("chamber")[1:] == pytest.approx(KEPT, rel=0.01)


def last_brakes(cells: float, **more: Any) -> tuple[float, float, float]:
    """Return when the air of an emergency arrives at the last of 20 coaches, when it has half of its pressure [s], and
    the air that its cylinder has taken from the pipe [kg].
    """
    train = Train(consist_of(rows(20, **more)), settings=Settings(cells=cells))
    train.drive("emergency")
    time, arrived = 0.0, math.inf
    full = train.consist.vehicles[1].distributor.full_pressure
    while train.cylinder_pressure[-1] < 0.5 * full:
        train.advance(0.02)
        time += 0.02
        if math.isinf(arrived) and train.pipe_pressure[-1] > -VACUUM + 500.0:
            arrived = time
        assert train.cylinder_pressure[1] >= train.cylinder_pressure[-1] - 1.0
        assert time < 60.0
    return arrived, time, train.air.passed.vehicle_mass


def test_an_application_runs_through_a_train_of_20_below_the_speed_of_sound() -> None:
    """Cells of a half and of the whole vehicle agree; 19 coaches of 27.64 m of pipe, and most of the locomotive's."""
    (coarse, half, _), (fine, half_fine, _) = last_brakes(1.0), last_brakes(4.0)
    assert 100.0 < 545.0 / fine < 343.0
    assert coarse == pytest.approx(fine, rel=0.15)
    assert half == pytest.approx(half_fine, rel=0.03)


def test_direct_admission_brakes_the_last_vehicle_earlier_without_air_of_the_pipe() -> None:
    piped, direct = last_brakes(1.0), last_brakes(1.0, direct_admission="yes")
    assert direct[1] < 0.7 * piped[1]
    assert direct[2] == pytest.approx(0.0, abs=1e-20)
    assert piped[2] > 0.5


def test_a_parted_hose_brakes_both_parts() -> None:
    train = bb.train(rows(6), speed=20.0)
    train.inputs["hose_state"][3] = 2
    train.advance(30.0)
    assert (train.cylinder_pressure[4:] > 0.95 * train.consist.vehicles[1].distributor.full_pressure).all()
    assert train.cylinder_pressure[1] > 30e3  # the exhauster cannot hold the vacuum at an open end


def test_a_saved_state_goes_on_alike_and_a_stop_is_that_of_its_fmu_and_of_its_files(tmp_path: Path) -> None:
    consist = consist_of(rows(4, vacuum="25 inHg", direct_admission="yes"))
    train, position = Train(consist, speed=20.0), (1, 3, 6, 5, 0, 4, 2)
    assert train.pipe_pressure == pytest.approx(-25 * INCH)
    found, states = [], []
    for number in position:
        train.inputs["driver_position"][0], train.inputs["driver_step"][0] = number, 0.4
        states.append(train.state)
        train.advance(3.0)
        found.append((train.pipe_pressure.tolist(), train.cylinder_pressure.tolist(), train.speed.tolist()))
    train.state = states[3]
    for number, expected in zip(position[3:], found[3:], strict=True):
        train.inputs["driver_position"][0], train.inputs["driver_step"][0] = number, 0.4
        train.advance(3.0)
        assert (train.pipe_pressure.tolist(), train.cylinder_pressure.tolist(), train.speed.tolist()) == expected
    for version in (2, 3):
        write_in_c(train_fmu(consist), tmp_path / "train.fmu", version)
        with FmuInstance(tmp_path / "train.fmu", start_speed=20.0) as slave:
            slave.start()
            names = [name for name in slave.units if name.startswith("driver_position")]
            for step, (number, (pipe, cylinder, _)) in enumerate(zip(position, found, strict=True)):
                slave.set(**{names[0]: number if version == 2 else [number]})
                slave.set(**{names[0].replace("position", "step"): 0.4 if version == 2 else [0.4]})
                slave.step(3.0 * step, 3.0)
                of_fmu = [
                    slave.array(name) if version == 3 else slave.get([f"{name}[{n}]" for n in range(1, 6)])
                    for name in ("pipe_pressure", "cylinder_pressure")
                ]
                assert [np.ravel(one).tolist() for one in of_fmu] == [pipe, cylinder]
    for name in ("train.toml", "train.csv"):
        write_consist(consist, tmp_path / name)
        assert read_consist(tmp_path / name).vehicles[1].distributor.values() == pytest.approx(
            consist.vehicles[1].distributor.values(), rel=1e-9
        )
    text = "kind,distributor,lambda,Unterdruck [mmHg],count\nlocomotive,vacuum,,533.4,\ncoach,vacuum,80,533.4,3\n"
    (tmp_path / "german.csv").write_text(text, encoding="utf-8")
    assert read_consist(tmp_path / "german.csv").charged_pressure == pytest.approx(-VACUUM, rel=1e-5)


def test_a_consist_with_a_vacuum_is_written_as_it_was_stated() -> None:
    own = {
        "exhauster": 2,
        "ejector": 5,
        "exhaust": 20,
        "service_rate": 0.1,
        "traction_force": 200,
        "traction_power": 900,
    }
    stated = [{**LOCOMOTIVE, **own}, {**COACH, "auxiliary": 150, "cylinder": 45, "fill_time": 4, "vacuum": 0.65}]
    consist = consist_of(stated)
    again = consist_of(rows_of(consist))
    for one, as_stated in zip(again.vehicles, consist.vehicles, strict=True):
        valves = [None if valve is None else astuple(valve) for valve in (one.valve, as_stated.valve)]
        assert valves[0] == (None if valves[1] is None else pytest.approx(valves[1], rel=1e-9))
        assert one.distributor.values() == pytest.approx(as_stated.distributor.values(), rel=1e-9)
    assert again.vehicles[0].traction.traction_cut_out == 0.0
    assert {v.pipe_diameter for v in again.vehicles} == {0.0508}


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        (
            [{"kind": "locomotive"}, COACH],
            "either air or a vacuum; got distributor = uic of vehicle 1, and vacuum of vehicle 2. Give both one kind",
        ),
        (
            [LOCOMOTIVE, COACH, {**COACH, "vacuum": 0.8}],
            "vacuum must be one number for a train; got 0.7111 bar of vehicle 2",
        ),
        ([LOCOMOTIVE, {**COACH, "vacuum": 21}], "vacuum must be a number from 0.3 to 0.9 bar; got 21"),
        ([LOCOMOTIVE, {**COACH, "full_pressure": 3.8}], "full_pressure must be of the distributor"),
        ([LOCOMOTIVE, {**COACH, "release_time": 20}], "release_time must be of the distributor"),
        ([LOCOMOTIVE, {**COACH, "position": "P"}], "position has no effect with distributor = vacuum"),
        ([LOCOMOTIVE, {**COACH, "auxiliary": 40}], "cylinder must be at most .* l with auxiliary = 40 l"),
        ([LOCOMOTIVE, {"kind": "wagon", "distributor": "vacuum"}], "of a wagon must come with lambda or deceleration"),
        ([{"kind": "locomotive", "exhauster": 2}], "exhauster of vehicle 1 has no effect without distributor = vacuum"),
        (
            [{**LOCOMOTIVE, "traction_force": 100, "traction_power": 900, "traction_cut_out": 2.5}, COACH],
            "traction_cut_out of vehicle 1 has no effect with a vacuum",
        ),
        (
            [{"kind": "locomotive", "brake": "none", "main_reservoir": 800}, COACH],
            "main_reservoir of vehicle 1 has no effect with a vacuum in the pipe. Add direct_pressure",
        ),
        (
            [{"kind": "locomotive"}, {"kind": "coach", "direct_admission": "yes"}],
            "direct_admission must be of the distrib",
        ),
        ([{"kind": "locomotive"}, {"kind": "coach", "brake": "vacuum"}], "Write distributor = vacuum"),
    ],
)
def test_values_that_a_vacuum_excludes_are_refused(stated: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        consist_of(stated)


def test_pressures_models_and_valves_of_air_are_refused_with_a_vacuum_and_the_other_way_round() -> None:
    consist = consist_of(rows(2))
    for value, most in ((5e5, "-95000 to 0 Pa"), (-99e3, "-95000 to 0 Pa")):
        with pytest.raises(ValueError, match=f"pipe must be a number from {most}"):
            Train(consist, pipe=value)
    with pytest.raises(ValueError, match="pipe must be a number from 0 to 800000 Pa"):
        Train(consist_of([{"kind": "locomotive"}]), pipe=-5e4)
    with pytest.raises(ValueError, match="cylinder must be a number from 0 to 0 Pa"):
        Train(consist, cylinder=5e4)
    for brake_model in ("empirical", "delay"):
        with pytest.raises(
            ValueError, match=f"distributor of vehicle 2 has no effect with brake_model = {brake_model}"
        ):
            Train(consist, settings=Settings(brake_model, cells=1.0))
    with pytest.raises(ValueError, match=r"driver's valve of vehicle 1 must hold 0\.7111 bar of vacuum"):
        Train(Consist((replace(consist.vehicles[0], valve=drivers_valve()), *consist.vehicles[1:])))


def test_an_fmu_refuses_the_pressure_of_the_other_brake(tmp_path: Path) -> None:
    cases = {"vacuum": (rows(1), 5e5, "from -95000 to 0 Pa"), "air": ([{"kind": "locomotive"}], -5e4, "at least 0 Pa")}
    for stated, pressure, message in cases.values():
        write_in_c(train_fmu(consist_of(stated)), tmp_path / "train.fmu", 2)
        with FmuInstance(tmp_path / "train.fmu", start_pipe_pressure=pressure) as slave:
            slave.start()
            with pytest.raises(Exception, match=message):
                slave.step(0.0, 0.1)
