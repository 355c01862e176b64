"""Systems that join into one: names in a scope of their own, and outputs that become inputs without a coupling's error.

A connection is a link as those within a system: the symbol of the input stands for the expression of the output, and
derivatives go through it by the chain rule. The parts' equations are not written again.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from fmu_src.chain import Call, Waist
from fmu_src.symbols import ca
from fmu_src.system import System, Variable
from fmu_src.user_files import FileTable


def scope(system: System, before: str = "", after: str = "", common: Collection[str] = ()) -> System:
    """Return the same system with other names.

    It renames variables, states, tables and observables. Equations use symbols, not names, and are unchanged. So are
    the messages of frictions and conditions.
    """
    return _named(system, lambda name: name if name in common else f"{before}{name}{after}")


def renamed(system: System, names: Mapping[str, str]) -> System:
    """Return the same system with some other names; names: the new name by the old one, as in `scope`."""
    return _named(system, lambda name: names.get(name, name))


def _named(system: System, named: Callable[[str], str]) -> System:
    def keyed(entries: Mapping[str, Any]) -> dict[str, Any]:
        return {named(name): entry for name, entry in entries.items()}

    return replace(
        system,
        variables=[replace(variable, name=named(variable.name)) for variable in system.variables],
        input_symbols=keyed(system.input_symbols),
        parameter_symbols=keyed(system.parameter_symbols),
        derived_symbols=keyed(system.derived_symbols),
        derived_expressions=keyed(system.derived_expressions),
        states={named(name): replace(state, name=named(name)) for name, state in system.states.items()},
        derivatives=keyed(system.derivatives),
        tables=[replace(table, name=named(table.name)) for table in system.tables],
        frictions=[replace(friction, states=tuple(map(named, friction.states))) for friction in system.frictions],
        outputs=keyed(system.outputs),
        observables=keyed(system.observables),
        largest_changes=[(tuple(map(named, names)), largest) for names, largest in system.largest_changes],
    )


def compose(name: str, description: str, parts: Sequence[System], connections: Mapping[str, str]) -> System:
    """Join several systems into one that shares the time.

    Parameters of one name are one parameter, declared as in the first part that has it.
    """
    whole = System(name, description)
    links = [_Link(link) for part in parts for link in part.links]
    for part in parts:
        links += [_same(part.time, whole.time), *_share_parameters(whole, part)]
    faces = {variable.name: variable for part in parts for variable in part.variables if variable.causality == "output"}
    for target, source in connections.items():
        links.append(_connected(name, parts, faces, target, source))
    for part in parts:
        _take(whole, part, connections)
    _put_in_order(whole, links, [table for part in parts for table in part.tables])
    return whole


@dataclass(frozen=True)
class _Link:
    """A link that is not yet in its place; text: which connection it is, if it is one."""

    link: Call | Waist
    text: str = ""


def _same(symbol: ca.SX, value: ca.SX, text: str = "") -> _Link:
    return _Link(Waist(value, symbol, value), text)


def _share_parameters(whole: System, part: System) -> list[_Link]:
    """Add the parameters of a part to the whole; those that an earlier part has too are linked to that part's."""
    shared = []
    declared = {variable.name: variable for variable in whole.variables}
    for variable in part.variables:
        if variable.causality != "parameter":
            continue
        symbol, known = part.parameter_symbols[variable.name], declared.get(variable.name)
        if known is None:
            whole.variables.append(variable)
            whole.parameter_symbols[variable.name] = symbol
        elif known.unit == variable.unit:
            shared.append(_same(symbol, whole.parameter_symbols[variable.name]))
        else:
            raise ValueError(
                f"{whole.name}: the parameter {variable.name} is in {known.unit} and, in {part.name}, in "
                f"{variable.unit}; give one of them a scope."
            )
    return shared


def _connected(name: str, parts: Sequence[System], outputs: Mapping[str, Variable], target: str, source: str) -> _Link:
    """Return the link of one connection."""
    inputs = {variable.name: variable for part in parts for variable in part.variables if variable.causality == "input"}
    for asked, there, word in ((target, inputs, "input"), (source, outputs, "output")):
        if asked not in there:
            raise ValueError(f"{name}: no part has the {word} {asked}; there are {', '.join(there)}.")
    if inputs[target].unit != outputs[source].unit:
        units = f"{outputs[source].unit} and {inputs[target].unit}"
        raise ValueError(f"{name}: {source} cannot become {target}, they are in {units}.")
    symbol = next(part.input_symbols[target] for part in parts if target in part.input_symbols)
    value = next(part.outputs[source] for part in parts if source in part.outputs)
    return _same(symbol, value, f"{source} to {target}")


def _take(whole: System, part: System, connections: Mapping[str, str]) -> None:
    """Take everything of a part except its links, tables of files and parameters."""

    def add(kind: str, entries: Mapping[str, Any]) -> None:
        known = getattr(whole, kind)
        for twice in known.keys() & entries.keys():
            raise ValueError(f"{whole.name}: {twice} is there twice among the {kind}; give each part a scope.")
        known.update(entries)

    add("input_symbols", {name: one for name, one in part.input_symbols.items() if name not in connections})
    for kind in ("derived_symbols", "derived_expressions", "states", "derivatives", "outputs", "observables"):
        add(kind, getattr(part, kind))
    inside = [v for v in part.variables if v.causality == "input" and v.name in connections]
    whole.variables += [v for v in part.variables if v.causality != "parameter" and v not in inside]
    whole.frictions += part.frictions
    whole.end_conditions += part.end_conditions
    whole.warnings += part.warnings
    whole.records += part.records
    whole.refuses_records = whole.refuses_records or part.refuses_records
    whole.largest_changes += part.largest_changes


def _put_in_order(whole: System, links: Sequence[_Link], tables: Sequence[FileTable]) -> None:
    """Put each link and table after those that it needs, with its rank among those of its kind."""
    nodes: list[Call | Waist | FileTable] = [*(link.link for link in links), *tables]
    needs = _needs([_needed_by(node) for node in nodes], [node.symbols for node in nodes])
    place: dict[int, int] = {}
    waiting = list(range(len(nodes)))
    while waiting:
        ready = [node for node in waiting if needs[node] <= place.keys()]
        if not ready:
            ring = ", ".join(links[node].text for node in waiting if node < len(links) and links[node].text)
            raise ValueError(f"{whole.name}: {ring} depend on each other in a ring without a state; cut one of them.")
        place |= {node: len(place) + number for number, node in enumerate(ready)}
        waiting = [node for node in waiting if node not in place]
    in_order = sorted(place, key=place.__getitem__)
    calls, looked_up = (
        _ranks(in_order, needs, {n for n in in_order if isinstance(nodes[n], kind)}) for kind in (Call, FileTable)
    )
    for number in in_order:
        node = nodes[number]
        if isinstance(node, FileTable):
            whole.tables.append(replace(node, rank=looked_up[number]))
        elif isinstance(node, Call):
            plain = whole.without_waists(node.taken)
            whole.links.append(replace(node, rank=calls[number], plain=plain))
        else:
            whole.links.append(replace(node, plain=whole.without_waists(node.values)))


def _needed_by(node: Call | Waist | FileTable) -> ca.SX:
    if isinstance(node, FileTable):
        return node.argument
    return node.taken if isinstance(node, Call) else node.values


def _needs(values: Sequence[ca.SX], symbols: Sequence[ca.SX]) -> list[set[int]]:
    """Return, for each value, the numbers of those whose symbols are in it."""
    rows, columns = ([i for i, one in enumerate(all_) for _ in range(one.numel())] for all_ in (values, symbols))
    pattern = ca.jacobian_sparsity(ca.vertcat(*[ca.vec(value) for value in values]), ca.vertcat(*symbols))
    needs: list[set[int]] = [set() for _ in values]
    for row, column in zip(*pattern.get_triplet(), strict=True):
        needs[rows[row]].add(columns[column])
    return needs


def _ranks(in_order: Sequence[int], needs: Sequence[set[int]], counted: set[int]) -> dict[int, int]:
    """Return, for each node, the largest number of counted nodes in a chain of those that it needs."""
    rank: dict[int, int] = {}
    for node in in_order:
        rank[node] = max((rank[need] + (need in counted) for need in needs[node]), default=0)
    return rank
