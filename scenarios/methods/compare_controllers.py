"""Compares wheel-slide controllers on the test rig: one score table, one picture, one JSON file.

  bogie-braking controllers compare mine.py:PI                    a Python class; none and our own stand beside it
  bogie-braking controllers compare mine.py:PI libpi.so           and a shared library
  bogie-braking controllers compare pi.c --vehicle vehicle        C, compiled now; on the coach
  bogie-braking controllers compare mine.py:PI --rails low,wet    on these rails alone
  bogie-braking controllers compare mine.py:PI --programme full   18 cases: 60 to 200 km/h, sensors and valves that fail
  bogie-braking controllers compare mine.py:PI --programme my.toml
                                                                  cases of your own (controllers programme > my.toml)
  bogie-braking controllers compare mine.py:PI --speed 160km/h --teeth 80 --period 10ms
  bogie-braking controllers compare mine.py:PI --json | jq .runs  for a program
  bogie-braking controllers header > wheel_slide.h                what a controller in C includes

A class has the method step(time, wheel_speeds) -> valves: [s], [m/s] -> 0 apply, 1 hold or 2 vent for each wheelset.
All make the same stops with the same brake, sensors and rails, in the plane. Without a controller the wheels may lock.
The ideal has the best slip at every instant. Measures in the manner of EN 15595, without any claim of conformity.

Exit status: 0 all controllers stopped everywhere; 1 one did not stop, or failed; 2 bad input; 3 the simulation failed;
130 interrupted with Ctrl-C.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from brake_controller.wheel_slide import SlideProtection
from fmu_src.compile import CompilerError
from products.protection.braked_machine import Machine, bogie, coach
from products.protection.programme import OWN, Case, four_rails, read_programme, speed_of
from products.protection.protected_stop import CYLINDER_VOLUME, Settings
from products.protection.rails import LOCK_ABOVE, RAILS
from products.protection.rig import FOLDER, Form, InC, Rig, Run, Stop, check_period, compiled, machine_model
from scenarios.bench.peak_adhesion import PeakAdhesion
from scenarios.methods.pace import time_of
from scenarios.reporting.plots import BOGIE, LEADING, THESIS, TRAILING, plt, titled
from scenarios.reporting.progress import counting
from scenarios.scenario import BadInputError

MACHINES = {"bogie": bogie, "vehicle": coach}
#: Of every comparison, ahead of what is given.
ALWAYS: dict[str, Form] = {"none": None, "protection": SlideProtection}
LIBRARIES = (".so", ".dll", ".dylib")
#: Pressure at which litres of air are counted [Pa].
FREE_AIR = 101325.0


@dataclass(frozen=True)
class Scored:
    """A stop of a controller in a case, beside the ideal and its own on the dry rail [m]; air in litres."""

    case: str
    controller: str
    stop: Stop
    ideal: float | None
    dry: float | None

    def over(self, other: float | None) -> float | None:
        """The distance over another; None where one of them is missing."""
        return None if self.stop.distance is None or other is None else self.stop.distance / other

    @property
    def air(self) -> float:
        """Of all cylinders, whose volume is taken as constant [l]."""
        return 1e3 * self.stop.filled * CYLINDER_VOLUME / FREE_AIR


def add_commands(parser: argparse.ArgumentParser, speech: Callable[[argparse.ArgumentParser], None]) -> None:
    """What can be done with controllers; speech: gives a command its ways of printing less."""
    actions = parser.add_subparsers(dest="action", required=True)
    form: dict[str, Any] = {"description": __doc__, "formatter_class": argparse.RawDescriptionHelpFormatter}
    compare = actions.add_parser("compare", help="score controllers on the same rails", **form)
    add_arguments(compare)
    speech(compare)
    actions.add_parser("header", help="print wheel_slide.h, which a controller in C includes")
    actions.add_parser("programme", help="print the programme that comes along, to begin one of your own with")
    parser.set_defaults(quiet=False, json=False, out=Path("results"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    text = "FILE.py:CLASS, a shared library, or a C file that includes wheel_slide.h"
    parser.add_argument("controller", nargs="+", help=text)
    parser.add_argument("--vehicle", choices=list(MACHINES), default="bogie", help="bogie, or vehicle: the coach")
    group = parser.add_mutually_exclusive_group()
    text = f"some of {','.join(rail.name for rail in RAILS)} (default: all)"
    group.add_argument("--rails", default="", metavar="NAMES", help=text)
    text = "a TOML file with cases, or full: the programme that comes along"
    group.add_argument("--programme", metavar="FILE", help=text)
    parser.add_argument("--speed", default="25", help="at the start, as 25m/s or 160km/h (default: 25 m/s)")
    parser.add_argument("--strength", type=float, default=1.0, help="torque over that of the full brake (default: 1)")
    parser.add_argument("--period", default="5ms", metavar="TIME", help="of the controllers (default: 5ms)")
    parser.add_argument("--teeth", type=int, default=Settings.pulses, help="of each sensor (default: 100)")
    text = "standard deviation of the teeth's places, as a share of the pitch (default: 0)"
    parser.add_argument("--jitter", type=float, default=0.0, help=text)
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder of the results (default: results)")


def forms_of(given: Sequence[str]) -> dict[str, Form]:
    """Controllers by their names, those of every comparison first. Raises BadInputError, CompilerError."""
    forms = dict(ALWAYS)
    for text in given:
        name, form = form_of(text)
        if name in forms:
            raise BadInputError(f"Two controllers are called {name}; give each another name.")
        forms[name] = form
    return forms


def form_of(text: str) -> tuple[str, Form]:
    """The name of a controller, and what it is. Raises BadInputError, CompilerError."""
    file, _, name = text.rpartition(":")
    if file.endswith(".py"):
        return name, class_in(Path(file), name)
    path = Path(text)
    if path.suffix not in (*LIBRARIES, ".c"):
        raise BadInputError(f"Give FILE.py:CLASS, a shared library or a C file as a controller: it was {text}.")
    if not path.is_file():
        raise BadInputError(f"There is no file {path}; give the path of a controller.")
    try:
        form = compiled(path) if path.suffix == ".c" else InC(path.resolve())
        form.functions(len(bogie().numbers))
    except CompilerError as error:
        raise BadInputError(f"{path} does not compile. {error}") from None
    except (OSError, AttributeError, ValueError) as error:
        raise BadInputError(
            f"{path} is no controller ({error}); it needs the functions of wheel_slide.h, which "
            "bogie-braking controllers header prints."
        ) from None
    return path.stem, form


def class_in(file: Path, name: str) -> type:
    """A class of a Python file. Raises BadInputError."""
    if not file.is_file():
        raise BadInputError(f"There is no file {file}; give FILE.py:CLASS.")
    about = importlib.util.spec_from_file_location(file.stem, file)
    assert about is not None
    assert about.loader is not None
    module = importlib.util.module_from_spec(about)
    try:
        about.loader.exec_module(module)
    except Exception as error:
        raise BadInputError(f"{file} cannot be imported ({type(error).__name__}: {error}); mend it.") from error
    found = getattr(module, name, None)
    if not isinstance(found, type) or not callable(getattr(found, "step", None)):
        raise BadInputError(f"{file} has no class {name} with a method step(time, wheel_speeds); give one that has.")
    try:
        found()
    except (Exception, SystemExit) as error:
        raise BadInputError(
            f"{name} of {file} cannot be made without arguments ({type(error).__name__}: {error}); give its gains "
            "default values, or write a class below it that sets them."
        ) from None
    return found


def cases_of(chosen: argparse.Namespace) -> list[Case]:
    """The cases that are asked for. Raises BadInputError."""
    if chosen.programme:
        path = OWN if chosen.programme == "full" else Path(chosen.programme)
        try:
            return read_programme(path)
        except OSError:
            raise BadInputError(f"There is no file {path}; give a programme, or full.") from None
        except ValueError as error:
            raise BadInputError(str(error)) from None
    known = {case.name: case for case in four_rails()}
    names = [name.strip() for name in chosen.rails.split(",") if name.strip()] or list(known)
    for name in names:
        if name not in known:
            raise BadInputError(f"There is no rail {name}; give some of {', '.join(known)}.")
    return [known[name] for name in names]


def compare(machine: Machine, forms: dict[str, Form], cases: Sequence[Case], settings: Settings) -> list[Scored]:
    """Every controller in every case, case by case, and what each came to."""
    try:
        runs = [case.run(len(machine.numbers)) for case in cases]
    except ValueError as error:
        raise BadInputError(str(error)) from None
    known = {variable.name for variable in machine_model(machine.counted).variables}
    for case, run in zip(cases, runs, strict=True):
        for name in run.values:
            if name not in known:
                raise BadInputError(f"The case {case.name} sets {name}, which this machine has not.")
    stops: dict[str, list[Stop]] = {}
    with counting(total=len(forms) + len(runs), text="controllers and ideals", unit="") as bar:
        for name, form in forms.items():
            with contextlib.redirect_stdout(sys.stderr):  # what a controller prints
                stops[name] = Rig(machine, form, settings).runs(runs)
            bar.update()
        ideal = []
        for run in runs:
            ideal.append(ideal_distance(machine, run, settings))
            bar.update()
    names = [case.name for case in cases]
    dry = {name: found[names.index("dry")].distance if "dry" in names else None for name, found in stops.items()}
    return [
        Scored(case, name, found[number], ideal[number], dry[name] if cases[number].speed is None else None)
        for number, case in enumerate(names)
        for name, found in stops.items()
    ]


def ideal_distance(machine: Machine, run: Run, settings: Settings) -> float | None:
    """With the best slip at every instant; None where the rail stops nothing."""
    strength = settings.strength if run.strength is None else run.strength
    try:
        return PeakAdhesion(machine, run.values).stopping_distance(run.speed or settings.speed, strength)
    except ValueError:
        return None


def run(chosen: argparse.Namespace) -> bool:
    """Compares and reports, or prints a file; whether all stopped. Raises BadInputError, CompilerError."""
    printed = {"header": FOLDER / "wheel_slide.h", "programme": OWN}
    if chosen.action in printed:
        print(printed[chosen.action].read_text(encoding="utf-8"), end="")
        return True
    settings = settings_of(chosen)
    machine, forms = MACHINES[chosen.vehicle](), forms_of(chosen.controller)
    scores = compare(machine, forms, cases_of(chosen), settings)
    folder = chosen.out / "controllers"
    folder.mkdir(parents=True, exist_ok=True)
    about = document(chosen.vehicle, settings, scores)
    (folder / "compare.json").write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")
    figure = draw(scores)
    figure.savefig(folder / "compare.png")
    plt.close(figure)
    if chosen.json:
        print(json.dumps(about, indent=2))
    elif not chosen.quiet:
        print("\n".join([*lines(chosen.vehicle, settings, scores), "", f"Picture: {folder / 'compare.png'}"]))
    return all(score.stop.distance is not None for score in scores)


def settings_of(chosen: argparse.Namespace) -> Settings:
    """What the command line asks for. Raises BadInputError."""
    period = time_of(chosen.period, "--period")
    try:
        check_period(period)
        return Settings(
            speed=speed_of(chosen.speed),
            strength=chosen.strength,
            period=period,
            host_step=period,
            pulses=chosen.teeth,
            jitter=chosen.jitter,
        )
    except ValueError as error:
        raise BadInputError(str(error)) from None


def document(vehicle: str, settings: Settings, scores: Sequence[Scored]) -> dict[str, object]:
    """For programs; SI units, air in litres."""
    runs = [
        {"case": one.case, "controller": one.controller, **asdict(one.stop)}
        | {"over_ideal": one.over(one.ideal), "over_dry": one.over(one.dry), "ideal": one.ideal, "air": one.air}
        for one in scores
    ]
    return {"vehicle": vehicle, "settings": asdict(settings), "runs": runs}


# ---- for people ------------------------------------------------------------------------------------------------------

HEADS = ("case", "controller", "distance", "over ideal", "over dry", "longest lock", "in the band", "air", "commands")
UNITS = ("", "", "m", "1", "1", "s", "1", "l", "1")


def lines(vehicle: str, settings: Settings, scores: Sequence[Scored]) -> Iterator[str]:
    """The table, and what was said."""
    about = f"{settings.pulses} teeth, every {1e3 * settings.period:g} ms; lock counted above {LOCK_ABOVE:g} m/s"
    strength = "full brake" if settings.strength == 1.0 else f"{settings.strength:g} of the full brake"
    yield f"{vehicle}: {strength} from {settings.speed:g} m/s unless the case says otherwise, {about}"
    yield ""
    rows = [HEADS, UNITS, *(cells(one) for one in scores)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADS))]
    for number, row in enumerate(rows):
        if number > 1 and row[0] != rows[number - 1][0]:
            yield "-" * (sum(widths) + 2 * (len(widths) - 1))
        texts = [
            text.ljust(width) if column < 2 else text.rjust(width)
            for column, (text, width) in enumerate(zip(row, widths, strict=True))
        ]
        yield "  ".join(texts).rstrip()
    for one in scores:
        if one.stop.said:
            yield ""
            yield f"{one.controller}, {one.case}: {one.stop.said}"


def cells(one: Scored) -> tuple[str, ...]:
    """A row of the table."""

    def number(value: float | None, form: str) -> str:
        return "no stop" if value is None and form == ".1f" else "-" if value is None else format(value, form)

    stop = one.stop
    ratios = number(one.over(one.ideal), ".3f"), number(one.over(one.dry), ".3f")
    rest = f"{stop.longest_lock:.2f}", f"{stop.share_in_band:.2f}", f"{one.air:.0f}", str(stop.commands)
    return one.case, one.controller, number(stop.distance, ".1f"), *ratios, *rest


def draw(scores: Sequence[Scored]) -> Figure:
    """Distances over the ideal by rail and controller; the title says who stops shortest on the worst rail."""
    cases, names = (list(dict.fromkeys(getattr(one, kind) for one in scores)) for kind in ("case", "controller"))
    figure, axis = plt.subplots(figsize=(9.0, 1.2 + 0.35 * len(scores)))
    colours = dict(zip(names, ("0.75", THESIS, LEADING, TRAILING, BOGIE, "0.5"), strict=False))
    for place, one in enumerate(reversed(scores)):
        ratio, hatch = one.over(one.ideal), "" if one.stop.distance else "///"
        axis.barh(place, ratio or 0.0, color=colours.get(one.controller, "0.5"), hatch=hatch)
        words = "no stop" if one.stop.distance is None else f"{one.stop.distance:.0f} m"
        axis.text((ratio or 0.0) + 0.01, place, words, va="center", fontsize=8)
    axis.set_yticks(range(len(scores)), [f"{one.case}, {one.controller}" for one in reversed(scores)], fontsize=8)
    axis.axvline(1.0, color="0.2", linewidth=0.8)
    axis.set_xlabel("stopping distance over the ideal [1]")
    axis.margins(x=0.08)
    return titled(figure, message(scores, cases))


def message(scores: Sequence[Scored], cases: Sequence[str]) -> str:
    """What the picture says in one sentence."""
    worst = max(cases, key=lambda name: max((one.over(one.ideal) or 0.0) for one in scores if one.case == name))
    stopped = [one for one in scores if one.case == worst and one.stop.distance is not None]
    if not stopped:
        return f"{worst}: nothing stops"
    ratios = {one.controller: one.over(one.ideal) for one in stopped if one.controller != "none"}
    told = [f"{name} {ratio:.2f}" for name, ratio in ratios.items() if ratio]
    return f"{worst}: distance over the ideal, {', '.join(told)}" if told else f"{worst}: no ideal to compare with"
