"""An FMU around any Python object with `step(time, inputs) -> outputs`, for hosts that have Python."""

from __future__ import annotations

import tempfile
from pathlib import Path

from fmu_src.archive import write_archive
from fmu_src.identity import identifier
from fmu_src.model_description import model_description
from fmu_src.objects import PYTHON
from fmu_src.python_fmu import joined, packed
from fmu_src.step_model import StepInPython

SLAVE = [Path(__file__).parent / name for name in ("telling_slave.py", "step_slave.py")]


def build_step_fmu(step: StepInPython, path: Path) -> None:
    """Write the pythonfmu FMU. Raises the errors of the sources when they are loaded."""
    slave = [file.read_text(encoding="utf-8") for file in SLAVE]
    body = joined([*step.sources, *slave], [*step.own, f"{__package__}.telling_slave"])
    guid = identifier([body, repr(step)])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        # The module's name holds the content's GUID: two versions of an FMU may live in one process.
        script = folder / f"{step.name}_{guid[1:9]}.py"
        script.write_text(body + slave_class(step, guid), encoding="utf-8")
        contents = packed(script)
    contents["modelDescription.xml"] = model_description(step.model, guid, PYTHON).encode()
    write_archive(path, contents)


def slave_class(step: StepInPython, guid: str) -> str:
    """Return the text of the class that pythonfmu instantiates, named after the FMU."""
    return (
        f"\n\nclass {step.name}(StepSlave):\n"
        f'    guid_of_content = "{guid}"\n'
        f"    input_count = {len(step.inputs)}\n"
        f"    safe = {list(step.safe)!r}\n"
        f"    first_period = {step.period!r}\n\n"
        f"    def make(self):\n        return {step.expression}\n"
    )
