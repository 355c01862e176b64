"""WheelSlideProtection: any wheel-slide controller as the content of an FMU.

Names and descriptions only, without FMI.
"""

import re
from collections.abc import Mapping
from pathlib import Path

from brake_controller.pneumatics import APPLY, VALVE
from brake_controller.slide_protection import RIG, SlideProtectionParameters, slide_sources
from fmu_src.step_model import StepInC, StepInPython
from fmu_src.system import Variable, choosing

#: Place of the protocol and the supervision, which travel with a class.
SUPERVISION = Path(__file__).parent / "wheel_slide.py"
OWN_MODULE, OWN_CLASS = f"{__package__}.wheel_slide", "SlideProtection"
#: An import of that class from any module.
OWN_IMPORT = re.compile(rf"^from [\w.]+ import (\([^)]*|[^\n(]*)\b{OWN_CLASS}\b", re.MULTILINE)
PERIOD = 5e-3
#: Header of a controller in C, and the largest size of memory that it may request [bytes].
HEADER, LARGEST_MEMORY = "wheel_slide.h", 1 << 20
#: Wheelsets of a bogie, and the most that one controller protects.
BOGIE, MOST_WHEELSETS = 2, 16


def wheel_slide_protection(wheelsets: int = BOGIE, parameters: SlideProtectionParameters | None = None) -> StepInC:
    """Return the FMU of the built-in protection, by default with its common thresholds.

    wheelsets: number of protected wheelsets; unless it is that of a bogie, 2, the name of the FMU ends with it.
    """
    return _in_c("WheelSlideProtection", OWN_CLASS, slide_sources(parameters), wheelsets)


def wheel_slide_in_python(file: Path, name: str, wheelsets: int = BOGIE) -> StepInPython:
    """Return the FMU of the class `name` in `file`, with the same name.

    wheelsets: as for `wheel_slide_protection`. The file may import from brake_controller.wheel_slide and from packages
    of the host's Python; nothing else is included.
    """
    text = file.read_text(encoding="utf-8")
    if f"class {name}" not in text:
        raise ValueError(f"There is no class {name} in {file}; give --controller FILE:CLASS.")
    if OWN_IMPORT.search(text):
        raise ValueError(f"{OWN_CLASS} must stay out of {file}; it is C. Give a controller in C that calls it.")
    return StepInPython(
        named(name, wheelsets),
        f"Wheel-slide protection: {name}",
        *faces(wheelsets),
        PERIOD,
        [float(APPLY)] * wheelsets,
        # The class after its own definition, because its name may be that of the FMU.
        [SUPERVISION.read_text(encoding="utf-8"), text, f"Chosen = {name}\n"],
        [OWN_MODULE],
        f"Supervised(Chosen(), {wheelsets})",
    )


def wheel_slide_in_c(file: Path, wheelsets: int = BOGIE) -> StepInC:
    """Return the FMU of a controller in C, the three functions of wheel_slide.h, with the name of its file."""
    if not re.fullmatch(r"[A-Za-z_]\w*", file.stem, re.ASCII):
        raise ValueError(f"The name of the file, and of its FMU, must be of letters, digits and _; got {file.name}.")
    sources = {one.name: one.read_text(encoding="utf-8") for one in (file, RIG / HEADER)}
    return _in_c(file.stem, file.name, sources, wheelsets)


def _in_c(name: str, about: str, sources: Mapping[str, str], wheelsets: int) -> StepInC:
    """Return the FMU of the three functions of wheel_slide.h in these sources."""
    return StepInC(
        named(name, wheelsets),
        f"Wheel-slide protection: {about}",
        *faces(wheelsets),
        PERIOD,
        [float(APPLY)] * wheelsets,
        sources,
        HEADER,
        "wheel_slide_size",
        "wheel_slide_start",
        "wheel_slide_step",
        wheelsets,
        LARGEST_MEMORY,
    )


def named(name: str, wheelsets: int) -> str:
    """Return the name of an FMU, which ends with the number of wheelsets unless that is a bogie's."""
    return name + (str(wheelsets) if wheelsets != BOGIE else "")


def faces(wheelsets: int) -> tuple[list[Variable], list[Variable]]:
    """Return inputs and outputs."""
    numbers = range(1, wheelsets + 1)
    inputs = [
        Variable(f"wheel_speed_{number}", "input", "m/s", f"Circumferential speed of the wheels of wheelset {number}")
        for number in numbers
    ]
    text = "Valve of the cylinder of wheelset {}"
    outputs = [
        Variable(f"valve_{number}", "output", start=APPLY, **choosing(text.format(number), VALVE)) for number in numbers
    ]
    return inputs, outputs
