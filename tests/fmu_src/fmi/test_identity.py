"""GUIDs follow from everything that decides an answer, and an FMU without its data is refused."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description

import bogie_braking as bb
from fmu_src.archive import contents_of
from fmu_src.identity import FILE, token_in, with_data
from fmu_src.ssp import Component, write_ssp
from products.building import write_in_c
from products.train.consist import Consist, block_train
from products.train.coupler_fmu import coupler_fmu
from products.train.coupler_tables import coupler_named
from products.train.fmu import train_fmu
from products.train.numbers import Settings
from rbd_model.contact.geometry import european_pair
from rbd_model.contact.pair_file import write_pair
from tests.fmu_src.fmi.hosting import ERROR, host
from tests.fmu_src.fmi.masters import MASTERS, master
from tests.fmu_src.fmi.test_resource_folders import Opened, extracted, named, refused

FACES = {"native": 2, "fmi3": 3}
#: Vehicles that differ in their mass alone.
FILES = {name: f'name = "{name}"\nlike = "coach"\ntare = {tare}\n' for name, tare in (("light", 36e3), ("heavy", 64e3))}


def written(name: str, folder: Path, kind: str = "native", more: str = "") -> Path:
    """Write the FMU of a vehicle file."""
    (folder / f"{name}.toml").write_text(FILES[name] + more)
    return bb.write_fmu(bb.read_vehicle(folder / f"{name}.toml"), folder / f"{name}-{kind}.fmu", kind)


def train(consist: Consist, folder: Path, **how: object) -> str:
    """Return the GUID of a train."""
    write_in_c(train_fmu(consist, **how), folder / "train.fmu", 2)  # type: ignore[arg-type]
    return token_in(contents_of(folder / "train.fmu")["modelDescription.xml"].decode())


def test_each_change_of_the_data_gives_another_guid(fmus: dict) -> None:
    contents, random, found = contents_of(fmus["vehicle", "native"]), np.random.default_rng(1), set[str]()
    rows = [f"body_mass,{value}\n".encode() for value in random.uniform(2e4, 6e4, 100)]
    rows += [f"initial_speed,{value}\n".encode() for value in random.uniform(1.0, 60.0, 100)]
    for row in rows:
        made = with_data(contents, {"start_values.csv": row})
        token = token_in(made["modelDescription.xml"].decode())
        assert token == token_in(with_data(contents, {"start_values.csv": row})["modelDescription.xml"].decode())
        assert token.encode() in made["documentation/host.c"]
        found.add(token)
    assert len(found) == len(rows)
    assert token_in(contents["modelDescription.xml"].decode()) not in found
    # Data that are added later keep the first ones, and the binary's own GUID.
    both = with_data(made, {"line.csv": b"distance,curvature\n0,0\n"})[FILE].decode()
    assert "start_values.csv," in both
    assert f"binary,{token_in(contents['modelDescription.xml'].decode())}\n" in both


@pytest.mark.study
def test_each_train_has_its_guid(tmp_path: Path) -> None:
    plain = block_train(3)
    first, *others = plain.vehicles
    changed = [replace(first, **{name: getattr(first, name) * 1.001 + 1e-6}) for name in ("mass", "length", "leak")]
    trains = [plain, block_train(4), *(Consist((one, *others)) for one in changed)]
    found = [train(one, tmp_path) for one in trains]
    found.append(train(plain, tmp_path, settings=Settings(cells=0.5)))
    found.append(train(plain, tmp_path, line=bb.line_of([bb.straight(5000.0, gradient=1e-3)])))
    assert len({*found}) == len(found)
    assert train(plain, tmp_path) == found[0]


@pytest.mark.study
@pytest.mark.parametrize("kind", FACES)
def test_vehicle_files_have_names_and_guids_of_their_own(kind: str, fmus: dict, tmp_path: Path) -> None:
    about = [read_model_description(str(written(name, tmp_path, kind))) for name in FILES]
    about.append(read_model_description(str(fmus["vehicle", kind])))
    assert len({one.guid if kind == "native" else one.instantiationToken for one in about}) == 3
    assert [one.modelName for one in about] == ["light", "heavy", "VehicleDynamics"]


def of_a_file(folder: Path, kind: str) -> Path:
    return written("light", folder, kind)


def of_profiles(folder: Path, kind: str) -> Path:
    write_pair(european_pair(), folder / "pair.csv")
    return written("light", folder, kind, 'profile_file = "pair.csv"\n')


def of_a_train(folder: Path, kind: str) -> Path:
    write_in_c(train_fmu(block_train(2)), folder / "train.fmu", FACES[kind])
    return folder / "train.fmu"


def of_a_coupler(folder: Path, kind: str) -> Path:
    write_in_c(coupler_fmu(coupler_named("screw")), folder / "coupler.fmu", FACES[kind])
    return folder / "coupler.fmu"


@pytest.mark.study
@pytest.mark.parametrize("kind", FACES)
@pytest.mark.parametrize("make", [of_a_file, of_profiles, of_a_train, of_a_coupler])
def test_an_fmu_without_its_data_is_refused(make: Callable[[Path, str], Path], kind: str, tmp_path: Path) -> None:
    path = make(tmp_path, kind)
    folder = extracted(path, tmp_path / "unpacked")
    assert "got none" in refused(path, folder, None)
    assert "got none" in refused(path, folder, "")
    for other in (tmp_path / "no", folder / "documentation"):
        assert "the folder resources" in refused(path, folder, named(kind, other))
    assert Opened(path, folder, named(kind, folder / "resources")).component
    [data] = {*(folder / "resources").glob("*.bin"), *(folder / "resources").glob("start_values.csv")}
    data.unlink()
    assert f"{data.name} is missing" in refused(path, folder, named(kind, folder / "resources"))


@pytest.mark.study
def test_changed_data_are_refused(tmp_path: Path) -> None:
    path = written("light", tmp_path)
    changed = tmp_path / "changed.fmu"
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(changed, "w") as new:
        for name in old.namelist():
            text = old.read(name)
            new.writestr(
                name, text.replace(b"body_mass,", b"body_mass,1") if name.endswith("start_values.csv") else text
            )
    with pytest.raises(bb.CosimulationError, match=r"start_values\.csv was changed after the FMU was built"):
        bb.FmuInstance(changed)


@pytest.mark.study
def test_a_saved_state_is_of_one_vehicle(tmp_path: Path) -> None:
    with host(written("light", tmp_path)) as light, host(written("heavy", tmp_path)) as heavy:
        light.start()
        heavy.start()
        assert heavy.status(heavy.fmu.deSerializeFMUstate, light.state(), None) == ERROR
        assert "with the same resources" in heavy.said[-1]


@pytest.mark.study
@pytest.mark.parametrize("name", MASTERS)
def test_two_vehicles_in_one_system_have_their_own_answers(name: str, tmp_path: Path) -> None:
    """Both files have one name, in two folders. The heavier vehicle needs 1.4 times the distance."""
    run: Callable = master(name)
    parts = []
    for one in FILES:
        (tmp_path / one).mkdir()
        path = written(one, tmp_path / one).rename(tmp_path / one / "Vehicle.fmu")
        torque = {f"brake_torque_{number}": 6e3 for number in (1, 2, 3, 4)}
        parts.append(Component(one, path, {"level": 1, "initial_speed": 20.0, **torque}, ["speed"]))
    write_ssp(tmp_path / "both.ssp", "both", parts, [], (5.0, 0.01))
    found = run(tmp_path / "both.ssp", 0.01, 500, (("light", "speed"), ("heavy", "speed")))
    single = [
        bb.run(bb.read_vehicle(tmp_path / one / f"{one}.toml"), 5.0, names=["speed"], **parts[0].parameters)["speed"][
            -1
        ]
        for one in FILES
    ]
    assert found == pytest.approx(single, rel=1e-6)
    assert single[1] - single[0] > 1.0
