"""The distributor on a test bench and in a train: times, sensitivity, insensitivity, release, balances of air."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from brake_controller.distributors.uic import UIC, UicDistributor, fastest_change, freight
from products.train.consist import block_train
from products.train.numbers import Settings
from products.train.pipe import EndConditions, Pipe
from products.train.train import Train

AMBIENT, R, WARM = 101325.0, 287.05287, 293.15
FULL, RUNNING = 380e3, 500e3
DIAMETER, STEP = 0.03175, 0.01
SOUND = math.sqrt(1.4 * R * WARM)
#: UIC 540: filling to 95 % and release to 0.4 bar [s], by position.
WINDOWS = {"P": ((3.0, 5.0), (15.0, 20.0)), "G": ((18.0, 30.0), (45.0, 60.0))}
Course = NDArray[np.float64]


def train(vehicles: int = 1, position: str = "P", cells: int = 2, **values: float) -> Pipe:
    """Return vehicles of 15 m with charged pipe and reservoirs, and distributors at mid-length."""
    pipe = Pipe(cells * vehicles, pressure=RUNNING + AMBIENT, length=15.0 / cells, diameter=DIAMETER)
    own = replace(freight(position), **values)
    pipe.connect([cells * n + cells // 2 for n in range(vehicles)], [own] * vehicles, RUNNING + AMBIENT)
    return pipe


def fed(pipe: Pipe, pressure: Callable[[float], float], seconds: float) -> Course:
    """Return gauge pressures of the last vehicle: cylinder, pipe and auxiliary reservoir, every STEP [Pa].

    pressure: gauge pressure at a large opening at the first end.
    """
    course = []
    for number in range(round(seconds / STEP)):
        pipe.open_to(0, EndConditions(2e-4, pressure(number * STEP) + AMBIENT))
        pipe.advance(STEP)
        cylinder, auxiliary = (pipe.vehicle_pressures(name)[-1] for name in ("cylinder", "auxiliary"))
        course.append([cylinder, pipe.pressure[-1], auxiliary])
    return np.array(course) - AMBIENT


def when(course: Course, reached: Callable[[Course], NDArray[np.bool_]]) -> float:
    """Return the first time at which the cylinder pressure fulfils a condition [s]."""
    found = np.flatnonzero(reached(course[:, 0]))
    return float(found[0] * STEP) if found.size else math.inf


# ---- on the bench ----------------------------------------------------------------------------------------------------


@pytest.mark.study
@pytest.mark.parametrize("position", ["P", "G"])
def test_a_cylinder_fills_and_empties_in_the_times_of_the_standard(position: str) -> None:
    pipe = train(position=position)
    applied = fed(pipe, lambda _: 300e3, 60.0)
    (least, most), (soonest, latest) = WINDOWS[position]
    assert least < when(applied, lambda p: p > 0.95 * FULL) < most
    assert applied[-1, 0] == pytest.approx(FULL, rel=1e-3)
    released = fed(pipe, lambda _: RUNNING, 70.0)
    assert soonest < when(released, lambda p: p < 40e3) < latest


@pytest.mark.study
@pytest.mark.parametrize("position", ["P", "G"])
def test_it_feels_a_fall_of_a_tenth_of_a_bar_a_second_and_no_leak(position: str) -> None:
    """UIC 540: it applies within 1.2 s if the pipe loses 0.6 bar in 6 s, and not at all if it loses 0.3 bar in 60 s."""
    falls = fed(train(position=position), lambda t: RUNNING - 10e3 * t, 3.0)
    assert when(falls, lambda p: p > 1e3) < 1.2
    leaks = fed(train(position=position), lambda t: RUNNING - 500.0 * t, 60.0)
    assert leaks[:, 0].max() < 1.0
    clogged = fed(train(position=position, control_choke=0.059e-3), lambda t: RUNNING - 500.0 * t, 60.0)
    assert clogged[:, 0].max() > 1e3


@pytest.mark.study
@pytest.mark.parametrize("fall", [60e3, 100e3, 140e3])
def test_the_cylinder_follows_the_pipe_in_steps_down_and_up(fall: float) -> None:
    """3.8 bar for a drop of 1.5 bar, within the 2 % that a relay needs to open. The brake releases gradually."""
    pipe = train()
    for level in (fall, fall / 2, fall):
        course = fed(pipe, lambda _, level=level: RUNNING - level, 40.0)  # type: ignore[misc]
        assert course[-1, 0] == pytest.approx(FULL / 150e3 * level, abs=0.03 * FULL)


@pytest.mark.study
def test_a_small_auxiliary_reservoir_does_not_reach_the_full_pressure() -> None:
    """Isothermal volumes reach one pressure: (V_R p_R + V_C p_a) / (V_R + V_C), absolute. The pipe is empty."""
    volume = 20e-3
    course = fed(train(auxiliary_volume=volume), lambda _: 0.0, 60.0)
    cylinder = freight().cylinder_volume
    together = (volume * (RUNNING + AMBIENT) + cylinder * AMBIENT) / (volume + cylinder) - AMBIENT
    assert together < FULL
    assert course[-1, [0, 2]] == pytest.approx([together, together], rel=0.02)


@pytest.mark.study
def test_each_application_takes_a_cylinder_of_air_from_the_reservoir() -> None:
    """Boyle: nothing recharges it, and n applications take n V_C / V_A of the cylinder's gauge pressure."""
    pipe, left = train(auxiliary_choke=0.0), RUNNING
    for _ in range(2):
        course = fed(pipe, lambda _: 300e3, 15.0)
        left -= course[-1, 0] * freight().cylinder_volume / freight().auxiliary_volume
        assert course[-1, [0, 2]] == pytest.approx([FULL, left], rel=0.02)
        assert fed(pipe, lambda _: RUNNING, 25.0)[-1, 2] == pytest.approx(left, rel=2e-3)


# ---- in the train ----------------------------------------------------------------------------------------------------


def wave(cells: int, vehicles: int = 50, **values: float) -> float:
    """Return the speed [m/s] at which cylinders begin to fill after an emergency application, beyond ten vehicles."""
    pipe = train(vehicles, cells=cells, **values)
    pipe.open_to(0, EndConditions(4e-4))
    begun = np.full(vehicles, math.nan)
    time = 0.0
    while np.isnan(begun).any():
        pipe.advance(STEP)
        time += STEP
        begun[np.isnan(begun) & (pipe.vehicle_pressures("cylinder") > AMBIENT + 10e3)] = time
    return float(15.0 * (vehicles - 11) / (begun[-1] - begun[10]))


def test_an_emergency_runs_faster_than_asked_and_with_fine_cells_no_faster_than_sound() -> None:
    """UIC 540 requires 250 m/s. A smeared front trips accelerators early: with two cells a vehicle, 7 % above sound."""
    coarse, middle, fine = wave(2), wave(4), wave(12)
    assert 250.0 < fine < 1.03 * SOUND
    assert fine < middle < coarse < 1.15 * SOUND
    assert fine - SOUND < (coarse - SOUND) / 2
    assert 250.0 < wave(2, accelerator_volume=0.0) < SOUND


def test_air_of_pipe_and_vehicles_closes() -> None:
    """The vehicles' air is in their volumes. Accelerators would vent it again; they are negligible here."""
    pipe = train(12, accelerator_volume=1e-9)
    mass, energy = pipe.mass, pipe.energy
    volumes = {name: getattr(freight(), f"{name}_volume") for name, _ in UIC.states if name != "accelerator"}

    def in_vehicles() -> float:
        return sum(float(pipe.vehicle_pressures(name).sum()) * volume / (R * WARM) for name, volume in volumes.items())

    before = in_vehicles()
    pipe.open_to(0, EndConditions(1e-4))
    pipe.advance(6.0)
    gone = pipe.passed
    assert pipe.mass + sum(gone.end_mass) + gone.vehicle_mass == pytest.approx(mass, rel=1e-12)
    assert pipe.energy + sum(gone.end_energy) + gone.vehicle_energy - gone.heat == pytest.approx(energy, rel=1e-9)
    # The last cylinders have just begun to fill; none has released.
    assert in_vehicles() - before == pytest.approx(gone.vehicle_mass, abs=1e-6 * before)
    assert gone.cylinder_mass > 0.0


def test_trains_at_random_stay_above_zero() -> None:
    draw = np.random.default_rng(34)
    for _ in range(3):
        vehicles = int(draw.integers(1, 9))
        scale = {
            field.name: getattr(freight(), field.name) * draw.choice([0.7, 1.0, 1.4])
            for field in fields(UicDistributor)
            if field.name.endswith(("volume", "choke"))
        }
        pipe = train(vehicles, str(draw.choice(["P", "G"])), **scale)
        for _ in range(4):
            pipe.open_to(
                int(draw.integers(2)), EndConditions(draw.choice([0.0, 1e-5, 4e-4]), draw.choice([AMBIENT, 6.5e5]))
            )
            pipe.advance(draw.uniform(0.1, 2.0))
            assert (pipe.pressure > 0.0).all()
            for name, _ in UIC.states:
                assert (pipe.vehicle_pressures(name) > 0.5 * AMBIENT).all()


def test_volumes_of_one_size_do_not_hide_the_faster_of_them() -> None:
    """The wagon's cylinder has a wide choke; a control chamber of the same volume has a narrow one."""
    alike = replace(freight(), control_volume=freight().cylinder_volume)
    assert fastest_change(alike) == pytest.approx(fastest_change(freight()), rel=1e-12)


def test_steps_are_as_short_as_the_fastest_volume_asks() -> None:
    """A cylinder of a tenth of its volume fills as with quarter steps. Steps at the CFL limit alone would be wrong."""
    small = {"cylinder_volume": 1e-3, "inshot_choke": 12e-3}
    ways = []
    for courant in (0.8, 0.2):
        pipe = train(2, **small)
        pipe.open_to(0, EndConditions(4e-4))
        course = []
        for _ in range(100):
            pipe.advance(0.02, courant)
            course.append(pipe.vehicle_pressures("cylinder")[0])
        ways.append(np.array(course))
    assert np.abs(ways[0] - ways[1]).max() < 0.02 * FULL


@pytest.mark.parametrize("brake_model", ["whole", "empirical", "delay"])
def test_a_cylinder_that_protection_vents_empties_to_the_surroundings(brake_model: str) -> None:
    """Air does not flow out of a cylinder that has no more than the pressure around it (ISO 6358-1)."""
    one = Train(block_train(2), cylinder=380e3, settings=Settings(brake_model))
    one.drive("emergency")
    one.inputs["protection"] = 2
    lowest = np.inf
    for _ in range(60):
        one.advance(0.05)
        lowest = min(lowest, float(one.cylinder_pressure.min()))
    assert lowest > -100.0
    assert one.cylinder_pressure == pytest.approx([0.0] * 3, abs=100.0)
