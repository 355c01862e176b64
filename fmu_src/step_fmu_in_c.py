"""An FMU (FMI 2.0 or 3.0, co-simulation) around three functions in C, which needs no Python: runtime/step_object.c."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import fmpy

from fmu_src.arrays_fmu import ArraysInC, ArrayVariable, Lengths, all_sources, build_arrays_fmu
from fmu_src.compile import library_suffix, plain_library
from fmu_src.native_fmu import PLATFORMS, PLATFORMS3, binary_for
from fmu_src.objects import RUNTIME
from fmu_src.system import StepInC, Variable


def build_step_fmu_in_c(step: StepInC, path: Path, platforms: Sequence[str] = (), version: int = 2) -> None:
    """Write the FMU with its sources."""
    known, own = (PLATFORMS, fmpy.platform) if version == 2 else (PLATFORMS3, fmpy.platform_tuple)
    given, binaries = step_in_c(step), {}
    for name in platforms or [own]:
        targets, suffix = known[name] if platforms else ((), library_suffix())
        binaries[f"{name}/{step.name}{suffix}"] = binary_for(targets, lambda target: _library(step, target))
    starts = [[one.start] for one in step.model.variables]
    of = Lengths([1] * len(starts), starts, step.model.step_size, step.model.stop_time)
    build_arrays_fmu(given, of, path, version, binaries, {})


def _library(step: StepInC, target: str | None) -> Path:
    """Return the path of the binary; the files of a user may have warnings. Raises CompilerError."""
    texts = all_sources(step_in_c(step))
    ours = {name: text for name, text in texts.items() if name not in step.sources or name.endswith(".h")}
    return plain_library(ours, step.sources, target)


def step_in_c(step: StepInC) -> ArraysInC:
    """Return the three functions as an object whose arrays have one element each."""
    own = {"step_object.c": (RUNTIME / "step_object.c").read_text(encoding="utf-8"), "step_model.h": _numbers(step)}
    arrays = tuple(_array(one) for one in step.model.variables)
    return ArraysInC(step.name, step.description, arrays, {**step.sources, **own}, stride=1, starts_alone=True)


def _array(one: Variable) -> ArrayVariable:
    """Return the array of a variable; an input takes any value of a sensor, NaN too."""
    limits = (one.minimum, one.maximum)
    return ArrayVariable(
        *(one.name, one.causality, one.unit, one.description, *limits), one.kind == "integer", one.causality == "input"
    )


def _numbers(step: StepInC) -> str:
    """Return step_model.h: the numbers and functions with which step_object.c is compiled."""
    least, most = ({int(getattr(one, limit)) for one in step.outputs} for limit in ("minimum", "maximum"))
    return f"""/* What step_object.c is compiled with. */
#include "{step.header}"
#define INPUTS {len(step.inputs)}
#define OUTPUTS {len(step.outputs)}
#define PERIOD {step.period!r}
#define SAFE {int(step.safe[0])}
#define LEAST {least.pop()}
#define MOST {most.pop()}
#define COUNT {step.count}
#define LARGEST_MEMORY {step.largest}
#define MEMORY {step.size}
#define START {step.start}
#define STEP {step.step}
"""
