"""Contact tables as files: what is written is read, and damaged files are refused in one sentence."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import bogie_braking as bb
from fmu_src.kernel import Kernel, SimulationError
from fmu_src.records import OwnRecord
from fmu_src.system import Model, System, Variable, model_of
from rbd_model.contact.bearing import CUBIC
from rbd_model.contact.depth import Contact
from rbd_model.contact.geometry import Sides, european_pair, synthetic_pair
from rbd_model.contact.pair_file import PAIR_FILE, read_pairs, write_pair
from rbd_model.contact.pair_table import MOST_PATCHES, pair_record, side_record
from rbd_model.contact.patches import parts_of
from rbd_model.levels.models import DEFAULT_TOLERANCE, model_of_levels, places_of
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie, wheelset_under_frame
from rbd_model.wheelset.standing import lift_until_static
from rbd_model.wheelset.wheel_on_record import FLANGES
from readers.text import BadInputError
from tests.fmu_src.quick_library import quick_library

#: Profiles of EN 15302.
REFERENCE = Path(__file__).parents[1] / "data" / "contact"
#: Error of that power for 10 % of the radius, on treads 0.1 %, on flanges 2.7 %.
STIFFNESS_OF_RADIUS = 0.03
#: Flange forces that show contact [N], and a difference that no rounding makes [m].
FLANGE_TOUCHES, MOVES_OTHERWISE = 1e3, 1e-4


def own_pair() -> Sides:
    """Return the pair of the wheelset in a frame."""
    return wheelset_under_frame().wheelsets[0].pair


@lru_cache
def unequal() -> Sides:
    """Return a wheelset with S1002 on 60E1 on the left, and the synthetic wheel on its rail on the right."""
    return Sides(european_pair().left, synthetic_pair().right)


@pytest.mark.study
@pytest.mark.parametrize("sides", [own_pair(), european_pair(), unequal()], ids=["synthetic", "S1002", "unequal"])
def test_a_table_that_is_read_is_the_one_that_was_written(sides: Sides, tmp_path: Path) -> None:
    path = write_pair(sides, tmp_path / "pair.csv")
    [found] = read_pairs(path)
    assert found == pair_record(sides)
    assert len(found.lists[0]) == 1 + (sides.left != sides.right)
    assert sides.left.wheel.name in path.read_text(encoding="utf-8").splitlines()[1]


@pytest.mark.study
def test_only_the_stiffness_depends_on_the_radius_of_a_wheel() -> None:
    """The runtime scales it with the radius of the instance to the power of a quarter, Johnson (1985), section 4.2."""
    one = own_pair().left
    smaller = replace(one, radius=0.9 * one.radius)
    whole, other = (side_record(side, 0.0).lists[0][0] for side in (one, smaller))
    assert other.tables[:2] == whole.tables[:2]
    (first, rows), (again, scaled) = whole.tables[3], other.tables[3]
    assert again == first
    ratios = np.array(scaled)[:, CUBIC] / np.array(rows)[:, CUBIC]
    assert np.abs(ratios / 0.9**0.25 - 1).max() < STIFFNESS_OF_RADIUS


#: How a file is damaged, and the sentence that says so.
DAMAGES = {
    "another file": (r"contact_pair,2", "distance,curvature", "the row must be 'contact_pair' with 1 more cells"),
    "an older format": (r"contact_pair,2", "contact_pair,1", "the format must be 2; got 1"),
    "no number": (r"mean_radius,.*", "mean_radius,big", r"mean_radius must be a number from 0.1 to 1; got big"),
    "millimetres": (r"mean_radius,.*", "mean_radius,460", r"mean_radius must be a number from 0.1 to 1; got 460"),
    "too long a table": (
        r"table,in_contact,\d+",
        "table,in_contact,20001",
        "the length of in_contact must be a number from 1 to 20000",
    ),
    "a broken count": (
        r"table,in_contact,\d+",
        "table,in_contact,2.5",
        "the length of in_contact must be a whole number",
    ),
    "no patches": (
        r"list,treads,\d",
        "list,treads,0",
        f"the length of treads must be a number from 1 to {MOST_PATCHES}",
    ),
    "no direction": (r"sine,0.9.*", "sine,0.5", "cosine and sine above must be those of one angle"),
    "no breadth": (r"rail_ends,.*", "rail_ends,-0.5", "rail_begins above must be below rail_ends"),
    "no number in a row": (r"(table,at_first,.*\n.*),[^,]*\n", r"\1,nan\n", "a coefficient must be a number"),
    "a row that goes back": (r"(table,at_first,.*\n.*\n)[^,]*", r"\1-0.9", "breakpoints of at_first must grow"),
    "a short row": (r"(table,at_first,.*\n.*),[^,]*\n", r"\1\n", "a row of at_first must have 21 numbers here; got 20"),
    "a changed digit": (r"mean_radius,0.4\d*", "mean_radius,0.47", "the checksum must be [0-9a-f]{16}"),
    "a second end": (r"\Z", "list,sides,1\n", "the row must be 'contact_pair' with 1 more cells"),
    "half a file": (r"(?s)table,in_contact.*", "", "the row must be 'table'; the file ends"),
}


@pytest.mark.study
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_table_is_refused_with_row_and_remedy(damage: str, tmp_path: Path) -> None:
    pattern, text, sentence = DAMAGES[damage]
    path = write_pair(own_pair(), tmp_path / "pair.csv")
    whole = path.read_text(encoding="utf-8")
    path.write_text(re.sub(pattern, text, whole, count=1), encoding="utf-8")
    assert path.read_text(encoding="utf-8") != whole
    with pytest.raises(BadInputError, match=rf"pair.csv, row \d+: {sentence}.*\. Make the file again"):
        read_pairs(path)


# -- in kernels -------------------------------------------------------------------------------------------------------


def model_on(*pairs: Sides) -> Model:
    """Return a bogie on elastic contacts, with the pairs of both wheelsets in its equations."""
    own = two_axle_bogie()
    both = zip(own.wheelsets, (pairs[0], pairs[-1]), strict=True)
    vehicle = replace(own, wheelsets=tuple(replace(one, pair=pair) for one, pair in both))
    return model_of(spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(2)), DEFAULT_TOLERANCE)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pairs")
    pairs = {"synthetic": own_pair(), "european": european_pair(), "unequal": unequal()}
    return {name: write_pair(pair, folder / f"{name}.csv") for name, pair in pairs.items()}


def weight() -> float:
    """Return the weight of the bogie [N]."""
    numbers = tables_5_1_and_5_2()
    return (numbers.frame_mass + 2 * numbers.wheelset_mass) * numbers.gravity


#: Outputs of a wheelset.
OF_WHEELSET = ("state_lateral_{}", "state_yaw_{}", "state_roll_{}", "flange_force_{}", "wheel_load_{}_left")


def swing(*pairs: Sides, **values: float | str) -> np.ndarray:
    """Return outputs of both wheelsets of a bogie that starts 8 mm beside the track's middle: its flanges touch.

    Shape (times, wheelsets, outputs).
    """
    library = quick_library(model_on(*pairs))
    kernel = Kernel(library, initial_speed=30.0, initial_lateral=8e-3, initial_yaw=0.01, **values)
    rows = []
    kernel.initialise()
    for number in range(60):
        rows.append([[kernel[name.format(one)] for name in OF_WHEELSET] for one in (1, 2)])
        kernel.step(number * 5e-3, 5e-3)
    return np.array(rows)


@pytest.mark.study
def test_files_give_the_run_of_the_pairs_in_the_equations(files: dict[str, Path], tmp_path: Path) -> None:
    """One file for each wheelset, or both tables in one file; one file, or a file twice, is that of both wheelsets."""
    paths = [str(files[name]) for name in ("unequal", "european")]
    found = swing(own_pair(), profile_file=" ; ".join(paths))
    assert np.array_equal(found, swing(unequal(), european_pair()))
    whole = tmp_path / "with;semicolon.csv"
    whole.write_bytes(b"".join(Path(path).read_bytes() for path in paths))
    assert np.array_equal(found, swing(own_pair(), profile_file=str(whole)))
    assert np.abs(found[:, :, 3]).max() > FLANGE_TOUCHES
    own = swing(own_pair())
    assert np.abs(found - own)[:, :, 0].max() > MOVES_OTHERWISE
    synthetic = str(files["synthetic"])
    assert np.array_equal(own, swing(own_pair(), profile_file=synthetic))
    assert np.array_equal(own, swing(own_pair(), profile_file=f"{synthetic};{synthetic}"))


@pytest.mark.study
def test_a_pair_on_wheelset_1_changes_the_contact_of_wheelset_1_alone(files: dict[str, Path]) -> None:
    own = swing(own_pair())
    other = swing(own_pair(), profile_file=f"{files['european']};{files['synthetic']}")
    assert np.array_equal(own[0, 1], other[0, 1])
    assert np.abs(own - other)[0, 0, 4] > FLANGE_TOUCHES
    assert not np.array_equal(own[-1, 1], other[-1, 1])  # the frame joins them


@pytest.mark.study
def test_worn_wheel_whose_contact_jumps_often_carries_the_vehicle(tmp_path: Path) -> None:
    worn = bb.pair(REFERENCE / "en15302_RUIC519A.csv", REFERENCE / "en15302_SUIC519A.csv")
    assert len(parts_of(worn.left)) > 5
    path = write_pair(worn, tmp_path / "worn.csv")
    kernel = Kernel(quick_library(model_on(own_pair())), initial_speed=20.0, profile_file=str(path))
    kernel.initialise()
    kernel.advance(2.0)
    loads = [kernel[f"axle_load_{number}"] for number in (1, 2)]
    assert sum(loads) == pytest.approx(weight(), rel=0.01)


def test_another_number_of_tables_and_a_missing_file_are_refused(files: dict[str, Path]) -> None:
    one = str(files["synthetic"])
    kernel = Kernel(quick_library(model_on(own_pair())), profile_file=one)
    for text, sentence in (
        (f"{one};{one};{one}", "one contact table for all wheelsets or one for each, 2; got 3. Correct it."),
        (f"{one};nowhere.csv", "Contact table nowhere.csv: it cannot be opened"),
        (f"{one};", "Contact table : it cannot be opened"),
        (f'{one};"{one}', "quotes must close"),
    ):
        with pytest.raises(SimulationError, match=sentence):
            kernel.set(profile_file=text)
    assert kernel.get_text(kernel.number_of("profile_file")) == one


@pytest.mark.parametrize("lateral", [0.0, 5e-3])
def test_wheels_start_with_their_static_load_on_all_their_patches(lateral: float, files: dict[str, Path]) -> None:
    """S1002 on 60E1 bears on two patches when centred: the approach of one of them would give more load."""
    static = weight() / 4
    library, still = quick_library(model_on(own_pair())), {"initial_speed": 20.0, "initial_lateral": lateral}
    for path in files.values():
        kernel = Kernel(library, profile_file=str(path), **still)
        kernel.initialise()
        loads = [kernel[f"wheel_load_1_{side}"] for side in ("left", "right")]
        assert loads == pytest.approx([static, static], rel=0.005)
        kernel.step(0.0, 2e-3)
        if lateral == 0.0:
            assert kernel["wheel_load_1_left"] == pytest.approx(static, rel=0.01)


def test_two_equal_patches_sink_less_than_one() -> None:
    """Each carries half: by Hertz the approach is 2^(-2/3) of that of one patch. An error below 0.5 % is kept."""
    lift, load, sunk = ca.SX.sym("lift"), 50e3, 0.1e-3

    def lift_with(patches: float) -> float:
        stiffness = patches * load / sunk**1.5

        def press(lifted: ca.SX, asked: ca.SX) -> tuple[ca.SX, ca.SX]:
            approach = ca.fmax(sunk - lifted, 0)
            return stiffness * approach**1.5, -1.5 * stiffness * ca.sqrt(approach)

        return float(ca.Function("lift", [lift], [lift_until_static(ca.SX(load), press)])(0.0))

    assert lift_with(2.0) == pytest.approx((1 - 2 ** (-2 / 3)) * sunk, rel=1e-6)
    assert lift_with(100.0) == pytest.approx((1 - 100 ** (-2 / 3)) * sunk, rel=1e-6)
    assert lift_with(0.5) == pytest.approx((1 - 0.5 ** (-2 / 3)) * sunk, rel=1e-6)
    assert lift_with(1.004) == 0.0


@pytest.mark.study
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_kernel_refuses_what_python_refuses_and_keeps_its_table(
    damage: str, files: dict[str, Path], tmp_path: Path
) -> None:
    pattern, text, _ = DAMAGES[damage]
    kernel = Kernel(quick_library(model_on(own_pair())), profile_file=str(files["european"]))
    path = tmp_path / "pair.csv"
    whole = files["synthetic"].read_text(encoding="utf-8")
    path.write_text(re.sub(pattern, text, whole, count=1), encoding="utf-8")
    refused = r"^Contact table .*pair.csv, row \d+: .* contact table before it stays in force"
    with pytest.raises(SimulationError, match=refused) as in_c:
        kernel.set(profile_file=str(path))
    with pytest.raises(BadInputError) as in_python:
        read_pairs(path)
    assert row_of(str(in_python.value)) == row_of(str(in_c.value))
    assert kernel.get_text(kernel.number_of("profile_file")) == str(files["european"])


def row_of(message: str) -> str:
    """Return the row that a message names."""
    found = re.search(r"row (\d+)", message)
    assert found
    return found[1]


def test_a_state_belongs_to_the_profiles_of_its_run(files: dict[str, Path]) -> None:
    library = quick_library(model_on(own_pair()))
    kernel = Kernel(library, initial_speed=30.0, initial_lateral=8e-3, profile_file=str(files["european"]))
    kernel.initialise()
    kernel.step(0.0, 0.02)
    state = kernel.save()
    kernel.step(0.02, 0.02)
    there = kernel["state_lateral_1"]
    kernel.restore(state)
    kernel.step(0.02, 0.02)
    assert kernel["state_lateral_1"] == there
    other = Kernel(library, initial_speed=30.0, profile_file=str(files["unequal"]))
    with pytest.raises(SimulationError, match="one with another contact table"):
        other.restore(state)


def test_a_patch_that_a_table_does_not_have_is_none_of_its_others(files: dict[str, Path]) -> None:
    """Its record is 0, and parts with it are not called. A single side is that of both wheels."""
    system, own = System("Reader", "reads records"), OwnRecord(pair_record, european_pair())
    system.derivative(system.state("x", "1", 0.0, 1.0), ca.SX(0.0))
    paths = {"first": [(0, 0), (FLANGES, 0)], "missing": [(0, 0), (FLANGES, MOST_PATCHES - 2)], "right": [(0, 1)]}
    for name, path in paths.items():
        record = system.of_record(PAIR_FILE, own, path)
        system.output(Variable(name, "output", "1", "A record is there"), record > 0.0)
    kernel = Kernel(quick_library(model_of(system, 1e-6)), profile_file=str(files["synthetic"]))
    kernel.initialise()
    assert [kernel[name] for name in paths] == [1.0, 0.0, 1.0]


@pytest.mark.study
def test_contact_without_a_table_refuses_a_file_and_other_levels_warn(files: dict[str, Path]) -> None:
    places = places_of(2, on_line=False) + places_of(3, 1, on_line=False)
    rigid = model_of_levels("Bogie", "planar and rigid", two_axle_bogie(), places)
    variables = (*rigid.variables, PAIR_FILE.variable)
    library = quick_library(replace(rigid, variables=variables, reads_records=PAIR_FILE))
    kernel = Kernel(library, level=3.0, contact_model=1.0, profile_file=str(files["synthetic"]))
    with pytest.raises(SimulationError, match="profile_file must be empty at contact model 1"):
        kernel.initialise()
    kernel = Kernel(library, level=2.0, profile_file=str(files["synthetic"]))
    kernel.initialise()
    assert "depends on profile_file, so that setting this has no effect" in str(kernel.messages)
