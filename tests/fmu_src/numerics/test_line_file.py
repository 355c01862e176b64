"""Lines from files: valid and invalid files, and the values that the runtime looks up."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from fmu_src.kernel import ERROR, Kernel, Library, SimulationError
from fmu_src.system import System, Variable, model_of
from rbd_model.track.line import Line, Segment, arc, clothoid, line_of, straight
from rbd_model.track.line_table import LARGEST_TURN, PIECES, along_line
from tests.fmu_src.quick_library import quick_library

HEAD = "distance,curvature,cant,gradient\n"


@pytest.fixture(scope="module")
def surveyor() -> Library:
    """Return a model that moves along a line and outputs its values, slopes and second derivatives."""
    system = System("Surveyor", "looks at a line")
    place = system.state("distance", "m", 0.0, 1.0)
    distance = place + system.input(Variable("away", "input", "m", "Added"))
    system.derivative(place, system.parameter(Variable("speed", "parameter", "m/s", "How fast")))
    for piece in PIECES:
        values = along_line(system, piece.name, distance, min(piece.degree, 2))
        for order, value in enumerate(values):
            system.output(Variable(f"{piece.name}_{order}", "output", "1", "Looked up"), value)
    return quick_library(model_of(system, 1e-9))


def surveyed(library: Library, line: Line, folder: Path, places: Sequence[float], names: Sequence[str]) -> np.ndarray:
    """Return the named values at some places; shape (places, names)."""
    kernel = Kernel(library, line_file=str(line.write(folder / "line.csv")))
    kernel.initialise()
    found = []
    for place in places:
        kernel.set(away=place)
        found.append([kernel[name] for name in names])
    return np.array(found)


def whole(values: np.ndarray) -> np.ndarray:
    """Return the sum of whole metres and the rest."""
    return values[:, 0] + values[:, 1]


def test_an_arc_is_a_circle(surveyor: Library, tmp_path: Path) -> None:
    """Heading s / R, position R (sin, 1 - cos): to 1e-9 m after a full turn, on either side."""
    for radius in (150.0, -700.0):
        circle = 2 * math.pi * abs(radius)
        places = np.linspace(0.0, circle, 41)
        names = ["ahead_0", "ahead_far_0", "aside_0", "aside_far_0", "heading_0", "heading_1"]
        found = surveyed(surveyor, line_of([arc(circle, radius)]), tmp_path, places.tolist(), names)
        assert whole(found[:, :2]) == pytest.approx(radius * np.sin(places / radius), abs=1e-9)
        assert whole(found[:, 2:4]) == pytest.approx(radius * (1 - np.cos(places / radius)), abs=1e-9)
        assert found[:, 4] == pytest.approx(places / radius, abs=1e-12)
        assert found[:-1, 5] == pytest.approx(1 / radius, rel=1e-12)


def test_rows_far_apart_are_a_circle_too(surveyor: Library, tmp_path: Path) -> None:
    """The tightest curve with the largest turn from row to row: measured 0.26 um in the plan, 73 nrad in its direction.

    The quintic through both ends of an arc of turn h deviates by R h^6 / 46080 (Hermite's remainder).
    """
    radius, turn = 50.0, LARGEST_TURN * (1 - 1e-12)
    distance = radius * turn * np.arange(26)
    bend = np.full_like(distance, 1 / radius)
    line = Line({"distance": distance, "curvature": bend, "cant": 0 * bend, "gradient": 0 * bend})
    places = np.linspace(0.0, distance[-1], 301)
    names = ["ahead_0", "ahead_far_0", "aside_0", "aside_far_0", "heading_0", "ahead_1", "aside_1"]
    found = surveyed(surveyor, line, tmp_path, places.tolist(), names)
    plan = np.column_stack([whole(found[:, :2]), whole(found[:, 2:4])])
    circle = radius * np.column_stack([np.sin(places / radius), 1 - np.cos(places / radius)])
    assert np.max(np.abs(plan - circle)) <= 1.01 * radius * turn**6 / 46080
    assert found[:, 4] == pytest.approx(places / radius, abs=1e-12)
    heading = np.column_stack([np.cos(places / radius), np.sin(places / radius)])
    assert np.max(np.abs(found[1:-1, 5:7] - heading[1:-1])) <= 1e-7


def test_a_clothoid_is_fresnels_integral(surveyor: Library, tmp_path: Path) -> None:
    """Between rounded ends the heading grows with the square of the distance; the plan is checked by quadrature."""
    line = line_of([straight(50), clothoid(80, straight(1), arc(1, 300, 0.1)), arc(50, 300, 0.1)])
    places = np.linspace(52.0, 128.0, 20)
    names = ["heading_0", "heading_1", "ahead_0", "ahead_far_0", "aside_0", "aside_far_0", "cant_0", "cant_1"]
    found = surveyed(surveyor, line, tmp_path, places.tolist(), names)
    curvature = (places - 50) / 80 / 300
    assert found[:, 1] == pytest.approx(curvature, rel=1e-12)
    turned = found[:, 0] - found[0, 0]
    assert turned == pytest.approx((curvature**2 - curvature[0] ** 2) * 80 * 300 / 2, abs=1e-13)
    assert found[:, 6] == pytest.approx(-0.1 / 1.5 * curvature * 300, rel=1e-12)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    for which, wave in ((2, np.cos), (4, np.sin)):
        gained = whole(found[:, which : which + 2])
        for place, value in zip(places, gained, strict=True):
            half = (place - places[0]) / 2
            along = places[0] + half * (1 + nodes)
            heading = found[0, 0] + ((along - 50) ** 2 - (places[0] - 50) ** 2) / (2 * 80 * 300)
            assert value - gained[0] == pytest.approx(half * np.sum(weights * wave(heading)), abs=1e-10)


def test_gradients_add_up_to_height(surveyor: Library, tmp_path: Path) -> None:
    up, down = straight(100, 0.03), straight(100, -0.02)
    line = line_of([up, Segment(60, gradient=(0.03, -0.02)), down])
    found = surveyed(
        surveyor, line, tmp_path, [0.0, 90.0, 180.0, 250.0], ["rise_0", "rise_1", "level_0", "level_far_0"]
    )
    assert found[:, 0] == pytest.approx([0.0, 2.7, 3.0 + 0.3 - 0.4, 3.3 - 1.8], abs=1e-3)
    assert found[[0, 1, 3], 1] == pytest.approx([0.03, 0.03, -0.02], rel=1e-12)
    assert whole(found[:, 2:])[1] == pytest.approx(90 * math.sqrt(1 - 0.03**2), rel=1e-12)


def test_what_is_read_is_smooth_and_goes_through_its_rows(surveyor: Library, tmp_path: Path) -> None:
    """Value, slope and second derivative are continuous at rows. The line passes through the values of its rows."""
    random_rows = np.random.default_rng(4)
    distance = np.cumsum(random_rows.uniform(0.3, 2.0, 60))
    rows = {"distance": distance, "curvature": random_rows.uniform(-1e-2, 1e-2, 60)}
    rows |= {"cant": random_rows.uniform(-0.1, 0.1, 60), "gradient": random_rows.uniform(-0.03, 0.03, 60)}
    rows |= {"left_vertical": random_rows.uniform(-0.01, 0.01, 60), "right_friction": random_rows.uniform(0.0, 1.0, 60)}
    names = [f"{column}_{order}" for column in ("cant", "left") for order in range(3)] + ["ahead_1", "ahead_2"]
    names += ["heading_0", "heading_1", "heading_2", "rise_1", "rise_2"]
    at = distance[5:50]
    before, behind = (surveyed(surveyor, Line(rows), tmp_path, (at + way).tolist(), names) for way in (-1e-9, 1e-9))
    scale = np.max(np.abs(behind), axis=0)
    assert np.all(np.abs(behind - before) < 1e-6 * scale + 1e-8)
    met = surveyed(surveyor, Line(rows), tmp_path, at.tolist(), ["cant_0", "heading_1", "rise_1", "left_0"])
    for place, name in enumerate(("cant", "curvature", "gradient", "left_vertical")):
        factor = -1 / 1.5 if name == "cant" else 1.0
        assert met[:, place] == pytest.approx(factor * rows[name][5:50], abs=1e-12), name
    friction = surveyed(surveyor, Line(rows), tmp_path, np.linspace(1, 60, 500).tolist(), ["right_friction_0"])
    assert 0.0 <= friction.min() < friction.max() <= 1.0


def test_beyond_its_ends_a_line_goes_on_straight(surveyor: Library, tmp_path: Path) -> None:
    line = line_of([arc(100, 500, 0.1, 0.02)])
    names = ["heading_0", "heading_1", "cant_0", "rise_0", "rise_1", "rise_2", "left_friction_0"]
    found = surveyed(surveyor, line, tmp_path, [-30.0, 130.0], names)
    assert found[0] == pytest.approx([0.0, 0.0, -0.1 / 1.5, -0.6, 0.02, 0.0, 1.0], abs=1e-12)
    assert found[1] == pytest.approx([0.2, 0.0, -0.1 / 1.5, 2.6, 0.02, 0.0, 1.0], abs=1e-12)


BAD = {
    "nothing": ("", "must have a row of names and rows of values; it is empty"),
    "names alone": (HEAD, "at least 2 rows of values; it has 0"),
    "no names": ("0,0,0,0\n1,0,0,0\n", "row 1: the first row must have names; got '0'"),
    "a name that is missing": ("distance,curvature,cant\n0,0,0\n1,0,0\n", "row 1: the column gradient is missing"),
    "a name twice": ("distance,cant,cant,gradient\n", "column cant must be there once; it is there twice"),
    "a near miss": ("distance,curvature,cant,gradiant\n", "'gradiant' is unknown. Did you mean gradient?"),
    "another unit": (
        "distance,curvature [1/ft],cant,gradient\n",
        "row 1: the unit '1/ft' of curvature is unknown. Use 1/m",
    ),
    "distance that falls": (HEAD + "0,0,0,0\n5,0,0,0\n4,0,0,0\n", r"row 4, column distance: .*got 4 m after 5 m"),
    "distance that stays": (HEAD + "0,0,0,0\n5,0,0,0\n5,0,0,0\n", "row 4, column distance: .*got 5 m after 5 m"),
    "a tight curve": (
        HEAD + "0,0,0,0\n1,0.021,0,0\n",
        r"row 3, column curvature: .*from -0.02 to 0.02 1/m; got '0.021'",
    ),
    "cant above the gauge": (HEAD + "0,0,0,0\n1,0,1.6,0\n", "row 3, column cant: .*from -0.3 to 0.3 m; got '1.6' m"),
    "a steep gradient": (HEAD + "0,0,0,0.6\n1,0,0,0\n", "row 2, column gradient: .*from -0.5 to 0.5; got '0.6'"),
    "no number": (HEAD + "0,0,0,0\n1,nan,0,0\n", "row 3, column curvature: the value must be a number; got 'nan'"),
    "infinite": (HEAD + "0,0,0,0\n1,0,0,1e999\n", "row 3, column gradient: .* got '1e999'"),
    "a word": (HEAD + "0,0,0,0\n1,0,left,0\n", "row 3, column cant: the value must be a number; got 'left'"),
    "an empty cell": (HEAD + "0,0,0,0\n1,0,,0\n", "row 3, column cant: .*the cell is empty"),
    "a cell too few": (HEAD + "0,0,0,0\n1,0,0\n", "row 3, column gradient: .*the cell is empty"),
    "a cell too many": (HEAD + "0,0,0,0\n1,0,0,0,0\n", "row 3: a row must have at most 4 values"),
    "rows too far apart": (HEAD + "0,0.01,0,0\n700,0.01,0,0\n", "row 3: the line turns by 7 rad over the 700 m"),
    "a long row": (HEAD + "0,0,0,0" + "0" * 30000 + "\n", "row 2: a row must have at most 20000 characters"),
    "bytes": (HEAD + "0,0,0,\x01\n", "row 2: the character 1 is not text"),
    "a null byte": (HEAD + "0,0,\x00,0\n1,0,0,0\n", "row 2"),
    "letters of another kind": (HEAD + "0,0,0,½\n", "row 2, column gradient: .*got '½'"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_line_ends_with_its_row_and_value(surveyor: Library, tmp_path: Path, name: str) -> None:
    """One error message; the previous line stays in force."""
    text, sentence = BAD[name]
    path = tmp_path / "bad.csv"
    path.write_bytes(text.encode())
    good = str(line_of([arc(100, 500)]).write(tmp_path / "good.csv"))
    kernel = Kernel(surveyor, line_file=good)
    with pytest.raises(SimulationError, match=sentence) as refused:
        kernel.set(line_file=str(path))
    assert refused.value.status == ERROR
    assert str(path) in str(refused.value)
    assert "stays in force" in str(refused.value)
    assert kernel.get_text(surveyor.index["line_file"]) == good
    kernel.initialise()
    assert kernel["heading_1"] == pytest.approx(1 / 500)


def test_files_that_are_none_are_refused(surveyor: Library, tmp_path: Path) -> None:
    kernel = Kernel(surveyor)
    with pytest.raises(SimulationError, match=r"cannot be opened\. Give the path"):
        kernel.set(line_file=str(tmp_path / "missing.csv"))
    with pytest.raises(SimulationError, match=r"Line .* Give"):
        kernel.set(line_file=str(tmp_path))
    with pytest.raises(SimulationError, match="must be set and read as a text"):
        kernel.set(line_file=3.0)
    with pytest.raises(SimulationError, match="must be set and read as a number"):
        kernel.set(speed="fast")
    with pytest.raises(SimulationError, match="line_file must be the path of a file with a line"):
        kernel.initialise()


@pytest.mark.study
def test_more_rows_than_there_is_room_for_are_refused(surveyor: Library, tmp_path: Path) -> None:
    path = tmp_path / "endless.csv"
    path.write_text(HEAD + ",0,0,0\n".join(map(str, range(4_000_001))) + ",0,0,0\n")
    with pytest.raises(SimulationError, match=r"row 4000002: the file must have at most 4000000 rows\. Split it"):
        Kernel(surveyor, line_file=str(path))


def test_any_bytes_end_in_a_sentence(surveyor: Library, tmp_path: Path) -> None:
    """Random damage in the rows of a valid file: no crash, no NaN, and every refusal has a complete message.

    tests/readers/test_twin.py reads more of them, without a kernel.
    """
    good = line_of([arc(60, 400, 0.1, 0.01)]).write(tmp_path / "good.csv").read_bytes()
    chance = random.Random(11)
    taken, refused = 0, []
    for number in range(150):
        spoilt, path = bytearray(good), tmp_path / f"{number}.csv"  # to overwrite a file waits for the disk
        for _ in range(chance.randint(1, 4)):
            spoilt[chance.randrange(len(spoilt))] = chance.choice(b'0123456789.,-e\n\r \x00\xff"')
        path.write_bytes(bytes(spoilt[: chance.choice([len(spoilt), chance.randrange(len(spoilt))])]))
        kernel = Kernel(surveyor)
        try:
            kernel.set(line_file=str(path), speed=7.0)
            kernel.advance(10.0)
            taken += 1
            assert all(math.isfinite(kernel[name]) for name in surveyor.names if name not in ("line_file",))
        except SimulationError as error:
            refused.append(str(error))
    assert taken > 5
    assert len(refused) > 20
    assert all(sentence.startswith("Line ") and sentence.endswith("stays in force.") for sentence in refused)


def test_instances_run_on_lines_of_their_own(surveyor: Library, tmp_path: Path) -> None:
    radii = (200.0, 300.0, -500.0)
    kernels = []
    for number, radius in enumerate(radii):
        path = line_of([arc(300, radius)]).write(tmp_path / f"{number}.csv")
        kernels.append(Kernel(surveyor, line_file=str(path), speed=10.0))
        path.unlink()  # the file is not read again
    for kernel in kernels:
        kernel.initialise()
    for _ in range(20):
        for kernel in kernels:
            kernel.advance(1.0)
    assert [kernel["heading_1"] for kernel in kernels] == pytest.approx([1 / radius for radius in radii])


def test_a_saved_state_belongs_to_its_line(surveyor: Library, tmp_path: Path) -> None:
    """Its mirror image is another line, although its numbers differ in sign only."""
    radii = (200.0, 300.0, -200.0)
    one, other, mirrored = (str(line_of([arc(300, r, r / 2e3)]).write(tmp_path / f"{r:.0f}.csv")) for r in radii)
    kernel = Kernel(surveyor, line_file=one, speed=10.0)
    kernel.advance(3.0)
    saved, heading = kernel.save(), kernel["heading_0"]
    kernel.advance(3.0)
    kernel.restore(saved)
    assert kernel["heading_0"] == heading
    for file in (other, mirrored):
        stranger = Kernel(surveyor, line_file=file, speed=10.0)
        stranger.initialise()
        with pytest.raises(SimulationError, match=r"one on another line\. Set line_file to that of the saved state"):
            stranger.restore(saved)
    twin = Kernel(surveyor, line_file=one, speed=10.0)
    twin.restore(saved)
    assert twin["heading_0"] == heading
    with pytest.raises(SimulationError, match="fixed once the run has begun"):
        kernel.set(line_file=other)
    kernel.reset()
    assert kernel.get_text(surveyor.index["line_file"]) == ""
