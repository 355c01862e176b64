"""Definitions that exist twice, in C or in C and Python: structures, and the function tables of objects."""

from __future__ import annotations

import ctypes
import re
import subprocess
from pathlib import Path

import numpy as np

from brake_controller.slide_protection import RIG
from fmu_src import batch, kernel
from fmu_src.codegen import RUNTIME
from fmu_src.compile import compiler
from fmu_src.objects import ARRAYS, KERNEL
from products import controller_kinds
from products.protection import rig_in_c
from products.train import library
from products.train.layout_in_c import layout_in_c

HEADERS = ("rig.h", "pipe.h", "status.h", "batch.h")
MIRRORED: dict[str, type[ctypes.Structure]] = {
    "encoder_settings": rig_in_c.SensorSettings,
    "rig_settings": rig_in_c.RigSettings,
    "rig_wheelset": rig_in_c.RigWheelset,
    "rig_notes": rig_in_c.RigNotes,
    "rig_desk": rig_in_c.Desk,
    "rig_controller": controller_kinds.FunctionsInC,
    "pipe_outside": library.OutsideInC,
    "pipe_passed": library.PassedInC,
    "kernel_sentence": kernel._Sentence,
    "batch_runs": batch._Runs,
    "batch_steps": batch._Steps,
}


def laid_in_python() -> dict[str, int]:
    """Return the sizes of structures and the offsets of their fields."""
    found = {name: ctypes.sizeof(one) for name, one in MIRRORED.items()}
    for name, one in MIRRORED.items():
        found |= {f"{name}.{field[0]}": getattr(one, field[0]).offset for field in one._fields_}
    places = rig_in_c.SCORE.fields
    assert places is not None
    return found | {"rig_score": rig_in_c.SCORE.itemsize} | {f"rig_score.{n}": at[1] for n, at in places.items()}


def test_structures_are_the_same_in_c_and_in_python(tmp_path: Path) -> None:
    """Sizes and field offsets are equal."""
    laid = laid_in_python()
    rows = []
    for name in laid:
        kind, _, field = name.partition(".")
        rows.append(f'    printf("{name} %zu\\n", {f"offsetof({kind}, {field})" if field else f"sizeof({kind})"});')
    includes = [f'#include "{name}"' for name in HEADERS]
    text = "\n".join([*includes, "#include <stdio.h>", "int main(void) {", *rows, "    return 0;", "}", ""])
    (tmp_path / "train_layout.h").write_text(layout_in_c())
    (tmp_path / "laid.c").write_text(text)
    folders = [f"-I{one}" for one in (RIG, library.FOLDER, RUNTIME, tmp_path)]
    program = tmp_path / "laid"
    subprocess.run([*compiler(), *folders, str(tmp_path / "laid.c"), "-o", str(program)], check=True)
    told = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    assert {name: int(number) for name, number in (line.split() for line in told.splitlines())} == laid
    fields = sum(len(one._fields_) for one in MIRRORED.values()) + len(np.dtype(rig_in_c.SCORE).names or ())
    assert len(laid) == len(MIRRORED) + 1 + fields


def test_tables_of_objects_name_the_members_in_their_order() -> None:
    """modelDescription.xml is generated from these comments; a NULL row has no other name."""
    header = (RUNTIME / "object.h").read_text()
    struct = header[header.index("/* Members that are not marked") : header.index("} object_functions;")]
    code = re.sub(r"/\*.*?\*/", "", struct, flags=re.DOTALL)
    members = re.findall(r"\(\*(\w+)\)\(|\*(exchange);", code)
    names = [one or other for one, other in members]
    assert len(names) == code.count(";")
    for file in (KERNEL, ARRAYS):
        rows = re.findall(r"^    /\* (\w+) \*/ (\S+),$", (RUNTIME / file).read_text(), re.MULTILINE)
        assert [name for name, _ in rows] == names
        given = {name: function for name, function in rows if function not in ("NULL", "&EXCHANGE")}
        assert given == {name: f"object_{name}" for name in given}
