"""Thresholds of the built-in wheel-slide protection, and its C code (rig/slide_protection.c)."""

import math
from dataclasses import astuple, dataclass, fields
from pathlib import Path

#: Folder of the C code.
RIG = Path(__file__).parent / "rig"
#: The C code of the protection, without the header that is written from its thresholds.
FILES = ("slide_protection.c", "slide_numbers.h", "slide_protection.h", "wheel_slide.h")
#: The header of all controllers in C.
OWN_HEADER = "wheel_slide.h"


@dataclass(frozen=True)
class SlideProtectionParameters:
    """Thresholds of `SlideProtection`; all finite and not below 0."""

    #: Slip speed below which the brake is applied further, and above which it is vented; between them it is held [m/s].
    #: Below 8 m/s both become smaller with the speed.
    lower_slip: float
    upper_slip: float
    #: Slip that is evidence of sliding [1], and the same in m/s at low speed.
    evident_slip: float
    least_evident_slip: float
    #: Time by which a change of slip is anticipated [s].
    lead_time: float
    #: Durations of the lines through readings: for the slip, and for evidence, the reference and gains of speed [s].
    fit_time: float
    calm_time: float
    #: Largest deceleration of rolling wheels on any rail [m/s2].
    largest_deceleration: float
    #: Longest time of sliding without a sample of the true speed, and longest time of continuous venting [s].
    synchronising_period: float
    watchdog: float
    #: Reference speed below which no wheel is protected: all brakes apply [m/s].
    slowest: float

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"{item.name} must be finite and at least 0; got {value}. Give such a number.")
        if not self.upper_slip > self.lower_slip:
            raise ValueError(
                f"upper_slip must be above lower_slip, {self.lower_slip}; got {self.upper_slip}. Increase it."
            )


def common_protection() -> SlideProtectionParameters:
    """Return assumed thresholds, chosen on half of the rails of a test suite (docs/fitted.md).

    The slip is that of (2.10) times the speed, with the reference speed as that of the car.
    """
    return SlideProtectionParameters(
        lower_slip=0.4,
        upper_slip=0.8,
        evident_slip=0.08,
        least_evident_slip=0.6,
        lead_time=0.1,
        fit_time=0.06,
        calm_time=0.2,
        largest_deceleration=4.4,
        synchronising_period=8.0,
        watchdog=5.0,
        slowest=0.3,
    )


def slide_sources(parameters: SlideProtectionParameters | None = None) -> dict[str, str]:
    """Return the C code of the protection by file name, with these thresholds or `common_protection()`."""
    chosen = parameters or common_protection()
    names = ", ".join(item.name for item in fields(chosen))
    header = (
        "/* Thresholds of the wheel-slide protection, and those that it starts with: written from\n"
        " * SlideProtectionParameters, which has their units and limits. */\n"
        "#ifndef SLIDE_THRESHOLDS_H\n#define SLIDE_THRESHOLDS_H\n"
        f"typedef struct {{ double {names}; }} slide_thresholds;\n"
        f"#define SLIDE_COMMON {{ {', '.join(repr(float(one)) for one in astuple(chosen))} }}\n"
        "#endif\n"
    )
    return {name: (RIG / name).read_text(encoding="utf-8") for name in FILES} | {"slide_thresholds.h": header}


def controlled() -> dict[str, str]:
    """Return the C of the sensors and of the built-in protection, by file name."""
    return {name: (RIG / name).read_text(encoding="utf-8") for name in ("encoder.c", "encoder.h")} | slide_sources()


def guarded() -> dict[str, str]:
    """Return the same, and the C that calls a controller in guarded memory."""
    return {name: (RIG / name).read_text(encoding="utf-8") for name in ("guarded.c", "guarded.h")} | controlled()


def one_file() -> str:
    """Return the C code of the protection as one file, which includes wheel_slide.h and the standard library only."""
    sources = slide_sources()
    standard: list[str] = []

    def opened(name: str) -> str:
        lines = []
        for line in sources.pop(name, "").splitlines():
            if line.startswith("#include <"):
                standard.append(line)
            elif line.startswith('#include "') and line != f'#include "{OWN_HEADER}"':
                lines.append(opened(line.split('"')[1]))
            elif line != f'#include "{OWN_HEADER}"':
                lines.append(line)
        return "\n".join(lines).strip("\n")

    text = opened(FILES[0])
    included = "\n".join([f'#include "{OWN_HEADER}"', "", *standard])
    return f"{included}\n\n{text}\n"
