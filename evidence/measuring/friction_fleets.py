"""Shares of intervals of `bb.fit(..., places=...)` that hold, over fleets of simulated stops with known fields.

python -m evidence.measuring.friction_fleets bogie          100 fleets of five stops each, table of docs/public.md
python -m evidence.measuring.friction_fleets coach 0.05     friction differs between stops by 5 %
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from scipy.signal import lfilter

import bogie_braking as bb
from products.machine import MACHINES, Machine
from products.protection.rig import Rig
from products.protection.rig_in_c import slide_protection
from products.protection.runs import Run
from products.protection.settings import Settings
from products.registry import fmu_named
from rbd_model.track.friction import low

#: Knots [m], stops of a fleet, and fleets.
PLACES, STOPS, FLEETS = np.arange(0.0, 401.0, 40.0), 5, 100
#: Interval of the rows [s]; errors of the speed: independent, and correlated over 1 s [m/s]; relative errors of wheel
#: speeds, independent, and of the pressures of a log, one for each wheelset.
EVERY, WHITE, SLOW, OF_WHEELS, OF_PRESSURES = 0.04, 0.03, 0.02, 0.01, 0.02


def logged(stop: bb.Recording, random: np.random.Generator) -> bb.Recording:
    """Return a stop as a train's recorder may have logged it."""
    names = [one for one in stop.names if one.split("_")[0] in ("time", "speed", "distance", "wheel", "pressure")]
    step = round(EVERY / (stop["time"][1] - stop["time"][0]))
    rows = np.column_stack([stop[one] for one in names])[::step]
    kept, count = np.exp(-EVERY), len(rows)
    drift = lfilter([np.sqrt(1 - kept**2)], [1.0, -kept], random.normal(size=count + 500))[500:]
    for column, name in enumerate(names):
        if name == "speed":
            rows[:, column] += WHITE * random.normal(size=count) + SLOW * drift
        elif name.startswith("wheel_speed"):
            rows[:, column] *= 1.0 + OF_WHEELS * random.normal(size=count)
        elif name.startswith("pressure"):
            rows[:, column] *= 1.0 + OF_PRESSURES * random.normal()
    return bb.Recording({one: stop.units[one] for one in names}, rows)


def fleet(machine: Machine, seed: int, scatter: float) -> tuple[np.ndarray, list[bb.Recording]]:
    """Return a drawn field and the logs of stops over it; scatter: between their frictions."""
    random, rail = np.random.default_rng(seed), low()
    friction = random.uniform(0.05, 0.12, PLACES.size)
    line = bb.line_of([bb.straight(3000.0)], -60.0).with_friction(PLACES, friction / rail.friction)
    runs = []
    for _ in range(STOPS):
        own = rail.friction * (1.0 + scatter * random.normal())
        values = rail.law.values() | {f"friction_{n}": own for n in machine.numbers}
        phases = tuple(random.uniform(0.0, 1.0, len(machine.numbers)).tolist())
        runs.append(
            Run(values, random.uniform(17.0, 24.0), phases=phases, teeth=int(random.integers(1, 2**31)), line=line)
        )
    rig = Rig(machine, slide_protection(), Settings(jitter=0.02), by_flow=True)
    radius = machine.parameters.wheel_radius
    return friction, [logged(stop.course.recording(radius), random) for stop in rig.runs(runs, every=5e-3)]


def main() -> int:
    """Print the share of intervals that hold, and the errors."""
    name, scatter = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 0.0
    machine, law = MACHINES[fmu_named(name)](), dict[str, Any](low().law.values())
    inside, errors = [], []
    for seed in range(FLEETS):
        friction, logs = fleet(machine, seed, scatter)
        found = bb.fit(name, logs, {"friction": 0.1}, places=PLACES, **law)
        there = np.isfinite(found.values)
        inside.append(((found.lower <= friction) & (friction <= found.upper))[there])
        errors.append((found.values / friction - 1.0)[there])
    every = np.concatenate(errors)
    print(f"{name}, scatter {scatter:g}: {np.mean(np.concatenate(inside)):.3f} of {every.size} intervals hold")
    print(f"errors: mean {100 * every.mean():.2f} %, rms {100 * np.sqrt(np.mean(every**2)):.2f} %")
    return 0


if __name__ == "__main__":
    sys.exit(main())
