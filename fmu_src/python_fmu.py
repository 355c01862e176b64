"""The pythonfmu FMU: the same kernel behind pythonfmu's slave interface, for hosts that have Python.

pythonfmu packs it; then its modelDescription.xml, which has no units and no initial unknowns, is replaced by ours, and
the archive is compressed with fixed dates.
"""

from __future__ import annotations

import importlib
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from pythonfmu.builder import FmuBuilder

from fmu_src.archive import write_archive
from fmu_src.codegen import generate, guid_of
from fmu_src.compile import library_of, library_suffix
from fmu_src.model_description import model_description
from fmu_src.pages import pages
from fmu_src.system import Model

HERE = Path(__file__).parent


def build_python_fmu(model: Model, path: Path) -> None:
    """Writes the pythonfmu FMU of a model. It needs Python on the host, but neither CasADi nor a compiler."""
    sources = generate(model)
    guid = guid_of(sources)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        # The module's name holds the content's GUID: two versions of an FMU may live in one process.
        script = folder / f"{model.name}_{guid[1:9]}.py"
        script.write_text(slave_module(model, guid))
        library = folder / f"kernel{library_suffix()}"
        shutil.copyfile(library_of(sources), library)
        contents = packed(script, [library])
    contents["modelDescription.xml"] = model_description(model, guid, native=False).encode()
    write_archive(path, contents | pages(model, "python"))


def packed(script: Path, files: Sequence[Path] = ()) -> dict[str, bytes]:
    """What pythonfmu packs around the module `script`, by place in the archive; no trace stays in this process."""
    folder = script.parent
    try:
        made = FmuBuilder.build_FMU(script, dest=folder / "out", project_files=list(files))
    finally:
        sys.path[:] = [entry for entry in sys.path if entry != str(folder)]
        sys.modules.pop(script.stem, None)
        importlib.invalidate_caches()
    with zipfile.ZipFile(made) as archive:
        return {entry: archive.read(entry) for entry in archive.namelist()}


def slave_module(model: Model, guid: str) -> str:
    """One self-contained module: kernel.py, python_slave.py and the class named like the model."""
    kernel, slave = (HERE / "kernel.py").read_text(), (HERE / "python_slave.py").read_text()
    future = "from __future__ import annotations\n"
    parts = [future]
    for text in (kernel, slave):
        parts.append(text.replace(future, ""))
    body = "\n".join(parts).replace("from fmu_src.kernel import DISCARD, Kernel, KernelError, Library\n", "")
    return (
        f"{body}\n\nclass {model.name}(KernelSlave):\n"
        f'    library_file = "kernel{library_suffix()}"\n    guid_of_content = "{guid}"\n'
    )
