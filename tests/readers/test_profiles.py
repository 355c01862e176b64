"""Test profile files: read as they are meant, or refused with one message that names the row."""

from __future__ import annotations

import itertools
import os
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from readers.profiles import contour_of, read_contour
from readers.text import FileError

#: Files of instruments and programs, if available: kind, points, extent in y [mm].
STRANGERS = Path(os.environ.get("PROFILES_OF_OTHERS", "nowhere"))
READ = {
    "Car7216_0001r.whl": ("wheel", 645, (-0.1571, 131.3551)),
    "MBench_S1002_v3.prw": ("wheel", 399, (-69.612628, 60.0)),
    "MBench_UIC60_v3.ban": ("rail", 476, (-30.595912, 43.704898)),
    "MBench_UIC60_v3.prr": ("rail", 495, (-43.704898, 30.595912)),
    "rail_left_iter288.ban": ("rail", 571, (-36.4366, 37.2813)),
    "uic60_true.prr": ("rail", 801, (-40.435889, 40.435889)),
    "whl_left_iter288.whl": ("wheel", 539, (-0.2373, 145.0764)),
}
#: A parabolic rail head [mm], and the rounding of its digits in tables.
Y = np.arange(-36.0, 36.5, 0.5)
Z = -0.01 * Y**2
DIGITS = 1e-4
#: Blanks of a row just below the length limit.
BLANKS = 19_900 * " "


def rows(template: str, decimal: str = ".", scale: float = 1.0) -> str:
    lines = [template.format(f"{scale * y:.5f}", f"{scale * z:.5f}") for y, z in zip(Y, Z, strict=True)]
    return "\n".join(lines).replace(".", decimal)


def wave() -> np.ndarray:
    """Return a contour without symmetry [mm], so that each change of the points shows."""
    return np.column_stack([Y, -0.01 * Y**2 + 0.2 * np.sin(Y / 9)])


def read(text: str, kind: str = "rail") -> np.ndarray:
    return 1e3 * contour_of(text, "mine.csv", kind).points


@pytest.mark.parametrize(
    "text",
    [
        rows("{},{}"),
        rows("{}; {}"),
        rows("{};{}", ","),
        rows("{}\t{}", ","),
        rows("  {}   {}"),
        rows("{} {}", ","),
        rows('"{}";"{}"', ","),
        "# a remark\ny;z\n" + rows("{};{}", ","),
        "y z\n" + rows("{} {}"),
        "X,Y\n" + rows("{},{}"),
        "y_mm,z_mm\n" + rows("{},{}"),
        "y [mm];z [mm]\n" + rows("{};{}", ","),
        "y [m];z [m]\n" + rows("{};{}", ".", 1e-3),
        "unit: mm\n" + rows("{} {}"),
        "XOffset=\u22120.0\nZShift=\u22120 0\n" + rows("{} {}"),
        "Rail 7, left\nMileage=12.3\n\n" + rows("{} {}"),
        f"{Y.size}\n" + rows("{} {}"),
        f"XYPoints={Y.size}\nXOffset=0.0000\nMirror=no\nColumnDef=X,Y,A\n\n" + rows("{} {} 0.5"),
        f"XYPoints={Y.size + 1}\nColumnDef=X,Y\n" + rows("{} {}").replace("\n", '\n" 1.0 2.0\n', 1),
        "z;y\n" + "\n".join(f"{z:.5f};{y:.5f}" for y, z in zip(Y, Z, strict=True)),
        rows("{} {}   % dent"),
        rows("{},{},1,2"),
        rows("{};{};0,0", ","),
        rows("{},{}") + "\n,\n,,\n\n",
        rows("{};{}", ",").replace("\n", "\r\n"),
    ],
)
def test_every_writing_of_a_contour_is_the_same_contour(text: str) -> None:
    assert read(text) == pytest.approx(np.column_stack([Y, Z]), abs=1e-2 if "[m]" in text else DIGITS)


def simpack(body: str, spline: str = "", kind: int = 0) -> str:
    head = f"header.begin\n  version = 1\n  type = {kind} ! 0=rail\nheader.end\nspline.begin\n  units.len.f = 1000.\n"
    return f"{head}{spline}\n  point.begin\n{body}\n  point.end\nspline.end\n"


def test_blocks_of_simpack_are_obeyed() -> None:
    points = np.column_stack([Y, Z])
    assert read(simpack(rows("{} {} 1.0"))) == pytest.approx(points, abs=DIGITS)
    assert read(simpack(rows("{} {} ! here"), "mirror.y = 1\nshift.y = 0.0")) == pytest.approx(
        points * [-1, 1], abs=DIGITS
    )
    assert read(simpack(rows("{} {}"), "mirror.z = 1")) == pytest.approx(points * [1, -1], abs=DIGITS)
    metres = simpack(rows("{} {}", scale=1e-3)).replace("1000.", "1.")
    assert read(metres) == pytest.approx(points, abs=1e-2)


def lines(points: np.ndarray, template: str = "{:.9f} {:.9f}") -> str:
    return "\n".join(template.format(*point) for point in points)


@pytest.mark.parametrize("degrees", [False, True])
def test_header_that_undoes_a_change_gives_the_contour_before_it(degrees: bool) -> None:
    """A copy that is mirrored, turned and shifted, with the header that undoes this in SIMPACK's order."""
    angle, shift = 0.03, np.array([4.0, -7.0])
    cosine, sine = np.cos(angle), np.sin(angle)
    turned = wave() * [-1, 1] @ np.array([[cosine, -sine], [sine, cosine]])  # by -angle, from y to z
    keys = "shift.y = -4.0\nshift.z = 7.0\nmirror.y = 1\npoint.dist.min = 0\ncolour = blue\n"
    keys += f"rotate = {np.degrees(angle)}\nunits.ang = 'deg'" if degrees else f"rotate = {angle}\nunits.ang.f = 1"
    found = contour_of(simpack(lines(turned + shift), keys), "mine.prr")
    assert found.kind == "rail"
    assert 1e3 * found.points == pytest.approx(wave(), abs=1e-6)
    told = " | ".join(found.notes)
    assert "shift.y = -4 was applied | shift.z = 7 was applied | rotate =" in told
    assert "mirror.y = 1 was applied | keys of the header that are unknown and have no effect: colour" in told


def test_bounds_and_least_distances_of_simpack_remove_points_and_tell() -> None:
    keys = "bound.y.min = -30\nbound.y.max = 30\npoint.dist.min = 0.9\napprox.smooth = 2"
    found = contour_of(simpack(rows("{} {} 0.5"), keys), "mine.prr")
    assert 1e3 * found.points[[0, 1, -1], 0] == pytest.approx([-30.0, -29.0, 30.0])
    assert [note.split(" was")[0].split(" has")[0].split(" have")[0] for note in found.notes] == [
        "weights of 145 points",
        "point.dist.min = 0.9",
        "bound.y = -30 to 30",
        "approx.smooth = 2",
    ]


def test_profiles_of_an_mpt_file_are_chosen_by_kind_or_number(tmp_path: Path) -> None:
    part = (
        "[Profile{0}Info]\nMPTypeNo={1}\nColumnDef=X,Y,A\nXYPoints=145\nXoffset=1.5\nColour=blue\n[Profile{0}Points]\n"
    )
    text = "[FileInfo]\nProgramName=x\n" + part.format(1, 101) + rows("{} {} 0")
    path = tmp_path / "both.mpt"
    path.write_text(text + "\n" + part.format(2, 211) + lines(wave(), "{:.6f} {:.6f} 0"))
    assert 1e3 * read_contour(path, "rail").points == pytest.approx(wave() + np.array([1.5, 0.0]), abs=1e-5)
    first = read_contour(f"{path}#1")
    assert first.kind == "wheel"
    assert first.notes[0] == "profile 1 of 2 was read"
    assert "Xoffset = 1.5 mm was added" in first.notes[1]
    assert "unknown and have no effect: Colour" in first.notes[-1]
    for given, sentence in (("", "has the profiles 1, 2. Give one of them, as in"), ("#3", "must have profile 3")):
        with pytest.raises(FileError, match=sentence):
            read_contour(f"{path}{given}")


def test_one_slice_of_a_slices_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "b.txt").write_text(lines(wave(), "{:.6f} {:.6f}"))
    path = tmp_path / "nose.slcs"
    path.write_text("% a nose\n 0.0 1.0 U_OFFSET, U_SCALE\n 2 NSLC\n -10.0 'a.txt'\n 5.0 'b.txt'\n")
    found = read_contour(f"{path}#2")
    assert found.kind == "rail"
    assert found.notes[0] == "slice 2 of 2 was read, that at 5.0 of nose.slcs"
    for given, sentence in (("", "Give one of its 2 slices, as in"), ("#3", "Give one of its 2"), ("#1", "a.txt does")):
        with pytest.raises(FileError, match=sentence):
            read_contour(f"{path}{given}")


def test_instruments_numbers_for_a_pair_are_facts() -> None:
    keys = "MPTypeNo=131\nGauge=1436.9\nDiameterTaperline=719.2\nWheelDiameterTaperline=70.0\nRailAngle=1.4\n"
    keys += "ColumnDef=X,Y\n"
    found = contour_of(keys + "\n" + rows("{} {}"), "mine.whl")
    assert found.kind == "wheel"
    assert found.facts == pytest.approx({"gauge": 1.4369, "diameter": 0.7192, "tape_circle": 0.07})
    assert "RailAngle = 1.4 has no effect" in found.notes[0]


def test_unit_without_a_name_is_found_by_the_size_and_told() -> None:
    found = contour_of(rows("{} {}", scale=1e-3), "mine.csv", "rail")
    assert 1e3 * found.points == pytest.approx(np.column_stack([Y, Z]), abs=1e-2)
    assert found.notes == ("y spans 72 mm if the file is in metres: y and z were read as metres",)


def test_third_column_may_be_the_angle() -> None:
    angle = np.degrees(np.arctan(-0.02 * Y))
    text = "\n".join(f"{y:.4f} {z:.5f} {a:.4f}" for y, z, a in zip(Y, Z, angle, strict=True))
    found = contour_of(text, "mine.csv", "rail")
    assert found.notes == ("column 3 is the angle of the contour, and has no effect",)


@pytest.mark.parametrize("size", [-0.5, 0.15])
@pytest.mark.parametrize("count", [1, 2])
def test_outliers_are_refused_or_dropped_with_their_place(size: float, count: int) -> None:
    """On a noisy contour with a corner, which is no outlier; the spline through all points would follow them."""
    points = wave() + np.random.default_rng(1).normal(0.0, 0.005, (Y.size, 2)) * [0, 1]
    points = np.concatenate([points, points[-1] + np.arange(1, 20)[:, None] * [0.02, -0.5]])
    contour_of(lines(points), "mine.csv", "rail")
    points[60 : 60 + count, 1] += size
    with pytest.raises(FileError, match=r"row 6[12]: points must lie on .*y = -(6|5.5) mm"):
        contour_of(lines(points), "mine.csv", "rail")
    found = contour_of(lines(points), "mine.csv", "rail", drop_outliers=True)
    assert found.places.size == points.shape[0] - count
    assert "outliers were dropped, up to" in found.notes[0]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (rows("{},{}", ","), "row 1: commas must separate columns or mark decimals; in '-36,00000,-12,96000' they"),
        ("\n".join(f"0.0;{y};{z}" for y, z in zip(Y, Z, strict=True)), "column 3 begins with -12.96. Name the columns"),
        (simpack(rows("{} {}")).replace("point.end\nspline.end", ""), "the block point must end with point.end"),
        (rows("{},{}").replace(".", ""), "row 1: commas must separate columns or mark decimals"),
        (rows("{},{}") + "\ny,z\n" + rows("{},{}"), "row 146: between points a row must hold y and z; got 'y,z'"),
        (rows("{},{}") + "\n\n" + rows("{},{}"), "row 147: a file must hold one profile, point by point; y jumps"),
        (rows("{},{}") + "\n" + "\n".join(rows("{},{}").splitlines()[::-1]), "y turns back at 36 mm"),
        (rows("{},{}") + "\n1e5,0.0", "row 146, column y: the value must be from -1000 to 1000 mm; got '1e5'"),
        (rows("{},{}") + "\n900.0,0.0", "y must span 20 to 500 mm; got 936 mm"),
        (rows("{},{}", scale=1e-2), "y must span 20 to 500 mm; got 0.72 mm. Give y and z in mm, or name the columns"),
        (rows("{},{}") + "\n37,nan", "row 146, column z: the value must be a number; got 'nan'"),
        (rows("{},{}") + "\n37,5,1", "row 146: a row must have at most 2 values; got 3"),
        ("\n".join(rows("{},{}").splitlines()[:19]), "mine.csv has 19 points; a rail profile needs at least 20 rows"),
        ("", "mine.csv has 0 points"),
        ("Unit = furlong\n" + rows("{} {}"), "row 1: Unit must be one of mm, m, km"),
        ("# unit: inches\n" + rows("{} {}"), "row 1: unit must be one of mm, m, km"),
        ("All lengths in inches\n" + rows("{} {}"), "row 1: the text 'All lengths in inches' may change the points"),
        ("XOffset=3.5\n" + rows("{} {}"), "row 1: XOffset must be 0; got '3.5'. Apply it to the points"),
        ("Mirror=yes\n" + rows("{} {}"), "row 1: Mirror must be 0; got 'yes'"),
        ("ScaleFactor : 25.4\n" + rows("{} {}"), "row 1: ScaleFactor must be 1; got '25.4'"),
        ("XYPoints=12\n" + rows("{} {}"), "row 1: the header announces 12 points; the file has 145"),
        ("12\n" + rows("{} {}"), "row 1: the header announces 12 points; the file has 145"),
        ("ColumnDef=A,B\n" + rows("{} {}"), "ColumnDef must name X and Y, and each column once; got 'a,b'"),
        ("y [furlong];z\n" + rows("{};{}"), "the unit 'furlong' of y is unknown"),
        (simpack(rows("{} {}"), "shift.y = 1,5x"), "row 7: shift.y must be a finite number; got '1,5x'"),
        (simpack(rows("{} {}"), "rotate = 0.02\nunits.ang = gon"), "row 8: units.ang must be rad or deg; got 'gon'"),
        (simpack(rows("{} {}"), "bound.z.min=-5\nbound.z.max=5"), "bound.z must include all points; 56 points, the"),
        (simpack(rows("{} {}"), "bound.y.min=-4\nbound.y.max=3"), "must have at least 20 points after its header's"),
        (simpack(rows("{} {}"), "mirror.y = 2"), "row 7: mirror.y must be 0 or 1; got '2'"),
        (simpack(rows("{} {}"), "units.len = m"), "units.len must be the unit of units.len.f = 1000 a metre; got m"),
        ("\n".join(f"{y} {z} {y}" for y, z in zip(Y, Z, strict=True)),
         "row 1: behind y and z a column must be the contour's angle or a constant; column 3 begins with -36"),
        (rows("{},{}").replace(",-4.00000", ",-4.50000", 1), "row 33: points must lie on the contour of their neigh"),
        (simpack(rows("{} {}"), "units.len.f = 0"), "row 7: units.len.f must be above 0, 1000 for mm; got '0'"),
        ("XOffset=\u22123.5\n" + rows("{} {}"), "row 1: XOffset must be 0; got '\u22123.5'"),
        ("ScaleFactor=1,1\n" + rows("{} {}"), "row 1: ScaleFactor must be 1; got '1,1'"),
        (simpack(rows("{} {}"), "bound.z.min = \u22125\nbound.z.max = 5"), "lie beyond -5 to 5. Remove"),
        (simpack(rows("{} {}"), "bound.y.max = 1e999"), "row 7: bound.y.max must be a finite number; got '1e999'"),
        (simpack(rows("{} {}"), kind=1), "row 3: type must be that of a rail (0: rail, 1: wheel); got '1'"),
        (simpack(rows("{} {}")) * 2, "a second block header begins; a file must hold one profile"),
    ],
)  # fmt: skip
def test_what_is_not_one_contour_as_it_is_meant_gets_one_sentence(text: str, sentence: str) -> None:
    with pytest.raises(FileError) as told:
        read(text)
    assert sentence in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    "row",
    [
        "37" + BLANKS + "-13.69",
        "X" + BLANKS + "Y",
        "X =" + BLANKS + "Y",
        "X. " + ". " * (BLANKS.count(" ") // 2) + "Y = 1",
        BLANKS + '"',
        '"",' * (BLANKS.count(" ") // 3),
        "y" + BLANKS + "(" + BLANKS,
        "\n" * 10 * BLANKS.count(" "),
    ],
    ids=["numbers", "text", "value", "key", "quote", "quotes", "head", "rows"],
)
def test_the_time_for_long_rows_of_blanks_grows_with_their_length(row: str) -> None:
    """With quadratic growth the time would be 20 s and more."""
    begin = time.process_time()
    for text in (f"{row}\n{rows('{} {}')}", f"# {row}\n{rows('{} {}')}", f"{rows('{} {}')}\n{row}"):
        with suppress(FileError):
            read(text)
    assert time.process_time() - begin < 2.0


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="PROFILES_OF_OTHERS names no folder of their files")
@pytest.mark.parametrize("name", READ)
def test_files_of_instruments_and_programs_are_read_whole(name: str) -> None:
    kind, count, extent = READ[name]
    y = 1e3 * read_contour(STRANGERS / name, kind).points[:, 0]
    assert (y.size, *y[[np.argmin(y), np.argmax(y)]]) == pytest.approx((count, *extent))


@pytest.mark.study
def test_damaged_files_give_points_or_a_sentence() -> None:
    """Cuts, swaps and changed bytes: the result is a contour or a file error."""
    random = np.random.default_rng(0)
    whole = ["XYPoints=145\nColumnDef=X,Y\n" + rows("{} {}"), "y;z\n" + rows("{};{}", ","), simpack(rows("{} {} 1"))]
    letters = '0123456789.,;-+eE \t\n"#!=[]yz\u2212'
    refused = []
    for text, _ in itertools.product(whole, range(60)):
        place, count = int(random.integers(len(text))), int(random.integers(1, 6))
        put = "".join(random.choice(list(letters), int(random.integers(0, 4))))
        try:
            points = contour_of(text[:place] + put + text[place + count :], "mine.csv", "rail").points
            assert np.all(np.isfinite(points))
            assert points.shape[0] >= 20
        except FileError as error:
            refused.append(str(error))
    assert len(refused) > 20
    assert not any("\n" in sentence for sentence in refused)
