"""Parameter sets and experiments with their results inside an FMU, by the layered standard FMI-LS-REF.

Followed are the draft 1.0.0-alpha.1 of FMI-LS-REF (github.com/modelica/fmi-ls-ref) and, for the file of experiments,
the schema of 2026 of the Modelica Association's experiments format (github.com/modelica/ma-hs-experiments).
"""

from __future__ import annotations

import hashlib
import html
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fmu_src.archive import xml_file
from fmu_src.codegen import generate
from fmu_src.compile import library_of
from fmu_src.kernel import Kernel, Library
from fmu_src.parameter_file import parameter_file
from fmu_src.system import Model

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
#: Recommended by the standard: a page that lists the content.
PAGE = "documentation/fmi-ls-ref.html"
EXPERIMENTS_FILE = "experiments.exp"
#: Digits of the largest value of a column, on which compilers and mathematical libraries agree: builds are equal.
DIGITS = 7
#: Type and role by the end of a file's name.
KINDS = {
    ".ssv": ("application/x-ssp-parameter-set", "parameter"),
    "_in.csv": ("text/csv", "other"),
    "_out.csv": ("text/csv", "result"),
    ".exp": ("application/x-ma-hs-experiments", "experiment/validation"),
}
NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"


@dataclass(frozen=True)
class Experiment:
    """A run of one FMU: parameters and constant inputs in SI units, outputs, duration and communication step [s]."""

    name: str
    description: str
    parameters: Mapping[str, float]
    inputs: Mapping[str, float]
    outputs: Sequence[str]
    stop_time: float
    step_size: float


def reference_files(model: Model, sets: Mapping[str, bytes], experiments: Sequence[Experiment]) -> dict[str, bytes]:
    """Return all files by their places in the archive; sets: parameter files by name. Runs the experiments."""
    if not (sets or experiments):
        return {}
    files = dict(sets) | (experiment_files(model, experiments) if experiments else {})
    files["fmi-ls-manifest.xml"] = manifest(files)
    return {f"{FOLDER}/{name}": data for name, data in files.items()} | {PAGE: page(model, sets, experiments).encode()}


def experiment_files(model: Model, experiments: Sequence[Experiment]) -> dict[str, bytes]:
    """Return the experiments by name: their descriptions, parameters, inputs and results."""
    files = {EXPERIMENTS_FILE: experiments_file(model, experiments)}
    kernel = Kernel(Library(library_of(generate(model))))
    for experiment in experiments:
        files[f"{experiment.name}.ssv"] = parameter_file(
            experiment.name, experiment.description, experiment.parameters, model.variables
        )
        files[f"{experiment.name}_in.csv"] = table(
            ["time", *experiment.inputs], [[t, *experiment.inputs.values()] for t in (0, experiment.stop_time)]
        )
        files[f"{experiment.name}_out.csv"] = table(["time", *experiment.outputs], results(kernel, experiment))
    return files


def results(kernel: Kernel, experiment: Experiment) -> list[list[float]]:
    """Return the time and outputs at each step of a host."""
    kernel.reset()
    kernel.set(**experiment.parameters, **experiment.inputs)
    kernel.initialise()
    size, rows = experiment.step_size, []
    for number in range(round(experiment.stop_time / size) + 1):
        if number:
            kernel.step((number - 1) * size, size)
        rows.append([number * size, *(kernel[name] for name in experiment.outputs)])
    return rows


def table(names: Sequence[str], rows: Sequence[Sequence[float]]) -> bytes:
    """Return a table as text: a line of names, and the numbers, rounded to DIGITS of the largest of their column."""
    columns = np.array(rows, float).T
    sizes = np.abs(columns).max(axis=1)
    places = DIGITS - 1 - np.floor(np.log10(np.where(sizes > 0.0, sizes, 1.0))).astype(int)
    rounded = [np.round(column, place) + 0.0 for column, place in zip(columns, places, strict=True)]
    lines = [",".join(names), *(",".join(f"{value:.{DIGITS}g}" for value in row) for row in zip(*rounded, strict=True))]
    return ("\n".join(lines) + "\n").encode()


def experiments_file(model: Model, experiments: Sequence[Experiment]) -> bytes:
    """Return the experiments of an FMU, with the names of their files."""
    root = ET.Element("Experiments", name=model.name, description=f"Reference experiments of {model.name}")
    for experiment in experiments:
        element = ET.SubElement(root, "Experiment", name=experiment.name, description=experiment.description)
        times = {"startTime": "0.0", "stopTime": repr(experiment.stop_time), "stepSize": repr(experiment.step_size)}
        ET.SubElement(element, "TransientSimulation", times)
        for kind, end in (("Parameters", ".ssv"), ("Stimuli", "_in.csv"), ("References", "_out.csv")):
            ET.SubElement(element, kind, type=KINDS[end][0], source=f"{experiment.name}{end}")
    return xml_file(root)


def manifest(files: Mapping[str, bytes]) -> bytes:
    """Return the manifest: the purpose of each file, and its digest (SHA3-256)."""
    about = {
        "xmlns:fmi-ls": NAMESPACE,
        "fmi-ls:fmi-ls-name": FOLDER.removeprefix("extra/"),
        "fmi-ls:fmi-ls-version": "1.0.0-alpha.1",
        "fmi-ls:fmi-ls-description": "Layered Standard providing information on related files included in an FMU.",
    }
    root = ET.Element("fmiReferences", about)
    for name in sorted(files):
        kind, role = next(found for end, found in KINDS.items() if name.endswith(end))
        digest = hashlib.sha3_256(files[name]).hexdigest()
        ET.SubElement(root, "Related", type=kind, source=name, role=role, checksum=digest)
    return xml_file(root)


def page(model: Model, sets: Mapping[str, bytes], experiments: Sequence[Experiment]) -> str:
    """Return a page that lists the sets and experiments, for people."""
    listed = "".join(f"<li><code>{name}</code></li>\n" for name in sets)
    runs = "".join(
        f"<li><code>{experiment.name}</code>: {html.escape(experiment.description)}, {experiment.stop_time:g} s in "
        f"steps of {experiment.step_size:g} s</li>\n"
        for experiment in experiments
    )
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{model.name}: references</title>\n'
        f"<h1>{model.name}: parameter sets and experiments</h1>\n<p>In <code>{FOLDER}</code>, by FMI-LS-REF.</p>\n"
        f"<h2>Parameter sets</h2>\n<ul>\n{listed}</ul>\n<h2>Experiments</h2>\n<p>With parameters, inputs and results, "
        f"to {DIGITS} digits of the largest value of each. Inputs are constant: hosts that hold or interpolate them "
        f"agree.</p>\n<ul>\n{runs}</ul>\n</html>\n"
    )
