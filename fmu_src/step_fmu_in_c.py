"""An FMU (FMI 2.0, co-simulation) around three functions in C, for hosts that have no Python: step_in_c/fmi2_step.c."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

import fmpy

from fmu_src.archive import write_archive
from fmu_src.codegen import RUNTIME
from fmu_src.compile import FMI_HEADERS, library_suffix, plain_library
from fmu_src.model_description import STEP, model_description
from fmu_src.native_fmu import PLATFORMS, STANDARD_HEADERS, binary_for
from fmu_src.system import StepInC

FACE = Path(__file__).parent / "step_in_c" / "fmi2_step.c"
#: Headers of the runtime that it includes.
SHARED = ("duration.h", "fmi2Functions.h", "sealed.h")


def build_step_fmu_in_c(step: StepInC, path: Path, platforms: Sequence[str] = ()) -> None:
    """Writes the FMU with its sources.

    platforms: names in PLATFORMS, compiled with zig; none: the platform it is built on. Raises CompilerError.
    """
    face = {path.name: path.read_text(encoding="utf-8") for path in (FACE, *(RUNTIME / name for name in SHARED))}
    digest = hashlib.sha256((repr(step) + "".join(face.values())).encode()).hexdigest()
    guid = f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"
    headers = {name: text for name, text in step.sources.items() if name.endswith(".h")}
    ours = face | headers | {"step_model.h": numbers(step, guid)}
    named = sorted(name for name in {**ours, **step.sources} if name.endswith(".c"))
    files = {f"sources/{name}": text.encode() for name, text in {**ours, **step.sources}.items()}
    files |= {f"sources/{name}": (FMI_HEADERS / name).read_bytes() for name in STANDARD_HEADERS[2]}
    about = model_description(step.model, guid, STEP, named)
    for name in platforms or [fmpy.platform]:
        targets, suffix = PLATFORMS[name] if platforms else ((), library_suffix())
        library = binary_for(targets, lambda target: plain_library(ours, step.sources, target))
        files[f"binaries/{name}/{step.name}{suffix}"] = library
    write_archive(path, {"modelDescription.xml": about.encode(), **files})


def numbers(step: StepInC, guid: str) -> str:
    """step_model.h: the numbers and the functions that fmi2_step.c is compiled with."""
    least, most = ({int(getattr(one, limit)) for one in step.outputs} for limit in ("minimum", "maximum"))
    return f"""/* What fmi2_step.c is compiled with. */
#include "{step.header}"
#define GUID "{guid}"
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
