"""Words of the command `etcs`: lines of text, and a document for programs."""

from __future__ import annotations

import argparse
from typing import Any

from bogie_braking.braking_curves.compute import Found
from bogie_braking.braking_curves.safety import document_of, lines_of
from products.supervision import Steps

#: Limits in the order in which they are met.
LIMITS = ("I", "P", "W", "SBI", "EBI", "EBD")


def document(found: Found) -> dict[str, Any]:
    """Return what --json prints."""
    data, few = found.data, found.few
    train = data.train
    return {
        "train": {
            "length_m": train.length,
            "A_brake_emergency": _steps(train.A_brake_emergency),
            "A_brake_service": _steps(train.A_brake_service),
            "T_brake_emergency_s": float(train.T_brake_emergency),
            "T_brake_service_s": float(train.T_brake_service),
            "brake_percentage": data.consist.percentage,
            "Kdry_rst": None if data.factors is None else data.factors.tolist(),
        },
        "safety": None if data.safety is None else document_of(data.safety),
        "V_est_kmh": (3.6 * few.V_est).tolist(),
        "limits_m": {name: getattr(few, name).tolist() for name in LIMITS},
        "own_stops_m": [stop.ends for stop in found.stops],
        "ends_m": found.ends,
    }


def text(chosen: argparse.Namespace, found: Found) -> list[str]:
    """Return the lines that are printed."""
    data, few = found.data, found.few
    train, consist, runs = data.train, data.consist, data.runs
    lines = [
        f"{chosen.file}: {len(consist.vehicles)} vehicles, {1e-3 * consist.mass:.1f} t, {consist.length:.1f} m, "
        f"brake percentage {consist.percentage:.0f} %",
        ", ".join(f"{name} {float(getattr(train, name)):.2f} s" for name in ("T_brake_emergency", "T_brake_service")),
        *_lines_of_steps("A_brake_emergency", train.A_brake_emergency),
        *_lines_of_steps("A_brake_service", train.A_brake_service),
    ]
    if runs is not None:
        lines.append(f"Steps add {100 * runs.emergency.loss:.1f} % to the braking distance of the run.")
    if data.factors is not None:
        each = " ".join(f"{factor:.2f}" for factor in data.factors)
        lines.append(f"Kdry_rst of levels 0 to 9, rounded down: {each}; in use: level {chosen.level}")
    if data.safety is not None:
        lines += lines_of(data.safety)
    names = [*LIMITS, *(["own stop"] if found.stops else [])]
    lines += [
        "",
        f"Distance before {_name_of_end(chosen, found)}, {found.ends:g} m [m]",
        "V_est [km/h]" + "".join(f"{name:>10}" for name in names),
    ]
    for n, speed in enumerate(few.V_est):
        places = [float(getattr(few, name)[n]) for name in LIMITS]
        places += [found.stops[n].ends] if found.stops else []
        lines.append(f"{3.6 * speed:12.1f}" + "".join(f"{found.ends - place:10.1f}" for place in places))
    return lines


def _name_of_end(chosen: argparse.Namespace, found: Found) -> str:
    return "the target" if found.ends == chosen.target else "the supervised location"


def _lines_of_steps(name: str, steps: Steps) -> list[str]:
    ends, values = [*(3.6 * steps.boundaries).tolist(), float("inf")], steps.values.tolist()
    begins = [0.0, *ends]
    parts = [
        f"{value:.3f} " + (f"to {end:.0f} km/h" if end < 1e9 else "above")
        for begin, end, value in zip(begins, ends, values, strict=False)
        if end > begin
    ]
    return [f"{name} [m/s2]: " + ", ".join(parts)]


def _steps(steps: Steps) -> dict[str, list[float]]:
    return {
        "boundaries_kmh": [round(3.6 * one, 3) for one in steps.boundaries.tolist()],
        "m_s2": [round(one, 4) for one in steps.values.tolist()],
    }
