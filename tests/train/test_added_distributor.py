"""A user-defined distributor takes a file like this one and a line in DISTRIBUTORS. It runs mixed with the built-in
one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from brake_controller.air import AMBIENT, DISCHARGE, GAS_CONSTANT, HEAT_CAPACITY, WALL, effective_area, elliptic_flow
from brake_controller.distributors import DISTRIBUTORS
from brake_controller.distributors.distributor import Answer, Distributor, DistributorParameters, Moment
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.system import quantity
from products.train.consist import Consist, TrainVehicle, block_train
from products.train.consist_file import consist_of
from products.train.fmu import build_train_fmu
from products.train.numbers import Settings
from products.train.pipe import Outside, Pipe
from products.train.train import Train

# ---- the distributor -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class DirectDistributor(DistributorParameters):
    """A direct-acting valve: the pipe itself feeds the cylinder. When released, both are empty."""

    choke: float = quantity("m", "Diameter of the choke between pipe and cylinder", 1e-4)
    volume: float = quantity("m3", "Volume of the cylinders", 1e-4)
    meter_volume: float = quantity("m3", "Volume of a chamber beside the cylinder", 1e-5)


def direct(moment: Moment) -> Answer:
    """Return rates and flows, V dp/dt = R T G (ideal gas), flows by ISO 6358-1."""
    p, line, air_temperature = moment.given, moment.pipe.pressure, moment.pipe.temperature
    cylinder, meter = moment.states["cylinder"], moment.states["meter"]
    area, specific = effective_area(p["choke"], ca.SX(DISCHARGE)), GAS_CONSTANT * WALL

    def net(chamber: ca.SX, full: ca.SX | float = 0) -> ca.SX:
        into, out = elliptic_flow(area, line, air_temperature, chamber), elliptic_flow(area, chamber, ca.SX(WALL), line)
        return ca.if_else(full, 0, into) - out

    fills = (1 - p["held"]) * net(cylinder, cylinder > p["full_pressure"] + AMBIENT)
    vents = p["vented"] * elliptic_flow(area, cylinder, ca.SX(WALL), ca.SX(AMBIENT))
    beside = net(meter)
    rates = {
        "cylinder": specific * (fills - vents) / p["volume"],
        "meter": specific * beside / p["meter_volume"],
    }
    taken = fills + beside
    return Answer(rates, taken, HEAT_CAPACITY * taken * ca.if_else(taken > 0, air_temperature, WALL), fills)


def of_choke(position: str) -> DirectDistributor:
    """Return a built-in parameter set; its choke is narrower in position G."""
    choke = {"P": 3e-3, "G": 1e-3}[position]
    return DirectDistributor(full_pressure=300e3, choke=choke, volume=10e-3, meter_volume=10e-3)


def pace(p: DirectDistributor) -> float:
    """Return a bound on the rate at which the volumes settle [1/s]."""
    return float(30.0 * GAS_CONSTANT * WALL * p.choke**2 / min(p.volume, p.meter_volume))


DIRECT = Distributor(
    name="direct",
    parameters=DirectDistributor,
    states=(("meter", "around"), ("cylinder", "cylinder")),
    ready=of_choke,
    whole=direct,
    pace=pace,
)

# ---- and what it does in a train -------------------------------------------------------------------------------------


@pytest.fixture(autouse=True)
def _added(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(DISTRIBUTORS, DIRECT.name, DIRECT)


def every_second(wagons: int) -> Consist:
    """Return a train in which every second wagon has the new distributor."""
    vehicles = block_train(wagons).vehicles
    return Consist(tuple(replace(v, distributor=of_choke("P")) if n % 2 else v for n, v in enumerate(vehicles)))


def test_its_cylinder_has_the_pressure_of_the_pipe() -> None:
    """On the bench, both chambers follow the pipe up to the largest pressure. States of the built-in one are NaN."""
    pipe = Pipe(4, pressure=AMBIENT, length=7.5, diameter=0.03175)
    pipe.connect([1, 3], [of_choke("P"), of_choke("G")], AMBIENT)
    pipe.open_to(0, Outside(2e-4, 200e3 + AMBIENT))
    pipe.advance(120.0)
    assert pipe.vehicle_pressures("cylinder") == pytest.approx([200e3 + AMBIENT] * 2, rel=1e-3)
    assert pipe.vehicle_pressures("meter") == pytest.approx(pipe.vehicle_pressures("cylinder"), rel=1e-9)
    assert np.isnan(pipe.vehicle_pressures("auxiliary")).all()
    pipe.open_to(0, Outside(2e-4, 500e3 + AMBIENT))
    pipe.advance(60.0)
    assert pipe.vehicle_pressures("cylinder") == pytest.approx([300e3 + AMBIENT] * 2, rel=2e-2)


def test_in_a_mixed_train_each_vehicle_brakes_by_its_own() -> None:
    """When released, the pipe is full: direct cylinders are full and others empty. An emergency reverses this."""
    train = Train(every_second(8))
    mass, vehicles = train.air.mass, np.arange(9)
    train.advance(30.0)
    assert (train.cylinder_pressure[vehicles % 2 == 1] > 290e3).all()
    assert (train.cylinder_pressure[vehicles % 2 == 0] < 1e3).all()
    kept = train.state
    train.drive("emergency")
    train.advance(30.0)
    assert (train.cylinder_pressure[vehicles % 2 == 1] < 50e3).all()
    assert (train.cylinder_pressure[vehicles % 2 == 0] > 370e3).all()
    gone = train.air.passed
    left = gone.valve_mass + gone.leak_mass + gone.vehicle_mass
    assert train.air.mass + left == pytest.approx(mass, rel=1e-12)
    after = train.state
    train.state = kept
    train.drive("emergency")
    train.advance(30.0)
    assert np.array_equal(train.state, after, equal_nan=True)


@pytest.mark.parametrize("brake_model", ["whole", "empirical", "delay"])
def test_protection_holds_and_vents_the_cylinder_of_the_vehicle_that_it_commands(brake_model: str) -> None:
    train = Train(every_second(4), settings=Settings(brake_model))
    train.advance(30.0)
    train.inputs["protection"][:4] = [2.0, 2.0, 0.0, 0.0]
    train.advance(20.0)
    assert train.cylinder_pressure[1] < train.cylinder_pressure[3] - 100e3


def test_vehicles_beside_it_do_as_they_did() -> None:
    """Kinds share the pipe only: without flow of air, the built-in distributors fill as in an unmixed train.

    The tolerance is the error of the steps, which are as long as the fastest kind allows.
    """
    mixed, plain = (Train(consist, settings=Settings("delay")) for consist in (every_second(9), block_train(9)))
    for train in (mixed, plain):
        train.drive("service", 0.7)
        train.advance(9.0)
    assert mixed.cylinder_pressure[::2] == pytest.approx(plain.cylinder_pressure[::2], rel=2e-4)


def test_a_consist_picks_it_by_its_name_and_an_fmu_has_it(tmp_path: Path) -> None:
    rows = [{"kind": "locomotive"}, {"kind": "wagon", "count": 2}, {"kind": "wagon", "distributor": "direct"}]
    consist = consist_of([*rows, {"kind": "coach", "distributor": "direct", "position": "G"}])
    kinds = [type(one.distributor) is DirectDistributor for one in consist.vehicles]
    assert kinds == [False, False, False, True, True]
    assert consist.vehicles[-1].distributor == of_choke("G")
    assert consist.vehicles[-1].percentage > 0.0
    build_train_fmu(consist, tmp_path / "train.fmu", 2)
    own = Train(consist)
    own.advance(1.0)
    with FmuInstance(tmp_path / "train.fmu") as fmu:
        fmu.start()
        fmu.step(0.0, 1.0)
        found = fmu.get([f"cylinder_pressure[{n}]" for n in range(1, 6)])
    assert np.array_equal(found, own.cylinder_pressure)


def test_what_is_no_distributor_is_refused() -> None:
    wrong: TrainVehicle = replace(block_train(1).vehicles[0], distributor="uic")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"must be parameters of uic, .*direct; got 'uic'"):
        Train(Consist((wrong,)))
    with pytest.raises(ValueError, match=r"distributor must be one of uic, .*direct; got knorr"):
        consist_of([{"kind": "locomotive", "distributor": "knorr"}])
    with pytest.raises(ValueError, match="small letters, digits and underscores; got 'Mine'"):
        replace(DIRECT, name="Mine")
    with pytest.raises(ValueError, match="one must be called cylinder"):
        replace(DIRECT, states=(("meter", "around"),))
