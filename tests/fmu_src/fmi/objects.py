"""A small example of each kind of FMU object, linked with a program in C under sanitizers."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brake_controller.protection_fmu import wheel_slide_in_c
from fmu_src.arrays_fmu import all_sources
from fmu_src.codegen import generate
from fmu_src.compile import FLAGS, FOREIGN_FLAGS, compiler, objects_of
from fmu_src.step_fmu_in_c import step_in_c
from fmu_src.system import Model, System, Variable, model_of_choices
from products.braking_curves.fmu import curves_in_c
from products.protection.sensor_fmu import sensor_in_c
from products.train.consist import Consist, block_train
from products.train.consist_file import consist_of
from products.train.coupler_fmu import coupler_in_c
from products.train.driver_fmu import driver_in_c
from products.train.fmu import train_in_c
from products.train.numbers import Settings, numbers_of
from rbd_model.levels.models import bogie_dynamics, places_of
from rbd_model.track.line import arc, line_of, straight
from rbd_model.track.line_table import along_line
from rbd_model.train.coupler import screw_coupler
from tests.fmu_src.fmi.sanitized import HEADERS, SANITIZERS, driver, sanitized
from tests.fmu_src.fmi.sled import sled

SPEED, GRIP, LENGTH = 3.0, 2.0, 4.0
#: Controller that counts its calls. It returns the count modulo 3, or the negative of a negative speed.
COUNTS = """
#include "wheel_slide.h"
typedef struct { int wheelsets, asked; double period; } memory_of_one;
size_t wheel_slide_size(int wheelsets) { return wheelsets > 0 ? sizeof(memory_of_one) : 0; }
void wheel_slide_start(void *memory, int wheelsets, double period)
{
    memory_of_one *self = memory;
    self->wheelsets = wheelsets;
    self->period = period;
}
void wheel_slide_step(void *memory, double time, const double *speed, int *valve)
{
    memory_of_one *self = memory;
    int unused;  /* a warning of one's own code is no error */
    (void)time;
    ++self->asked;
    for (int i = 0; i < self->wheelsets; ++i) valve[i] = speed[i] < 0 ? (int)-speed[i] : self->asked % 3;
}
"""


def brick(detail: int, on_a_line: bool = False) -> System:
    """Return a brick on a table with an end, pushed through gears and by a line. At detail 2 it also warms up."""
    system = System(f"brick_{detail}{'_on_a_line' * on_a_line}", "A brick on a table")
    push = system.input(Variable("push", "input", "N", "Force forward"))
    grip = system.input(Variable("grip", "input", "N", "Largest friction", GRIP, 0.0))
    gear = system.input(Variable("gear", "input", "1", "Multiplies the push", 1.0, 0.0, 3.0, kind="integer"))
    x, v = system.state("x", "m", 0.0, 1.0), system.state("v", "m/s", SPEED, 2.0)
    direction = system.direction("direction")
    drive = gear * push
    if on_a_line:
        drive += along_line(system, "heading", x, 1)[1]
    system.derivative(x, v)
    system.derivative(v, direction**2 * (drive - direction * grip))
    system.dry_friction("The brick", direction, [v], drive, grip, ("stuck", "slides"))
    system.end_when_negative(1 - x / LENGTH, "The brick fell off at %s s.")
    system.warn_when_negative(0.5 - x, "The brick passed half a metre at %s s.")
    system.output(Variable("way", "output", "m", "Way"), x)
    system.output(Variable("speed", "output", "m/s", "Speed"), v)
    system.output(Variable("stuck", "output", "1", "It is stuck", kind="boolean"), direction == 0)
    if detail == 2:
        system.derivative(system.state("heat", "J", 0.0, 1.0), grip * v)
    return system


def bricks() -> Model:
    """Return the brick at two levels of detail, and on a line at the first."""
    detail = Variable("detail", "parameter", "1", "Level of detail", 1.0, 1.0, 2.0, kind="integer")
    on_a_line = brick(1, on_a_line=True)
    assert on_a_line.table_file
    systems, file = (brick(1), brick(2), on_a_line), on_a_line.table_file.variable
    return model_of_choices("Brick", "A brick on a table", systems, [detail], (0, 1, 2, -1), 1e-8, file)


def _nothing(folder: Path) -> list[str]:
    return []


def _lines(folder: Path) -> list[str]:
    """Write two lines, a copy of one under a name that is a format, and two invalid files."""
    curve = line_of([arc(300, 250, 0.1, 0.02)]).write(folder / "curve.csv")
    copy = shutil.copy(curve, folder / "copy, 100 %s.csv")
    (folder / "bad.csv").write_bytes(b"%s%n,\xff\xfe\n1,2,3\n")
    (folder / "bad_empty.csv").write_text("")
    straightforward = line_of([straight(9000)]).write(folder / "straight.csv")
    return [str(one) for one in (curve, copy, straightforward, *sorted(folder.glob("bad*")))]


def _coupler(folder: Path) -> list[str]:
    np.array(screw_coupler().constants(), "<f8").tofile(folder / "coupler.bin")
    return []


def _gradients(folder: Path) -> list[str]:
    np.array([3.0, 0.0, 400.0, 900.0, 5.0, -8.0, 2.0], "<f8").tofile(folder / "gradients.bin")
    return []


def _train(folder: Path, consist: Consist | None = None, cells: float = 0.5) -> list[str]:
    numbers = numbers_of(consist or block_train(2), Settings(cells=cells), None)
    np.asarray(numbers, "<f8").tofile(folder / "train.bin")
    return []


def _equipped_train(folder: Path) -> list[str]:
    """Write a train with a cab, motors, electric and parking brakes, wheel-slide protection, a coupler that breaks."""
    slides = {"kind": "coach", "protection": "built-in", "friction_ratio": 0.4, "friction_decay": 0.6}
    head = {"kind": "locomotive", "direct_pressure": 3.8, "main_reservoir": 100, "vigilance_time": 1}
    head |= {"traction_table": "0:200 100:50", "dynamic_force": 80, "blending": "interlock", "parking_force": 20}
    last = slides | {"brake": "ep-direct", "direct_pressure": 2, "disc_mass": 100, "discs": 8}
    return _train(folder, consist_of([head, slides | {"coupler_strength": 50}, last]), 1.0)


def _controller(folder: Path) -> Mapping[str, str]:
    (folder / "counts.c").write_text(COUNTS)
    return all_sources(step_in_c(wheel_slide_in_c(folder / "counts.c")).given)


@dataclass(frozen=True)
class Behind:
    """Sources of an object, its files, its features, and the arguments of machine.c.

    `sources`: the generated sources of a kernel, else all sources.
    `files`: writes the object's files to a folder of resources; returns the paths of lines.
    `words`: ranges of the variables.
    `kernel`: whether the object is a kernel.
    `exchange`: whether it supports model exchange.
    `ends`: whether its runs end by themselves.
    `calls`: share of the usual number of calls, for slow objects.
    """

    sources: Callable[[Path], Mapping[str, str]]
    files: Callable[[Path], list[str]]
    words: str
    kernel: bool = False
    exchange: bool = False
    reads_files: bool = False
    ends: bool = False
    calls: float = 1.0

    def linked(self, program: Path, folder: Path) -> Path:
        """Link the program with the object and its FMI functions, under sanitizers."""
        texts = self.sources(folder)
        if self.kernel:
            return driver(sanitized(texts), program, folder)
        flags = [*FLAGS, "-O1", *SANITIZERS]
        own = {name for name, text in texts.items() if text == COUNTS}
        headers = {name: text for name, text in texts.items() if name.endswith(".h")}
        for name, text in headers.items():
            (folder / name).write_text(text)
        objects = objects_of({name: text for name, text in texts.items() if name not in own}, flags)
        objects += objects_of(dict.fromkeys(own, COUNTS) | headers, [*FOREIGN_FLAGS, "-O1", *SANITIZERS])
        return driver([*compiler(), *FLAGS, *SANITIZERS, f"-I{folder}", *HEADERS, *objects], program, folder)


OBJECTS = {
    "sled": Behind(
        lambda _: generate(sled()),
        _nothing,
        "push=-9:21 lift=-9:21 brake=0:21 mass=9.7:10.3 initial_speed=1.94:2.06 length=2.9:3.1 push>pace=1e-3",
        kernel=True,
        ends=True,
    ),
    "brick": Behind(
        lambda _: generate(bricks()),
        _lines,
        "push=-1:2 grip=0:3 gear=1:2 detail=1:2 off=detail:2",
        kernel=True,
        exchange=True,
        ends=True,
    ),
    "bogie": Behind(
        lambda _: generate(bogie_dynamics(places=(*places_of(1), *places_of(2)))),
        _lines,
        "level=1:2 off=level:0 initial_speed=24:26 brake_torque_1=0:2e4 brake_torque_2=0:2e4 traction_torque_1=0:5e3 "
        "friction_1=0.29:0.31 drawbar_force=-30:30 gradient=-0.01:0.01",
        kernel=True,
        exchange=True,
    ),
    "bogie in space": Behind(
        lambda _: generate(bogie_dynamics(places=places_of(3, on_line=False))),
        _nothing,
        "contact_model=1:3 off=contact_model:0 initial_speed=24:26 brake_torque_1=0:2e4 brake_torque_2=0:2e4 "
        "friction_1=0.29:0.31",
        kernel=True,
        exchange=True,
        calls=0.1,
    ),
    "coupler": Behind(
        lambda _: all_sources(coupler_in_c()), _coupler, "way=-0.02:0.02 coupling_closed=0:1", reads_files=True
    ),
    "train": Behind(
        lambda _: all_sources(train_in_c()),
        _train,
        "driver_position=0:4 driver_step=0:1 pull=-1e4:1e4 friction=0.1:0.3 protection=0:2 coupling_closed=0:1 "
        "start_speed=-1:20 start_pipe_pressure=4e5:5e5 end_force=-1e3:1e3",
        reads_files=True,
    ),
    "equipped train": Behind(
        lambda _: all_sources(train_in_c()),
        _equipped_train,
        "driver_position=0:6 driver_step=0:1 pull=-1e4:1e4 friction=0.02:0.3 coupling_closed=0:1 direct_brake=0:1 "
        "bail_off=0:1 penalty=0:2 vigilance=0:1 dynamic_brake=0:1 traction=0:1 parking_brake=0:1 start_speed=-1:20 "
        "start_pipe_pressure=4e5:5e5 end_force=-1e5:1e5",
        reads_files=True,
    ),
    "sensor": Behind(
        lambda _: all_sources(sensor_in_c()),
        _nothing,
        "rotation_1=-50:50 rotation_2=-50:50 period=1e-3:1e-2",
    ),
    "curves": Behind(
        lambda _: all_sources(curves_in_c()),
        _gradients,
        "V_est=-1:60 A_est=-1:1 distance_to_target=-50:1500 distance=0:1000 V_MRSP=0:60 V_release=0:5 "
        "beyond=0:100 length=20:700 T_brake_emergency=0:5 T_traction_cut_off=0:5 service_command=0:1 baseline=3:4",
        reads_files=True,
    ),
    "driver": Behind(
        lambda _: all_sources(driver_in_c()),
        _nothing,
        "speed=-1:40 distance=0:2500 V_P=0:40 distance_P=0:1500 service_brake=0:1 emergency_brake=0:1 target=1000:2000",
    ),
    "controller": Behind(_controller, _nothing, "wheel_speed_1=-4:20 wheel_speed_2=-4:20 period=1e-3:1e-2", ends=True),
}
