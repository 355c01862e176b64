"""Words of the command `etcs`: lines of text, and a document for programs."""

from __future__ import annotations

from typing import Any

import numpy as np

from bogie_braking.braking_curves.compute import LIMITS, CurveResults
from bogie_braking.braking_curves.pictures import message_of_stops
from bogie_braking.braking_curves.safety import document_of, lines_of
from products.supervision import Steps

#: Speed above that of the train up to which a step acts on its limits [m/s]: error of the speed, and acceleration.
REACH = 20.0 / 3.6
TIMES = ("T_brake_emergency", "T_brake_service")


def document(found: CurveResults) -> dict[str, Any]:
    """Return what --json prints."""
    chosen, data, few, train = found.chosen, found.data, found.few, found.data.train
    by_decelerations = train.position is None
    return {
        "train": {
            "length_m": float(np.asarray(train.length)),
            "A_brake_emergency": _steps(train.A_brake_emergency),
            "A_brake_service": _steps(train.A_brake_service),
            "T_brake_emergency_s": float(train.T_brake_emergency),
            "T_brake_service_s": float(train.T_brake_service),
            "brake_percentage": None if data.consist is None else data.consist.percentage,
            "M_BRAKE_PERCENTAGE": None if train.percentage is None else float(np.asarray(train.percentage)),
            "Kdry_rst": _levels_of(found),
            "Kdry_rst_in_use": _steps(train.Kdry_rst, "values") if by_decelerations else None,
            "Kwet_rst_in_use": _steps(train.Kwet_rst, "values") if by_decelerations else None,
            "level": train.level,
        },
        "safety": None if data.safety is None else document_of(data.safety),
        "target": {"kind": found.kind, "place_m": chosen.target, "speed_kmh": chosen.target_speed},
        "baseline": chosen.baseline,
        "M_NVEBCL": found.country.M_NVEBCL,
        "without_effect": found.without_effect,
        "rounding": {move.name: {"most": move.most, "unit": move.unit} for move in found.moves},
        "rounded_limits_m": {
            shift.name: {"nearer_to_target": shift.nearer, "further_from_target": shift.further}
            for shift in found.shifts
        },
        "V_est_kmh": (3.6 * few.V_est).tolist(),
        "limits_m": {name: getattr(few, name).tolist() for name in found.limits},
        "own_stops_m": [stop.ends for stop in found.stops],
        "ends_m": found.ends,
        "line_m": None if found.covered is None else list(found.covered),
        "release_speed_kmh": None if found.release_speed is None else round(3.6 * found.release_speed),
    }


def _steps(steps: Steps, name: str = "m_s2") -> dict[str, list[float]]:
    return {
        "boundaries_kmh": [round(3.6 * speed, 3) for speed in steps.boundaries.tolist()],
        name: [round(value, 4) for value in steps.values.tolist()],
    }


def text(found: CurveResults) -> list[str]:
    """Return the lines that are printed."""
    limits = [*LIMITS, *(["GUI"] if found.few.GUI is not None else [])]
    heads = [*limits, *(["own stop"] if found.stops else [])]
    lines = [
        *_lines_of_train(found),
        *lines_of_target(found),
        "",
        title_of_distances(found),
        "V_est [km/h]" + "".join(f"{head:>10}" for head in heads),
    ]
    for speed, *before in found.distances(limits):
        lines.append(f"{speed:12.1f}" + "".join(f"{distance:10.1f}" for distance in before))
    if found.stops:
        lines += ["", f"{message_of_stops(found)}."]
    if found.release_speed is not None:
        lines += ["", f"Release speed {3.6 * found.release_speed:.0f} km/h"]
    return lines


def title_of_distances(found: CurveResults) -> str:
    """Return the title of the table of distances before the place that no train may pass."""
    end = "the supervised location" if found.chosen.beyond else "the target"
    return f"Distance before {end}, {found.ends:g} m [m]"


def _lines_of_train(found: CurveResults) -> list[str]:
    data, train = found.data, found.data.train
    lines = [
        f"{found.chosen.file}: {train_words(found)}",
        ", ".join(f"{name} {float(getattr(train, name)):.2f} s" for name in TIMES),
        f"A_brake_emergency [m/s2]: {steps_words(train.A_brake_emergency)}",
        f"A_brake_service [m/s2]: {steps_words(train.A_brake_service)}",
    ]
    if data.runs is not None:
        lines.append(f"Steps add {100 * data.runs.emergency.loss:.1f} % to the braking distance of the run.")
    if train.position is None:
        lines += _lines_of_factors(found)
    if data.safety is not None:
        lines += lines_of(data.safety)
        if not data.dry_by_level:
            lines.append("Train data have Kdry_rst of this level alone: T_brake_emergency depends on the level.")
    if found.moves:
        moved = ", ".join(f"{move.name} by {move.most:.2g} {move.unit}".removesuffix(" 1") for move in found.moves)
        lines.append(f"Rounded to the safe side, at most: {moved}. Between whole km/h the lower step counts.")
    if found.shifts:
        lines.append(shift_words(found))
    return lines


def shift_words(found: CurveResults) -> str:
    """Return how far rounding moved the limits: away from the target is the safe side."""
    further = max(shift.further for shift in found.shifts)
    words = f"By rounding, limits lie up to {further:.1f} m further from the target, the safe side"
    near = ", ".join(
        f"{shift.name} up to {shift.nearer:.2g} m (to {3.6 * shift.below:.0f} km/h)"
        for shift in found.shifts
        if shift.nearer
    )
    if not near:
        return f"{words}. None lies nearer to it."
    return f"{words}. On the unsafe side, nearer to it: {near}. Their curves continue behind a moving target."


def _levels_of(found: CurveResults) -> list[float] | None:
    """Return Kdry_rst of the levels 0 to 9, if they are known and the same at each speed."""
    data = found.data
    if data.factors is not None:
        levels: list[float] = data.factors.tolist()
        return levels
    if not data.dry_by_level or any(np.ptp(steps.values) for steps in data.dry_by_level):
        return None
    return [float(steps.values[0]) for steps in data.dry_by_level]


def _lines_of_factors(found: CurveResults) -> list[str]:
    """Return the factors of all levels and those in use; none if all are 1."""
    train, levels, lines = found.data.train, _levels_of(found), []
    if levels is not None:
        kind = ", rounded down" if found.data.factors is not None else ""
        each = " ".join(f"{factor:.2f}" for factor in levels)
        lines.append(f"Kdry_rst of levels 0 to 9{kind}: {each}; in use: level {train.level}")
    elif train.level is not None or np.any(train.Kdry_rst.values != 1.0):
        of = "" if train.level is None else f" of level {train.level}"
        lines.append(f"Kdry_rst in use{of}: {steps_words(train.Kdry_rst)}")
    if np.any(train.Kwet_rst.values != 1.0):
        lines.append(f"Kwet_rst in use: {steps_words(train.Kwet_rst)}")
    return lines


def lines_of_target(found: CurveResults) -> list[str]:
    """Return what the target, the line and the country leave out."""
    lines = []
    if found.kind != "EOA":
        kind = {"LOA": "a limit of authority", "MRSP": "a lower permitted speed"}[found.kind]
        of = f"{found.chosen.target_speed:g} km/h ({found.kind})"
        lines.append(f"The target is {kind} of {of}; own stops need an end of authority.")
    if found.without_effect:
        lines.append(f"Without effect on this train: {', '.join(found.without_effect)}.")
    lines += _boundaries_beyond(found)
    if found.least_friction < 1.0:
        lines.append(
            f"Friction of the line, down to a factor of {found.least_friction:g}, acts on own stops; limits have none."
        )
    if found.covered is not None:
        first, last = found.covered
        begin = float(np.min(found.many.I))
        if first > begin or last < found.ends:
            lines.append(
                f"The line has rows from {first:g} to {last:g} m; the limits need it from {begin:.0f} to "
                f"{found.ends:g} m. Its first and last gradients hold before and behind it."
            )
    return lines


def _boundaries_beyond(found: CurveResults) -> list[str]:
    """Return the step functions of train data whose boundaries are all above the speeds of the limits, as in km/h."""
    train, fastest, beyond = found.data.train, float(found.many.V_est.max()), []
    for name in ("A_brake_emergency", "A_brake_service", "Kdry_rst", "Kwet_rst"):
        first = float(getattr(train, name).boundaries.min(initial=np.inf))
        if train.position is None and fastest + REACH < first < np.inf:
            beyond.append(f"{name} from {3.6 * first:.0f} km/h")
    return [f"Steps begin above all speeds here, {3.6 * fastest:.0f} km/h: {', '.join(beyond)}."] if beyond else []


def train_words(found: CurveResults) -> str:
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


def steps_words(steps: Steps, unit: str = "km/h", scale: float = 3.6) -> str:
    """Return the steps of a function in words; scale: from the boundaries to their unit."""
    changes = np.diff(steps.values) != 0.0
    if not changes.any():
        return f"{steps.values[0]:.3f}"
    ends = (scale * steps.boundaries[changes]).tolist()
    values = steps.values[np.append(changes, True)].tolist()
    wide = np.diff(ends, prepend=0.0) > 0.0
    parts = [
        f"{value:.3f} to {end:.0f} {unit}" for value, end, is_wide in zip(values, ends, wide, strict=False) if is_wide
    ]
    return ", ".join([*parts, f"{values[-1]:.3f} above"])
