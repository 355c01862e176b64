"""Messages of figures follow from the data, which are written here."""

from __future__ import annotations

import pytest

from bogie_braking.reporting.plots import plt
from fmu_src.cosimulation.recording import Recording
from rbd_model.track.line import arc, line_of, straight
from scenarios.brakes import uneven_brakes
from scenarios.brakes.uneven_brakes import UnevenStop
from scenarios.lines import line_from_file
from scenarios.thesis import heavy_braking, qr30, wheelset_skid
from scenarios.vehicles.vehicle_modes import phase

NEVER = 99.0


def locking(**times: float) -> Recording:
    """Return a braked motion in which wheelsets lock at given times [s], or never with NEVER."""
    units = {"time": "s", "speed": "m/s", "distance": "m"} | dict.fromkeys(times, "1")
    instants = [0.1 * number for number in range(100)]
    rows = [[time, 25.0 - time, 20.0 * time, *(time >= lock for lock in times.values())] for time in instants]
    return Recording(units, [list(map(float, row)) for row in rows])


@pytest.mark.parametrize(
    ("leading", "trailing", "said"),
    [
        (4.6, 4.2, "By 60\u00a0kN.m the trailing wheelset locks 0.4 s before the leading one"),
        (4.2, 4.7, "By 60\u00a0kN.m the leading wheelset locks 0.5 s before the trailing one"),
        (NEVER, 4.2, "Braked alike, the two wheelsets do not both lock"),
    ],
)
def test_the_wheelset_that_locks_first_is_named(leading: float, trailing: float, said: str) -> None:
    assert heavy_braking.message(locking(locked_1=leading, locked_2=trailing)) == said


def test_a_skid_tells_when_and_how_fast_or_that_there_is_none() -> None:
    said = "25 kN.m at friction 0.3 lock wheels within 1.0 s at 22\u00a0m/s"
    assert wheelset_skid.message(locking(locked_1=3.0)) == said
    assert wheelset_skid.message(locking(locked_1=NEVER)) == "25 kN.m do not lock the wheelset"


def test_of_several_torques_the_one_that_locks_is_named() -> None:
    def run(speed: float | None) -> qr30.BrakedRun:
        return qr30.BrakedRun(locking(locked_2=NEVER), None, speed, None, {})

    rolls = {"printed averages": run(None)}
    assert qr30.message(130, rolls) == "At 130 kPa the trailing wheelset rolls until the bogie stands"
    two = rolls | {"1.80 kN.m, fitted": run(1.75)}
    assert qr30.message(180, two) == "At 180 kPa, 1.80 kN.m lock the trailing wheelset at 1.75 m/s"
    history = {"a torque of many words in a file.csv": run(1.2)}
    assert qr30.message(150, history) == "At 150 kPa the trailing wheelset locks at 1.20 m/s"


def stop(distance: float, ended: str = "") -> UnevenStop:
    names = ("time", "speed", "distance", "locked_1", "locked_2", "lateral_1", "lateral_2")
    return UnevenStop(Recording(dict.fromkeys(names, "1"), [[0.0, 0.0, distance, 0.0, 0.0, 0.0, 0.0]]), ended)


def test_of_shares_that_stop_alike_the_first_is_named() -> None:
    found = {0.5: stop(256.5), 0.6: stop(244.503), 0.65: stop(244.499)}
    assert uneven_brakes.message(found) == "60% of the torque in front saves 12\u00a0m from 25 m/s"


def test_shoes_tell_from_which_error_on_a_wheelset_derails() -> None:
    stands, derails = stop(1.0), stop(1.0, "Derailed: the left wheel lost its tread contact")
    found = {(0.25, 0.0): stands, (0.5, 0.0): stands, (0.75, 0.0): derails, (0.0, 0.5): stands, (0.0, 0.75): stands}
    assert uneven_brakes.message_of_shoes(found) == "Uneven shoes derail the bogie at 75% error, not at 50%"
    found[0.75, 0.0] = stands
    assert uneven_brakes.message_of_shoes(found) == "Shoes up to 75% uneven derail no wheelset"
    found[0.25, 0.0] = derails
    assert uneven_brakes.message_of_shoes(found) == "Uneven shoes derail the bogie at 25% error"


def test_motions_of_a_mode_are_in_phase_in_antiphase_or_between() -> None:
    said = [phase(1.0, other) for other in (2.0 + 0.5j, -1.0 + 0.1j, 1.0j)]
    assert said == ["in phase", "in antiphase", "90° apart"]


def test_the_picture_of_a_line_tells_its_tightest_curve_or_that_it_has_none() -> None:
    for piece, said in (
        (arc(100.0, 400.0), "The tightest radius is 400 m, the heights differ by 0.0 m"),
        (straight(100.0, 0.01), "The line is straight, the heights differ by 1.0 m"),
    ):
        figure = line_from_file.draw_track(line_of([piece]))
        assert figure.get_suptitle() == said
        plt.close(figure)
