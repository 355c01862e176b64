"""The protection from the public description: one valve a bogie, a difference of speeds, seven seconds."""

import pytest

from bogie_braking.controllers.controller_loader import controller_of
from products.controller_kinds import OneInC, compiled
from products.protection.rig_in_c import RIG

APPLY, VENT = 0, 2


@pytest.fixture
def coach():
    """A protection of four wheelsets at 5 ms."""
    return OneInC(compiled(RIG / "dump_valve.c"), 4, 5e-3)


def test_the_valve_releases_for_seven_seconds_and_never_again(coach):
    """The other bogie is braked all the time; after the lock-out even a rolling wheel brings nothing back."""
    given = [coach.step(0.005 * i, [20.0, 15.0, 20.0, 20.0]) for i in range(3000)]
    assert given == [[VENT, VENT, APPLY, APPLY]] * 1400 + [[APPLY] * 4] * 1600
    coach.step(15.0, [20.0] * 4)
    assert coach.step(15.005, [20.0, 0.0, 20.0, 20.0]) == [APPLY] * 4
    assert coach.step(15.010, [20.0, 0.0, 20.0, 0.0]) == [APPLY, APPLY, VENT, VENT]


def test_the_seven_seconds_begin_anew_when_the_wheel_rolls_in_between(coach):
    """Two releases of 6.995 s."""
    for _ in range(2):
        assert {tuple(coach.step(0.0, [20.0, 15.0, 20.0, 20.0])) for _ in range(1399)} == {(2, 2, 0, 0)}
        for _ in range(20):  # it slowed long ago: no reading left that it could have sped up from
            assert coach.step(0.0, [20.0, 20.0, 20.0, 20.0]) == [APPLY] * 4


def test_it_opens_above_one_difference_and_closes_below_another(coach):
    """1.5 and 0.5 m/s; the slow wheel changes by 4 m/s2, which closes nothing."""
    speed = 20.0
    for slow, command in ((18.6, APPLY), (18.4, VENT), (19.4, VENT), (19.6, APPLY), (18.6, APPLY)):
        while speed != slow:
            speed = min(speed + 0.02, slow) if slow > speed else max(speed - 0.02, slow)
            found = coach.step(0.0, [20.0, 20.0, 20.0, speed])
        assert found == [APPLY, APPLY, command, command], slow


@pytest.mark.parametrize(("rate", "command"), [(4.9, VENT), (5.1, APPLY)])
def test_it_closes_while_the_slow_wheel_speeds_up(coach, rate, command):
    """It closes at 5 m/s2, measured over 0.1 s."""
    for i in range(40):
        found = coach.step(0.005 * i, [20.0, 10.0 + rate * 0.005 * i, 20.0, 20.0])
    assert found == [command, command, APPLY, APPLY]


def test_the_command_line_has_it_by_name():
    """`controllers compare dump-valve` finds it."""
    assert controller_of("dump-valve", 2)[0] == "dump-valve"
