"""FMUs of pythonfmu, for hosts with Python: the same kernel with its slave interface, or any object with a `step`.

pythonfmu packs it. Then its modelDescription.xml, which lacks units and initial unknowns, is replaced by ours, and the
archive is compressed with fixed dates.
"""

from __future__ import annotations

import importlib
import re
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from fmu_src.archive import write_archive
from fmu_src.codegen import generate, guid_of
from fmu_src.compile import library_of, library_suffix
from fmu_src.identity import identifier
from fmu_src.model_description import model_description
from fmu_src.objects import PYTHON
from fmu_src.pages import pages
from fmu_src.step_model import StepInPython
from fmu_src.system import Model
from readers.extras import OptionalModule

builder = OptionalModule("pythonfmu.builder")

FUTURE = "from __future__ import annotations\n"
HERE = Path(__file__).parent


def build_python_fmu(model: Model, path: Path) -> None:
    """Write the pythonfmu FMU of a model. The host needs Python, but neither CasADi nor a compiler."""
    sources = generate(model)
    guid = guid_of(sources)
    contents = _packed(model, guid, slave_module(model, guid), library_of(sources))
    write_archive(path, contents | pages(model, "python"))


def build_step_fmu(step: StepInPython, path: Path) -> None:
    """Write the FMU around a Python object with `step(time, inputs) -> outputs`, for hosts with Python.

    Raises the errors of the sources when they are loaded.
    """
    slave = [(HERE / f"{name}.py").read_text(encoding="utf-8") for name in ("telling_slave", "step_slave")]
    body = joined([*step.sources, *slave], [*step.own, f"{__package__}.telling_slave"])
    guid = identifier([body, repr(step)])
    write_archive(path, _packed(step.model, guid, body + _step_class(step, guid)))


def _packed(model: Model, guid: str, text: str, library: Path | None = None) -> dict[str, bytes]:
    """Return the files of pythonfmu around the module with this text, with our description, by place in the archive.

    This process is unchanged.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        # The module's name holds the content's GUID: two versions of an FMU may live in one process.
        script = folder / f"{model.name}_{guid[1:9]}.py"
        script.write_text(text, encoding="utf-8")
        files = [Path(shutil.copyfile(library, folder / f"kernel{library_suffix()}"))] if library else []
        try:
            made = builder.FmuBuilder.build_FMU(script, dest=folder / "out", project_files=files)
        finally:
            sys.path[:] = [entry for entry in sys.path if entry != str(folder)]
            sys.modules.pop(script.stem, None)
            importlib.invalidate_caches()
        with zipfile.ZipFile(made) as archive:
            contents = {entry: archive.read(entry) for entry in archive.namelist()}
    return contents | {"modelDescription.xml": model_description(model, guid, PYTHON).encode()}


def joined(sources: Sequence[str], own: Sequence[str]) -> str:
    """Return one module from several, without the imports that they make from each other."""
    text = "\n".join(source.replace(FUTURE, "") for source in sources)
    for module in own:
        text = re.sub(rf"^from {re.escape(module)} import (\([^)]*\)|[^\n]*)\n", "", text, flags=re.M)
    return FUTURE + text


def slave_module(model: Model, guid: str) -> str:
    """Return one self-contained module: the parts of python_slave.py, and the class named like the model."""
    files = [HERE / f"{name}.py" for name in ("kernel", "telling_slave", "python_slave")]
    own = [f"{__package__}.{name}" for name in ("kernel", "telling_slave")]
    body = joined([file.read_text(encoding="utf-8") for file in files], own)
    own_files = {file.variable.name: file.resource for file in (model.table_file, model.record_file) if file}
    return (
        f"{body}\n\nclass {model.name}(KernelSlave):\n"
        f'    library_file = "kernel{library_suffix()}"\n    guid_of_content = "{guid}"\n'
        f"    own_files = {own_files!r}\n"
    )


def _step_class(step: StepInPython, guid: str) -> str:
    """Return the text of the class that pythonfmu instantiates, named after the FMU."""
    return (
        f"\n\nclass {step.name}(StepSlave):\n"
        f'    guid_of_content = "{guid}"\n'
        f"    input_count = {len(step.inputs)}\n"
        f"    safe = {list(step.safe)!r}\n"
        f"    first_period = {step.period!r}\n\n"
        f"    def make(self):\n        return {step.expression}\n"
    )
