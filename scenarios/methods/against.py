"""This version against another checkout of the project, such as `git worktree add` makes: which takes less time.

Each has its kernels built by its own Python, four copies of each, as two copies of one library differ by 7 % by where
they are loaded; both are measured in turns, and the least counts.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from tqdm import tqdm

from products.sources import ROOT
from scenarios.reporting.report import Row
from scenarios.scenario import BadInputError

COPIES, TURNS = 4, 3
#: What is built, and what is measured: calls, steps of 1 ms, and the stop of `speed`, in microseconds.
BUILD = (
    "import sys; from products.building import kernel_of; print(*[kernel_of(name) for name in ('bogie', 'vehicle')])"
)
MEASURE = """
import json, sys, time
from fmu_src.kernel import Kernel, Library
found = {}
def keep(name, begin, count):
    found[name] = min(found.get(name, 1e99), (time.perf_counter() - begin) / count * 1e6)
for level, fmu in ((1, 'bogie'), (2, 'bogie'), (3, 'bogie'), (2, 'vehicle'), (3, 'vehicle')):
    torque = 2e4 if fmu == 'bogie' else 8e3
    for copy in range(int(sys.argv[2])):
        library = Library(f'{sys.argv[1]}/{fmu}_{copy}')
        wheelsets = range(1, 5 if fmu == 'vehicle' else 3)
        values = {'level': level, 'initial_speed': 25.0} | {f'brake_torque_{i}': torque for i in wheelsets}
        kernel = Kernel(library, **values)
        kernel.initialise()
        kernel.step(0.0, 1.0)
        case = f"{'coach' if fmu == 'vehicle' else fmu}, {('point', 'planar', 'spatial')[level - 1]}"
        for what, call, count in (('right-hand side', kernel.repeat_right_hand_side, 3000),
                                  ('Jacobian', kernel.repeat_jacobian, 1000)):
            begin = time.perf_counter()
            call(count)
            keep(f'{what}, {case}', begin, count)
        begin = time.perf_counter()
        kernel.repeat_step(1e-3, 1500)
        keep(f'doStep of 1 ms, {case}', begin, 1500)
        kernel = Kernel(library, **values)
        kernel.initialise()
        begin = time.perf_counter()
        kernel.step(0.0, 22.9)
        keep(f'22.9 s stop, {case}', begin, 1)
print(json.dumps(found))
"""
#: The largest ratio that is wanted of what begins so; none: it shall not be slower.
WANTED: Mapping[str, float] = {
    "right-hand side, bogie, spatial": 0.5,
    "Jacobian, bogie, spatial": 0.55,
    "doStep of 1 ms, bogie, spatial": 0.6,
    "22.9 s stop, bogie, spatial": 0.5,
    "right-hand side, coach, spatial": 0.55,
    "Jacobian, coach, spatial": 0.55,
    "doStep of 1 ms, coach, spatial": 0.6,
    "22.9 s stop, coach, spatial": 0.55,
}


def rows_against(checkout: Path) -> list[Row]:
    """Ratios of this version's times to those of the other one. Raises BadInputError."""
    if not (checkout / "products" / "building.py").is_file():
        raise BadInputError(
            f"{checkout} is no checkout of this project; make one: git worktree add {checkout} REVISION."
        )
    with tempfile.TemporaryDirectory() as folder:
        places = {Path(folder) / "new": ROOT, Path(folder) / "old": checkout.resolve()}
        with tqdm(total=len(places) * (1 + TURNS), desc="against another version", leave=False) as bar:
            for place, root in places.items():
                place.mkdir()
                for name, library in zip(("bogie", "vehicle"), _python(root, BUILD).split(), strict=True):
                    for copy in range(COPIES):
                        shutil.copy(library, place / f"{name}_{copy}")
                bar.update()
            found: dict[Path, dict[str, float]] = {place: {} for place in places}
            for _ in range(TURNS):
                for place, root in places.items():
                    times = json.loads(_python(root, MEASURE, str(place), str(COPIES)))
                    found[place] = {name: min(value, found[place].get(name, value)) for name, value in times.items()}
                    bar.update()
    return ratios(*found.values())


def ratios(new: Mapping[str, float], old: Mapping[str, float]) -> list[Row]:
    """A row for each time that both have."""
    rows = []
    for name in (name for name in new if name in old):
        source = f"{new[name]:.4g} us for {old[name]:.4g} us; at most {WANTED.get(name, 1.0):g}"
        rows.append(Row(f"new over old: {name}", "1", None, new[name] / old[name], None, source))
    return rows


def _python(root: Path, code: str, *arguments: str) -> str:
    environment = os.environ | {"PYTHONPATH": str(root)}
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise BadInputError(f"The version in {root} cannot be measured: {done.stderr.strip().splitlines()[-1]}")
    return done.stdout.strip().splitlines()[-1]
