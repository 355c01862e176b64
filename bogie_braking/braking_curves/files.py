"""Files of the command `etcs`: picture and table."""

from __future__ import annotations

import argparse
from pathlib import Path

from bogie_braking.braking_curves.compute import Found
from bogie_braking.braking_curves.words import LIMITS
from readers.storage import write_whole, writing
from scenarios.reporting.causes_picture import figure_of_causes
from scenarios.reporting.supervision_picture import figure_of_supervision


def write(chosen: argparse.Namespace, found: Found) -> tuple[Path, Path]:
    """Write picture and table; return their paths."""
    picture, table = (chosen.out / f"etcs-{chosen.file.stem}{end}" for end in (".png", ".csv"))
    many = found.many
    stops = [(stop.places, stop.speeds) for stop in found.stops]
    figure = figure_of_supervision(many, found.ends, found.gradients, stops)
    with writing(chosen.out):
        chosen.out.mkdir(parents=True, exist_ok=True)
        figure.savefig(picture, dpi=130)
    head = ",".join(["V_est [km/h]", *(f"{name} [m]" for name in LIMITS)])
    rows = zip(3.6 * many.V_est, *(getattr(many, name) for name in LIMITS), strict=True)
    lines = [head, *(",".join(f"{value:.3f}" for value in row) for row in rows)]
    write_whole(table, ("\n".join(lines) + "\n").encode(), "name another folder with --out")
    return picture, table


def write_causes(chosen: argparse.Namespace, found: Found) -> Path | None:
    """Write the figure of the causes that lower Kdry_rst; return its path, or None without tolerances."""
    safety = found.data.safety
    if safety is None:
        return None
    picture = chosen.out / f"etcs-{chosen.file.stem}-causes.png"
    figure = figure_of_causes(safety.causes, float(safety.factors[safety.level]), safety.level)
    with writing(chosen.out):
        chosen.out.mkdir(parents=True, exist_ok=True)
        figure.savefig(picture, dpi=130)
    return picture
