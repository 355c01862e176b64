"""Page of the command `etcs`: its tables, from the results."""

from __future__ import annotations

import argparse

import numpy as np

from bogie_braking.braking_curves.compute import Found
from bogie_braking.braking_curves.safety import lines_of
from bogie_braking.braking_curves.words import (
    TIMES,
    limits_of,
    lines_of_target,
    name_of_end,
    shift_words,
    steps_words,
    train_words,
)
from bogie_braking.reporting.supervision_page import Table, page_of_supervision
from products.etcs_files.train_file import SWITCHES
from products.supervision import Steps
from readers.storage import write_whole


def write_page(chosen: argparse.Namespace, found: Found) -> None:
    """Write the page to --page. Raises StorageError."""
    stops = [(stop.places, stop.speeds) for stop in found.stops]
    tables = [_distances(chosen, found), _train(found), _factors(found), _settings(chosen, found)]
    if found.moves:
        rows = [(move.name, f"{move.most:.3g}", "" if move.unit == "1" else move.unit) for move in found.moves]
        tables.append(Table("Rounded to the safe side, at most by", ("variable", "by", "unit"), rows))
    title = f"Braking curves of ETCS: {chosen.file.name}"
    text = page_of_supervision(title, found.many, found.ends, found.gradients, stops, tables)
    write_whole(chosen.page, text.encode(), "name another file with --page")


def _distances(chosen: argparse.Namespace, found: Found) -> Table:
    """Return the distances before the place that no train may pass, the fastest row last."""
    few, names = found.few, limits_of(found)
    rows = []
    for n, speed in enumerate(few.V_est):
        places = [float(getattr(few, name)[n]) for name in names] + [stop.ends for stop in found.stops[n : n + 1]]
        rows.append((f"{3.6 * speed:.1f}", *(f"{found.ends - place:.1f}" for place in places)))
    heads = ("V_est [km/h]", *names, *(["own stop"] if found.stops else []))
    return Table(f"Distance before {name_of_end(chosen, found)}, {found.ends:g} m [m]", heads, rows)


def _train(found: Found) -> Table:
    """Return the train data."""
    train = found.data.train
    rows = [("train", train_words(found)), ("L_TRAIN", f"{float(np.asarray(train.length)):.2f} m")]
    rows += [(name, f"{float(np.asarray(getattr(train, name))):.3f} s") for name in (*TIMES, "T_traction_cut_off")]
    for name in ("A_brake_emergency", "A_brake_service", "A_brake_normal_service"):
        steps: Steps | None = getattr(train, name)
        if steps is not None:
            rows.append((f"{name} [m/s2]", steps_words(steps)))
    known = "unknown: 15 % uphill, 2 % downhill"
    rows.append(("M_rotating_nom", known if train.rotating is None else f"{float(np.asarray(train.rotating)):g} %"))
    rows += [(name, "yes" if getattr(train, of) else "no") for name, of in SWITCHES.items()]
    if found.data.runs is not None:
        rows.append(("steps add to the braking distance", f"{100 * found.data.runs.emergency.loss:.2f} %"))
    return Table("Train data", (), rows, numbers=False)


def _factors(found: Found) -> Table:
    """Return the factors in use and of all levels, and what decides them."""
    data, train = found.data, found.data.train
    if train.position is not None:
        rows = [("Kdry_rst, Kwet_rst", "none: the country corrects brake percentages by Kv_int, Kr_int and Kt_int")]
        return Table("Factors", (), rows, numbers=False)
    rows = [("Kdry_rst in use", steps_words(train.Kdry_rst)), ("Kwet_rst", steps_words(train.Kwet_rst))]
    rows += [(f"Kdry_rst of level {n}", steps_words(one)) for n, one in enumerate(data.dry_by_level)]
    if data.safety is not None:
        rows += [("", line.strip()) for line in lines_of(data.safety) if line]
    return Table("Factors", (), rows, numbers=False)


def _settings(chosen: argparse.Namespace, found: Found) -> Table:
    """Return the target, the baseline and the national values."""
    country = found.country
    yes = {True: "yes", False: "no"}
    adhesion = ", ".join(f"{one:g}" for one in country.reduced_adhesion)
    rows = [
        ("target", f"{found.kind} at {chosen.target:g} m, {chosen.target_speed:g} km/h"),
        ("supervised location", f"{chosen.beyond:g} m behind the target"),
        *([] if found.release_speed is None else [("release speed", f"{3.6 * found.release_speed:.0f} km/h")]),
        ("line", "level" if chosen.line is None else chosen.line.name),
        ("reduced adhesion", yes[chosen.slippery]),
        ("baseline", chosen.baseline),
        ("national values", "SUBSET-026, A.3.2" if chosen.national is None else chosen.national.name),
        ("M_NVEBCL", f"{country.M_NVEBCL}"),
        ("M_NVAVADH", f"{country.M_NVAVADH:g}"),
        ("Kv_int", steps_words(country.Kv_int)),
        *([] if country.Kv_int_b is None else [("Kv_int of set b", steps_words(country.Kv_int_b))]),
        ("A_NVP12, A_NVP23", f"{country.A_NVP12:g}, {country.A_NVP23:g} m/s2"),
        ("Kr_int", steps_words(country.Kr_int, "m", 1.0)),
        ("Kt_int", f"{country.Kt_int:g}"),
        ("A_NVMAXREDADH1 to 3", f"{adhesion} m/s2"),
        ("Q_NVGUIPERM, Q_NVINHSMICPERM", f"{yes[country.guidance]}, {yes[country.exact_speed]}"),
        ("Q_NVSBFBPERM", yes[country.feedback]),
    ]
    rows += [("note", line) for line in lines_of_target(chosen, found)]
    rows += [("rounding", shift_words(found))] if found.shifts else []
    return Table("Settings", (), rows, numbers=False)
