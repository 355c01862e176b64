"""Words of the command `etcs`: lines of text, and a document for programs."""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

from bogie_braking.braking_curves.compute import Found
from bogie_braking.braking_curves.safety import document_of, lines_of
from products.supervision import Steps

#: Limits in the order in which they are met.
LIMITS = ("I", "P", "W", "SBI", "EBI", "EBD")
#: Limits of some targets and countries alone.
OTHERS = ("GUI", "SBI1", "SBI2", "SBD")
TIMES = ("T_brake_emergency", "T_brake_service")


def document(chosen: argparse.Namespace, found: Found) -> dict[str, Any]:
    """Return what --json prints."""
    data, few = found.data, found.few
    train = data.train
    return {
        "train": {
            "length_m": float(np.asarray(train.length)),
            "A_brake_emergency": _steps(train.A_brake_emergency),
            "A_brake_service": _steps(train.A_brake_service),
            "T_brake_emergency_s": float(train.T_brake_emergency),
            "T_brake_service_s": float(train.T_brake_service),
            "brake_percentage": None if data.consist is None else data.consist.percentage,
            "Kdry_rst": None if data.factors is None else data.factors.tolist(),
        },
        "safety": None if data.safety is None else document_of(data.safety),
        "target": {"kind": found.kind, "place_m": chosen.target, "speed_kmh": chosen.target_speed},
        "baseline": chosen.baseline,
        "M_NVEBCL": found.country.M_NVEBCL,
        "rounding": {move.name: {"most": move.most, "unit": move.unit} for move in found.moves},
        "V_est_kmh": (3.6 * few.V_est).tolist(),
        "limits_m": {name: getattr(few, name).tolist() for name in limits_of(found)},
        "own_stops_m": [stop.ends for stop in found.stops],
        "ends_m": found.ends,
        "release_speed_kmh": None if found.release_speed is None else round(3.6 * found.release_speed),
    }


def limits_of(found: Found) -> list[str]:
    """Return the names of the limits that the target has."""
    return [*LIMITS, *(name for name in OTHERS if getattr(found.few, name) is not None)]


def text(chosen: argparse.Namespace, found: Found) -> list[str]:
    """Return the lines that are printed."""
    few = found.few
    names = [*LIMITS, *(["GUI"] if few.GUI is not None else []), *(["own stop"] if found.stops else [])]
    lines = [
        *_lines_of_train(chosen, found),
        "",
        f"Distance before {name_of_end(chosen, found)}, {found.ends:g} m [m]",
        "V_est [km/h]" + "".join(f"{name:>10}" for name in names),
    ]
    for n, speed in enumerate(few.V_est):
        places = [found.stops[n].ends if name == "own stop" else float(getattr(few, name)[n]) for name in names]
        lines.append(f"{3.6 * speed:12.1f}" + "".join(f"{found.ends - place:10.1f}" for place in places))
    if found.release_speed is not None:
        lines += ["", f"Release speed {3.6 * found.release_speed:.0f} km/h"]
    return lines


def _lines_of_train(chosen: argparse.Namespace, found: Found) -> list[str]:
    data = found.data
    train, runs = data.train, data.runs
    lines = [
        f"{chosen.file}: {train_words(found)}",
        ", ".join(f"{name} {float(getattr(train, name)):.2f} s" for name in TIMES),
        *_lines_of_steps("A_brake_emergency", train.A_brake_emergency),
        *_lines_of_steps("A_brake_service", train.A_brake_service),
    ]
    if runs is not None:
        lines.append(f"Steps add {100 * runs.emergency.loss:.1f} % to the braking distance of the run.")
    if data.factors is not None:
        each = " ".join(f"{factor:.2f}" for factor in data.factors)
        lines.append(f"Kdry_rst of levels 0 to 9, rounded down: {each}; in use: level {found.country.M_NVEBCL}")
    if data.safety is not None:
        lines += lines_of(data.safety)
        if not data.dry_by_level:
            lines.append("Train data have Kdry_rst of this level alone: T_brake_emergency depends on the level.")
    if found.moves:
        moved = ", ".join(f"{move.name} by {move.most:.2g} {move.unit}".replace(" 1,", ",") for move in found.moves)
        lines.append(f"Rounded to the safe side, at most: {moved.removesuffix(' 1')}")
    return lines


def train_words(found: Found) -> str:
    """Return the train in words: vehicles, mass, length, brake percentage, or the source of its data."""
    consist, train = found.data.consist, found.data.train
    if consist is None:
        kind = f"brake percentage {float(train.percentage):.0f} %" if train.percentage is not None else "decelerations"
        return f"{found.data.source}, {float(np.asarray(train.length)):.1f} m, {kind}"
    words = (
        f"{len(consist.vehicles)} vehicles, {1e-3 * consist.mass:.1f} t, {consist.length:.1f} m, "
        f"brake percentage {consist.percentage:.0f} %"
    )
    if train.percentage is not None and float(train.percentage) < consist.percentage:
        return f"{words}; train data have at most {float(train.percentage):.0f} %"
    return words


def name_of_end(chosen: argparse.Namespace, found: Found) -> str:
    """Return the name of the place that no train may pass."""
    return "the target" if found.ends == chosen.target else "the supervised location"


def _lines_of_steps(name: str, steps: Steps) -> list[str]:
    return [f"{name} [m/s2]: {steps_words(steps)}"]


def steps_words(steps: Steps, unit: str = "km/h", scale: float = 3.6) -> str:
    """Return the steps of a function in words; scale: from the boundaries to their unit."""
    changes = np.diff(steps.values) != 0.0
    if not changes.any():
        return f"{steps.values[0]:.3f}"
    ends = [*(scale * steps.boundaries[changes]).tolist(), float("inf")]
    values = steps.values[np.append(changes, True)].tolist()
    begins = [0.0, *ends]
    parts = [
        f"{value:.3f} " + (f"to {end:.0f} {unit}" if end < 1e9 else "above")
        for begin, end, value in zip(begins, ends, values, strict=False)
        if end > begin
    ]
    return ", ".join(parts)


def _steps(steps: Steps) -> dict[str, list[float]]:
    return {
        "boundaries_kmh": [round(3.6 * one, 3) for one in steps.boundaries.tolist()],
        "m_s2": [round(one, 4) for one in steps.values.tolist()],
    }
