"""Files of the command `etcs`: picture, table, train data, causes, page."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from bogie_braking.braking_curves.compute import CurveResults
from bogie_braking.braking_curves.pictures import figure_of_causes, figure_of_supervision
from bogie_braking.reporting.plots import saved
from products.etcs_files.osrd import osrd_document
from products.etcs_files.train_file import write_train
from readers.command_line import check_folder
from readers.documents import document_text
from readers.extras import need
from readers.storage import write_whole, writing
from readers.text import BadInputError


def check_files(chosen: argparse.Namespace) -> None:
    """Refuse files that cannot be written, before the work for them starts."""
    check_folder(chosen.out)
    if chosen.page is not None:
        need("plotly")
    for option, end in (("page", ".html"), ("osrd", ".json")):
        path: Path | None = getattr(chosen, option)
        if path is None:
            continue
        if path.suffix.lower() != end:
            raise BadInputError(f"--{option} must end in {end}; got {path}. Rename it.")
        if path.resolve() == chosen.file.resolve():
            raise BadInputError(f"--{option} must be another file than FILE; got {path} twice. Name another.")
        check_folder(path.parent, f"--{option}")


def write(found: CurveResults) -> dict[str, Path]:
    """Write all files; return their paths by the names of their contents."""
    chosen, data = found.chosen, found.data
    for folder in (chosen.out, *(path.parent for path in (chosen.page, chosen.osrd) if path is not None)):
        with writing(folder):
            folder.mkdir(parents=True, exist_ok=True)
    # Results of train data, etcs-x.json, do not replace the train's own.
    stem = chosen.file.stem
    name = f"{stem}-again" if stem.startswith("etcs-") else f"etcs-{stem}"
    ends = {"picture": ".png", "table": ".csv", "causes": "-causes.png", "train_data": ".json"}
    paths = {content: chosen.out / f"{name}{end}" for content, end in ends.items()}
    pictures = saved(partial(figure_of_supervision, found), paths["picture"], dpi=130)
    write_whole(paths["table"], _table(found).encode(), "name another folder with --out")
    if data.safety is not None:
        pictures += saved(partial(figure_of_causes, data.safety), paths["causes"], dpi=130)
    paths = {content: path for content, path in paths.items() if path.suffix != ".png" or path in pictures}
    write_train(paths["train_data"], data.train, data.dry_by_level, chosen.file.name)
    if chosen.osrd is not None:
        write_whole(chosen.osrd, document_text(osrd_document(data.train)).encode())
        paths["osrd"] = chosen.osrd
    if chosen.page is not None:
        from bogie_braking.braking_curves.page import write_page  # with Plotly, an optional dependency

        write_page(found)
        paths["page"] = chosen.page
    return paths


def _table(found: CurveResults) -> str:
    """Return speeds and places of all limits as CSV."""
    many = found.many
    rows = zip(3.6 * many.V_est, *(getattr(many, name) for name in found.limits), strict=True)
    lines = [",".join(["V_est [km/h]", *(f"{name} [m]" for name in found.limits)])]
    lines += [",".join(f"{value:.3f}" for value in row) for row in rows]
    return "\n".join(lines) + "\n"
