"""Lines between their rows: linear, rounded at the rows, always between two rows, in C as in Python."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from bogie_braking.live.lines import BEFORE, BEGIN, CANTS, TRANSITION, line_for
from fmu_src.codegen import KERNEL_SOURCES
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System
from rbd_model.track.irregularity import track_from_points
from rbd_model.track.line import NAMES, Line, arc, clothoid, line_of, straight
from rbd_model.track.line_table import COLUMNS, GAUGE, LARGEST_TURN, ROUNDING
from tests.fmu_src.numerics.test_line_file import surveyor  # noqa: F401

WEB = Path(__file__).parents[3] / "bogie_braking/live/web"

#: Rounding errors of a column, relative to its limits.
ROUND_OFF = 1e-12
LIMIT = {column.name: max(-column.minimum, column.maximum) for column in COLUMNS}


def by_column(values: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return columns of a line from looked-up values; the widening is shared between both rails."""
    lateral, spread = values["lateral_0"], values["spread_0"]
    return {
        "curvature": values["heading_1"],
        "gradient": values["rise_1"],
        "cant": -GAUGE * values["cant_0"],
        "left_lateral": lateral + spread,
        "right_lateral": lateral - spread,
        "left_vertical": values["left_0"],
        "right_vertical": values["right_0"],
        "left_friction": values["left_friction_0"],
        "right_friction": values["right_friction_0"],
    }


def looked_up(kernel: Kernel, places: np.ndarray, names: Sequence[str]) -> dict[str, np.ndarray]:
    """Return the outputs of the surveyor at some places."""
    found = []
    for place in places.tolist():
        kernel.set(away=place)
        found.append([kernel[name] for name in names])
    return dict(zip(names, np.array(found).T, strict=True))


VALUES = (
    *("heading_0", "heading_1", "rise_0", "rise_1", "cant_0", "lateral_0", "spread_0", "left_0", "right_0"),
    *("left_friction_0", "right_friction_0"),
)
#: Tolerance of positions in the plan, by quintics over distant rows [m]; measured 2.1e-7.
PLAN_BAND = 1e-6
#: Slopes that are looked up, and their columns.
SLOPES = {
    "heading_2": ["curvature"],
    "rise_2": ["gradient"],
    "cant_1": ["cant"],
    "lateral_1": ["left_lateral", "right_lateral"],
    "spread_1": ["left_lateral", "right_lateral"],
    "left_1": ["left_vertical"],
    "right_1": ["right_vertical"],
}
#: Second derivatives that are looked up, and their columns.
BENDS = {name.replace("1", "2"): columns for name, columns in SLOPES.items() if name.endswith("1")}
#: Distance from a row at which both sides are compared [m]. Tolerance of slopes: share of the steepest slope, due to
#: rounding over 1 cm. Tolerance of second derivatives: share of the steepest slope over the shortest distance.
BESIDE, SLOPE_BAND, BEND_BAND = 1e-10, 1e-6, 1e-5


def random_line(chance: np.random.Generator) -> Line:
    """Return rows 1 cm to 100 m apart; columns are noise, plateaus, or grow only; some rows have no bend."""
    count = int(chance.integers(3, 25))
    distance = np.cumsum(10.0 ** chance.uniform(-2.0, 2.0, count))
    distance -= distance[count // 2]
    rows = {"distance": distance}
    for name in [*NAMES[1:4], *NAMES[5:]]:
        noise = chance.uniform(-1.0, 1.0, count)
        kinds = noise, np.round(noise), np.cumsum(noise**8) / count
        rows[name] = LIMIT[name] * kinds[chance.integers(3)]
        if name.endswith("friction"):
            rows[name] = np.abs(rows[name])
    rows["curvature"] *= min(1.0, 0.99 * LARGEST_TURN / LIMIT["curvature"] / np.max(np.diff(distance)))
    return Line(rows)


@pytest.mark.study
def test_random_lines_stay_within_their_rows_and_straight_between_them(surveyor: Library, tmp_path: Path) -> None:  # noqa: F811
    """The closed form is `numpy.interp`. Python and the runtime have the same values."""
    chance, straights = np.random.default_rng(7), 0
    for number in range(200):  # one file each: to overwrite a file waits for the disk
        line = random_line(chance)
        s = line.rows["distance"]
        first, last = np.sort(chance.uniform(s[0], s[-1], 2))
        kernel = Kernel(surveyor, line_file=str(line.write(tmp_path / f"{number}.csv")), away=first, speed=last - first)
        table = {
            name: np.array(values) for name, values in kernel.record(1.0, 1 / 16, [*VALUES, "state_distance"]).items()
        }
        places, found = first + table["state_distance"], by_column(table)
        row = np.searchsorted(s, places, "right") - 1
        beyond = np.minimum(places - s[row], s[row + 1] - places) > ROUNDING
        straights += np.count_nonzero(beyond)
        for name, values in found.items():
            ends, room = np.array([line.rows[name][row], line.rows[name][row + 1]]), ROUND_OFF * LIMIT[name]
            assert np.all(values >= ends.min(axis=0) - room), name
            assert np.all(values <= ends.max(axis=0) + room), name
            told = np.interp(places, s, line.rows[name])
            exact = beyond | name.endswith("friction")
            assert np.all(np.abs(values - told)[exact] <= room), name
            assert np.all(np.abs(values - line.value(name, places)) <= room), name
    assert straights > 600


def quadrature(line: Line, name: str, first: float, last: float) -> float:
    """Return the integral of a column by Gauss's rule, between all places where a polynomial may begin."""
    rows = line.rows["distance"]
    breaks = np.unique(np.clip(np.concatenate([rows, rows + ROUNDING, rows - ROUNDING, [first, last]]), first, last))
    nodes, weights = np.polynomial.legendre.leggauss(4)
    half = np.diff(breaks)[:, None] / 2
    return float(np.sum(half * weights * line.value(name, breaks[:-1, None] + half * (1 + nodes))))


def test_heading_and_height_are_integrals_and_slopes_go_on_at_rows(surveyor: Library, tmp_path: Path) -> None:  # noqa: F811
    chance, path = np.random.default_rng(8), tmp_path / "line.csv"
    for _ in range(100):
        line = random_line(chance)
        s = line.rows["distance"]
        kernel = Kernel(surveyor, line_file=str(line.write(path)))
        kernel.initialise()
        first, last = np.sort(chance.uniform(s[0], s[-1], 2))
        found = looked_up(kernel, np.array([first, last]), VALUES)
        for name, column in (("heading_0", "curvature"), ("rise_0", "gradient")):
            size = LIMIT[column] * max(1.0, last - first)
            assert np.diff(found[name])[0] == pytest.approx(quadrature(line, column, first, last), abs=1e-12 * size)
        places = np.concatenate([s[1:-1], s + ROUNDING, s - ROUNDING])
        places = places[(places > s[0]) & (places < s[-1])]
        before, behind = (looked_up(kernel, places + way, [*SLOPES, *BENDS]) for way in (-BESIDE, BESIDE))
        for name, columns in (SLOPES | BENDS).items():
            steepest = max(float(np.max(np.abs(np.diff(line.rows[one]) / np.diff(s)))) for one in columns)
            band = BEND_BAND / np.min(np.diff(s)) if name in BENDS else SLOPE_BAND
            assert np.all(np.abs(before[name] - behind[name]) <= band * steepest), name


def test_python_differentiates_what_it_reads() -> None:
    line, way = random_line(np.random.default_rng(9)), 1e-6
    places = np.random.default_rng(10).uniform(*line.rows["distance"][[0, -1]], 200)
    for name in NAMES[1:4]:
        differences = (line.value(name, places + way) - line.value(name, places - way)) / (2 * way)
        assert line.value(name, places, 1) == pytest.approx(differences, rel=1e-3, abs=1e-6 * LIMIT[name])
    with pytest.raises(KeyError, match="got 'gradiant'"):
        line.value("gradiant", places)
    with pytest.raises(ValueError, match="must be 0, 1 or 2; got 3"):
        line.value("cant", places, 3)


def test_corners_alone_are_the_line_of_its_segments(surveyor: Library, tmp_path: Path) -> None:  # noqa: F811
    """Rows that `line_of` places next to a joint add no information to a row at the joint."""
    curve = arc(100.0, 3000.0, 0.05, 0.004)
    line = line_of([straight(50.0), clothoid(80.0, straight(1.0), curve), curve])
    ends = [0.0, 50.0, 130.0, 230.0]
    corners = Line({name: np.interp(ends, line.rows["distance"], values) for name, values in line.rows.items()})
    places = np.linspace(0.5, 229.5, 700)
    found = []
    for one in (line, corners):
        kernel = Kernel(surveyor, line_file=str(one.write(tmp_path / "line.csv")))
        kernel.initialise()
        found.append(looked_up(kernel, places, (*VALUES, *SLOPES, "ahead_0", "ahead_far_0", "aside_0", "aside_far_0")))
    for name in (*VALUES, *SLOPES):
        assert found[0][name] == pytest.approx(found[1][name], rel=1e-9, abs=1e-13), name
    for name in ("ahead", "aside"):
        one, other = (values[f"{name}_0"] + values[f"{name}_far_0"] for values in found)
        assert one == pytest.approx(other, abs=PLAN_BAND)


def test_the_live_page_has_the_same_line(surveyor: Library, tmp_path: Path) -> None:  # noqa: F811
    """Its kernels contain the same sources, which read the page's file. The page has no line reader in JavaScript."""
    assert {"table_file.c", "table_pieces.c"} <= set(KERNEL_SOURCES)
    scripts = "".join((WEB / name).read_text() for name in ("one_file.js", "kernel.js", "simulation.js"))
    assert "new OneFile" in scripts
    assert not any(word in scripts for word in ("curvature", "cant", "interpol"))
    begin, radius, gradient = BEGIN + BEFORE, 500, 0.01
    places = np.linspace(BEGIN + 0.3, 300.0, 141)
    kernel = Kernel(surveyor, line_file=str(line_for(radius, gradient).write(tmp_path / "line.csv")))
    kernel.initialise()
    found = by_column(looked_up(kernel, places, VALUES))
    away = np.min(np.abs(places[:, None] - [begin, begin + TRANSITION]), axis=1) > ROUNDING
    for name, last in (("curvature", 1 / radius), ("cant", CANTS[radius])):
        told = np.interp(places, [begin, begin + TRANSITION], [0.0, last])
        assert np.abs(found[name] - told)[away] == pytest.approx(0.0, abs=ROUND_OFF * LIMIT[name]), name
    assert found["gradient"] == pytest.approx(gradient, abs=ROUND_OFF)


def test_a_measured_track_stays_within_its_points() -> None:
    """A track in the equations has the same meaning as one in a file."""
    line = random_line(np.random.default_rng(11))
    s, columns = line.rows["distance"], ("left_lateral", "left_vertical", "right_vertical")
    system, place = System("track", "of points"), ca.SX.sym("place")
    track = track_from_points(s, *(line.rows[name] for name in columns), line.rows["left_friction"])
    section = track(system)(1, place, 1)
    function = ca.Function("track", [place], [system.expand(section.rails), system.expand(section.friction)])
    for one in np.random.default_rng(12).uniform(s[0], s[-1], 300).tolist():
        rails, friction = (np.array(found) for found in function(one))
        row = int(np.searchsorted(s, one, "right")) - 1
        for found, name in zip(rails[:, 0], columns, strict=True):
            ends = line.rows[name][row : row + 2]
            assert ends.min() - 1e-12 <= found <= ends.max() + 1e-12, name
            assert found == pytest.approx(line.value(name, one), abs=1e-12)
        assert friction[0, 0] == pytest.approx(np.interp(one, s, line.rows["left_friction"]), abs=1e-12)
