"""The content of an FMU around three functions in C, which needs no Python: runtime/step_object.c."""

from __future__ import annotations

from fmu_src.arrays_fmu import ArraysFmu, ArraysInC, ArrayVariable
from fmu_src.objects import RUNTIME
from fmu_src.step_model import StepInC
from fmu_src.system import Variable


def step_in_c(step: StepInC) -> ArraysFmu:
    """Return the FMU of three functions in C, an object whose arrays have one element each."""
    own = {"step_object.c": (RUNTIME / "step_object.c").read_text(encoding="utf-8"), "step_model.h": _numbers(step)}
    model = step.model
    arrays, sources = tuple(_array(one) for one in model.variables), {**step.sources, **own}
    arrays_in_c = ArraysInC(step.name, step.description, arrays, sources, 1, True, foreign=tuple(step.sources))
    starts = [[variable.start] for variable in model.variables]
    return ArraysFmu(arrays_in_c, [1] * len(starts), starts, model.step_size, model.stop_time)


def _array(variable: Variable) -> ArrayVariable:
    """Return the array of a variable; an input takes any value of a sensor, NaN too."""
    limits = (variable.minimum, variable.maximum)
    return ArrayVariable(
        *(variable.name, variable.causality, variable.unit, variable.description, *limits),
        variable.kind == "integer",
        variable.causality == "input",
    )


def _numbers(step: StepInC) -> str:
    """Return step_model.h: the numbers and functions with which step_object.c is compiled."""
    least, most = ({int(getattr(output, limit)) for output in step.outputs} for limit in ("minimum", "maximum"))
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
