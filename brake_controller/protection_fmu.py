"""WheelSlideProtection: any wheel-slide controller as the content of an FMU. Names and texts only, FMI is elsewhere."""

from pathlib import Path

from brake_controller.wheel_slide import APPLY, VENT
from fmu_src.system import StepModel, Variable

#: Place of the protocol, the supervision and the protection that comes with the brake.
PROTECTION = Path(__file__).parent / "wheel_slide.py"
OWN_MODULE, OWN_CLASS = f"{__package__}.wheel_slide", "SlideProtection"
PERIOD = 5e-3
#: Wheelsets of a bogie.
BOGIE = 2


def wheel_slide_protection(file: Path | None = None, name: str = OWN_CLASS, wheelsets: int = BOGIE) -> StepModel:
    """The FMU of the class `name` in `file`, and called like it; by default the protection that comes with the brake.

    wheelsets: how many it protects; where they are not a bogie's two, the name of the FMU ends with their number. The
    file may import from brake_controller.wheel_slide and from what the host's Python has; nothing else travels with it.
    Raises ValueError where there is no such class.
    """
    sources = [PROTECTION.read_text(encoding="utf-8")]
    if file is not None:
        text = file.read_text(encoding="utf-8")
        if f"class {name}" not in text:
            raise ValueError(f"There is no class {name} in {file}; give --controller FILE:CLASS.")
        sources.append(text)
    numbers = range(1, wheelsets + 1)
    inputs = [
        Variable(f"wheel_speed_{number}", "input", "m/s", f"Circumferential speed of the wheels of wheelset {number}")
        for number in numbers
    ]
    outputs = [
        Variable(
            f"valve_{number}",
            "output",
            "1",
            f"Valve of the cylinder of wheelset {number}: 0 apply, 1 hold, 2 vent",
            APPLY,
            APPLY,
            VENT,
            "integer",
        )
        for number in numbers
    ]
    # The class behind its own name, which may be that of the FMU.
    sources.append(f"Chosen = {name}\n")
    return StepModel(
        ("WheelSlideProtection" if file is None else name) + (str(wheelsets) if wheelsets != BOGIE else ""),
        f"Wheel-slide protection: {name}",
        inputs,
        outputs,
        PERIOD,
        sources,
        [OWN_MODULE],
        f"Supervised(Chosen(), {wheelsets})",
        [float(APPLY)] * wheelsets,
    )
