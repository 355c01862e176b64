"""A twin pipe: reservoirs stay full over repeated applications, and the brake pipe only controls."""

from __future__ import annotations

from dataclasses import replace

import pytest

from brake_controller.distributors import twin_pipe, uic
from brake_controller.distributors.uic import UicDistributor
from products.train.pipe import EndConditions, Pipe

AMBIENT, RUNNING, FULL = 101325.0, 500e3, 380e3


def applied(one: UicDistributor, times: int) -> tuple[float, float, float]:
    """Return gauge pressures of reservoir and cylinder [Pa] after applications, and the air from the pipe [kg]."""
    pipe = Pipe(2, pressure=RUNNING + AMBIENT, length=7.5, diameter=0.03175)
    pipe.connect([1], [one], RUNNING + AMBIENT)
    for _ in range(times):
        for pressure, seconds in ((RUNNING, 6.0), (330e3, 6.0)):
            pipe.open_to(0, EndConditions(2e-4, pressure + AMBIENT))
            pipe.advance(seconds)
    left = [float(pipe.vehicle_pressures(name)[0]) - AMBIENT for name in ("auxiliary", "cylinder")]
    return left[0], left[1], pipe.passed.vehicle_mass


def test_its_reservoir_stays_full_where_that_of_one_pipe_falls() -> None:
    """A choke of 1 mm charges slowly; the main pipe does so in braking, too. Air of the cylinder is not the pipe's."""
    alone = applied(replace(uic.freight(), auxiliary_choke=1e-3), 6)
    twin = applied(replace(twin_pipe.ready("P"), auxiliary_choke=1e-3), 6)
    assert twin[0] > alone[0] + 15e3
    assert twin[1] == pytest.approx(FULL, rel=0.02)
    assert twin[2] < 0.5 * alone[2]


def test_only_the_main_pipe_charges_its_reservoir() -> None:
    """A main pipe of 3 bar beside a brake pipe of 5 bar: the reservoir ends at 3 bar, at the choke of the charging."""
    pipe = Pipe(2, pressure=250e3 + AMBIENT, length=7.5, diameter=0.03175)
    pipe.connect([1], [replace(twin_pipe.ready("P"), main_pressure=300e3)], 250e3 + AMBIENT)
    pipe.open_to(0, EndConditions(2e-4, RUNNING + AMBIENT))
    pipe.advance(60.0)
    assert pipe.pressure[1] - AMBIENT == pytest.approx(RUNNING, rel=0.01)
    assert pipe.vehicle_pressures("auxiliary")[0] - AMBIENT == pytest.approx(300e3, rel=0.01)
