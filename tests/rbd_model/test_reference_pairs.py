"""Test the reference profiles of EN 15302 on a vehicle: each contact model runs, or one message states the reason."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

import bogie_braking as bb
from rbd_model.contact.geometry import Pair, contact_at, thesis_pair
from rbd_model.contact.measured import read_profile
from rbd_model.contact.patches import parts_of, patches_of, positions_of, stand_on_treads
from rbd_model.contact.profiles import from_points
from rbd_model.contact.strips_in_c import MOST_SEGMENTS, segments_of, wheel_on_strips
from rbd_model.vehicle.description import Vehicle
from rbd_model.vehicle.ready import wheelset_under_frame
from rbd_model.wheelset.rigid import check_one_contact

REFERENCE = Path(__file__).parents[1] / "data" / "contact"
#: Pitch of the search for a place on a profile [m].
PITCH = 0.02e-3


@lru_cache
def pair_of(wheel: str) -> Pair:
    profiles = [read_profile(REFERENCE / f"en15302_{name}.csv", kind) for name, kind in
                ((f"RUIC519{wheel}", "wheel"), ("SUIC519A", "rail"))]  # fmt: skip
    return Pair(*profiles, 0.425, 0.75, 0.75)


def vehicle_on(pair: Pair) -> Vehicle:
    own = wheelset_under_frame()
    return replace(own, wheelsets=tuple(replace(one, pair=pair) for one in own.wheelsets))


@pytest.mark.study
@pytest.mark.parametrize("wheel", ["A", "B"])
def test_parts_that_jump_too_often_are_joined(wheel: str) -> None:
    """Their contacts jump every tenth of a millimetre of shift in the flange root, those of A on the tread too."""
    one = pair_of(wheel).left
    parts, s = parts_of(one, most=MOST_SEGMENTS), positions_of(one)
    assert 3 <= len(parts) <= MOST_SEGMENTS < len(parts_of(pair_of("A").left))
    for part in parts:
        places = part.nearest[np.isfinite(part.nearest)]
        assert places.size >= 6
        assert np.all((places >= s[part.first]) & (places <= s[part.last - 1]))
    # Segments cover the profile from one end to the other, without a gap wider than the pitch of the search.
    ends = segments_of(one)
    assert [high for _, high in ends[:-1]] == [low for low, _ in ends[1:]]
    assert wheel_on_strips(one).results is not None
    if wheel == "B":
        for shift in (0.0, 2e-3):
            stand, rigid = stand_on_treads(pair_of(wheel), shift), contact_at(pair_of(wheel), shift)
            assert stand.position == pytest.approx(rigid.position, abs=2 * PITCH)
            assert stand.roll == pytest.approx(rigid.roll, abs=1e-7)


@pytest.mark.study
@pytest.mark.parametrize(("height", "length"), [(5e-6, 8e-3), (2e-6, 4e-3)])
def test_waves_within_a_contact_make_no_patches(height: float, length: float) -> None:
    """Measured wheels have waves of micrometres. At contact model 3 each wave is a part, at contact model 2 none is."""
    one = pair_of("B").left
    y = np.arange(*one.wheel.limits, 0.25e-3)
    worn = from_points("worn", "waves", y, one.wheel.height(y) + height * np.cos(2 * np.pi * y / length))
    wavy = replace(one, wheel=worn)
    assert len(patches_of(wavy)) == len(patches_of(one))
    assert len(parts_of(wavy)) > len(parts_of(one))


def test_a_pair_whose_contact_jumps_is_refused_at_depth_1() -> None:
    check_one_contact(thesis_pair())
    with pytest.raises(ValueError, match="RUIC519B on rail en15302_SUIC519A jumps at 3 mm or before"):
        check_one_contact(pair_of("B"))  # the flange root touches from 2.9 mm on, while the tread contact continues
    with pytest.raises(
        ValueError, match=r"jumps at 0.1 mm or before, from y = 12.1 mm of the wheel. Take contact model 2 or 3"
    ):
        bb.Simulation(vehicle_on(pair_of("A")), level=3, contact_model=1)
    with pytest.raises(
        ValueError, match=r"jumps at 0.1 mm or before, from y = 12.1 mm of the wheel. Take contact model 2 or 3"
    ):
        bb.batch(vehicle_on(pair_of("A")), 1.0, ["speed"], level=3, contact_model=1)


def test_distances_that_are_none_of_a_wheel_and_its_rail_are_refused_at_once() -> None:
    """With distances in millimetres the search would have millions of offsets."""
    pair = pair_of("B")
    for half_distance in (750.0, 1.5, float("nan")):
        with pytest.raises(
            ValueError, match=r"must be within 0.25 m of each other; got 0.75 and .* Give both in metres"
        ):
            patches_of(Pair(pair.wheel, pair.rail, 0.425, 0.75, half_distance).left)
