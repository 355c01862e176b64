"""Builds FMUs and validates them with FMPy.

  python build_fmu.py                    the list of FMUs
  python build_fmu.py bogie              the bogie into build/, with its parameter sets (.ssv) and the systems (.ssp)
                                         that it is part of; native for FMI 2.0 and 3.0, and pythonfmu
  python build_fmu.py all                every FMU of the list

  python build_fmu.py ssp                bogie, brake and BogieBraking.ssp, which connects them
  python build_fmu.py all --kind native --platforms all
                                         for FMI 2.0 on Linux (x86-64 and ARM), Windows and macOS, compiled with zig

  python build_fmu.py --controller pi.c --wheelsets 4
                                         pi4.fmu: your wheel-slide controller in C, for a coach
  python build_fmu.py --controller mine.py:FixedSlip
                                         FixedSlip.fmu: your class in Python

  python build_fmu.py train --consist consist.csv --line line.csv
                                         a train on a line; a wheel needs no compiler for it, only FMPy

  python build_fmu.py coupler --coupler draft-gear
  python build_fmu.py sensor --wheelsets 4
  python build_fmu.py curves --line line.csv
                                         supervision by ETCS, with the gradients of a line
  python build_fmu.py curves --train results/etcs-consist.json
                                         of the train whose data `bogie-braking etcs consist.toml` wrote
  python build_fmu.py ssp --consist consist.toml --train results/etcs-consist.json --target 2000 --speed 100km/h
                                         SupervisedTrain.ssp: the train, its curves and a driver, connected

  python build_fmu.py bogie --describe   no FMU: the table of its variables as Markdown

Exit status: 0 all FMUs are valid; 1 one is not valid; 2 bad input; 3 one was not built; 130 interrupted with Ctrl-C.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from brake_controller.protection_fmu import BOGIE, MOST_WHEELSETS
from fmu_src.compile import CompilerError
from fmu_src.model_description import variable_table
from products.building import KINDS, NATIVE, build_all, build_controller, variables_of
from products.parameter_sets import write_sets
from products.registry import ALIASES, FMUS, IN_C, fmu_named
from products.supervised_train import NEEDED, SupervisedRun, supervised, write_supervised_train
from products.systems import build_systems, say_system
from products.train.layout import BRAKE_MODELS
from products.train.numbers import SETTING_LIMITS
from rbd_model.train.coupler import COUPLERS
from readers.command_line import CommandLine, check_folder, quantity, whole
from readers.extras import need
from readers.text import BadInputError

#: Name of this program.
PROGRAM = "python build_fmu.py"
#: Options of the FMUs in C, which each has the function in IN_C, and their defaults.
OWN_OPTIONS = {
    "consist": None,
    "line": None,
    "coupler": "screw",
    "brake_model": "whole",
    "cells": 2.0,
    "wheelsets": BOGIE,
    "train": None,
    "national": None,
    "target": None,
    "speed": None,
    "start_speed": None,
}
#: Options of SupervisedTrain.ssp.
OF_SSP = ("consist", "line", "brake_model", "cells", "train", "national", "target", "speed", "start_speed")
#: Names of FMUs and systems.
NAMES = (*FMUS, *IN_C, "ssp", "all")
#: Exit status.
DONE, NOT_VALID, BAD_INPUT, FAILED, INTERRUPTED = 0, 1, 2, 3, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Build the FMUs of a command line; return the exit status."""
    parser = CommandLine(PROGRAM)
    add_arguments(parser)
    try:
        return run(parser.parse_args(arguments))
    except BadInputError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT


def run(chosen: argparse.Namespace) -> int:
    """Build the chosen FMUs; return the exit status. Raises BadInputError."""
    if chosen.model is None and not (chosen.controller or chosen.describe):
        return listed(chosen, unset())
    chosen.model = chosen.model or "all"
    kinds = kinds_of(chosen)
    try:
        if not chosen.describe:
            check_extras(chosen, kinds)
            check_folder(chosen.out)
        return NOT_VALID if built(chosen, kinds) else DONE
    except ValueError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except (CompilerError, OSError) as error:
        print(f"The FMUs in {chosen.out} are not complete: {error}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print(f"Interrupted; the FMUs that were finished are in {chosen.out}.", file=sys.stderr)
        return INTERRUPTED


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add description and options, for this program or for the command `bogie-braking build`."""
    parser.description = (__doc__ or "").replace(PROGRAM, parser.prog)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    add = parser.add_argument
    also = "; ".join(f"{own} = {name}" for own, name in ALIASES.items())
    text = f"{', '.join(NAMES)} (default: list them); {also}"
    add("model", nargs="?", type=fmu_named, choices=[*NAMES, *ALIASES], metavar="FMU", help=text)
    add("--kind", default="all", choices=[*KINDS, "all"], help="FMI 2.0, FMI 3.0, pythonfmu or all")
    add("--out", type=Path, default=Path("build"), help="folder of the FMUs (default: build)")
    add("--platforms", choices=["own", "all"], default="own", help="of native FMUs (default: own)")
    add("--controller", metavar="FILE", help="only the FMU of FILE.py:CLASS, a wheel-slide protection, or of FILE.c")
    wheelsets = whole("--wheelsets", 1, MOST_WHEELSETS)
    text = f"of the vehicle with the controller or the sensors, 1 to {MOST_WHEELSETS} (default: {BOGIE})"
    add("--wheelsets", type=wheelsets, default=BOGIE, metavar="COUNT", help=text)
    add("--consist", type=Path, metavar="FILE", help="of the train, CSV or TOML (default: a locomotive and 20 wagons)")
    add("--line", type=Path, metavar="FILE", help="of the train or the curves, CSV (default: straight and level)")
    text = f"of the coupler's FMU: {', '.join(COUPLERS)}, or FILE.toml:NAME of a consist (default: screw)"
    add("--coupler", default="screw", metavar="COUPLER", help=text)
    add("--brake-model", default="whole", choices=[*BRAKE_MODELS], help="of the train (default: whole)")
    least, most = SETTING_LIMITS["cells"]
    text = f"of the pipe in each vehicle, {least:g} to {most:g} (default: 2)"
    add("--cells", type=quantity("--cells", least=least, most=most), default=2.0, metavar="COUNT", help=text)
    text = "train data of the curves, JSON of bogie-braking etcs or an OSRD rolling stock"
    add("--train", type=Path, metavar="FILE", help=text)
    add("--national", type=Path, metavar="FILE", help="national values of the curves, TOML (default: those of A.3.2)")
    place = quantity("--target", "m", 1.0, 1e6)
    add("--target", type=place, metavar="PLACE", help="of the ssp: place of its end of authority, as 2000 or 2km")
    speed = quantity("--speed", "km/h", 5.0, 400.0)
    add(
        "--speed",
        type=speed,
        metavar="SPEED",
        help="of the ssp: permitted speed (default: V_MAXTRAIN of the train data)",
    )
    speed = quantity("--start-speed", "km/h", 0.0, 400.0)
    add("--start-speed", type=speed, metavar="SPEED", help="of the ssp: speed at the start (default: 0)")
    add("--describe", action="store_true", help="print the table of variables instead of building")


def unset() -> argparse.Namespace:
    """Return the options of a command line without any."""
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    return parser.parse_args([])


def listed(chosen: argparse.Namespace, defaults: argparse.Namespace) -> int:
    """Print all FMUs. Raises BadInputError for an option that has an effect on a build alone."""
    if idle := [name for name, value in vars(defaults).items() if getattr(chosen, name) != value]:
        raise BadInputError(f"--{idle[0].replace('_', '-')} must be with an FMU; got none. Name one, or all.")
    for name, fmu in (FMUS | IN_C).items():
        print(f"{name:<16} {fmu.summary}")
    print(f"{'ssp':<16} bogie and brake, connected; with --consist a train, its curves and a driver")
    print(f"{'all':<16} all of these")
    return DONE


def kinds_of(chosen: argparse.Namespace) -> list[str]:
    """Return the kinds of FMUs to build. Raises BadInputError for options that do not go together."""
    native_only = chosen.platforms == "all" or chosen.model in IN_C
    able = ["native"] if chosen.model == "ssp" else [*NATIVE] if native_only else [*KINDS]
    if chosen.kind not in ("all", *able):
        of = "--platforms all" if chosen.platforms == "all" and chosen.model != "ssp" else chosen.model
        raise BadInputError(f"--kind must be all or one of {', '.join(able)} for {of}; got {chosen.kind}.")
    check_own_options(chosen)
    if chosen.describe and chosen.model in (*IN_C, "ssp"):
        raise BadInputError(f"--describe must be with an FMU of {', '.join(FMUS)}; got {chosen.model}.")
    if chosen.describe:
        check_describe(chosen)
    if chosen.controller:
        check_controller(chosen)
    return able if chosen.kind == "all" else [chosen.kind]


def names_of(chosen: argparse.Namespace) -> list[str]:
    """Return the names of the FMUs to build."""
    ssp = list(NEEDED) if is_supervised(chosen) else ["bogie", "brake"]
    return {"all": [*FMUS, *IN_C], "ssp": ssp}.get(chosen.model, [chosen.model])


def is_supervised(chosen: argparse.Namespace) -> bool:
    """Return whether SupervisedTrain.ssp is to be built. Raises BadInputError without its target or train data."""
    given = chosen.model == "ssp" and any(getattr(chosen, name) != OWN_OPTIONS[name] for name in OF_SSP)
    if given and (chosen.target is None or chosen.train is None):
        missing = "--target" if chosen.target is None else "--train"
        raise BadInputError(
            f"The ssp of a train must have {missing}; got none. Write: ssp --consist FILE --train FILE --target PLACE."
        )
    return given


def supervised_run(chosen: argparse.Namespace) -> SupervisedRun:
    """Return the content of SupervisedTrain.ssp."""
    speeds = {
        name: getattr(chosen, name) / 3.6 for name in ("speed", "start_speed") if getattr(chosen, name) is not None
    }
    return SupervisedRun(chosen.consist, chosen.train, chosen.target, national=chosen.national, **speeds)


def check_extras(chosen: argparse.Namespace, kinds: Sequence[str]) -> None:
    """Refuse FMUs before any work if a package that they need is missing. Raises MissingExtraError."""
    in_python = ":" in chosen.controller if chosen.controller else "python" in kinds
    from_equations = not chosen.controller and any(name in FMUS for name in names_of(chosen))
    needed = {"fmpy": True, "pythonfmu": in_python, "casadi": from_equations}
    need(*(package for package, is_needed in needed.items() if is_needed))


def check_own_options(chosen: argparse.Namespace) -> None:
    """Refuse options of other FMUs. Raises BadInputError."""
    for option, default in OWN_OPTIONS.items():
        value, owners = getattr(chosen, option), [name for name, fmu in IN_C.items() if option in fmu.options]
        owners += ["ssp"] if option in OF_SSP else []
        with_controller = option == "wheelsets"
        if value == default or chosen.model in owners or (with_controller and chosen.controller):
            continue
        text = "FILE" if isinstance(value, Path) else f"{value:g}" if isinstance(value, float) else value
        flag = f"--{option.replace('_', '-')}"
        belongs = " and ".join(owners) if len(owners) > 1 else f"the {owners[0]}"
        raise BadInputError(
            f"{flag} belongs to {belongs}{' and to --controller' if with_controller else ''}; got {chosen.model}. "
            f"Write: {owners[0]} {flag} {text}."
        )


def check_describe(chosen: argparse.Namespace) -> None:
    """Refuse options that have no effect on a table of variables. Raises BadInputError."""
    given = {
        "--controller": chosen.controller,
        "--kind": chosen.kind != "all",
        "--platforms": chosen.platforms != "own",
    }
    if idle := [name for name, is_given in given.items() if is_given]:
        raise BadInputError(f"{idle[0]} has no effect with --describe, which builds nothing. Leave one out.")


def check_controller(chosen: argparse.Namespace) -> None:
    """Refuse options that have no effect on the FMU of a controller. Raises BadInputError."""
    if chosen.model != "all":
        raise BadInputError(f"--controller builds an FMU of its own; got {chosen.model} too. Leave one of both out.")
    if chosen.platforms == "all":
        raise BadInputError("--controller builds for this platform; got --platforms all. Leave it out.")
    able = NATIVE if chosen.controller.endswith(".c") else ("python",)
    if chosen.kind not in ("all", *able):
        raise BadInputError(f"--kind must be {' or '.join(able)} for {chosen.controller}; got {chosen.kind}.")


def built(chosen: argparse.Namespace, kinds: Sequence[str]) -> bool:
    """Build the chosen FMUs; return whether one is not valid. Raises ValueError, CompilerError, OSError."""
    every = chosen.platforms == "all"
    names = names_of(chosen)
    if chosen.describe:
        print("\n".join(variable_table(name, [*variables_of(name).values()]) for name in names if name in FMUS), end="")
        return False
    if chosen.controller:
        kind = "fmi3" if chosen.kind == "fmi3" else "native"
        return bool(build_controller(chosen.controller, chosen.out, chosen.wheelsets, kind))
    own = {option: getattr(chosen, option) for option in OWN_OPTIONS}
    system = supervised(supervised_run(chosen)) if is_supervised(chosen) else None
    problems = build_all(names, kinds, chosen.out, every, **own)
    write_sets(names, chosen.out)
    if system:
        say_system(write_supervised_train(system, chosen.out))
    elif "native" in kinds:
        build_systems(names, chosen.out, every)
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main())
