"""Makes a release.

It consists of a wheel for each platform with its FMUs, kernels and the live page, and a wheel without them for all
others. Further files are the sdist, an archive of the FMUs for all platforms with parameter sets and systems, the live
pages, and SHA256SUMS.

  python release.py              into dist/
  python release.py --out FOLDER

It contains the files that git tracks, in their present state. Everything is compiled with zig from PyPI; equal sources
make equal files, byte for byte, on any day and in any folder.
"""

import argparse
import hashlib
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from bogie_braking.live.page import write_page
from bogie_braking.live.train_page import PAGE as TRAIN_PAGE
from bogie_braking.live.train_page import write_train_page
from brake_controller.protection_fmu import BOGIE
from fmu_src import __version__
from fmu_src.archive import write_archive
from fmu_src.arrays_fmu import binary_of_arrays
from fmu_src.batch import lane_sources
from fmu_src.codegen import generate
from fmu_src.compile import CompilerError, plain_library
from fmu_src.native_fmu import PLATFORMS, binary_for, binary_of, build_native_fmu
from products.building import (
    LINEAR,
    NATIVE,
    build_all,
    extras,
    license_text,
    linear_kernel_file,
    linear_model,
    variables_file,
    variables_table,
)
from products.parameter_sets import write_sets
from products.prebuilt import PAGE, write_contents
from products.protection.compiled_machine import READY, machine_model
from products.protection.rig_in_c import SHIPPED, binary_of_rig
from products.registry import ALIKE, DIFFERENT, FMUS, IN_C, content_in_c, model_of
from products.sources import PREBUILT, ROOT
from products.systems import build_systems
from products.train.library import CELLS, cells
from products.train.library import SHIPPED as TRAIN
from products.train.library import sources as train_sources
from readers.command_line import CommandLine, check_folder
from readers.text import BadInputError

#: FMUs of wheel-speed sensors besides those of a bogie: those of a vehicle with two.
MORE_SENSORS = {"wheelsets": 2 * BOGIE}
#: Platforms of wheels -> folder in binaries/ of an FMU.
WHEELS = {
    "manylinux_2_17_x86_64": "linux64",
    "manylinux_2_17_aarch64": "aarch64-linux",
    "win_amd64": "win64",
    "macosx_11_0_universal2": "darwin64",
}
#: Widths of lanes; processors of ARM have the first alone.
LANES = (2, 4, 8)


def copy_sources(folder: Path) -> None:
    """Copy the files that git tracks; a release contains no others."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, listed.split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, folder / name)


def fill(folder: Path, platform: str) -> None:
    """Writes the FMUs and kernels of a platform that scenarios ask for, and the live page, which all platforms show."""
    place = WHEELS[platform]
    targets, suffix = PLATFORMS[place]
    for name in DIFFERENT:
        build_native_fmu(model_of(name), folder / "native" / f"{name}.fmu", [place], extras(name, "native"))
    (folder / "kernel").mkdir(exist_ok=True)
    for name in (*DIFFERENT, *(own for own, like in ALIKE.items() if like in DIFFERENT)):
        model = model_of(name)
        (folder / "kernel" / f"{name}{suffix}").write_bytes(binary_of(generate(model), targets, fmu=False))
        (folder / variables_file(name)).write_text(json.dumps(variables_table(model)), encoding="utf-8")
    fill_machines(folder, targets, suffix)
    for name in LINEAR:
        kernel = folder / linear_kernel_file(name, suffix)
        kernel.write_bytes(binary_of(generate(linear_model(name)), targets, fmu=False))
    (folder / "train").mkdir(exist_ok=True)
    for fmu in (*(content_in_c(name, {}) for name in IN_C), content_in_c("sensor", MORE_SENSORS)):
        (folder / "train" / f"{fmu.given.name}{suffix}").write_bytes(binary_of_arrays(fmu.given, targets))
    (folder / CELLS).write_text(json.dumps(cells()), encoding="utf-8")
    functions = binary_for(targets, lambda target: plain_library(train_sources(), target=target))
    (folder / f"{TRAIN}{suffix}").write_bytes(functions)
    rig = folder / f"{SHIPPED}{suffix}"
    rig.parent.mkdir(exist_ok=True)
    rig.write_bytes(binary_of_rig(targets))
    write_page(folder / PAGE)
    write_train_page(folder / TRAIN_PAGE)
    write_contents(folder, platform, DIFFERENT)


def fill_machines(folder: Path, targets: Sequence[str], suffix: str) -> None:
    """Write the ready machines of the test rig: tables of variables, kernels, and kernels in lanes of each width."""
    (folder / "machines").mkdir(exist_ok=True)
    for name, machine in READY.items():
        model = machine_model(machine)
        [system] = model.systems
        about = {"variables": variables_table(model), "states": list(system.states)}
        (folder / f"{name}.json").write_text(json.dumps(about), encoding="utf-8")
        (folder / f"{name}{suffix}").write_bytes(binary_of(generate(model), targets, fmu=False))
        for lanes in LANES:
            if able := [target for target in targets if lanes == LANES[0] or target.startswith("x86")]:
                binary = binary_of(lane_sources(model, system), able, fmu=False, lanes=lanes)
                (folder / f"{name}-{lanes}-lanes{suffix}").write_bytes(binary)


def pack(kind: str, sources: Path, out: Path) -> None:
    """Makes a wheel or the sdist of a copy of the sources."""
    command = [sys.executable, "-m", "hatchling", "build", "--target", kind, "--directory", str(out)]
    subprocess.run(command, cwd=sources, check=True)


def write_wheels(platforms: Iterable[str], out: Path) -> None:
    """Write the sdist, the wheel for all platforms, and one for each given platform."""
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name)
        copy_sources(copy)
        pack("sdist", copy, out)
        pack("wheel", copy, out)
        inside = copy / PREBUILT.relative_to(ROOT)
        for platform in platforms:
            fill(inside, platform)
            pack("wheel", copy, out)
            shutil.rmtree(inside)


def write_fmus(out: Path) -> None:
    """The native FMUs for FMI 2.0 and 3.0, for all platforms, parameter sets and systems, in one archive."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        problems = build_all([*FMUS, *IN_C], NATIVE, folder, all_platforms=True)
        if problems + build_all(["sensor"], NATIVE, folder, all_platforms=True, **MORE_SENSORS):
            raise CompilerError("An FMU is not valid; nothing was packed")
        write_sets(list(FMUS), folder)
        build_systems(list(FMUS), folder, all_platforms=True)
        made = [path for path in folder.rglob("*") if path.suffix in (".fmu", ".ssp", ".ssv")]
        files = {path.relative_to(folder).as_posix(): path.read_bytes() for path in made}
    write_archive(out / f"bogie_braking-{__version__}-fmus.zip", files | {"LICENSE": license_text()})


def write_checksums(out: Path) -> None:
    """Write SHA256SUMS in the format of `sha256sum --check`."""
    files = sorted(path for path in out.iterdir() if path.name != "SHA256SUMS")
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
    (out / "SHA256SUMS").write_text("".join(lines))


def main(arguments: list[str] | None = None) -> int:
    """Make the release and return the exit status: 0, 2 bad input, 3 after a failure, 130 interrupted."""
    parser = CommandLine(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("dist"), help="a new or empty folder (default: dist)")
    try:
        out = parser.parse_args(arguments).out.resolve()
        check_folder(out)
    except BadInputError as error:
        print(error, file=sys.stderr)
        return 2
    if out.exists() and any(out.iterdir()):
        print(
            f"--out must be a new or empty folder; {out} holds files. Empty it, or name another one.", file=sys.stderr
        )
        return 2
    try:
        out.mkdir(parents=True, exist_ok=True)
        write_wheels(WHEELS, out)
        write_fmus(out)
        write_page(out / f"bogie_braking-{__version__}-{PAGE}")
        write_train_page(out / f"bogie_braking-{__version__}-{TRAIN_PAGE}")
        write_checksums(out)
    except (CompilerError, OSError, subprocess.CalledProcessError) as error:
        print(f"The release in {out} is not complete ({error}).", file=sys.stderr)
        return 3
    except KeyboardInterrupt:
        print(f"Interrupted; the release in {out} is not complete, what was compiled is kept.", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
