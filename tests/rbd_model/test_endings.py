"""Test how 3D runs end: a vehicle tips over by rigid statics, or climbs its rail."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from fmu_src.kernel import Kernel, Library, SimulationError
from fmu_src.system import model_of
from rbd_model.contact.geometry import thesis_pair
from rbd_model.track.line import arc, clothoid, line_of, straight
from tests.fmu_src.quick_library import quick_library
from tests.rbd_model.test_standing import MAKERS, MASS, P

RADIUS = 300.0
#: Height of the centre of mass above the rails [m], of a rigid vehicle: frame and wheelsets.
HEIGHT = P.wheel_radius + P.frame_mass * P.frame_height / MASS
#: Range of the contact of the outer wheels from the middle of the track [m]: at most the middle of the rail's head, at
#: least its gauge face. The vehicle moves to them by PLAY, the clearance of its flanges.
HEAD, PLAY = thesis_pair().left.rail_half_distance, P.flange_clearance
FACE = HEAD - max(thesis_pair().left.rail.limits)
#: Springs so stiff that the vehicle is nearly rigid.
STIFF = {name: 30 * getattr(P, name) for name in ("lateral_stiffness", "vertical_stiffness", "vertical_damping")}


@pytest.fixture(scope="module")
def patched() -> Library:
    return quick_library(model_of(MAKERS["spatial"](), 1e-6))


def said_in_curve(library: Library, folder: Path, arm: float, sign: float) -> list[str]:
    """Return the messages of a bogie in a level curve to the left (1) or right (-1). It runs fast enough to tip over
    wheels `arm` [m] outside of its middle: M v^2 / R h = M g b.
    """
    speed = math.sqrt(P.gravity * arm / HEIGHT * RADIUS)
    before, curve = straight(20.0), arc(8 * speed, sign * RADIUS)
    path = str(line_of([before, clothoid(4 * speed, before, curve), curve]).write(folder / "line.csv"))
    kernel = Kernel(library, line_file=path, initial_speed=speed, constant_speed=1.0, **STIFF)
    try:
        kernel.advance(10.0)
    except SimulationError:
        assert kernel.ended
    return kernel.messages


@pytest.mark.study
@pytest.mark.parametrize(("sign", "inner", "outer"), [(1.0, "left", "right"), (-1.0, "right", "left")])
def test_a_vehicle_overturns_where_rigid_statics_say(patched: Library, tmp_path: Path, sign, inner, outer) -> None:  # type: ignore[no-untyped-def]
    assert not any("verturn" in line for line in said_in_curve(patched, tmp_path, FACE - PLAY, sign))
    said = said_in_curve(patched, tmp_path, HEAD, sign)
    lifted = [line for line in said if line.startswith("Wheel lift")]
    assert [line.split(" carried")[0] for line in sorted(lifted)] == [
        f"Wheel lift: the {inner} wheel of wheelset {number}" for number in (1, 2)
    ]
    warned, ended = (line for line in said if "verturn" in line)
    assert warned.startswith(f"Overturning: all {inner} wheels were 5 mm off their rails at ")
    assert f"tipped over its {outer} wheel and lifted the {inner} one off its rail" in ended
    assert not any("limb" in line or "Derailed" in line for line in said)
