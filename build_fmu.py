"""Builds FMUs and validates them with FMPy.

  python build_fmu.py                    all FMUs, native for FMI 2.0 and 3.0 and pythonfmu, into build/, with their
                                         parameter sets (.ssv) and the systems (.ssp) that connect them
  python build_fmu.py bogie              the bogie only
  python build_fmu.py ssp                bogie and brake, native for FMI 2.0, and BogieBraking.ssp, which connects them
  python build_fmu.py braked-vehicle     the braked vehicle, and the systems that it is part of
  python build_fmu.py --kind native      the native ones for FMI 2.0 only
  python build_fmu.py --platforms all    native FMUs for Linux (x86-64 and ARM), Windows and macOS, compiled with zig
  python build_fmu.py --controller mine.py:FixedSlip
                                         FixedSlip.fmu (pythonfmu): wheel-slide protection by your class FixedSlip
  python build_fmu.py --controller pi.c --wheelsets 4
                                         pi4.fmu (native, without Python): by your controller in C, for a coach
  python build_fmu.py train --consist consist.csv --line line.csv
                                         TrainDynamics.fmu of a consist on a line; the page "A train" says what such
                                         files hold. It needs no compiler where a wheel is installed
  python build_fmu.py coupler --coupler draft-gear
                                         Coupler.fmu, one coupler between two vehicles
  python build_fmu.py --describe         no FMUs: the table of variables as Markdown

Exit status: 0, 1 after a failed build or validation, 2 after bad input, 130 when it was interrupted.
"""

import argparse
import sys
from pathlib import Path

from brake_controller.protection_fmu import BOGIE, MOST_WHEELSETS
from fmu_src.compile import CompilerError
from fmu_src.model_description import variable_table
from fmu_src.suggestion import suggestion
from products.building import KINDS, NATIVE, build_all, build_controller
from products.parameter_sets import write_sets
from products.promised_variables import changes
from products.registry import FMUS, model_of
from products.systems import build_systems
from products.train.building import build_coupler, build_train
from products.train.layout import DEPTHS
from products.train.numbers import SETTING_LIMITS, Settings
from rbd_model.train.coupler import COUPLERS

#: What can be built.
NAMES = (*FMUS, "train", "coupler", "ssp", "all")
#: Cells of a pipe in each vehicle, from and to.
CELLS = SETTING_LIMITS["cells"]


def known(name: str) -> str:
    """The name of what can be built. Raises ArgumentTypeError."""
    if name not in NAMES:
        raise argparse.ArgumentTypeError(f"there is no FMU {name}; {suggestion(name, NAMES)}")
    return name


def main(arguments: list[str] | None = None, program: str | None = None) -> int:
    """Exit status: 0, 1 after a failed build or validation, 2 bad input, 130 interrupted."""
    shape = argparse.RawDescriptionHelpFormatter
    about = (__doc__ or "").replace("python build_fmu.py", program or "python build_fmu.py")
    parser = argparse.ArgumentParser(program, description=about, formatter_class=shape)
    add = parser.add_argument
    add("model", nargs="?", default="all", type=known, metavar="FMU", help=f"{', '.join(NAMES)} (default: all)")
    add("--kind", default="all", choices=[*KINDS, "all"], help="FMI 2.0, FMI 3.0, pythonfmu or all")
    add("--out", type=Path, default=Path("build"), help="folder of the FMUs (default: build)")
    add("--platforms", choices=["own", "all"], default="own", help="of native FMUs (default: own)")
    add("--controller", metavar="FILE", help="only the FMU of FILE.py:CLASS, a wheel-slide protection, or of FILE.c")
    add("--wheelsets", type=int, default=BOGIE, help="of the vehicle that it protects (default: 2)")
    add("--consist", type=Path, metavar="FILE", help="of the train, CSV or TOML (default: a locomotive and 20 wagons)")
    add("--line", type=Path, metavar="FILE", help="that the train runs on, CSV (default: straight and level)")
    add("--coupler", default="screw", choices=[*COUPLERS], help="of the coupler's FMU (default: screw)")
    add("--depth", default="whole", choices=[*DEPTHS], help="of the train's brake (default: whole)")
    add("--cells", type=float, default=2.0, help="of the pipe in each vehicle (default: 2)")
    add("--describe", action="store_true", help="print the table of variables instead of building")
    chosen = parser.parse_args(arguments)
    names = {"all": list(FMUS), "ssp": ["bogie", "brake"]}.get(chosen.model, [chosen.model])
    every = chosen.platforms == "all"
    native_only = every or chosen.model in ("train", "coupler")
    able = ["native"] if chosen.model == "ssp" else [*NATIVE] if native_only else [*KINDS]
    if chosen.kind not in ("all", *able):
        parser.error(f"--kind {chosen.kind} does not go with this; take one of {', '.join(able)}.")
    if not 1 <= chosen.wheelsets <= MOST_WHEELSETS:
        parser.error(f"Set --wheelsets to 1 to {MOST_WHEELSETS}: it was {chosen.wheelsets}.")
    if chosen.model != "train" and (chosen.consist or chosen.line):
        parser.error("--consist and --line are of a train; say: train --consist FILE.")
    if not CELLS[0] <= chosen.cells <= CELLS[1]:
        parser.error(f"Set --cells to {CELLS[0]:g} to {CELLS[1]:g}: it was {chosen.cells:g}.")
    if chosen.model in ("train", "coupler"):
        return train(chosen, able if chosen.kind == "all" else [chosen.kind])
    if chosen.describe:
        print("\n".join(variable_table(model_of(name)) for name in names), end="")
        return 0
    try:
        if chosen.controller:
            kind = "fmi3" if chosen.kind == "fmi3" else "native"
            return build_controller(chosen.controller, chosen.out, chosen.wheelsets, kind)
        kinds = able if chosen.kind == "all" else [chosen.kind]
        problems = build_all(names, kinds, chosen.out, every)
        write_sets(names, chosen.out)
        if "native" in kinds:
            build_systems(names, chosen.out, every)
        for sentence in (one for name in names for one in changes(name)):
            print(sentence)
    except (CompilerError, OSError) as error:
        print(f"The FMUs in {chosen.out} are not complete ({error}).", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"Interrupted; the FMUs that were finished are in {chosen.out}.", file=sys.stderr)
        return 130
    return 1 if problems else 0


def train(chosen: argparse.Namespace, kinds: list[str]) -> int:
    """Builds the FMU of a train or of a coupler; exit status."""
    try:
        if chosen.model == "coupler":
            return 1 if build_coupler(chosen.out, kinds, chosen.coupler, chosen.platforms == "all") else 0
        settings = Settings(depth=chosen.depth, cells=chosen.cells)
        every = chosen.platforms == "all"
        return 1 if build_train(chosen.out, kinds, chosen.consist, chosen.line, settings, every) else 0
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    except (CompilerError, OSError) as error:
        print(f"The FMU of the train was not built ({error}).", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
