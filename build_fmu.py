"""Builds the FMUs and validates them with fmpy.

  python build_fmu.py                    all FMUs, native for FMI 2.0 and 3.0 and pythonfmu, into build/
  python build_fmu.py bogie              the bogie only
  python build_fmu.py ssp                the system BogieBraking.ssp of both native FMUs
  python build_fmu.py --kind native      the native ones for FMI 2.0 only
  python build_fmu.py --platforms all    native FMUs for Linux (x86-64 and ARM), Windows and macOS, compiled with zig
  python build_fmu.py --controller scenarios/bench/own_controller.py:FixedSlip
                                         WheelSlideProtection.fmu (pythonfmu) around a class of one's own
  python build_fmu.py --out elsewhere    another folder
  python build_fmu.py --describe         no FMUs: the table of variables as Markdown

A new FMU is one function that returns a Model, and one line in MODELS.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

from fmpy import read_model_description
from fmpy.validation import validate_fmu

from brake_controller.cylinder import brake_cylinder
from brake_controller.parameters import qr30
from brake_controller.protection_fmu import wheel_slide_protection
from fmu_src.codegen import generate, guid_of
from fmu_src.compile import CompilerError
from fmu_src.model_description import variable_table
from fmu_src.native_fmu import PLATFORMS, PLATFORMS3, build_native_fmu, build_native_fmu3
from fmu_src.python_fmu import build_python_fmu
from fmu_src.ssp import Component, Connection, write_ssp
from fmu_src.step_fmu import build_step_fmu
from fmu_src.system import Model, StepModel
from rbd_model.bogie import bogie_dynamics, wheelset_dynamics
from rbd_model.parameters import tables_8_1_and_8_2
from rbd_model.rail_recovery import rail_adhesion

MODELS: dict[str, Callable[[], Model]] = {
    "bogie": bogie_dynamics,
    "wheelset": wheelset_dynamics,
    "brake": brake_cylinder,
    "rail": rail_adhesion,
}
ROOT = Path(__file__).resolve().parent
#: Where the FMUs of this checkout live.
BUILD = ROOT / "build"
#: Picture on the page inside each FMU.
PICTURES = {
    "BogieDynamics": "qr30-180kpa.png",
    "WheelsetDynamics": "wheelset-hunting.png",
    "BrakeCylinder": "qr30-180kpa.png",
    "RailAdhesion": "qr30-180kpa.png",
}


def extras(model: Model, icon: str) -> dict[str, bytes]:
    """The page's picture, the license and the icon of an FMU."""
    files = {
        "documentation/picture.png": ROOT / "docs" / PICTURES[model.name],
        "documentation/licenses/license.txt": ROOT / "LICENSE",
        icon: ROOT / "docs" / "icon.png",
    }
    return {name: file.read_bytes() for name, file in files.items()}


def build_native(model: Model, path: Path, all_platforms: bool = False) -> None:
    build_native_fmu(model, path, list(PLATFORMS) if all_platforms else [], extras(model, "model.png"))


def build_native3(model: Model, path: Path, all_platforms: bool = False) -> None:
    platforms = list(PLATFORMS3) if all_platforms else []
    build_native_fmu3(model, path, platforms, extras(model, "terminalsAndIcons/icon.png"))


NATIVE: dict[str, Callable[..., None]] = {"native": build_native, "fmi3": build_native3}
#: How each kind is built: native for FMI 2.0 and for FMI 3.0, and pythonfmu.
BUILDERS: dict[str, Callable[..., None]] = NATIVE | {"python": build_python_fmu}


def fmu_path(model: Model, kind: str, out: Path) -> Path:
    return out / kind / f"{model.name}.fmu"


def up_to_date(name: str, kind: str, out: Path = BUILD) -> Path:
    """Path of an FMU, built now unless the file in `out` has the present content."""
    model = MODELS[name]()
    path = fmu_path(model, kind, out)
    if guid_in(path) != guid_of(generate(model)):
        BUILDERS[kind](model, path)
    return path


def guid_in(path: Path) -> str | None:
    """GUID of an FMU file; None when there is no readable one."""
    try:
        return str(read_model_description(str(path), validate=False).guid)
    except Exception:  # fmpy raises whatever zip, XML or file system raise; any of them means: build it
        return None


#: The system: the QR30 bogie of the experiment, its trailing wheelset braked by a cylinder at 180 kPa from the start.
SYSTEM, EXPERIMENT = "BogieBraking", (5.0, 1e-3)


def build_system(out: Path) -> Path:
    """Writes OUT/BogieBraking.ssp: both native FMUs connected, with the parameters of the experiment."""
    bogie, brake = (fmu_path(MODELS[name](), "native", out) for name in ("bogie", "brake"))
    known = {variable.name for variable in MODELS["bogie"]().variables}
    parameters = {key: value for key, value in tables_8_1_and_8_2().values().items() if key in known}
    parameters |= {"level": 2, "initial_speed": 2.9, "friction_1": 0.18, "friction_2": 0.18}
    path = out / f"{SYSTEM}.ssp"
    write_ssp(
        path,
        SYSTEM,
        [
            Component("brake", brake, qr30(180).values() | {"pressure_demand": 180e3}, ["cylinder_pressure"]),
            Component("bogie", bogie, parameters, ["speed", "distance"]),
        ],
        [
            Connection(("brake", "brake_torque"), ("bogie", "brake_torque_2")),
            Connection(("bogie", "angular_velocity_2"), ("brake", "angular_velocity")),
        ],
        EXPERIMENT,
    )
    print(f"{path}  {path.stat().st_size / 1000:.0f} kB")
    return path


def build(name: str, kind: str, out: Path, all_platforms: bool = False) -> list[str]:
    """Builds one FMU, prints its line and returns the problems that fmpy finds."""
    begin = time.perf_counter()
    model = MODELS[name]()
    path = fmu_path(model, kind, out)
    if all_platforms:
        NATIVE[kind](model, path, all_platforms)
    else:
        BUILDERS[kind](model, path)
    problems = validate_fmu(str(path))
    seconds, size = time.perf_counter() - begin, path.stat().st_size / 1000
    verdict = "valid" if not problems else f"{len(problems)} problems"
    print(f"{path}  {size:.0f} kB  {seconds:.1f} s  {len(model.variables)} variables  {verdict}")
    return [f"{path}: {problem}" for problem in problems]


def build_protection(out: Path = BUILD, controller: StepModel | None = None) -> Path:
    """Writes OUT/python/WheelSlideProtection.fmu around a controller, by default the one that comes with the brake."""
    step = controller or wheel_slide_protection()
    path = out / "python" / f"{step.name}.fmu"
    build_step_fmu(step, path)
    return path


def build_controller(text: str, out: Path) -> int:
    """The FMU of FILE:CLASS; exit status 0, or 2 with a sentence."""
    file, _, name = text.rpartition(":")
    try:
        path = build_protection(out, wheel_slide_protection(Path(file), name))
    except (OSError, ValueError, ImportError, SyntaxError, NameError) as error:
        print(f"{text} does not become an FMU: {error}", file=sys.stderr)
        return 2
    problems = validate_fmu(str(path))
    print(f"{path}  {path.stat().st_size / 1000:.0f} kB  {problems or 'valid'}")
    return 1 if problems else 0


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", nargs="?", default="all", choices=[*MODELS, "ssp", "all"])
    parser.add_argument(
        "--kind",
        default="all",
        choices=[*BUILDERS, "all"],
        help="native (FMI 2.0), fmi3 (native, FMI 3.0), python (pythonfmu, FMI 2.0) or all",
    )
    parser.add_argument("--out", type=Path, default=Path("build"), help="folder of the FMUs (default: build)")
    parser.add_argument("--platforms", choices=["own", "all"], default="own", help="of native FMUs (default: own)")
    parser.add_argument("--controller", metavar="FILE:CLASS", help="only WheelSlideProtection.fmu, around this class")
    parser.add_argument("--describe", action="store_true", help="print the table of variables instead of building")
    chosen = parser.parse_args(arguments)
    names = {"all": list(MODELS), "ssp": ["bogie", "brake"]}.get(chosen.model, [chosen.model])
    if chosen.describe:
        print("\n".join(variable_table(MODELS[name]()) for name in names), end="")
        return 0
    if chosen.controller:
        return build_controller(chosen.controller, chosen.out)
    kinds = list(BUILDERS) if chosen.kind == "all" else [chosen.kind]
    if chosen.model == "ssp":
        kinds = ["native"]
    elif chosen.platforms == "all":
        kinds = [kind for kind in kinds if kind in NATIVE]  # a pythonfmu FMU has the binaries of pythonfmu
    problems: list[str] = []
    try:
        for kind in kinds:
            for name in names:
                problems += build(name, kind, chosen.out, chosen.platforms == "all")
        if chosen.model in ("all", "ssp") and "native" in kinds:
            build_system(chosen.out)
    except CompilerError as error:
        print(error, file=sys.stderr)
        return 1
    except OSError as error:
        print(
            f"The FMUs cannot be written to {chosen.out} ({error}); choose another folder with --out.", file=sys.stderr
        )
        return 1
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
