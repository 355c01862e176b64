"""Runs what needs neither extras nor a C compiler: `python ready.py`, with a wheel of the platform.

Expected numbers are closed forms, or those that pages of the documentation show.
"""

import contextlib
import io
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import bogie_braking as bb
from bogie_braking import etcs
from bogie_braking.__main__ import main

#: Packages of extras, which must not be imported.
EXTRAS = ("casadi", "fmpy", "pythonfmu", "matplotlib", "plotly", "gymnasium", "cma", "pyarrow", "distributed")
CONSIST = "kind,count\nlocomotive,1\ncoach,6\n"
CONTROLLER = """class LetGo:
    def step(self, time, wheel_speeds):
        return [2 if speed < 0.8 * max(wheel_speeds) else 0 for speed in wheel_speeds]
"""


def command(*arguments: str, status: Sequence[int] = (0,)) -> str:
    """Return the output of a command."""
    with contextlib.redirect_stdout(io.StringIO()) as shown:
        assert main([*arguments]) in status, shown.getvalue()
    return shown.getvalue()


def stop_of_a_coach() -> str:
    """The README has 963 m."""
    brake = {f"pressure_demand_{n}": 380e3 for n in (1, 2, 3, 4)} | {f"friction_{n}": 0.30 for n in (1, 2, 3, 4)}
    coach = {"level": 2, "initial_speed": 160 / 3.6, "body_mass": 38e3}
    stop = bb.run("braked-vehicle", 150.0, names=["speed", "distance"], **coach, **brake)
    distance = stop["distance"][(stop["speed"] < 0.01).argmax()]
    assert round(distance) == 963
    return f"{distance:.0f} m"


def train() -> str:
    """An emergency brake stops it: after its build-up slower than by the adhesion of dry rails, 0.15 g at most."""
    own = bb.train(20, speed=80 / 3.6)
    own.drive("emergency")
    stop = own.record(120.0)
    names = [name for name in stop.names if name.startswith("speed")]
    assert stop[names[0]][-1] < 0.1
    return f"{np.diff(stop['time']) @ stop[names[0]][1:]:.0f} m"


def consist() -> str:
    Path("train.csv").write_text(CONSIST, encoding="utf-8")
    return command("consist", "check", "train.csv").splitlines()[0]


def curves() -> str:
    """The page on ETCS has 1068 m for EBD at 120 km/h."""
    own = etcs.SupervisedTrain.of_percentage(100.0, "passenger P", 200.0)
    limits = etcs.supervise(own, place=2000.0, V_est=np.array([120.0]) / 3.6)
    assert round(2000.0 - float(limits.EBD[0])) == 1068
    return command("etcs", "train.csv", "--target", "2000").splitlines()[0]


def controllers() -> str:
    """The page on controllers has 679 m on the slippery rail."""
    Path("let_go.py").write_text(CONTROLLER, encoding="utf-8")
    sys.path.insert(0, os.getcwd())
    from let_go import LetGo  # type: ignore[import-not-found]

    assert bb.protected_stops(LetGo).messages[2].startswith("low: 679 m")
    return command("controllers", "compare", "let_go.py:LetGo", status=(0, 1)).splitlines()[0]


def fit() -> str:
    """Noise of 0.05 m/s leaves the true parameters within their errors."""
    coach = {"level": 1, "initial_speed": 40.0}
    coast = bb.run("vehicle", 120.0, None, ["speed"], 1.0, davis_constant=700.0, davis_quadratic=3.5, **coach)
    coast["speed"][:] += np.random.default_rng(3).normal(0.0, 0.05, coast["speed"].size)
    coast.write("coast.csv")
    found = bb.fit("vehicle", "coast.csv", {"davis_constant": 500.0, "davis_quadratic": 2.0}, **coach)
    assert abs(found.values["davis_quadratic"] - 3.5) < 0.1
    return found.status


def live() -> str:
    command("live")
    return f"{Path('results/live.html').stat().st_size / 1e6:.1f} MB"


ALL = (stop_of_a_coach, train, consist, curves, controllers, fit, live)


def run_all(names: Sequence[str]) -> None:
    """Run those of these names in an empty folder, and print what each found; no name: all."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for run in (one for one in ALL if not names or one.__name__ in names):
            begin = time.perf_counter()
            print(f"{run.__name__}: {run()} ({time.perf_counter() - begin:.1f} s)", flush=True)
        os.chdir(Path(__file__).parent)
    imported = [name for name in EXTRAS if name in sys.modules]
    assert not imported, f"These must not be imported: {imported}"


if __name__ == "__main__":
    run_all(sys.argv[1:])
