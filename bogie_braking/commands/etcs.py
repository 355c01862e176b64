"""Braking curves of ETCS for a train: its data from own stops, all limits before a target, and stops that begin there.

  bogie-braking etcs train.toml --target 2000                        level line, end of authority at 2000 m
  bogie-braking etcs train.toml --target 2000 --line line.csv --speed 140km/h
  bogie-braking etcs train.toml --target 2000 --target-speed 40km/h  a lower speed instead of a stop
  bogie-braking etcs train.toml --target 2000 --dry 0.85 --wet 0.9   with the factors of its confidence level
  bogie-braking etcs train.toml --target 2000 --failure 0.1% --spread 5% --common 3% --level 9
                                                                     and with Kdry_rst of these failures and spreads
  bogie-braking etcs train.toml --target 2000 --position "passenger P"
                                                                     by its brake percentage, not its decelerations
  bogie-braking etcs train.toml --target 2000 --json | jq .train     for a program

A train is a consist (TOML, CSV) or a file of another program (bogie-braking consist import). It stops twice on level
track, in emergency and in full service braking; these stops give deceleration by speed and build-up time. Its own stops
then begin where the emergency brake intervenes (EBI).

Exit status: 0 all own stops end before the target; 1 one does not; 2 bad input; 3 the simulation failed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bogie_braking.commands.shared import add_out, add_speech, describe
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from readers.command_line import check_folder, quantity, whole
from readers.storage import write_whole, writing
from readers.text import BadInputError

#: Numbers of speeds of tables and curves, largest speed by default [m/s]; limits in the order in which they are met.
IN_TABLE, IN_CURVES, LARGEST = 8, 160, 120.0 / 3.6
LIMITS = ("I", "P", "W", "SBI", "EBI", "EBD")
BASELINES, POSITIONS = ("3.3.0", "4.0.0"), ("passenger P", "freight P", "freight G")


def share(name: str) -> Callable[[str], float]:
    """Return the reader of a share of 0 to 50 %, whose result is a number from 0 to 0.5; it must state its unit."""
    read = quantity(name, "%", 0.0, 50.0)

    def with_unit(text: str) -> float:
        found = read(text)
        if not text.strip().endswith("%"):
            raise argparse.ArgumentTypeError(f"{name} must have its unit, %; got {text}. Write {found:g}%, or another.")
        return found / 100.0

    return with_unit


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    describe(parser, __doc__)
    parser.add_argument("file", type=Path, metavar="FILE", help="a consist, or a file that consist import reads")
    place = quantity("--target", "m", 0.0, 1e6)
    parser.add_argument(
        "--target", type=place, required=True, metavar="PLACE", help="place of the target, as 2000 or 2km"
    )
    speed = quantity("--speed", "km/h", 5.0, 400.0)
    text = "largest speed of the train, as 140 or 38.9m/s (default: 120 km/h)"
    parser.add_argument("--speed", type=speed, metavar="SPEED", default=3.6 * LARGEST, help=text)
    speed = quantity("--target-speed", "km/h", 0.0, 400.0)
    text = "speed at the target (default: 0, an end of authority)"
    parser.add_argument("--target-speed", type=speed, metavar="SPEED", default=0.0, help=text)
    beyond = quantity("--beyond", "m", 0.0, 1e4)
    text = "distance of the supervised location behind the end of authority (default: 0)"
    parser.add_argument("--beyond", type=beyond, metavar="LENGTH", default=0.0, help=text)
    text = "line of which the gradients count (default: level)"
    parser.add_argument("--line", type=Path, metavar="FILE", help=text)
    for name, words in (("--dry", "Kdry_rst"), ("--wet", "Kwet_rst")):
        factor = quantity(name, "1", 0.05, 1.55)
        parser.add_argument(name, type=factor, metavar="FACTOR", default=1.0, help=f"{words} (default: 1, no margin)")
    text = "probability that the brake of a vehicle does not act, as 0.1%% (default: 0)"
    parser.add_argument("--failure", type=share("--failure"), metavar="SHARE", default=0.0, help=text)
    text = "standard deviation of a vehicle's brake force over its nominal force, as 5%% (default: 0)"
    parser.add_argument("--spread", type=share("--spread"), metavar="SHARE", default=0.0, help=text)
    text = "standard deviation that all vehicles share, of friction for example, as 3%% (default: 0)"
    parser.add_argument("--common", type=share("--common"), metavar="SHARE", default=0.0, help=text)
    text = "confidence level of Kdry_rst, 0 to 9 (default: 9, a weaker brake once in 1e9)"
    parser.add_argument("--level", type=whole("--level", 0, 9), metavar="LEVEL", default=9, help=text)
    text = "take the conversion model of the train's brake percentage, in this brake position"
    parser.add_argument("--position", choices=POSITIONS, help=text)
    parser.add_argument("--baseline", choices=BASELINES, default=BASELINES[0], help="default: %(default)s")
    parser.add_argument("--service", action="store_true", help="the on-board unit commands the service brake too")
    add_out(parser)
    add_speech(parser, "train data, limits and stops", "no table, only the exit status")


def run(chosen: argparse.Namespace) -> int:
    """Compute, draw and print; return the exit status."""
    check_folder(chosen.out)
    if chosen.target_speed >= chosen.speed:
        raise BadInputError(
            f"--target-speed must be below --speed, {chosen.speed:g} km/h; got {chosen.target_speed:g} km/h."
        )
    found = _compute(chosen)
    picture, table = _write(chosen, found)
    document = _document(found) | {"picture": str(picture), "table": str(table)}
    if chosen.json:
        print(json.dumps(document, indent=2))
    elif not chosen.quiet:
        print("\n".join(_text(chosen, found)))
        print(f"\npicture: {picture}\ntable:   {table}")
    return HOLDS if all(stop.ends <= found["ends"] for stop in found["stops"]) else DOES_NOT_HOLD


def _compute(chosen: argparse.Namespace) -> dict[str, Any]:
    """Return consist, train data, limits over many and few speeds, own stops."""
    import numpy as np

    from bogie_braking.supervised import gradients_of, own_stops
    from products.supervision import BASELINES, FixedValues, Gradients, supervise
    from products.train.foreign import consist_from
    from rbd_model.track.line_files import line_from_file

    try:
        consist, _ = consist_from(chosen.file)
        line = None if chosen.line is None else line_from_file(chosen.line)
    except ValueError as error:
        raise BadInputError(str(error)) from error
    largest, target = chosen.speed / 3.6, chosen.target_speed / 3.6
    train, runs, factors = _train_data(chosen, consist, largest)
    set_up: dict[str, Any] = {
        "kind": "LOA" if target else "EOA",
        "target_speed": target,
        "beyond": 0.0 if target else chosen.beyond,
        "gradients": Gradients.level() if line is None else gradients_of(line),
        "fixed": FixedValues(T_indication_more=BASELINES[chosen.baseline]),
    }
    if target and chosen.beyond:
        raise BadInputError("--beyond is the distance behind a stop; leave it out with --target-speed.")
    few = target + (largest - target) * np.arange(1, IN_TABLE + 1) / IN_TABLE
    many = target + (largest - target) * np.arange(1, IN_CURVES + 1) / IN_CURVES
    limits = supervise(train, chosen.target, few, **set_up)
    if not np.all(np.isfinite(limits.EBI)):
        raise BadInputError("The train cannot brake on the gradients before the target. Give a better brake or line.")
    stops = [] if target else own_stops(consist, few, limits.EBI, line)
    return {
        "consist": consist,
        "train": train,
        "runs": runs,
        "factors": factors,
        "few": limits,
        "many": supervise(train, chosen.target, many, **set_up),
        "stops": stops,
        "ends": chosen.target + set_up["beyond"],
        "gradients": set_up["gradients"],
    }


def _train_data(chosen: argparse.Namespace, consist: Any, largest: float) -> tuple[Any, Any, Any]:
    """Return train data by the brake percentage, or by own stops, which are returned too, with Kdry_rst."""
    from bogie_braking.supervised import supervised_train, with_factors
    from products.supervision import SupervisedTrain

    if chosen.position is not None:
        if (chosen.dry, chosen.wet, chosen.failure, chosen.spread, chosen.common) != (1.0, 1.0, 0.0, 0.0, 0.0):
            raise BadInputError("Factors act on decelerations, not on percentages. Leave them out with --position.")
        percentage = min(consist.percentage, 250.0)
        train = SupervisedTrain.of_percentage(
            percentage, chosen.position, consist.length, service_command=chosen.service
        )
        return train, None, None
    runs = supervised_train(consist, largest, service_command=chosen.service)
    factors = _factors(chosen, consist, largest)
    dry = chosen.dry if factors is None else factors[chosen.level]
    return with_factors(runs.train, dry, chosen.wet), runs, factors


def _factors(chosen: argparse.Namespace, consist: Any, largest: float) -> Any:
    """Return Kdry_rst of all levels by failures and spreads, rounded down; None without any."""
    from bogie_braking.supervised import brake_units
    from products.supervision import dry_factors, rounded_down

    if not (chosen.failure or chosen.spread or chosen.common):
        return None
    if chosen.dry != 1.0:
        raise BadInputError(
            "--dry states Kdry_rst, which follows from --failure, --spread and --common. Leave one out."
        )
    units = brake_units(consist, largest / 2.0, chosen.failure, chosen.spread)
    factors = rounded_down(dry_factors(units, chosen.common))
    if not factors[chosen.level]:
        raise BadInputError(
            f"At level {chosen.level} no brake force is left: Kdry_rst is 0 with these failures and spreads. "
            "Give a lower --level or smaller numbers."
        )
    return factors


def _write(chosen: argparse.Namespace, found: dict[str, Any]) -> tuple[Path, Path]:
    """Write picture and table; return their paths."""
    from scenarios.reporting.supervision_picture import figure_of_supervision

    picture, table = (chosen.out / f"etcs-{chosen.file.stem}{end}" for end in (".png", ".csv"))
    many = found["many"]
    stops = [(stop.places, stop.speeds) for stop in found["stops"]]
    figure = figure_of_supervision(many, found["ends"], found["gradients"], stops)
    with writing(chosen.out):
        chosen.out.mkdir(parents=True, exist_ok=True)
        figure.savefig(picture, dpi=130)
    head = ",".join(["V_est [km/h]", *(f"{name} [m]" for name in LIMITS)])
    rows = zip(3.6 * many.V_est, *(getattr(many, name) for name in LIMITS), strict=True)
    lines = [head, *(",".join(f"{value:.3f}" for value in row) for row in rows)]
    write_whole(table, ("\n".join(lines) + "\n").encode(), "name another folder with --out")
    return picture, table


def _steps(steps: Any) -> dict[str, list[float]]:
    return {
        "boundaries_kmh": [round(3.6 * one, 3) for one in steps.boundaries.tolist()],
        "m_s2": [round(one, 4) for one in steps.values.tolist()],
    }


def _document(found: dict[str, Any]) -> dict[str, Any]:
    """Return what --json prints."""
    train, few = found["train"], found["few"]
    return {
        "train": {
            "length_m": train.length,
            "A_brake_emergency": _steps(train.A_brake_emergency),
            "A_brake_service": _steps(train.A_brake_service),
            "T_brake_emergency_s": float(train.T_brake_emergency),
            "T_brake_service_s": float(train.T_brake_service),
            "brake_percentage": found["consist"].percentage,
            "Kdry_rst": None if found["factors"] is None else found["factors"].tolist(),
        },
        "V_est_kmh": (3.6 * few.V_est).tolist(),
        "limits_m": {name: getattr(few, name).tolist() for name in LIMITS},
        "own_stops_m": [stop.ends for stop in found["stops"]],
        "ends_m": found["ends"],
    }


def _text(chosen: argparse.Namespace, found: dict[str, Any]) -> list[str]:
    """Return the lines that are printed."""
    train, consist, runs, few = (found[name] for name in ("train", "consist", "runs", "few"))
    lines = [
        f"{chosen.file}: {len(consist.vehicles)} vehicles, {1e-3 * consist.mass:.1f} t, {consist.length:.1f} m, "
        f"brake percentage {consist.percentage:.0f} %",
        ", ".join(f"{name} {float(getattr(train, name)):.2f} s" for name in ("T_brake_emergency", "T_brake_service")),
        *_lines_of_steps("A_brake_emergency", train.A_brake_emergency),
        *_lines_of_steps("A_brake_service", train.A_brake_service),
    ]
    if runs is not None:
        lines.append(f"Steps add {100 * runs.emergency.loss:.1f} % to the braking distance of the run.")
    if found["factors"] is not None:
        each = " ".join(f"{factor:.2f}" for factor in found["factors"])
        lines.append(f"Kdry_rst of levels 0 to 9, rounded down: {each}; in use: level {chosen.level}")
    names = [*LIMITS, *(["own stop"] if found["stops"] else [])]
    lines += [
        "",
        f"Distance before {_name_of_end(chosen, found)}, {found['ends']:g} m [m]",
        "V_est [km/h]" + "".join(f"{name:>10}" for name in names),
    ]
    for n, speed in enumerate(few.V_est):
        places = [float(getattr(few, name)[n]) for name in LIMITS]
        places += [found["stops"][n].ends] if found["stops"] else []
        lines.append(f"{3.6 * speed:12.1f}" + "".join(f"{found['ends'] - place:10.1f}" for place in places))
    return lines


def _name_of_end(chosen: argparse.Namespace, found: dict[str, Any]) -> str:
    return "the target" if found["ends"] == chosen.target else "the supervised location"


def _lines_of_steps(name: str, steps: Any) -> list[str]:
    ends, values = [*(3.6 * steps.boundaries).tolist(), float("inf")], steps.values.tolist()
    begins = [0.0, *ends]
    parts = [
        f"{value:.3f} " + (f"to {end:.0f} km/h" if end < 1e9 else "above")
        for begin, end, value in zip(begins, ends, values, strict=False)
        if end > begin
    ]
    return [f"{name} [m/s2]: " + ", ".join(parts)]
