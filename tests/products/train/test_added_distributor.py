"""A user-defined distributor takes a file like this one and a line in DISTRIBUTORS. It runs mixed with the built-in
one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from brake_controller.air import AMBIENT, DISCHARGE, GAS_CONSTANT, HEAT_CAPACITY, WALL, effective_area, elliptic_flow
from brake_controller.distributors import DISTRIBUTORS, kind_of
from brake_controller.distributors.checking import check_distributor
from brake_controller.distributors.distributor import Answer, Distributor, DistributorParameters, Moment
from brake_controller.distributors.uic import UIC, UicDistributor
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.system import quantity
from products.building import write_in_c
from products.train import library
from products.train.consist import Consist, TrainVehicle, block_train
from products.train.consist_file import consist_of
from products.train.consist_writer import rows_of
from products.train.fmu import train_fmu
from products.train.numbers import Settings
from products.train.pipe import EndConditions, Pipe
from products.train.train import Train
from tests.products.train.chains import without_added_kinds

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


@pytest.mark.study
def test_its_cylinder_has_the_pressure_of_the_pipe() -> None:
    """On the bench, both chambers follow the pipe up to the largest pressure. States of the built-in one are NaN."""
    pipe = Pipe(4, pressure=AMBIENT, length=7.5, diameter=0.03175)
    pipe.connect([1, 3], [of_choke("P"), of_choke("G")], AMBIENT)
    pipe.open_to(0, EndConditions(2e-4, 200e3 + AMBIENT))
    pipe.advance(120.0)
    assert pipe.vehicle_pressures("cylinder") == pytest.approx([200e3 + AMBIENT] * 2, rel=1e-3)
    assert pipe.vehicle_pressures("meter") == pytest.approx(pipe.vehicle_pressures("cylinder"), rel=1e-9)
    assert np.isnan(pipe.vehicle_pressures("auxiliary")).all()
    pipe.open_to(0, EndConditions(2e-4, 500e3 + AMBIENT))
    pipe.advance(60.0)
    assert pipe.vehicle_pressures("cylinder") == pytest.approx([300e3 + AMBIENT] * 2, rel=2e-2)


@pytest.mark.study
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


@pytest.mark.study
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


@pytest.mark.study
def test_a_consist_picks_it_by_its_name_and_an_fmu_has_it(tmp_path: Path) -> None:
    rows = [{"kind": "locomotive"}, {"kind": "wagon", "count": 2}, {"kind": "wagon", "distributor": "direct"}]
    consist = consist_of([*rows, {"kind": "coach", "distributor": "direct", "position": "G"}])
    kinds = [type(one.distributor) is DirectDistributor for one in consist.vehicles]
    assert kinds == [False, False, False, True, True]
    assert consist.vehicles[-1].distributor == of_choke("G")
    assert consist.vehicles[-1].percentage > 0.0
    write_in_c(train_fmu(consist), tmp_path / "train.fmu", 2)
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
    with pytest.raises(ValueError, match="different names"):
        replace(DIRECT, states=(*DIRECT.states, ("meter", "around")))
    with pytest.raises(ValueError, match="empirical_pace of the distributor direct must be above 0"):
        replace(DIRECT, empirical=direct)
    with pytest.raises(ValueError, match="empirical_pace of the distributor direct must come with empirical"):
        replace(DIRECT, empirical_pace=3.0)


ROWS = [{"kind": "locomotive"}, {"kind": "wagon", "distributor": "direct", "count": 2}]


@dataclass(frozen=True)
class Bare(DistributorParameters):
    """A choke without a unit."""

    choke: float = 1.0


@dataclass(frozen=True)
class Commanded(DistributorParameters):
    """A parameter with the name of a command."""

    held: float = quantity("1", "Share", 0.0)


UNUSABLE = {
    "parameters of another": ({"parameters": UicDistributor, "ready": UIC.ready}, "UicDistributor for uic and direct"),
    "another set": ({"ready": UIC.ready}, "return DirectDistributor for position P; got UicDistributor"),
    "another set in G": (
        {"ready": lambda position: of_choke("P") if position == "P" else None},
        "return DirectDistributor for position G; got NoneType",
    ),
    "no pressure": (
        {"ready": lambda _: replace(of_choke("P"), full_pressure=0.0)},
        "full_pressure above 0 Pa",
    ),
    "not at rest": ({"pace": lambda p: 0.0}, "pace of the distributor direct must be above 0 1/s .* got 0"),
    "backwards": ({"pace": lambda p: -30.0}, "got -30"),
    "unknown pace": ({"pace": lambda p: float("nan")}, "got nan"),
    "endless pace": ({"pace": lambda p: float("inf")}, "got inf"),
    "a column that does not exist": (
        {"adjustable": ("pressure",)},
        "among full_pressure, .* got 'pressure'",
    ),
    "a column of UIC": ({"adjustable": ("fill_time",)}, "come with parameters of UicDistributor"),
    "no unit": ({"parameters": Bare}, "choke of the distributor direct must have a unit"),
    "a command": ({"parameters": Commanded}, "must not be called .* got held"),
    "not of distributors": ({"parameters": Consist}, "must be a DistributorParameters; got Consist"),
}


@pytest.mark.parametrize("case", UNUSABLE)
def test_a_kind_that_cannot_be_used_is_refused_before_any_train(monkeypatch: pytest.MonkeyPatch, case: str) -> None:
    """Without the check, most of these run, some with the equations of another kind."""
    changes, words = UNUSABLE[case]
    monkeypatch.setitem(DISTRIBUTORS, "direct", replace(DIRECT, **changes))
    for use in (
        lambda: consist_of([{"kind": "wagon", "valve": "head"}]),
        library.sources,
        lambda: kind_of(UIC.ready("P")),
    ):
        with pytest.raises(ValueError, match=words):
            use()


def test_a_name_is_that_of_one_kind(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(DISTRIBUTORS, "direkt", DIRECT)
    with pytest.raises(ValueError, match="each kind once; got the name direct at 'direct' and 'direkt'"):
        consist_of(ROWS)
    monkeypatch.delitem(DISTRIBUTORS, "direct")
    with pytest.raises(ValueError, match="each kind by its name; got 'direkt' for direct"):
        consist_of(ROWS)


def test_a_consist_sets_only_what_a_kind_has(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pressure that the equations ignore would state another force than acts."""

    def made(**columns: object) -> Consist:
        return consist_of([ROWS[0], ROWS[1] | columns])

    without_added_kinds(monkeypatch, "direct")
    uic = "must be of the distributor uic, ep_uic or twin_pipe; got direct"
    for name, value, words in (
        ("full_pressure", 3.0, f"full_pressure {uic}"),
        ("fill_time", 4.0, "fill_time must be of the distributor uic, ecp, ep_uic, twin_pipe or vacuum; got direct"),
        ("auxiliary", 100.0, "auxiliary must be of the distributor uic, ep_uic, twin_pipe or vacuum; got direct"),
        ("empty_load", 0.5, "empty_load must be of the distributor aar; got direct"),
        ("dead_time", 0.5, "dead_time has no effect with distributor = direct"),
    ):
        with pytest.raises(ValueError, match=words):
            made(**{name: value})
    assert made(position="G").vehicles[1].distributor == of_choke("G")
    monkeypatch.setitem(DISTRIBUTORS, "direct", replace(DIRECT, ready=lambda _: of_choke("P")))
    with pytest.raises(ValueError, match="position has no effect with distributor = direct"):
        made(position="G")
    monkeypatch.setitem(DISTRIBUTORS, "direct", replace(DIRECT, adjustable=("full_pressure",)))
    assert made(full_pressure=2.0).vehicles[1].distributor == replace(of_choke("P"), full_pressure=200e3)


def test_a_consist_with_it_is_written_again() -> None:
    consist = consist_of(ROWS)
    again = consist_of(rows_of(consist))
    assert [one.distributor for one in again.vehicles] == [one.distributor for one in consist.vehicles]
    assert "position" in rows_of(consist)[1]
    narrow = replace(consist.vehicles[1].distributor, full_pressure=100e3)
    with pytest.raises(ValueError, match="its full_pressure has none"):
        rows_of(Consist((consist.vehicles[0], replace(consist.vehicles[1], distributor=narrow))))


def _read(**changed: object) -> Callable[[Moment], Answer]:
    return lambda moment: replace(direct(moment), **changed)  # type: ignore[arg-type]


FAULTS: dict[str, tuple[Callable[[Moment], Answer], str]] = {
    "a rate too few": (_read(rates={"cylinder": 0.0}), "a rate for each of meter, cylinder; it lacks meter. Correct"),
    "a rate too many": (
        _read(rates={"meter": 0.0, "cylinder": 0.0, "slide": 1.0}),
        "a rate for each of meter, cylinder; it has slide too",
    ),
    "a misspelt parameter": (
        lambda m: _read(taken=m.given["chok"])(m),
        r"reads given\['chok'\], .* full_pressure, choke",
    ),
    "a misspelt state": (
        lambda m: _read(taken=m.states["slide"])(m),
        r"reads states\['slide'\], .* are meter, cylinder",
    ),
    "a branch": (
        lambda m: _read(taken=1.0 if m.states["meter"] > 1e5 else 0.0)(m),
        r"if, and, or, min or max \(test_added_distributor.py, line \d+\). Write ca.if_else",
    ),
    "another error": (lambda m: _read(taken=m.pipe.pressures)(m), r"fails in test_added_distributor.py, line \d+: "),
    "nothing": (lambda m: None, "must return an Answer"),  # type: ignore[arg-type, return-value]
    "a vector": (_read(taken=ca.SX.zeros(2)), "a number or a symbol for taken; got"),
    "a rate of nothing": (_read(rates={"meter": None, "cylinder": 0.0}), "for the rate of meter; got None"),
}


@pytest.mark.parametrize("case", FAULTS)
def test_a_fault_in_its_equations_has_one_message_with_its_name(case: str) -> None:
    whole, words = FAULTS[case]
    with pytest.raises(ValueError, match=f"^whole of the distributor direct .*{words}"):
        replace(DIRECT, whole=whole).function("whole")


@pytest.mark.study
@pytest.mark.parametrize("name", [*DISTRIBUTORS, "direct"])
def test_a_bench_passes_each_kind(name: str) -> None:
    check_distributor(DISTRIBUTORS[name])


def _of(**without: float) -> Callable[[Moment], Answer]:
    """Return the equations with other values of parameters or commands."""
    return lambda moment: direct(replace(moment, given={**moment.given, **without}))


def _answering(change: Callable[[Answer], dict[str, object]]) -> Callable[[Moment], Answer]:
    return lambda moment: replace(direct(moment), **change(direct(moment)))  # type: ignore[arg-type]


def _rate(name: str, change: Callable[[ca.SX], ca.SX]) -> Callable[[Moment], Answer]:
    return _answering(lambda answer: {"rates": {**answer.rates, name: change(ca.SX(answer.rates[name]))}})


def steepest(choke: float) -> float:
    """Return the slope of the flow near equal pressures, times R T [m3/s]: a parabola up to 0.1 % (ISO 6358-1)."""
    ratio, critical = 1e-3, (2 / 2.4) ** 3.5
    choked = (1.4 * (2 / 2.4) ** 6) ** 0.5
    place = 1 - ratio / (1 - critical)
    value, slope = choked * (1 - place**2) ** 0.5, choked * place / (1 - critical) / (1 - place**2) ** 0.5
    area = DISCHARGE * np.pi / 4 * choke**2
    return float(area * (2 * value / ratio - slope) * (GAS_CONSTANT * WALL) ** 0.5)


BENCH_FAULTS: dict[str, tuple[dict[str, object], str]] = {
    "a slow pace": ({"pace": lambda p: 0.95 * steepest(p.choke) / 10e-3}, r"pace of .* must be at least 11\.4"),
    "air into the pipe": ({"whole": _answering(lambda a: {"taken": -ca.fabs(a.taken)})}, "from 601325 Pa in the"),
    "air out of an empty pipe": (
        {"whole": _answering(lambda a: {"taken": ca.fabs(a.taken)})},
        "into a pipe at ambient",
    ),
    "air of the walls": (
        {"whole": _answering(lambda a: {"enthalpy": HEAT_CAPACITY * WALL * a.taken})},
        "times the temperature of the pipe",
    ),
    "heat against the flow": (
        {"whole": _answering(lambda a: {"enthalpy": ca.fabs(a.enthalpy)})},
        "enthalpy of .* must have the sign of taken",
    ),
    "below the surroundings": ({"whole": _rate("meter", lambda r: -r)}, "meter of .* must not fall below"),
    "without a limit": ({"whole": _rate("meter", lambda r: r * ca.sqrt(r))}, "meter of .* must be finite; got nan"),
    "another pressure": ({"whole": _of(full_pressure=200e3)}, r"must come to full_pressure, 300000 Pa.* comes to 2005"),
    "a pressure without effect": (
        {"whole": _of(full_pressure=300e3), "adjustable": ("full_pressure",)},
        r"full_pressure, 240000 Pa.* take it out of adjustable",
    ),
    "not held": ({"whole": _of(held=0.0)}, "held must hold the cylinder of whole of the distributor direct"),
    "not vented": ({"whole": _of(vented=0.0)}, "vented must empty the cylinder of whole of the distributor direct"),
}


@pytest.mark.parametrize("case", BENCH_FAULTS)
def test_a_bench_finds_what_a_train_would_simulate(case: str) -> None:
    changes, words = BENCH_FAULTS[case]
    with pytest.raises(ValueError, match=words):
        check_distributor(replace(DIRECT, **changes))  # type: ignore[arg-type]
