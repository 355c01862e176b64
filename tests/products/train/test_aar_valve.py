"""The AAR control valve: balance of its volumes, direct release, quick service, and emergency by local venting."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from brake_controller.air import AMBIENT
from brake_controller.distributors.aar import AarValve, balance, ready, retaining
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.numbers import Settings
from products.train.pipe import EndConditions, Pipe
from products.train.train import Train

PSI = 6894.757
#: Pressures of freight trains that AAR handbooks print, from 90 psi: full service, emergency [psi].
CHARGED, FULL_SERVICE, EMERGENCY = 90 * PSI, 64.3, 77.1
#: Relative error of a balance: an opening choke is laminar, and the relay stays a few kPa apart.
BALANCE = 0.002
#: Gas constant of air times the temperature of walls [J/kg].
R_T = 287.05287 * 293.15


def car(**changes: float) -> AarValve:
    return replace(ready("P"), **changes)


def bench(valve: AarValve, pressure: float, seconds: float, charged: float = CHARGED) -> tuple[Pipe, float]:
    """Open a charged car to a gauge pressure; return its pipe, and the cylinder's gauge pressure after a time."""
    pipe = Pipe(2, pressure=charged + AMBIENT, length=7.5, diameter=0.03175)
    pipe.connect([1], [valve], charged + AMBIENT)
    pipe.open_to(0, EndConditions(2e-4, pressure + AMBIENT))
    pipe.advance(seconds)
    return pipe, float(pipe.vehicle_pressures("cylinder")[0]) - AMBIENT


def train(cars: int, **changes: float) -> Train:
    """Return a locomotive that does not brake, and cars of 15 m."""
    rows = [{"kind": "locomotive", "brake": "none"}, {"kind": "wagon", "length": 15, "distributor": "aar"}]
    consist = consist_of([rows[0], rows[1] | {"count": cars}])
    vehicles = [replace(v, distributor=car(**changes)) if v.kind == "wagon" else v for v in consist.vehicles]
    return Train(replace(consist, vehicles=tuple(vehicles)), settings=Settings(cells=1))


def begun(one: Train, seconds: float) -> np.ndarray:
    """Return the time at which each car's cylinder has 10 kPa [s], infinite if it has not after `seconds`."""
    found = np.full(len(one.consist.vehicles) - 1, np.inf)
    while one.time < seconds:
        one.advance(0.05)
        found = np.where((one.cylinder_pressure[1:] > 10e3) & np.isinf(found), one.time, found)
    return found


def test_balances_are_those_that_handbooks_print() -> None:
    """Three volumes in gauge pressure, Boyle: 90 * 2.5 / 3.5 and 90 * 6 / 7 psi; emergency is 1.2 times service."""
    assert balance(ready("P"), CHARGED) / PSI == pytest.approx(FULL_SERVICE, abs=0.05)
    assert balance(ready("P"), CHARGED, emergency=True) / PSI == pytest.approx(EMERGENCY, abs=0.05)


def test_full_service_and_emergency_end_in_the_balances() -> None:
    """Without air of the pipe, the cylinder ends where Boyle has it; with quick service it ends a little above."""
    closed = car(quick_choke=0.0)
    slow = car(quick_choke=0.0, emergency_difference=1e7)
    _, service = bench(slow, CHARGED - 30 * PSI, 60.0)
    assert service == pytest.approx(balance(closed, CHARGED), rel=BALANCE)
    pipe, emergency = bench(closed, 0.0, 60.0)
    assert emergency == pytest.approx(balance(closed, CHARGED, emergency=True), rel=BALANCE)
    assert pipe.vehicle_pressures("auxiliary")[0] - AMBIENT == pytest.approx(emergency, rel=BALANCE)


def test_quick_service_adds_the_pressure_of_the_air_that_it_takes_from_the_pipe() -> None:
    """Full service from 90 psi is 65.05 psi instead of 64.3: reservoir and cylinder share the pipe's air too (Boyle).

    The pipe has given that air and the air in the quick-service volume. Quick service ends at 11 psi. Until then
    its share of the air is about that of its choke: 2^2 of 2^2 + 3^2 in mm2, both flows being choked.
    """
    valve = car(emergency_difference=1e7)
    pipe, quick = bench(valve, CHARGED - 30 * PSI, 60.0)
    bulb = float(pipe.vehicle_pressures("bulb")[0]) - AMBIENT
    given = R_T * pipe.passed.vehicle_mass - bulb * valve.bulb_volume
    both = valve.auxiliary_volume + valve.cylinder_volume
    assert quick == pytest.approx(balance(valve, CHARGED) + given / both, rel=BALANCE)
    assert given == pytest.approx(4 / 13 * 11 * PSI * valve.cylinder_volume, rel=0.3)
    assert quick / PSI == pytest.approx(1.012 * FULL_SERVICE, abs=0.1)
    assert bench(car(), 0.0, 60.0)[1] / PSI == pytest.approx(EMERGENCY, rel=0.01)


@pytest.mark.parametrize("reduction", [8.0, 15.0])
def test_a_reduction_gives_two_and_a_half_times_itself(reduction: float) -> None:
    """Auxiliary over cylinder 2.5: the air that leaves one fills the other; the valve laps within its band."""
    _, pressure = bench(car(quick_choke=0.0, emergency_difference=1e7), CHARGED - reduction * PSI, 60.0)
    assert pressure == pytest.approx(2.5 * reduction * PSI, abs=2.5 * 5e3)


def test_a_small_rise_of_the_pipe_releases_it_wholly() -> None:
    one = train(4)
    one.drive("service", 0.6)
    one.advance(30.0)
    assert one.cylinder_pressure[1:].min() > 200e3
    one.drive("service", 0.2)
    one.advance(40.0)
    assert one.pipe_pressure.max() < 450e3
    assert one.cylinder_pressure.max() < 1e3


@pytest.mark.parametrize(("retainer", "kept"), [("direct", 0.0), ("low", 10.0), ("high", 20.0)])
def test_a_retainer_keeps_its_pressure_in_a_released_cylinder(retainer: str, kept: float, tmp_path: Path) -> None:
    """An Alaska Railroad manual: 10 and 20 psi, here within the 5 kPa in which the valve shuts."""
    rows = [{"kind": "locomotive"}, {"kind": "wagon", "distributor": "aar", "retainer": retainer}]
    write_consist(consist_of(rows), tmp_path / "again.toml")
    one = Train(read_consist(tmp_path / "again.toml"))
    for position in ("service", "running"):
        one.drive(position, 1.0)
        one.advance(60.0)
    assert one.cylinder_pressure[1] == pytest.approx(kept * PSI, abs=5e3)
    assert one.cylinder_pressure[1] >= kept * PSI - 1.0


def test_slow_direct_empties_a_full_service_in_86_s() -> None:
    """An Alaska Railroad manual: 86 s, taken from a full service from 90 psi. The cylinder falls below 1 psi before."""
    slow = car(**retaining("slow-direct"), emergency_difference=1e7)
    pipe, full = bench(slow, CHARGED - 30 * PSI, 60.0)
    pipe.open_to(0, EndConditions(2e-4, CHARGED + AMBIENT))
    left = []
    for _ in range(100):
        pipe.advance(1.0)
        left.append(float(pipe.vehicle_pressures("cylinder")[0]) - AMBIENT)
    assert full > 440e3
    assert left[43] > 0.2 * full
    assert np.searchsorted(-np.array(left), -200.0) + 1 == pytest.approx(86.0, abs=3.0)


def test_accelerated_release_runs_through_a_long_train_and_takes_air_of_the_emergency_reservoirs() -> None:
    """Each car in release feeds the pipe. Plain valves leave the release to the pipe, which the reservoirs drain."""
    lost, late = [], []
    for choke in (3e-3, 0.0):
        one = train(60, accelerated_choke=choke)
        one.drive("service", 1.0)
        one.advance(40.0)
        before, start = one.cylinder_pressure, one.time
        one.drive("running")
        while one.cylinder_pressure[-1] > 0.97 * before[-1]:
            one.advance(0.1)
        late.append(one.time - start)
        one.advance(2.0)
        lost.append(500e3 + AMBIENT - float(one.air.vehicle_pressures("reservoir")[-1]))
    assert 15.0 * 60 / late[0] > 150.0
    assert late[1] > 1.3 * late[0]
    assert lost[0] > 10e3
    assert lost[1] < 100.0


def test_the_pipe_gains_the_air_that_the_emergency_reservoir_loses() -> None:
    """A closed pipe, slide valve in release: p V of pipe, auxiliary and emergency reservoir is kept (Boyle)."""
    valve = car(quick_choke=0.0, bulb_volume=0.0, emergency_difference=1e7)
    pipe, _ = bench(valve, CHARGED - 20 * PSI, 60.0)
    pipe.open_to(0, EndConditions(2e-4, CHARGED - 8 * PSI + AMBIENT))
    pipe.advance(0.5)
    pipe.open_to(0, EndConditions())
    volumes = {"auxiliary": valve.auxiliary_volume, "reservoir": valve.reservoir_volume}

    def in_car() -> float:
        return sum(float(pipe.vehicle_pressures(name)[0]) * volume for name, volume in volumes.items()) / R_T

    in_pipe, before = pipe.mass, in_car()
    low, high = (float(pipe.vehicle_pressures(name)[0]) for name in volumes)
    pipe.advance(120.0)
    after = [float(pipe.vehicle_pressures(name)[0]) for name in volumes]
    assert after[0] == pytest.approx(after[1], rel=BALANCE)
    assert low < after[0] < high - 50e3
    assert in_car() + pipe.mass == pytest.approx(before + in_pipe, rel=1e-9)


def test_a_charged_emergency_reservoir_does_not_feed_a_pipe_that_leaks() -> None:
    """The auxiliary reservoir is charged; the pipe falls by less than the valve feels, and nothing holds it up."""
    pipe, cylinder = bench(car(), CHARGED - 4e3, 20.0)
    assert cylinder < 100.0
    for name in ("auxiliary", "reservoir"):
        assert pipe.vehicle_pressures(name)[0] - AMBIENT == pytest.approx(CHARGED, abs=500.0)


def test_an_empty_car_has_a_share_of_a_loaded_cars_pressure_and_the_pipe_feels_no_difference(tmp_path: Path) -> None:
    """The equalising volume takes the rest of the air, so that a reduction means the same for both cars."""
    rows = [{"kind": "locomotive"}, {"kind": "wagon", "load": 0, "distributor": "aar", "count": 3}]
    device = {"empty_load": 0.5, "retainer": "slow-direct", "accelerated_release": "no"}
    write_consist(consist_of([rows[0], rows[1] | device]), tmp_path / "again.toml")
    again = read_consist(tmp_path / "again.toml")
    assert again.vehicles[2].distributor == consist_of([rows[0], rows[1] | device]).vehicles[2].distributor
    loaded = replace(again.vehicles[1].distributor, empty_share=1.0)
    whole = replace(again, vehicles=(again.vehicles[0], *(replace(v, distributor=loaded) for v in again.vehicles[1:])))
    empty, full = Train(again), Train(whole)
    for position, step, seconds in (("service", 0.3, 4.0), ("service", 1.0, 30.0), ("running", 0.0, 20.0)):
        for one in (empty, full):
            one.drive(position, step)
            one.advance(seconds)
        assert empty.cylinder_pressure[1:] == pytest.approx(0.5 * full.cylinder_pressure[1:], rel=1e-6, abs=1.0)
        assert empty.pipe_pressure == pytest.approx(full.pipe_pressure, rel=1e-9)
    emptied = consist_of([rows[0], rows[1] | device]).vehicles[1]
    rigged = consist_of([rows[0], rows[1] | {"load": 60}]).vehicles[1]
    assert emptied.brake == rigged.brake  # no lever: the device is in its place


def test_quick_service_carries_a_first_step_through_a_long_train() -> None:
    """The first step, 0.4 bar, brakes 60 cars at the speed of the wave; without quick service the end comes later."""
    quick, plain = (train(60, **changes) for changes in ({}, {"bulb_volume": 0.0, "quick_choke": 0.0}))
    for one in (quick, plain):
        one.drive("service", 0.0)
    first, later = begun(quick, 8.0), begun(plain, 8.0)
    assert first[-1] < 4.0
    assert later[-1] > first[-1] + 0.5
    assert plain.cylinder_pressure[-1] < 65e3 < quick.cylinder_pressure[1:].min()


def test_an_emergency_runs_faster_than_the_published_wave_and_a_service_does_not_begin_one() -> None:
    """Published: 280 m/s (920 ft/s). Each car vents the pipe; full service leaves it at 3.5 bar."""
    hard, soft = train(60), train(60)
    hard.drive("emergency")
    times = begun(hard, 10.0)
    wave = 15.0 * 50 / (times[-1] - times[9])
    assert 280.0 < wave < 380.0
    assert hard.pipe_pressure.max() < 5e3
    soft.drive("service", 1.0)
    soft.advance(60.0)
    assert soft.pipe_pressure.min() > 340e3
    hard.advance(30.0)
    assert hard.cylinder_pressure[1:].min() > 1.15 * soft.cylinder_pressure[1:].max()


def test_with_branches_an_emergency_runs_at_a_published_speed() -> None:
    """Published: 244 and 280 m/s (800 and 920 ft/s). Branches of 4 l slow the wave, as in UIC trains."""
    cars = {"kind": "wagon", "length": 15, "distributor": "aar", "count": 60, "branch": 4}
    one = Train(consist_of([{"kind": "locomotive", "brake": "none"}, cars]), settings=Settings(cells=2))
    one.drive("emergency")
    times = begun(one, 6.0)
    assert 244.0 < 15.0 * 50 / (times[-1] - times[9]) < 280.0


def test_the_balance_of_air_closes() -> None:
    one = train(6)
    mass = one.air.mass
    for position in ("service", "running", "emergency"):
        one.drive(position, 0.5)
        one.advance(8.0)
    gone = one.air.passed
    assert one.air.mass + gone.valve_mass + gone.leak_mass + gone.vehicle_mass == pytest.approx(mass, rel=1e-12)


def test_a_consist_states_it_and_its_drivers_valve_and_is_written_again(tmp_path: Path) -> None:
    """Columns: distributor, service_rate [bar/s], exhaust [mm]. What has no effect is refused."""
    rows = [
        {"kind": "locomotive", "service_rate": 0.14, "exhaust": 8},
        {"kind": "wagon", "count": 2, "distributor": "aar"},
    ]
    consist = consist_of(rows)
    valve = consist.vehicles[0].valve
    assert valve is not None
    assert (valve.service_rate, valve.exhaust_area) == pytest.approx((14e3, np.pi / 4 * 0.008**2))
    write_consist(consist, tmp_path / "again.toml")
    assert read_consist(tmp_path / "again.toml").vehicles[1].distributor == consist.vehicles[1].distributor
    for row, name in (
        ({"position": "G"}, "position"),
        ({"full_pressure": 3}, "full_pressure"),
        ({"exhaust": 8}, "exh"),
        ({"distributor": "uic", "retainer": "low"}, "retainer must be of the distributor aar; got uic"),
        ({"distributor": "uic", "accelerated_release": "no"}, "accelerated_release must be of the distributor aar"),
        ({"release_time": 9, "retainer": "slow-direct"}, "release_time has no effect with retainer = slow-direct"),
        ({"fill_time": 9}, "fill_time must be of the distributor uic, ecp, ep_uic, twin_pipe or vacuum; got aar"),
        ({"empty_load": 0.5}, "load or mass of an empty car, at most 40 t in all; got none. Set load to 0"),
        ({"empty_load": 0.5, "mass": 60}, "at most 40 t in all; got 60 t"),
        ({"empty_load": 0.5, "load": 0, "brake_force": 30}, "empty_load must be left out with brake_force"),
        ({"empty_load": 0.5, "load": 0, "weighing": "lever"}, "weighing must be left out with empty_load"),
        ({"empty_load": 0.5, "load": 0, "kind": "coach"}, "left out with the lambda of a coach"),
        ({"empty_load": 1.0, "load": 0}, "empty_load must be a number from 0.3 to 0.9"),
        ({"retainer": "middle"}, "retainer must be one of direct, slow-direct, low, high"),
    ):
        with pytest.raises(ValueError, match=name):
            consist_of([rows[0], rows[1] | row])


@pytest.mark.parametrize("release", [4.0, 40.0])
def test_it_releases_in_the_time_of_a_row(release: float, tmp_path: Path) -> None:
    """It falls from 3.57 to 0.4 bar, which begins as the pipe has risen by 0.2 bar, half a second after the command."""
    row = {"kind": "wagon", "valve": "head", "distributor": "aar", "release_time": release, "retainer": "direct"}
    consist = consist_of([row])
    one = Train(consist)
    one.drive("service", 1.0)
    one.advance(60.0)
    one.drive("running")
    times, pressures = [], []
    while one.cylinder_pressure[0] > 40e3:
        one.advance(0.01)
        times.append(one.time)
        pressures.append(one.cylinder_pressure[0])
    full = consist.vehicles[0].distributor.full_pressure
    begins = float(np.interp(-full, -np.array(pressures), times))
    assert times[-1] - begins == pytest.approx(release, rel=0.01)
    write_consist(consist, tmp_path / "again.toml")
    own, again = consist.vehicles[0].distributor, read_consist(tmp_path / "again.toml").vehicles[0].distributor
    assert list(again.values().values()) == pytest.approx(list(own.values().values()), rel=1e-9)


def test_a_slower_equalising_reservoir_brakes_later() -> None:
    """The pipe at the head follows 0.14 bar/s instead of 0.5: 1.5 bar in 10.7 s instead of 3 s."""
    wagon = {"kind": "wagon", "count": 3}
    falls = []
    for row in ({}, {"service_rate": 0.14}):
        one = Train(consist_of([{"kind": "locomotive"} | row, wagon]))
        one.drive("service", 1.0)
        one.advance(3.0)
        falls.append(500e3 - float(one.pipe_pressure[0]))
    assert falls[0] > 100e3
    assert falls[1] == pytest.approx(3.0 * 14e3, abs=10e3)


def test_each_full_service_takes_the_balances_share_of_what_the_reservoir_has() -> None:
    """Boyle: nothing recharges it, and n applications leave (V_A / (V_A + V_C))^n of its gauge pressure."""
    valve = car(quick_choke=0.0, charging_choke=0.0, emergency_difference=1e7)
    pipe, left = bench(valve, 0.0, 0.0)[0], CHARGED
    for _ in range(3):
        pipe.open_to(0, EndConditions(2e-4, AMBIENT))
        pipe.advance(40.0)
        left *= valve.auxiliary_volume / (valve.auxiliary_volume + valve.cylinder_volume)
        assert pipe.vehicle_pressures("cylinder")[0] - AMBIENT == pytest.approx(left, rel=2 * BALANCE)
        pipe.open_to(0, EndConditions(2e-4, CHARGED + AMBIENT))
        pipe.advance(60.0)
        assert pipe.vehicle_pressures("cylinder")[0] - AMBIENT < 100.0
        assert pipe.vehicle_pressures("auxiliary")[0] - AMBIENT == pytest.approx(left, rel=2 * BALANCE)


def test_a_car_between_two_parted_hoses_empties_its_pipe_and_it_stays_empty() -> None:
    """Steps as long as the pipe allows, in a short car: both ends and the vent of the valve are open at once."""
    cars = {"kind": "wagon", "length": 8, "count": 3, "distributor": "aar"}
    one = Train(consist_of([{"kind": "locomotive", "brake": "none"}, cars]), settings=Settings(cells=1))
    one.inputs["hose_state"] = 2.0
    one.advance(4.0)
    for _ in range(40):
        one.advance(0.37)
        assert np.abs(one.pipe_pressure[1:3]).max() < 500.0
