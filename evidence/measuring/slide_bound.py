"""Measures distances over the ideal by controller, up to one that is shown everything, for docs/controller.md.

python -m evidence.measuring.slide_bound              writes the figure and prints the table, from docs/data/
python -m evidence.measuring.slide_bound --measure    first the stops, some ten minutes
"""

import json
import sys
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting import plots
from evidence.omniscient import of_all, shortest
from products.controller_kinds import Form, compiled
from products.machine import MACHINES, Machine, filling_by_flow, filling_by_time
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.rig import Rig
from products.protection.rig_in_c import RIG, slide_protection
from products.protection.runs import Run, Stop
from products.protection.settings import Settings
from rbd_model.contact.friction import constant_friction
from rbd_model.track.friction import RailCondition, low, wet

DOCS = Path(__file__).parents[2] / "docs"
DATA, PICTURE = DOCS / "data" / "slide-bound.json", DOCS / "pictures" / "slide-bound.png"
FRICTIONS, SPEEDS = (0.04, 0.06, 0.08, 0.10, 0.12, 0.15), (16.7, 25.0, 40.0, 55.6)
#: Errors of the teeth, as a share of the pitch, and their seed.
JITTER, SEED = 0.02, 3
#: Names of the controllers, from the longest stops to the shortest.
NAMES = ("locked", "none", "dump valve", "protection", "omniscient")
WORDS = {"locked": "locked wheels", "dump valve": "dump valve, 7 s", "protection": "built-in protection"}
KINDS = (("bogie", True), ("bogie", False), ("vehicle", True), ("vehicle", False))


class LockedWheels(PeakAdhesion):
    """All wheelsets stand as soon as the brake force exceeds what they then transmit."""

    SLIPS = np.array([1.0])


def rails() -> list[tuple[str, dict[str, float], RailCondition, float]]:
    """Return name, values of a patch, condition and initial speed [m/s] of all rails."""
    found: list[tuple[str, dict[str, float], RailCondition, float]] = []
    for friction, falls, speed in product(FRICTIONS, (False, True), SPEEDS):
        rail = RailCondition(friction, low().law if falls else constant_friction(), verified=False)
        found.append((f"{friction:g}{' falling' if falls else ''}", {}, rail, speed))
    for factor, start in product((0.15, 0.25), (40.0, 80.0)):
        found.append((f"leaves {factor:g} from {start:g} m", patch(factor, start, 100.0), wet(), 25.0))
    for speed in (25.0, 40.0):
        found.append(("drop", patch(0.25, 80.0, 3000.0), wet(), speed))
        found.append(("better", patch(3.0, 150.0, 3000.0), low(), speed))
    return found


def patch(factor: float, start: float, length: float) -> dict[str, float]:
    """Return the values of a stretch with other friction."""
    return {"patch_friction": factor, "patch_start": start, "patch_length": length}


def reporting(machine: Machine) -> list[tuple[str, Run]]:
    """Return every second rail, on which no threshold was chosen, with phases and errors of the sensors drawn."""
    random, count = np.random.default_rng(SEED), len(machine.numbers)
    return [
        (
            f"{name} {speed:g} m/s",
            Run(
                condition.values(count) | of_patch,
                speed,
                phases=tuple(random.uniform(0.0, 1.0, count)),
                teeth=int(random.integers(1, 2**31)),
            ),
        )
        for name, of_patch, condition, speed in rails()[1::2]
    ]


def measured(machine: Machine, by_flow: bool) -> list[dict[str, Any]]:
    """Return distance over the ideal and longest lock of each controller on each rail."""
    named, settings = reporting(machine), Settings(jitter=JITTER)
    runs = [run for _, run in named]

    def by(form: Form) -> list[Stop]:
        return Rig(machine, form, settings, by_flow=by_flow).runs(runs)

    stops = {
        "none": by(None),
        "dump valve": by(compiled(RIG / "dump_valve.c")),
        "protection": by(slide_protection()),
        "omniscient": [shortest(one) for one in of_all(machine, runs, settings, by_flow)],
    }
    filling = filling_by_flow(machine.full_pressure) if by_flow else filling_by_time()
    rows = []
    for i, (name, run) in enumerate(named):
        ideal = PeakAdhesion(machine, run.values, filling).stopping_distance(run.speed or settings.speed)
        of = {who: [found[i].over(ideal), found[i].longest_lock] for who, found in stops.items()}
        locked = distance_of_locked(LockedWheels(machine, run.values, filling), run.speed or settings.speed)
        rows.append({"rail": name, "ideal": ideal, "locked": [locked and locked / ideal, None]} | of)
    return rows


def distance_of_locked(wheels: LockedWheels, speed: float) -> float | None:
    """Return the stopping distance [m]; None if it takes longer than a run of the rig."""
    try:
        return wheels.stopping_distance(speed)
    except ValueError:
        return None


def sliding(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the rails on which a wheelset locks without a controller."""
    return [row for row in rows if row["none"][1] > 0.0]


def ratios(rows: list[dict[str, Any]], who: str) -> list[float]:
    """Return distances over the ideal; infinite without a stop."""
    return [np.inf if row[who][0] is None else row[who][0] for row in sliding(rows)]


def table(data: dict[str, Any]) -> str:
    """Return the table of the page: median and worst by machine and cylinders, locks above 0.3 s."""
    titles = [f"{'coach' if name == 'vehicle' else name}, {'flow' if flow else 'timed'}" for name, flow in KINDS]
    lines = [f"| controller | {' | '.join(titles)} | locks |", "|---" * (len(KINDS) + 2) + "|"]
    for who in NAMES:
        cells, locks, count = [], 0, 0
        for name, flow in KINDS:
            rows = data[f"{name} {flow}"]
            found = ratios(rows, who)
            worst = f"{max(found):.2f}" if np.isfinite(max(found)) else f"{np.isinf(found).sum()} without a stop"
            cells.append(f"{np.median(found):.3f}, {worst}")
            locks += sum(row[who][1] is None or row[who][1] > 0.3 for row in sliding(rows))
            count += len(found)
        lines.append(f"| {WORDS.get(who, who)} | {' | '.join(cells)} | {locks} of {count} |")
    return "\n".join(lines) + "\n"


def picture(data: dict[str, Any]) -> Figure:
    """Plot the distance over the ideal of every stop by controller."""
    all_rows = [row for rows in data.values() for row in rows]
    medians = {who: float(np.median(ratios(all_rows, who))) for who in NAMES}
    allowed, taken = medians["omniscient"], medians["protection"]
    title = f"The valves allow {allowed:.2f} of the ideal distance, the protection takes {taken:.2f}"
    figure, axis = plots.single(title, "stopping distance over the ideal [1]", "")
    spread = np.random.default_rng(0)
    for place, who in enumerate(NAMES):
        found = np.array([ratio for ratio in ratios(all_rows, who) if np.isfinite(ratio)])
        axis.plot(found, place + spread.uniform(-0.25, 0.25, found.size), ".", color=plots.TRAILING, alpha=0.5)
        axis.plot([medians[who]] * 2, [place - 0.35, place + 0.35], color=plots.LEADING)
    axis.set(xscale="log", yticks=range(len(NAMES)), yticklabels=[WORDS.get(who, who) for who in NAMES])
    axis.set_xticks([1.0, 1.1, 1.2, 1.5, 2.0, 3.0, 4.0], ["1", "1.1", "1.2", "1.5", "2", "3", "4"])
    axis.minorticks_off()
    return figure


def main() -> int:
    data = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}
    if "--measure" in sys.argv:
        data = {f"{name} {flow}": measured(MACHINES[name](), flow) for name, flow in KINDS}
        DATA.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    picture(data).savefig(PICTURE, dpi=120)
    print(table(data))
    return 0


if __name__ == "__main__":
    sys.exit(main())
