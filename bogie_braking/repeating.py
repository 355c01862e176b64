"""Runs of results again, from the provenance in their files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.batches import batch
from bogie_braking.checks import shown
from bogie_braking.protection import protected_stop, protected_stops
from bogie_braking.provenance import Decoder
from bogie_braking.rare_events import Rare, rare
from bogie_braking.simulation import Simulation, run
from bogie_braking.sweeping import sweep
from bogie_braking.trains import train
from fmu_src import __version__
from fmu_src.cosimulation.provenance_text import provenance_in
from fmu_src.cosimulation.recording import Recording
from products.sources import sources_of_process
from readers.documents import mapping_in
from readers.text import FileError

#: Relative difference below which repeated values are equal: other processors may change the last digits.
SAME = 1e-9
#: Remedies for results of other functions.
REMEDIES = {
    "scenario": "Run it again: bogie-braking run {name}, with the options in its provenance.",
    "scenario sweep": "Run it again: bogie-braking sweep {name}, with the settings in its summary.json.",
    **{
        f"controllers {name}": f"Run it again: bogie-braking controllers {name}, with the settings in the file."
        for name in ("compare", "loop", "replay", "report")
    },
}


def repeat(result: str | Path | Recording, *, other_sources: bool = False, **arguments: Any) -> Recording:
    """Run a run again from the provenance of its result, and compare.

    Results of `run`, `Simulation`, `sweep`, `batch` (its `table`), `rare` (`tail` and `worst`), `train`,
    `protected_stop` and `protected_stops` can be repeated.

    Parameters
    ----------
    result : str, Path or Recording
        A result, or its file.
    other_sources : bool
        Whether another version of this project may repeat the run; a message states it.
    **arguments
        Arguments that a file cannot hold, by name. These are own equations and functions, vehicles as data, and long
        lines and tables.

    Returns
    -------
    Recording
        The new result. Its last message states whether its columns equal those of the file, to 1e-9.

    Raises
    ------
    ValueError
        If the result has no provenance or cannot be repeated, if an argument is missing, or if sources or equations
        differ.
    FileError
        If a file is missing or differs from that of the run.
    """
    source, provenance, table = _opened(result)
    notes = _check_sources(source, provenance, other_sources)
    folder = Path(source).parent if isinstance(result, str | Path) else Path()
    call = _decoded(source, provenance, Decoder(source, folder, arguments), table)
    made = FUNCTIONS[provenance["function"]](call)
    found: Recording = made if isinstance(made, Recording) else getattr(made, provenance["part"])
    if found.provenance.get("identity") != provenance.get("identity") and not notes:
        raise ValueError(f"The equations or vehicles must be those of the run of {source}; got others. Give the same.")
    found.messages += [*notes, _compared(source, table, found)]
    return found


def _opened(result: str | Path | Recording) -> tuple[str, dict[str, Any], Recording]:
    """Return the name of a result in messages, its provenance and its columns. Raises ValueError."""
    if isinstance(result, Recording):
        source, provenance, table = "The result", result.provenance, lambda: result
    elif isinstance(result, str | Path):
        result = Path(result, "table.csv") if Path(result).is_dir() else result
        path = Path(result)
        source, provenance = str(path), provenance_in(path)
        table = partial(Recording.read, path.with_name("table.csv") if path.suffix == ".json" else path)
    else:
        raise TypeError(f"What is repeated must be a Recording or the path of one; got {shown(result)}.")
    if "function" not in provenance:
        raise ValueError(
            f"{source} must have a provenance to be repeated; it has none. Results of {', '.join(FUNCTIONS)} have one."
        )
    function = str(provenance["function"])
    if function not in FUNCTIONS:
        remedy = REMEDIES.get(function, "").format(name=provenance.get("arguments", {}).get("name", ""))
        raise ValueError(f"{source} is of {function}, which repeat does not run. {remedy}".strip())
    if provenance.get("part", "tail") not in ("tail", "worst"):
        raise FileError(f"The part of {source} must be tail or worst; got {shown(provenance['part'])}.")
    if "unrepeatable" in provenance:
        raise ValueError(f"{source} cannot be repeated: {provenance['unrepeatable']}.")
    return source, provenance, table()


def _check_sources(source: str, provenance: Mapping[str, Any], allowed: bool) -> list[str]:
    """Return a note if the sources differ and may. Raises ValueError if they may not."""
    own = __version__, sources_of_process()
    due = provenance.get("version"), provenance.get("sources")
    if own == due:
        return []
    if not allowed:
        raise ValueError(
            f"{source} must be repeated by its own sources, version {due[0]} with digest {due[1]}; got {own[0]} with "
            f"{own[1]}. Install that version, or give other_sources=True."
        )
    return [f"Repeated by other sources: version {own[0]} ({own[1]}) instead of {due[0]} ({due[1]})."]


@dataclass(frozen=True)
class Call:
    """A call of a public function: arguments, values by name, and later steps."""

    arguments: dict[str, Any]
    values: dict[str, Any]
    steps: list[list[Any]]


def _decoded(source: str, provenance: Mapping[str, Any], decoder: Decoder, table: Recording) -> Call:
    """Return the arguments of the run. Raises ValueError, FileError."""
    given = dict(mapping_in(provenance, "arguments", f"The provenance of {source}"))
    try:
        values = {name: decoder.value(name, value) for name, value in given.pop("values", {}).items()}
        arguments = {name: decoder.value(name, value) for name, value in given.items()}
        if "vary" in arguments:
            arguments["vary"] = {name: table[name] for name in arguments["vary"]}
        steps = [[name, *(decoder.value(name, part) for part in parts)] for name, *parts in provenance.get("steps", [])]
        if target := TARGETS.get(provenance["function"]):
            signature(target).bind(**arguments, **values)
    except (KeyError, TypeError, AttributeError, IndexError) as error:
        raise FileError(f"The provenance of {source} must be as it was written; got another ({error!r}).") from error
    decoder.check_used()
    return Call(arguments, values, steps)


def _simulated(call: Call) -> Recording:
    simulation, found = Simulation(**call.arguments, **call.values), None
    for name, *parts in call.steps:
        if name == "set":
            simulation.set(**parts[0])
        else:
            duration, interval, names = parts
            found = simulation.advance(duration, names, interval)
    assert found is not None
    return found


def _ran(call: Call) -> Recording:
    """Return a run as a Simulation makes it, whose inputs may begin after its end."""
    advance = {name: call.arguments.pop(name) for name in ("duration", "names", "interval") if name in call.arguments}
    return Simulation(**call.arguments, **call.values).advance(**advance)


def _driven(call: Call) -> Recording:
    driven, found = train(**call.arguments), None
    for name, *parts in call.steps:
        if name == "inputs":
            for input_, array in parts[0].items():
                driven.inputs[input_] = np.array(array, float)
        elif name == "advance":
            driven.advance(*parts)
        else:
            found = driven.record(*parts)
    assert found is not None
    return found


def _batched(call: Call) -> Recording:
    varied = call.arguments.pop("vary")
    return batch(**call.arguments, **call.values, **varied).table


#: Functions that are called with all arguments and values by name.
TARGETS: dict[str, Callable[..., Any]] = {
    function.__name__: function for function in (run, sweep, protected_stop, protected_stops)
}


def _split(call: Call) -> Rare:
    vary: dict[str | tuple[str, ...], Any] = {}
    for names, distribution in call.arguments.pop("distributions"):
        vary[tuple(names)] = distribution
    return rare(**call.arguments, vary=vary, **call.values)


def _called(function: Callable[..., Any]) -> Callable[[Call], Any]:
    return lambda call: function(**call.arguments, **call.values)


#: Functions that run each public function again.
FUNCTIONS: dict[str, Callable[[Call], Any]] = {
    **{name: _called(function) for name, function in TARGETS.items()},
    "run": _ran,
    "Simulation": _simulated,
    "batch": _batched,
    "rare": _split,
    "train": _driven,
}


def _compared(source: str, table: Recording, found: Recording) -> str:
    """Return whether the columns of a new result are those of the old one."""
    names = [name for name in found if name in table]
    if not names or table.rows != found.rows:
        return f"Differs from {source}: it has {table.rows} rows, the repeated run {found.rows}."
    off = []
    for name in names:
        same = np.isclose(found[name], table[name], rtol=SAME, atol=0.0, equal_nan=True)
        if not np.all(same):
            size = float(np.max(np.abs(found[name][~same] - table[name][~same])))  # NaN where one alone is NaN
            off.append(f"{name} by up to {size:.3g} {found.units[name]}")
    if off:
        more = f", and {len(off) - 3} more columns" if len(off) > 3 else ""
        return f"Differs from {source}: {', '.join(off[:3])}{more}."
    return f"Equal to {source} in {len(names)} columns of {found.rows} rows."
