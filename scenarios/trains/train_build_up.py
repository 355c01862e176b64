"""Build-up time of trains against the formulas of the conversion model, and the effect of each unknown.

The times are shown without pass or fail and are not tuned, because the formulas include margins. The scenario tests
that each unknown changes the time in the physical direction.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import FOUR, charts, one_word
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.brake_weight import BrakingKind
from brake_controller.brake_weight import build_up_time as formula
from brake_controller.distributors.uic import filling_choke, freight
from products.train.consist import Consist
from products.train.numbers import Settings
from products.train.train import Train
from scenarios.bench.train_runs import TrainCourse, build_up_time, follow, propagation, train_of

#: Lengths by position [m]; mixed trains have five vehicles in G at their head.
LENGTHS = {"P": (400.0, 500.0, 600.0), "G": (400.0, 600.0, 750.0, 900.0), "five in G": (900.0, 1200.0, 1500.0)}
CASES = {
    "P": BrakingKind.EMERGENCY_FREIGHT_P,
    "G": BrakingKind.EMERGENCY_FREIGHT_G,
    "five in G": BrakingKind.EMERGENCY_FREIGHT_P,
}
MODES = {"P": ("P", 0), "G": ("G", 0), "five in G": ("P", 5)}
#: Volumes of branches with which the propagation is shown [m3].
BRANCHES = (0.0, 4e-3)
#: The trains whose unknowns are varied, and the simulated time [s].
VARIED, WATCHED = {"P": 600.0, "G": 750.0}, {"P": 60.0, "G": 90.0, "five in G": 90.0}


def build_up(consist: Consist, mode: str, settings: Settings | None = None) -> tuple[float, TrainCourse]:
    """Run an emergency at rest; return the equivalent time [s], and the course."""
    train = Train(consist, settings=settings)
    train.drive("emergency")
    course = follow(train, WATCHED[mode], 0.1)
    return build_up_time(course), course


def consist_of(mode: str, length: float) -> Consist:
    position, fast_from = MODES[mode]
    return train_of(length, position=position, fast_from=fast_from)


def with_distributors(consist: Consist, **changes: float) -> Consist:
    """Return the consist with all distributors changed alike."""
    vehicles = [replace(vehicle, distributor=replace(vehicle.distributor, **changes)) for vehicle in consist.vehicles]
    return Consist(tuple(vehicles))


def with_valve(consist: Consist, share: float) -> Consist:
    """Return the consist with a share of the emergency area of the head's valve."""
    head = consist.vehicles[0]
    assert head.valve is not None
    narrow = replace(head.valve, emergency_area=share * head.valve.emergency_area)
    return Consist((replace(head, valve=narrow), *consist.vehicles[1:]))


def slower(consist: Consist, mode: str) -> Consist:
    """Return the consist with cylinders that fill in the longest time of UIC 540: 5 s in P, 30 s in G."""
    choke = filling_choke(freight(mode), {"P": 5.0, "G": 30.0}[mode])
    return with_distributors(consist, filling_choke=choke)


def with_branches(consist: Consist, volume: float) -> Consist:
    """Return the consist with branches of its pipe, one volume in each vehicle [m3]."""
    return Consist(tuple(replace(vehicle, branch=volume) for vehicle in consist.vehicles))


def slowest(consist: Consist, mode: str) -> Consist:
    """Return the consist without accelerators and in-shot, filling in the longest time, with branches of 4 l and a
    third of the emergency valve's area.
    """
    plain = with_distributors(slower(consist, mode), accelerator_volume=0.0, inshot=0.0)
    return with_valve(with_branches(plain, 4e-3), 1 / 3)


@dataclass(frozen=True)
class Variation:
    """A changed parameter; later: physical sign of the effect on the time: longer (1), shorter (-1), or either (0)."""

    change: Callable[[Consist, str], Consist] | None
    settings: Settings
    later: int


UNKNOWNS = {
    "a third of the emergency valve's area": Variation(lambda c, _: with_valve(c, 1 / 3), Settings(), 1),
    "filling in the longest time of UIC 540": Variation(slower, Settings(), 1),
    "no in-shot": Variation(lambda c, _: with_distributors(c, inshot=0.0), Settings(), 1),
    "no accelerators": Variation(lambda c, _: with_distributors(c, accelerator_volume=0.0), Settings(), 1),
    "twice the wall friction": Variation(None, Settings(friction=2.0), 1),
    "half of the wall friction": Variation(None, Settings(friction=0.5), -1),
    "isothermal air": Variation(None, Settings(heat=1e3), 1),
    "adiabatic air": Variation(None, Settings(heat=0.0), -1),
    "branches of 2 l": Variation(lambda c, _: with_branches(c, 2e-3), Settings(), 1),
    "branches of 4 l": Variation(lambda c, _: with_branches(c, 4e-3), Settings(), 1),
    "the slowest brake that still has 250 m/s": Variation(lambda c, mode: slowest(c, mode), Settings(), 1),
    "pipes of 25 mm": Variation(  # less air has to leave, against more friction
        lambda c, _: Consist(tuple(replace(v, pipe_diameter=0.025) for v in c.vehicles)), Settings(), 0
    ),
}


def run(options: Options, quick: bool = False) -> Report:
    trains = [(mode, length) for mode, lengths in LENGTHS.items() for length in lengths]
    found = {one: build_up(consist_of(*one), one[0]) for one in counting(trains, "trains", unit="train")}
    tries = [(mode, name) for mode in VARIED for name in UNKNOWNS]
    moved = {(mode, name): shift(mode, name) for mode, name in counting(tries, "unknowns", unit="train")}
    rows = []
    for (mode, name), seconds in moved.items():
        asked = {1: at_least(-0.05), 0: None, -1: at_most(0.05)}[UNKNOWNS[name].later]
        quantity = f"{mode}, {VARIED[mode]:g} m, {name}: moves it by"
        rows.append(measured(quantity, "s", seconds, "the way physics says", asked))
    for (mode, length), (seconds, _) in found.items():
        due, name = formula(CASES[mode], length), f"{mode}, {length:g} m"
        rows.append(measured(f"{name}: build-up time", "s", seconds, f"formula {due:.2f} s"))
        rows.append(measured(f"{name}: over that of the formula", "1", seconds / due, "SUBSET-026"))
    rows += [row for volume in BRANCHES for row in rows_of_wave(volume)]
    largest = max(moved, key=lambda one: moved[one])
    said = [
        f"Plain physics builds up in {found['P', 600.0][0]:.1f} s in P at 600 m, where the formula has "
        f"{formula(CASES['P'], 600.0):.1f} s, and in {found['G', 750.0][0]:.1f} s in G at 750 m for "
        f"{formula(CASES['G'], 750.0):.1f} s.",
        f"Of the unknowns '{largest[1]}' moves it most: {moved[largest]:+.1f} s in {largest[0]}.",
    ]
    course = found["P", 600.0][1]
    seconds = sum(WATCHED[mode] for mode, _ in [*trains, *tries])
    parameters = {"varied": VARIED, "positions": list(MODES)}
    return Report(rows, course.recording(), lambda: draw(found, moved), parameters, seconds, said)


def rows_of_wave(volume: float) -> list[Row]:
    """Return propagation and mean begin of an emergency in P at 600 m, with a volume of branches [m3]."""
    consist = with_branches(consist_of("P", 600.0), volume)
    _, course = build_up(consist, "P")
    words = f"P, 600 m, branches of {1e3 * volume:g} l"
    wave, begun = propagation(course, consist.length), float(course.begun().mean())
    return [
        measured(f"{words}: propagation", "m/s", wave, "UIC 540: at least 250; measured: 280 to 300"),
        measured(f"{words}: cylinders begin to fill after", "s", begun, "formula: reaction time of 2.99 s"),
    ]


def shift(mode: str, name: str) -> float:
    """Return the change of the build-up time due to an unknown [s]."""
    own, one = consist_of(mode, VARIED[mode]), UNKNOWNS[name]
    plain, _ = build_up(own, mode)
    changed, _ = build_up(one.change(own, mode) if one.change else own, mode, one.settings)
    return changed - plain


def draw(
    found: Mapping[tuple[str, float], tuple[float, TrainCourse]], moved: Mapping[tuple[str, str], float]
) -> Figure:
    physics, due = found["P", 600.0][0], formula(CASES["P"], 600.0)
    message = f"At {one_word('600 m')} P builds up in {physics:.1f} s, the formula in {one_word(f'{due:.1f} s')}"
    titles = {"equivalent build-up time [s]": "length [m]", "what is not known": "moves the build-up time by [s]"}
    figure, (times, unknowns) = charts(message, titles, (11.0, 4.8))
    for colour, mark, (mode, lengths) in zip((FOUR[0], FOUR[2], FOUR[3]), "os^", LENGTHS.items(), strict=True):
        own = [found[mode, length][0] for length in lengths]
        times.plot(lengths, own, mark + "-", color=colour, label=f"{mode}, physics")
        fine = np.linspace(lengths[0], lengths[-1], 50)
        times.plot(fine, [formula(CASES[mode], one) for one in fine], "--", color=colour, label=f"{mode}, formula")
    for offset, colour, mode in ((-0.2, FOUR[0], "P"), (0.2, FOUR[3], "G")):
        places, label = np.arange(len(UNKNOWNS)) + offset, f"{mode}, {VARIED[mode]:g} m"
        unknowns.barh(places, [moved[mode, name] for name in UNKNOWNS], 0.38, color=colour, label=label)
    unknowns.set_yticks(range(len(UNKNOWNS)), list(UNKNOWNS), fontsize=8)
    for axis in (times, unknowns):
        axis.legend(fontsize=8)
    return figure


SCENARIO = Scenario(
    "train-build-up", "Build-up time of trains against the conversion model, and the effect of each unknown", run
)
