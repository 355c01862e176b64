"""The native FMU: the compiled kernel with its FMI 2.0 face, no Python inside."""

from __future__ import annotations

from pathlib import Path

import fmpy

from fmu_src.archive import write_archive
from fmu_src.codegen import generate, guid_of
from fmu_src.compile import library_of, library_suffix
from fmu_src.model_description import model_description
from fmu_src.system import Model


def build_native_fmu(model: Model, path: Path) -> None:
    """Writes the native FMU of a model for the platform it is built on."""
    sources = generate(model)
    write_archive(
        path,
        {
            "modelDescription.xml": model_description(model, guid_of(sources)).encode(),
            f"binaries/{fmpy.platform}/{model.name}{library_suffix()}": library_of(sources).read_bytes(),
        },
    )
