"""Measures the values of docs/rare.md by splitting and by ten million plain runs of the point level, and plots them.

python -m evidence.measuring.rare_stops              the figure, from docs/data/rare-stops.json
python -m evidence.measuring.rare_stops --plain      first the plain runs, five to fifteen minutes
python -m evidence.measuring.rare_stops --seeds      first the intervals of 200 seeds, as long
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import binomtest, norm, uniform

import bogie_braking as bb
from bogie_braking.rare_events import Rare
from bogie_braking.reporting import plots
from fmu_src.progress import counting

DOCS = Path(__file__).parents[2] / "docs"
DATA, PICTURE = DOCS / "data" / "rare-stops.json", DOCS / "pictures" / "rare-stops.png"
#: A stop of the bogie of chapter 5 as a point, from 90 km/h. All that is random is assumed: adhesion of the rail below
#: both wheelsets, shoes that each give another torque, a load between empty and full.
SCENE: dict[str, Any] = {"level": 1, "initial_speed": 25.0}
VARY: dict[Any, Any] = {
    ("friction_1", "friction_2"): norm(0.15, 0.02),
    "brake_torque_1": norm(20e3, 1.5e3),
    "brake_torque_2": norm(20e3, 1.5e3),
    "frame_mass": uniform(50e3, 20e3),
}
#: In which all stop [s].
DURATION = 120.0
#: Plain runs, in parts with a stream of random numbers each.
RUNS, PART, SEED = 10_000_000, 100_000, 20
#: Limits at which they are counted [m]; at two of them, 1e-4 and 1e-5, splitting is held against the count.
LIMITS = range(200, 1001, 10)
LIMIT_4, LIMIT_5, FAR = 420, 490, 700
#: Chosen before any was run.
SEEDS = range(200)


def plain_distances(part: int) -> np.ndarray:
    """Return stopping distances of one part of the plain runs [m], shape (PART,)."""
    random = np.random.default_rng([SEED, part])
    values: dict[str, Any] = {}
    for names, one in VARY.items():
        drawn = one.rvs(PART, random_state=random)
        values |= dict.fromkeys([names] if isinstance(names, str) else names, drawn)
    ends = bb.batch("bogie", DURATION, ["distance", "speed"], **SCENE, **values)
    assert not ends.failures, ends.failures
    assert not np.any(ends["speed"])
    return ends["distance"]


def plain_counts() -> dict[str, int]:
    """Return the number of all plain runs that are longer than each limit."""
    counts = np.zeros(len(LIMITS), int)
    for part in counting(range(RUNS // PART), "plain runs", unit="part"):
        counts += np.sum(plain_distances(part)[:, None] > np.array(LIMITS), axis=0)
    return dict(zip(map(str, LIMITS), counts.tolist(), strict=True))


def splitting(limit: float, seed: int, **more: Any) -> Rare:
    """The probability of a longer stop."""
    return bb.rare("bogie", DURATION, "distance", limit, VARY, seed=seed, **SCENE, **more)


def intervals() -> list[list[float]]:
    """Return probability and interval of each seed at the limit of 1e-4, and the number of its runs."""
    found = [splitting(LIMIT_4, seed) for seed in counting(SEEDS, "seeds", unit="seed")]
    return [[one.probability, *one.interval, one.runs] for one in found]


def picture(data: dict[str, Any]) -> Figure:
    """Plot the probability of a longer stop over distance, by plain runs and by splitting."""
    far = splitting(FAR, 0)
    title = f"To {FAR:g} m splitting makes {RUNS / far.runs:.0f} times fewer runs than plain sampling"
    figure, axis = plots.single(title, "stopping distance [m]", "probability of a longer stop")
    seen = far.tail["probability"] > 0.0
    distance, middle, lower, upper = (column[seen] for column in (far.tail[name] for name in far.tail.names))
    axis.fill_between(distance, lower, upper, color=plots.LEADING, alpha=0.25, label="its 95 % confidence interval")
    axis.semilogy(distance, middle, color=plots.LEADING, label=f"splitting, {far.runs:_} runs".replace("_", " "))
    counts = {int(limit): count for limit, count in data["counts"].items() if 0 < count < RUNS}
    ends = [binomtest(count, RUNS).proportion_ci() for count in counts.values()]
    shares = np.array(list(counts.values())) / RUNS
    off = np.abs(np.array([[end.low, end.high] for end in ends]).T - shares)
    label = f"plain, {RUNS:_} runs, 95 %".replace("_", " ")
    axis.errorbar(list(counts), shares, off, fmt=".", color=plots.TRAILING, elinewidth=1.0, label=label)
    axis.set(xlim=(250, FAR + 20), ylim=(1e-8, 2.0))
    axis.legend(loc="upper right")
    return figure


def main() -> int:
    asked = sys.argv[1:]
    data = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}
    if "--plain" in asked:
        data |= {"runs": RUNS, "part": PART, "seed": SEED, "counts": plain_counts()}
    if "--seeds" in asked:
        data |= {"limit": LIMIT_4, "intervals": intervals()}
    DATA.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    picture(data).savefig(PICTURE, dpi=120)
    return 0


if __name__ == "__main__":
    sys.exit(main())
