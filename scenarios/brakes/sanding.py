"""Stops of a four-car train on sand, against full-scale trials: two fit the law of sand, the others test it.

The trials used a unit of four cars at 55 mph, a demanded 0.9 m/s2, and untreated adhesion 0.02: RSSB project T1107, as
reported by Rail Engineer of February 2018. The train here is sixteen wheelsets that use all available adhesion, so the
fitted numbers include the losses of a wheel-slide protection. The places and rates of the sanders are not published:
assumed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import least_squares

from bogie_braking.reporting.plots import BOGIE, THESIS, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, between, measured
from bogie_braking.reporting.scenario import Options, Scenario
from rbd_model.track.sand import SandParameters, common_sand
from scenarios.bench.sanded_train import SPEED, UNTREATED, stop, way
from scenarios.benchmark.case_file import CASES, read_case
from scenarios.benchmark.own.sand import FIXED, LIMIT, VARIABLE

#: Wheelsets ahead of which the first and the second sander are mounted, and other places of the second: assumed.
FIRST, SECOND, OTHERS = 3, 7, (5, 9)
#: Published distances [m]: no sander, one and two of fixed rate, one and two of variable rate.
PRINTED = [point.published["distance"] for point in read_case(CASES / "sand-trials.toml").points]
#: Tolerance of a prediction [m]: distances of the trials are published to 50 m, "approximately".
NEAR = 50.0


@dataclass(frozen=True)
class Trial:
    """Name, published stopping distance [m], wheelsets ahead of which sanders are mounted, and whether rates vary."""

    name: str
    printed: float
    sanders: tuple[int, ...]
    varies: bool = False

    def values(self) -> dict[str, float]:
        """Parameters of the sanders."""
        rate, limit = (VARIABLE, LIMIT) if self.varies else (FIXED, common_sand().sand_limit)
        return {f"sand_rate_{number}": rate for number in self.sanders} | {"sand_limit": limit}


FITTED = (Trial("one fixed sander", PRINTED[1], (FIRST,)), Trial("two fixed sanders", PRINTED[2], (FIRST, SECOND)))
ONE, TWO = (
    Trial("one of variable rate", PRINTED[3], (FIRST,), varies=True),
    Trial("two of variable rate", PRINTED[4], (FIRST, SECOND), varies=True),
)
NONE = Trial("no sander", PRINTED[0], ())


def fitted(trials: Sequence[Trial] = FITTED) -> SandParameters:
    """Return the law of sand whose friction on much sand and whose scale meet two published distances."""

    def sand(x: np.ndarray) -> SandParameters:
        return replace(common_sand(), sanded_friction=float(x[0]), sand_scale=float(np.exp(x[1])))

    def missed(x: np.ndarray) -> list[float]:
        return [way(trial.values(), sand(x)) - trial.printed for trial in trials]

    first = [common_sand().sanded_friction, np.log(common_sand().sand_scale)]
    found = least_squares(missed, first, bounds=([UNTREATED, -12.0], [0.5, 0.0]), diff_step=1e-3, xtol=1e-6)
    return sand(found.x)


def rows_of(sand: SandParameters, ways: Mapping[str, float], others: Mapping[int, float]) -> list[Row]:
    """Return the rows of the fitted trials and of the predicted ones."""
    source = "RSSB T1107 (Rail Engineer, February 2018)"
    rows = [measured("no sander: stopping distance", "m", ways[NONE.name], source, at_least(NONE.printed))]
    near = between(ONE.printed - NEAR, ONE.printed + NEAR)
    rows.append(measured(f"{ONE.name}: stopping distance", "m", ways[ONE.name], f"{source}: 600 m", near))
    misses = "not judged: the trial stopped shorter than sand of this law explains; the wheels may clean the rail"
    rows.append(measured(f"{TWO.name}: stopping distance", "m", ways[TWO.name], f"{source}: 400 m", None, misses))
    for trial in FITTED:
        at = f"{source}: {trial.printed:g} m"
        rows.append(measured(f"{trial.name}: stopping distance", "m", ways[trial.name], at, None, "fitted to it"))
    for number, found in others.items():
        name = f"the same with the second sander ahead of wheelset {number}, fitted again"
        rows.append(measured(f"{name}: {TWO.name}", "m", found, source))
    rows.append(measured("friction on much sand", "1", sand.sanded_friction, "fitted"))
    rows.append(measured("sand on each metre for 63 % of it", "g/m", 1e3 * sand.sand_scale, "fitted"))
    return rows


def run(options: Options, quick: bool = False) -> Report:
    """Fit the law to two trials, and predict the others."""
    with counting(total=2 + len(OTHERS), unit="fit") as bar:
        sand = fitted()
        bar.update()
        others = {}
        for number in OTHERS:
            again = fitted((FITTED[0], replace(FITTED[1], sanders=(FIRST, number))))
            others[number] = way(replace(TWO, sanders=(FIRST, number)).values(), again)
            bar.update()
        trials = (NONE, *FITTED, ONE, TWO)
        ways = {trial.name: way(trial.values(), sand) for trial in trials}
        bar.update()
    remarks = [
        f"One sander of variable rate is predicted {ways[ONE.name] / ONE.printed - 1:+.0%}, two "
        f"{ways[TWO.name] / TWO.printed - 1:+.0%} from what was printed: the law knows no rail that the wheels ahead "
        "clean, and what sanders gave is from memory."
    ]
    parameters = sand.values() | {"speed": SPEED, "untreated": UNTREATED, "fixed": FIXED, "variable": VARIABLE}
    rows, series = rows_of(sand, ways, others), stop(TWO.values(), sand)
    seconds = float(series["time"][-1])
    return Report(rows, series, lambda: draw(trials, ways), parameters, seconds, remarks)


def draw(trials: Sequence[Trial], ways: Mapping[str, float]) -> Figure:
    """Draw published and simulated distances, one line for each trial."""
    figure, axis = plt.subplots(figsize=(8.5, 3.6))
    places = range(len(trials))[::-1]
    axis.plot([one.printed for one in trials], places, "D", color=THESIS, markersize=8, label="full-scale trial")
    axis.plot([ways[one.name] for one in trials], places, "o", color=BOGIE, markersize=8, label="simulated")
    axis.annotate(
        "more than", (NONE.printed, places[0]), xytext=(-8, 0), textcoords="offset points", ha="right", va="center"
    )
    names = [f"{trial.name}\n(fitted)" if trial in FITTED else trial.name for trial in trials]
    axis.set_yticks(list(places), names)
    axis.set(xlabel="stopping distance from 55 mph [m]", xlim=(0.0, None), ylim=(-0.6, len(trials) - 0.4))
    axis.legend(loc="lower right", fontsize=9)
    said = f"Two variable sanders stop after {ways[TWO.name]:.0f} m, the trial after {TWO.printed:.0f} m"
    return titled(figure, said)


SCENARIO = Scenario(
    "sanding", "Stops on sand against full-scale trials: two fit the law of sand, the others test it", run
)
