"""Builds the FMUs of the registry, as files for people or, for scenarios, on demand unless a release has built them."""

import hashlib
import json
import re
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import lru_cache, partial
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

from brake_controller.protection_fmu import wheel_slide_in_c, wheel_slide_in_python
from fmu_src.arrays_fmu import ArraysFmu, ArraysInC, binary_of_arrays, build_arrays_fmu
from fmu_src.chain import ONE_WRITES
from fmu_src.compile import CompilerError, build_library, compiler, here, in_cache, library_suffix
from fmu_src.native_fmu import PLATFORMS, PLATFORMS3, build_native_fmu, build_native_fmu3, platforms_of
from fmu_src.python_fmu import build_python_fmu, build_step_fmu
from fmu_src.references import reference_files
from fmu_src.step_fmu_in_c import step_in_c
from fmu_src.step_model import StepInC, StepInPython
from fmu_src.system import Model, Variable
from fmu_src.terminals import FILE, ICON, Terminal, terminals_and_icons
from products.build_notes import remembered, remembered_path
from products.experiments import experiments_of
from products.one_level import model_at
from products.parameter_sets import set_files
from products.prebuilt import PICTURES, content_of, prebuilt, prebuilt_from_these
from products.registry import FMUS, IN_C, content_in_c, model_of
from products.sources import ROOT
from products.terminals import terminals_of
from rbd_model.levels.models import model_of_levels, places_of
from readers.extras import OptionalModule
from readers.storage import write_whole, writing
from readers.text import BadInputError

validation = OptionalModule("fmpy.validation")
#: Vehicles whose small motions are analysed with `linear_model`.
LINEAR = ("bogie", "vehicle")
#: Native for FMI 2.0 and for FMI 3.0; pythonfmu brings its own binaries.
VERSIONS = {"native": 2, "fmi3": 3}
NATIVE = tuple(VERSIONS)
KINDS = (*NATIVE, "python")
#: Place of the license in an archive.
LICENSE = "documentation/licenses/license.txt"


def license_text() -> bytes:
    """Return the license, from the checkout or from the installed package."""
    beside = ROOT / "LICENSE"
    if beside.exists():
        return beside.read_bytes()
    try:
        files = distribution("bogie-braking").files or []
    except PackageNotFoundError:
        files = []
    found = next((file for file in files if file.name == "LICENSE"), None)
    if found is None:
        raise CompilerError("The file LICENSE is missing from the installation; install the package again")
    return Path(str(found.locate())).read_bytes()


def extras(name: str, kind: str) -> dict[str, bytes]:
    """Return the further contents of a native archive by name.

    They are those of every archive, the figure of its page if any, parameter sets, and experiments with their results.
    """
    files = common_files(terminals_of(model_of(name).variables), VERSIONS[kind])
    files |= reference_files(model_of(name), set_files(name), experiments_of(name))
    picture = FMUS[name].picture
    return files | ({"documentation/picture.png": (PICTURES / picture).read_bytes()} if picture else {})


def common_files(terminals: Sequence[Terminal], version: int) -> dict[str, bytes]:
    """Return license, terminals and icon of an archive by name; version: of FMI."""
    icons = [ICON, "model.png"] if version == 2 else [ICON]  # FMI 2.0.4 has both places
    icon = (PICTURES / "icon.png").read_bytes()
    return {LICENSE: license_text(), FILE: terminals_and_icons(terminals)} | dict.fromkeys(icons, icon)


def fmu_path(name: str, kind: str, out: Path) -> Path:
    """Return OUT/KIND/Model.fmu of an FMU of the registry."""
    return out / kind / f"{model_of(name).name}.fmu"


def write_fmu(name: str, kind: str, out: Path, all_platforms: bool = False) -> Path:
    """Builds one FMU as OUT/KIND/Model.fmu; all_platforms: of a native one. Raises CompilerError, OSError."""
    model, path = model_of(name), fmu_path(name, kind, out)
    with writing(path.parent, "choose another folder with --out"):
        path.parent.mkdir(parents=True, exist_ok=True)
    if kind == "python":
        build_python_fmu(model, path)
    else:
        build, known = {"native": (build_native_fmu, PLATFORMS), "fmi3": (build_native_fmu3, PLATFORMS3)}[kind]
        build(model, path, list(known) if all_platforms else [], extras(name, kind))
    return path


def copy_fmu(name: str, kind: str, out: Path) -> Path:
    """Write one native FMU for this platform as OUT/KIND/Model.fmu, a copy of that in the cache, built if missing."""
    path = fmu_path(name, kind, out)
    with writing(path.parent, "choose another folder with --out"):
        path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, up_to_date(name, kind).read_bytes(), "choose another folder with --out")
    return path


def up_to_date(name: str, kind: str) -> Path:
    """Return the path of an FMU from the package or the user's cache; build it if needed."""
    file = f"{kind}/{name}.fmu"
    with ONE_WRITES:
        return prebuilt(name, file) or remembered_path(name, file, [write_fmu], lambda: _in_cache(name, kind))


def _in_cache(name: str, kind: str) -> Path:
    """Return the path in the cache; equal content has one path."""
    words = hashlib.sha256(" ".join([content_of(name), here(), *compiler()]).encode()).hexdigest()

    def written(folder: Path) -> Path:
        return write_fmu(name, kind, folder)

    return in_cache(fmu_path(name, kind, Path("fmus") / words[:24]).as_posix(), written)


def kernel_of(name: str) -> Path:
    """Return the path of the library of an FMU's equations for fmu_src/kernel.py, likewise."""
    file = _kernel_file(name)
    with ONE_WRITES:
        return prebuilt(name, file) or remembered_path(
            name, file, [build_library], lambda: build_library(model_of(name))
        )


def _kernel_file(name: str) -> str:
    return f"kernel/{name}{library_suffix()}"


def whole_kernel(name: str) -> Path | None:
    """Return the path of the library of all equations of an FMU from the package.

    None is returned if a source has changed since.
    """
    return prebuilt_from_these(_kernel_file(name))


def kernel_at(name: str, place: int, before: Callable[[], None] | None = None) -> Path:
    """Return the path of the library of one of a vehicle's systems, compiled if missing."""

    def built() -> Path:
        if before:
            before()
        return build_library(model_at(name, variables_of(name), place))

    with ONE_WRITES:
        return remembered_path(name, f"system {place}, {_kernel_file(name)}", [model_at, build_library], built)


def linear_model(name: str) -> Model:
    """Return a vehicle of the registry at level 3 with contact model 2 and Kalker's linear creep."""
    make = FMUS[name].vehicle
    assert make is not None
    vehicle = replace(make(), creep_law="kalker-linear")
    return model_of_levels(vehicle.name, "Small motions", vehicle, places_of(3, 2, on_line=False))


def linear_kernel_file(name: str, suffix: str) -> str:
    """Return the path of the kernel of `linear_model` in a release."""
    return f"kernel/{name}-linear{suffix}"


def linear_kernel_of(name: str) -> Path:
    """Return the path of the library of `linear_model`, compiled if missing."""
    file = linear_kernel_file(name, library_suffix())
    with ONE_WRITES:
        return prebuilt_from_these(file) or remembered_path(
            name, file, [linear_model, build_library], lambda: build_library(linear_model(name))
        )


@lru_cache
def variables_of(name: str) -> dict[str, Variable]:
    """Return the variables of an FMU by name, without writing its equations again."""
    path = prebuilt_from_these(variables_file(name))
    text = path.read_text(encoding="utf-8") if path else remembered(name, "variables", [Variable], partial(_text, name))
    return variables_from(json.loads(text))


def variables_file(name: str) -> str:
    """Return the path of the table of variables of an FMU in a release."""
    return f"kernel/{name}.json"


def _text(name: str) -> str:
    return json.dumps(variables_table(model_of(name)))


def variables_table(model: Model) -> list[dict[str, Any]]:
    """Return the variables of a model as JSON writes them."""
    return [asdict(variable) for variable in model.variables]


def variables_from(table: Sequence[Mapping[str, Any]]) -> dict[str, Variable]:
    """Return the variables of a `variables_table` by name."""
    return {load["name"]: Variable(**load) for load in table}


def units_of(name: str) -> dict[str, str]:
    """Return the units of the variables of an FMU."""
    return {key: variable.unit for key, variable in variables_of(name).items()}


def announce(path: Path, seconds: float) -> list[str]:
    """Validate an FMU with fmpy, print its line and its problems, and return the problems."""
    problems = validation.validate_fmu(str(path))
    verdict = "valid" if not problems else f"{len(problems)} problems"
    print(f"{path}  {path.stat().st_size / 1000:.0f} kB  {seconds:.1f} s  {verdict}")
    for problem in problems:
        print(f"{path}: {problem}", file=sys.stderr)
    return list(problems)


def build_all(
    names: Sequence[str], kinds: Sequence[str], out: Path, all_platforms: bool = False, **options: Any
) -> list[str]:
    """Build FMUs, a line each; return the problems that fmpy finds. options: of those of IN_C, which are all native."""
    problems: list[str] = []
    in_c = {name: content_in_c(name, options) for name in names if name in IN_C}
    for kind in kinds:
        for name in names if kind in NATIVE else [name for name in names if name in FMUS]:
            begin = time.perf_counter()
            if name in in_c:
                path = out / kind / f"{in_c[name].given.name}.fmu"
                write_in_c(in_c[name], path, VERSIONS[kind], all_platforms)
            elif kind in NATIVE and not all_platforms:
                path = copy_fmu(name, kind, out)
            else:
                path = write_fmu(name, kind, out, all_platforms)
            problems += announce(path, time.perf_counter() - begin)
    return problems


def write_in_c(fmu: ArraysFmu, path: Path, version: int = 2, all_platforms: bool = False) -> None:
    """Write the FMU of an object in C; version: of FMI. Raises CompilerError, OSError."""
    given, names = fmu.given, [*{2: PLATFORMS, 3: PLATFORMS3}[version]] if all_platforms else []
    binaries = {
        f"{name}/{given.name}{suffix}": binary_of_arrays(given, targets) if targets else own_binary(given)
        for name, (targets, suffix) in platforms_of(version, names).items()
    }
    single = [array for array, starts in zip(given.arrays, fmu.starts, strict=True) if len(starts) == 1]
    files = common_files(terminals_of(single), version)
    build_arrays_fmu(replace(fmu, extras={**files, **fmu.extras}), path, version, binaries)


def own_binary(given: ArraysInC) -> bytes:
    """Return the binary for this platform, of the wheel where no source has changed, or compiled."""
    path = None if given.foreign or not given.ships else prebuilt_from_these(f"train/{given.name}{library_suffix()}")
    return path.read_bytes() if path else binary_of_arrays(given)


def build_protection(
    out: Path, step: StepInC | StepInPython, all_platforms: bool = False, kind: str = "native"
) -> Path:
    """Write OUT/KIND/NAME.fmu of a controller in C, or OUT/python/NAME.fmu; kind: one of NATIVE, of that in C."""
    if isinstance(step, StepInPython):
        path = out / "python" / f"{step.name}.fmu"
        build_step_fmu(step, path)
    else:
        path = out / kind / f"{step.name}.fmu"
        write_in_c(step_in_c(step), path, VERSIONS[kind], all_platforms)
    return path


def build_controller(text: str, out: Path, wheelsets: int, kind: str = "native") -> list[str]:
    """Build the FMU of a controller; return the problems that fmpy finds."""
    begin = time.perf_counter()
    try:
        path = _controller(text, out, wheelsets, kind)
    except FileNotFoundError:
        raise BadInputError(f"The file {text.split(':')[0]} does not exist. Check the path.") from None
    except CompilerError as error:
        missing = sorted(set(re.findall(r"undefined reference to `(wheel_slide_\w+)'", str(error))))
        lacks = f"{text} must have all functions of wheel_slide.h; it lacks {', '.join(missing)}. Add them."
        raise BadInputError(lacks if missing else f"{text} does not compile. {error}") from None
    except (OSError, ValueError, ImportError, SyntaxError, NameError, TypeError, AttributeError) as error:
        raise BadInputError(f"{text} does not become an FMU: {error}") from None
    return announce(path, time.perf_counter() - begin)


def _controller(text: str, out: Path, wheelsets: int, kind: str) -> Path:
    if text.endswith(".c"):
        return build_protection(out, wheel_slide_in_c(Path(text), wheelsets), kind=kind)
    file, _, name = text.rpartition(":")
    if not (file and name):
        raise ValueError("it names no class; give FILE:CLASS, such as own.py:LetGo, or a C file.")
    return build_protection(out, wheel_slide_in_python(Path(file), name, wheelsets))
