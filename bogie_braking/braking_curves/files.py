"""Files of the command `etcs`: picture, table, train data, causes, page."""

from __future__ import annotations

import argparse
from pathlib import Path

from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from bogie_braking.braking_curves.compute import Found
from bogie_braking.braking_curves.words import limits_of
from bogie_braking.common_options import look_for_plotly
from bogie_braking.reporting.causes_picture import figure_of_causes
from bogie_braking.reporting.supervision_picture import figure_of_supervision
from products.etcs_files.osrd import osrd_document
from products.etcs_files.train_file import write_train
from readers.command_line import check_folder
from readers.documents import document_text
from readers.storage import write_whole, writing
from readers.text import BadInputError


def check_files(chosen: argparse.Namespace) -> None:
    """Refuse files that cannot be written, before the work for them starts."""
    check_folder(chosen.out)
    if chosen.page is not None:
        look_for_plotly()
    for option, end in (("page", ".html"), ("osrd", ".json")):
        path: Path | None = getattr(chosen, option)
        if path is None:
            continue
        if path.suffix.lower() != end:
            raise BadInputError(f"--{option} must end in {end}; got {path}. Rename it.")
        if path.resolve() == chosen.file.resolve():
            raise BadInputError(f"--{option} must be another file than FILE; got {path} twice. Name another.")
        check_folder(path.parent, f"--{option}")


def write(chosen: argparse.Namespace, found: Found) -> dict[str, Path]:
    """Write all files; return their paths by the names of their contents."""
    for folder in (chosen.out, *(path.parent for path in (chosen.page, chosen.osrd) if path is not None)):
        with writing(folder):
            folder.mkdir(parents=True, exist_ok=True)
    paths = {"picture": _picture(chosen, found), "table": _table(chosen, found)}
    if found.data.safety is not None:
        paths["causes"] = _causes(chosen, found)
    paths["train_data"] = _path(chosen, ".json")
    write_train(paths["train_data"], found.data.train, found.data.dry_by_level, chosen.file.name)
    if chosen.osrd is not None:
        write_whole(chosen.osrd, document_text(osrd_document(found.data.train)).encode())
        paths["osrd"] = chosen.osrd
    if chosen.page is not None:
        from bogie_braking.braking_curves.page import write_page  # with Plotly, an optional dependency

        write_page(chosen, found)
        paths["page"] = chosen.page
    return paths


def _path(chosen: argparse.Namespace, end: str) -> Path:
    """Return the path of a file by its ending; results of train data, etcs-x.json, do not replace the train's own."""
    out, stem = chosen.out, chosen.file.stem
    name = f"{stem}-again" if stem.startswith("etcs-") else f"etcs-{stem}"
    found: Path = out / f"{name}{end}"
    return found


def _picture(chosen: argparse.Namespace, found: Found) -> Path:
    stops = [(stop.places, stop.speeds) for stop in found.stops]
    figure = figure_of_supervision(found.many, found.ends, found.gradients, stops)
    return _saved(figure, _path(chosen, ".png"))


def _saved(figure: Figure, path: Path) -> Path:
    with writing(path.parent):
        figure.savefig(path, dpi=130)
    plt.close(figure)
    return path


def _table(chosen: argparse.Namespace, found: Found) -> Path:
    names, many = limits_of(found), found.many
    head = ",".join(["V_est [km/h]", *(f"{name} [m]" for name in names)])
    rows = zip(3.6 * many.V_est, *(getattr(many, name) for name in names), strict=True)
    lines = [head, *(",".join(f"{value:.3f}" for value in row) for row in rows)]
    path = _path(chosen, ".csv")
    write_whole(path, ("\n".join(lines) + "\n").encode(), "name another folder with --out")
    return path


def _causes(chosen: argparse.Namespace, found: Found) -> Path:
    """Write the figure of the causes that lower Kdry_rst."""
    safety = found.data.safety
    assert safety is not None
    figure = figure_of_causes(safety.causes, float(safety.factors[safety.level]), safety.level)
    return _saved(figure, _path(chosen, "-causes.png"))
