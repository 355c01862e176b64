"""Connections and bodies of vehicle files: a whole vehicle in TOML is that in Python, refusals, levels, FMU."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking.machines import machine_of, model_from
from bogie_braking.vehicle_files.check import axle_loads
from fmu_src.kernel import Kernel
from products.vehicle_connections import KINDS
from products.vehicle_file import sheet_of
from products.vehicle_toml import write_vehicle
from rbd_model.contact.geometry import synthetic_pair
from rbd_model.levels.models import places_of
from rbd_model.vehicle.parameters import coach_with_traction_rods
from rbd_model.vehicle.variables import outputs as outputs_of

GZ18 = Path(__file__).parents[1] / "data" / "gz18.toml"
#: Relative difference of two descriptions of one vehicle, of their largest value.
SAME = 1e-9
#: Radius, cant, transition and circle of the curve of the source, and its speed [m], [m/s].
RADIUS, CANT, RAMP, SPEED = 300.0, 0.120, 100.0, 60 / 3.6


def gz18() -> bb.parts.Vehicle:
    """Return GZ18 in Python, from the same source; z is above the wheelset axes."""
    parts, radius, pivot = bb.parts, 0.42, 7.85
    inertia = (60845.0, 1315247.0, 1344928.0)
    bodies = [parts.RigidBody("body", "car body", 30551.0, inertia, 0.0, 1.346 - radius)]
    wheelsets, connections = [], []
    for bogie, middle in (("front", pivot), ("rear", -pivot)):
        frame = f"{bogie}_frame"
        own = (1650.0, 3419.0, 4994.0)
        bodies.append(parts.RigidBody(frame, f"{bogie} frame", 8900.0, own, middle, 0.557 - radius))
        ends, low = ("body", frame), 0.557 - radius
        connections += [
            parts.Springs(
                *(f"{bogie}_air_springs", *ends, (middle, 0.95, 0.638 - radius), True),
                *((185e3, 185e3, 230e3), (0.0, 0.0, 20e3)),
            ),
            parts.Torsion(f"{bogie}_anti_roll_bar", *ends, (middle, 0.0, low), False, "roll", 3.5e6),
            parts.SeriesDamper(f"{bogie}_lateral_damper", *ends, (middle, 0.0, low), False, "lateral", 1e9, 60e3),
            parts.TableDamper(
                *(f"{bogie}_yaw_dampers", *ends, (middle, 1.2, low), True, "longitudinal"),
                *((0.0, 0.02, 0.04), (0.0, 12e3, 12e3)),
            ),
        ]
        for place, along in (("leading", 1.25), ("trailing", -1.25)):
            wheelsets.append(
                parts.Wheelset(
                    middle + along, frame, 1836.0, (1063.0, 1650.0, 1078.0), (radius, radius), synthetic_pair()
                )
            )
            ends, side = (frame, f"wheelset_{len(wheelsets)}"), np.sign(along)
            connections += [
                parts.Springs(
                    *(f"{bogie}_{place}_primary", *ends, (middle + along, 1.0, 0.0), True),
                    *((0.0, 0.0, 1.4e6), (0.0, 0.0, 10e3)),
                ),
                parts.Springs(
                    *(f"{bogie}_{place}_bushes", *ends, (middle + side * 0.77, 1.055, 0.0135), True),
                    *((17e6, 9e6, 0.0), (0.0, 0.0, 0.0), side * 28.12e-3),
                ),
            ]
    pulls = bb.vehicle("coach").pulls
    numbers = replace(coach_with_traction_rods(), gravity=9.80665, coupler_distance=19.0, coupler_height=0.3)
    return bb.parts.Vehicle("GZ18", numbers, tuple(bodies), tuple(wheelsets), tuple(connections), pulls)


def curve() -> bb.Line:
    """Return a right-hand curve with 120 mm of cant."""
    ahead, bend = bb.straight(20.0), bb.arc(500.0, -RADIUS, -CANT)
    return bb.line_of([ahead, bb.clothoid(RAMP, ahead, bend), bend])


def pair_of_runs(
    level: int, duration: float, names: list[str], line: bb.Line | None = None, **values: Any
) -> list[Any]:
    return [bb.run(one, duration, line, names, 0.05, level=level, **values) for one in (bb.read_vehicle(GZ18), gz18())]


@pytest.mark.parametrize("level", [1, 2])
def test_a_vehicle_of_a_file_is_the_same_in_python(level: int) -> None:
    names = ["speed", "axle_load_1", "axle_load_2", "axle_load_3", "axle_load_4"] + ["body_pitch"] * (level > 1)
    values = {"initial_speed": 20.0, "brake_torque_1": 6e3, "traction_torque_4": 2e3, "level": level}
    runs = [bb.run(one, 2.0, None, names, 0.05, **values) for one in (bb.read_vehicle(GZ18), gz18())]
    for name in names:
        assert np.max(np.abs(runs[0][name] - runs[1][name])) < SAME * np.max(np.abs(runs[0][name])), name


@pytest.mark.study
def test_it_runs_through_a_curve_as_that_in_python(tmp_path: Path) -> None:
    """Outputs and rates of states at the states of a run; two runs differ by round-off in the length of a step."""
    path = tmp_path / "line.csv"
    curve().write(path)
    values: dict[str, Any] = {"level": 3, "initial_speed": SPEED, "line_file": str(path)}
    vehicles = bb.read_vehicle(GZ18).vehicle, gz18()
    kernels = [Kernel(machine_of(one, {"level": 3}, True).library, **values) for one in vehicles]
    names = list(model_from(vehicles[0], places_of(3, 2, True)).systems[0].states)
    outputs = [name for name in outputs_of(vehicles[0]) if name in kernels[0].library.index]
    for kernel in kernels:
        kernel.initialise()
    for time in np.arange(0.5, 10.1, 0.5).tolist():
        kernels[0].advance(0.5)
        place = [kernels[0][f"state_{name}"] for name in names]
        for kernel in kernels:
            kernel.arrive(time, place)
        both = [[kernel[name] for name in outputs] + kernel.slopes_at(time, place) for kernel in kernels]
        assert both[1] == pytest.approx(both[0], rel=SAME, abs=1e-13), time
    assert kernels[0]["lateral_1"] > 5e-3


def damper(**more: object) -> dict[str, Any]:
    """Return a file with one row, a lateral damper of each bogie; None removes an entry."""
    row: dict[str, Any] = {
        "name": "damper",
        "kind": "series_damper",
        "upper": "body",
        "lower": "frame",
        "height": "0.6 m",
    }
    row |= {"direction": "lateral", "stiffness": "5 MN/m", "damping": "30 kN.s/m", **more}
    return {"connection": [{key: value for key, value in row.items() if value is not None}]}


def body(**more: object) -> dict[str, Any]:
    row = {"name": "motor", "mass": "1 t", "inertia": [100, 200, "0.2 t.m2"], "height": "0.6 m", **more}
    return {"body": [{key: value for key, value in row.items() if value is not None}]}


def carried_by_frames() -> dict[str, Any]:
    springs = {"kind": "springs", "direction": None, "stiffness": [1e6, 1e6, 1e6], "half_spacing": 1.0}
    return damper(**springs, damping=None)


ROW = "[[connection]] damper: "
SPRING = {"kind": "springs", "direction": None, "stiffness": [1e6, 1e6, 0], "damping": None}
REFUSED: list[tuple[dict[str, Any], str]] = [
    (damper(name=None), "[[connection]] 1: name must be given; got none. Add it."),
    (damper(name="left damper"), "name must have at most 40 letters, digits and underscores, a letter first; got"),
    (damper(kind=None), ROW + "kind must be given; got none. Add it."),
    (damper(kind="series_dampers"), "got series_dampers. Did you mean series_damper?"),
    (damper(upper="bodies"), ROW + "upper must be one of body, frame, leading_wheelset, trailing_wheelset, front_"),
    (damper(lower="body"), ROW + "upper and lower must be two parts; got body twice. Change one of them."),
    (damper(upper="wheelset_1"), "must be parts of one bogie; got wheelset_1 beside frame, which stands for that of"),
    (damper(height=None), ROW + "height must be given; got none. Add it."),
    (damper(height=600), ROW + "height must be from 0 to 6 m; got 600. Did you mean 600 mm = 0.6 m?"),
    (damper(aside=1, half_spacing=1), ROW + "aside must be left out beside half_spacing; got both."),
    (damper(damping=None), ROW + "damping must be given; got none. Add it."),
    (damper(damping=0), ROW + "damping must be from 1 to 1e+09 N.s/m; got 0."),
    (damper(stiffness=5.0), "got 5.0. Did you mean 5 kN/mm"),
    (damper(direction="sideways"), ROW + "direction must be one of longitudinal, lateral, vertical; got sideways."),
    (damper(capacity=1), ROW + "'capacity' is not a known entry."),
    (damper(**SPRING | {"stiffness": [1e6]}), ROW + "stiffness must be a list of 3 numbers; got [1000000.0]."),
    (damper(**SPRING | {"stiffness": [0, 0, 0]}), ROW + "stiffness or damping must be above 0; got none."),
    (damper(**SPRING | {"stiffness": [1e6, 0, 1e6], "inclination": 0.1}), ROW + "inclination must be left out with a"),
    ({"connection": damper()["connection"] * 2}, "[[connection]] front_damper must be there once; got it 2 times."),
    ({"connection": 7}, "connection must be in rows; got 7. Write [[connection]] and its entries below it."),
    ({"connections": "files"}, "connections must be one of built-in, file; got files. Did you mean file?"),
    ({"connections": "file"}, "nothing carries body; give it a connection with a vertical stiffness"),
    ({"connections": "file"} | carried_by_frames(), "nothing carries front_frame; give it a connection with a"),
    (body(), "nothing carries motor; give it a connection with a vertical stiffness"),
    (body(name="frame"), "[[body]] frame: name must differ from that of a built-in part. Rename it."),
    (body(mass=None), "[[body]] motor: mass must be given; got none. Add it."),
    (body(inertia=[1, 2]), "[[body]] motor: inertia must be a list of 3 numbers; got [1, 2]."),
    (
        body(held=["lateral", "pich"]),
        "[[body]] motor: held must be one of lateral, bounce, roll, pitch, yaw; got pich",
    ),
    (damper(name="traction_rod") | {"parameters": {"traction_rod_stiffness": 5e6}}, "[parameters] traction_rod_stiff"),
    (damper(lower="front_frame", upper="wheelset_3", name="wheelset_2"), "wheelset_2 is there 2 times"),
]


@pytest.mark.parametrize(("more", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_a_row_that_is_not_clear_is_refused_in_one_message(more: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)) as refused:
        sheet_of({"tare": "40 t"} | more)
    assert "\n" not in str(refused.value)


def test_a_row_replaces_the_built_in_connection_of_its_name_and_its_values() -> None:
    before, after = sheet_of({"tare": "40 t"}), sheet_of({"tare": "40 t"} | damper(name="traction_rod"))
    names = [{one.name for one in sheet.vehicle.connections} for sheet in (before, after)]
    assert names[0] == names[1]
    assert before.assumed.keys() - after.assumed.keys() == {"traction_rod_stiffness", "traction_rod_damping"}
    assert before.fmu == "braked-vehicle" or before.fmu == "vehicle"
    assert after.fmu is None


def test_a_row_of_each_bogie_joins_the_wheelsets_of_both() -> None:
    """The place along is that of the axle, or ahead of the middle of the bogie; six axles have middle ones."""
    row = {"upper": "frame", "lower": "middle_wheelset", "name": "link"}
    six = {"tare": "120 t", "axles": 6, "wheel_base": "1.8 m", "pivot_distance": "11 m", "length": "20 m"}
    for along, ahead in ((None, 0.0), ("-0.4 m", -0.4)):
        sheet = sheet_of(six | damper(**row, along=along, aside="-1 m"))
        links = [one for one in sheet.vehicle.connections if one.name.endswith("link")]
        assert [(one.name, one.upper, one.lower) for one in links] == [
            ("front_link", "front_frame", "wheelset_2"),
            ("rear_link", "rear_frame", "wheelset_5"),
        ]
        places = [[sheet.vehicle.number(size) for size in one.place] for one in links]
        above = 0.6 - sheet.vehicle.number("wheel_radius")
        assert places == [pytest.approx([5.5 + ahead, -1.0, above]), pytest.approx([-5.5 + ahead, -1.0, above])]


def test_a_motor_on_its_mounts_loads_its_bogie() -> None:
    mounts: dict[str, Any] = {
        "kind": "springs",
        "direction": None,
        "upper": "motor",
        "lower": "front_frame",
        "damping": None,
    }
    mounts |= {"stiffness": [5e6, 5e6, 5e6]}
    front = damper(**mounts, name="front_mounts", along="9.8 m", half_spacing="0.3 m")["connection"]
    rear = damper(**mounts, name="rear_mounts", along="9.2 m", half_spacing="0.3 m")["connection"]
    sheet = sheet_of({"tare": "42 t", "connection": front + rear} | body(along="9.5 m"))
    own, loads = sheet.parameters.values(), axle_loads(sheet)
    under = own["frame_mass"] + 2 * own["wheelset_mass"] + own["body_mass"] / 2
    assert sheet.mass == pytest.approx(42e3, rel=1e-12)
    assert loads == pytest.approx([9.80665 * mass / 2 for mass in (under + 1e3, under + 1e3, under, under)], rel=1e-6)


def test_vehicles_with_rows_survive_the_way_through_a_file(tmp_path: Path) -> None:
    hung = {"upper": "motor", "lower": "front_frame", "along": "7 m", "half_spacing": "0.4 m", "name": "hanger"}
    ahead = damper(**SPRING | hung | {"stiffness": [1e6, 1e6, 1e6]})["connection"]
    behind = damper(**SPRING | hung | {"stiffness": [1e6, 1e6, 1e6], "along": "6.5 m", "name": "stop"})["connection"]
    own = {"tare": "40 t", "connection": ahead + behind} | body(along="7 m")
    for sheet in (bb.read_vehicle(GZ18), sheet_of(own)):
        again = bb.read_vehicle(write_vehicle(sheet, tmp_path / "again.toml"))
        assert again.vehicle == sheet.vehicle
        assert again.mass == sheet.mass
    assert again.mass == pytest.approx(40e3, rel=1e-12)
    assert again.parameters.values()["body_mass"] < sheet_of({"tare": "40 t"}).parameters.values()["body_mass"] - 999.0


@pytest.mark.parametrize("name", KINDS)
def test_the_page_lists_the_entries_of_each_kind(name: str) -> None:
    page = (Path(__file__).parents[2] / "docs" / "vehicle_files.md").read_text(encoding="utf-8")
    (row,) = [line for line in page.splitlines() if re.match(rf"\| .*`{name}`.* \|", line) and line.count("|") == 4]
    for entry in KINDS[name].entries:
        assert f"`{entry}`" in row, entry


@pytest.mark.study
def test_the_fmu_of_a_file_with_rows_is_its_run(tmp_path: Path) -> None:
    metro, names = bb.read_vehicle(GZ18), ["axle_load_1", "speed", "body_pitch"]
    values: dict[str, Any] = {"initial_speed": 20.0, "brake_torque_1": 6e3}
    run = bb.run(metro, 2.0, None, names, 1.0, level=2, **values)
    with bb.FmuInstance(bb.write_fmu(metro, tmp_path / "metro.fmu", level=2), **values) as fmu:
        fmu.start()
        fmu.step(0.0, 2.0)
        assert [fmu[name] for name in names] == pytest.approx([run[name][-1] for name in names], rel=1e-6)
