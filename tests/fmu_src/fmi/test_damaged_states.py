"""Damaged saved states (cut, extended or changed) are refused by every FMU and by every Python class that restores
them.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from ctypes import byref, c_size_t, c_ubyte, c_void_p
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description

import bogie_braking as bb
from brake_controller.protection_fmu import wheel_slide_in_c
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library, SimulationError
from fmu_src.step_fmu_in_c import step_in_c
from products.braking_curves.fmu import curves_fmu
from products.building import write_in_c
from products.protection.sensor_fmu import sensor_fmu
from products.registry import DIFFERENT
from products.train.consist import block_train
from products.train.coupler_fmu import coupler_fmu
from products.train.fmu import train_fmu
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.coupler import screw_coupler
from tests.fmu_src.fmi.hosting import ERROR, OK, Host, host
from tests.fmu_src.fmi.objects import COUNTS
from tests.fmu_src.fmi.sled import sled

DAMAGES = 1000
FACES = {"native": 2, "fmi3": 3}
#: All released FMUs, and one around a controller in C.
SHIPPED = [
    *((name, kind) for name in (*DIFFERENT, "train", "coupler", "sensor", "curves", "controller") for kind in FACES),
]


def controller(folder: Path) -> Path:
    """Return a controller in C that stores its number of wheelsets in its memory."""
    (folder / "counts.c").write_text(COUNTS)
    return folder / "counts.c"


def built(name: str, kind: str, fmus: dict, folder: Path) -> Path:
    """Return the path of an FMU of SHIPPED."""
    path = folder / f"{name}.fmu"
    if name in DIFFERENT:
        return Path(fmus[name, kind])
    if name == "train":
        write_in_c(train_fmu(block_train(3)), path, FACES[kind])
    elif name == "coupler":
        write_in_c(coupler_fmu(screw_coupler()), path, FACES[kind])
    elif name == "sensor":
        write_in_c(sensor_fmu(), path, FACES[kind])
    elif name == "curves":
        write_in_c(curves_fmu(), path, FACES[kind])
    else:
        write_in_c(step_in_c(wheel_slide_in_c(controller(folder))), path, FACES[kind])
    return path


def damaged(whole: bytes, draw: random.Random) -> bytes:
    """Return the state with one flipped bit, with fewer bytes or with more."""
    kind = draw.randrange(3)
    if kind == 1:
        return whole[: draw.randrange(len(whole))]
    if kind == 2:
        return whole + draw.randbytes(1 + draw.randrange(64))
    bytes_, place = bytearray(whole), draw.randrange(len(whole))
    bytes_[place] ^= 1 << draw.randrange(8)
    return bytes(bytes_)


def take(one: Host, state: bytes, place: c_void_p) -> int:
    """Deserialise a state; return the status."""
    size = c_size_t(len(state))
    if one.three:
        return one.raw("DeserializeFMUState", (c_ubyte * len(state)).from_buffer_copy(state), size, byref(place))
    return one.raw("DeSerializeFMUstate", state, size, byref(place))


@pytest.mark.study
@pytest.mark.parametrize(("name", "kind"), SHIPPED)
def test_each_damaged_state_is_refused_with_one_sentence(name: str, kind: str, fmus: dict, tmp_path: Path) -> None:
    draw, place = random.Random(f"{name} {kind}"), c_void_p()
    with host(built(name, kind, fmus, tmp_path)) as one:
        one.start()
        assert one.step(0.0) == OK
        whole = one.state()
        for number in range(DAMAGES):
            one.heard.clear()
            assert take(one, damaged(whole, draw), place) == ERROR, number
            assert len(one.heard) == 1
        assert not place
        assert take(one, whole, place) == OK
        assert one.raw("SetFMUState" if one.three else "SetFMUstate", place) == OK
        assert one.state() == whole
        assert one.step(1e-3) == OK
        assert one.raw("FreeFMUState" if one.three else "FreeFMUstate", byref(place)) == OK


def test_pythonfmu_fmus_promise_no_states(fmus: dict) -> None:
    able = read_model_description(str(fmus["brake", "python"])).coSimulation
    assert not able.canGetAndSetFMUstate
    assert not able.canSerializeFMUstate


# ---- states that Python keeps ------------------------------------------------------------------------------------


def refused(restore: Callable[[bytes], None], whole: bytes, kind: type[Exception]) -> None:
    draw = random.Random(7)
    for _ in range(DAMAGES):
        with pytest.raises(kind):
            restore(damaged(whole, draw))
    restore(whole)


def test_a_kernel_refuses_damaged_states() -> None:
    kernel = Kernel(Library(build_library(sled())))
    kernel.advance(0.1)
    whole = kernel.save()
    refused(kernel.restore, whole, SimulationError)
    assert kernel.save() == whole
    with pytest.raises(SimulationError, match=rf"must have {len(whole)} bytes; got 3\. Pass it unchanged\. Nothing"):
        kernel.restore(whole[:3])


def test_a_simulation_refuses_damaged_states() -> None:
    one = bb.Simulation(sled())
    one.advance(0.1)
    whole = one.save()
    refused(one.restore, whole, SimulationError)
    assert one.save() == whole


def test_a_train_refuses_damaged_states() -> None:
    train = Train(block_train(2), speed=10.0)
    train.advance(0.1)
    whole, draw = train.state, random.Random(3)
    for _ in range(DAMAGES):
        numbers, place = whole.copy(), draw.randrange(whole.size)
        numbers.view(np.uint64)[place] ^= np.uint64(1 << draw.randrange(64))
        with pytest.raises(ValueError, match="The state must be one that this train has saved"):
            train.state = draw.choice([numbers, whole[:place], np.append(whole, numbers[place])])
    train.state = whole
    assert np.array_equal(train.state, whole, equal_nan=True)
    other = Train(block_train(2), settings=Settings(friction=0.5))
    with pytest.raises(ValueError, match="The state must be one that this train has saved"):
        other.state = whole
