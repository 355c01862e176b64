"""Tables of docs/scenarios.md: every scenario by its package, from the catalogues."""

import importlib
from collections.abc import Iterator
from types import ModuleType

from pages import table

from bogie_braking.reporting.scenario import Scenario
from scenarios.catalogue import MODULES, scenarios_of


def modules() -> dict[str, list[ModuleType]]:
    """The files that hold scenarios, by the room they are in."""
    found: dict[str, list[ModuleType]] = {}
    for module in sorted(MODULES, key=lambda one: (one.__name__.startswith("evidence."), one.__name__)):
        found.setdefault(module.__name__.rpartition(".")[0], []).append(module)
    return found


def title(room: str) -> str:
    """Return the heading of a package with scenarios."""
    return room.partition(".")[2] + (", in a checkout" if room.startswith("evidence") else "")


def options(scenario: Scenario) -> str:
    """Return the options on the command line, and the parameters of a sweep."""
    given = ", ".join(f"`--{name.replace('_', '-')}`" for name in sorted(scenario.takes))
    if scenario.sweep is None:
        return given
    varied = ", ".join(f"`{name}`" for name in scenario.sweep.parameters)
    return f"{given}<br>" * bool(given) + f"sweep over {varied}"


def rows(files: list[ModuleType]) -> Iterator[tuple[str, str, str]]:
    """Yield the rows of one folder: the docstring of a file with one scenario, or the summary of each of several."""
    for module in files:
        held = scenarios_of(module)
        for scenario in held:
            about = " ".join((module.__doc__ or "").split()) if len(held) == 1 else f"{scenario.summary}."
            yield f"`{scenario.name}`", about, options(scenario)


def generated() -> str:
    """Return the tables of all packages."""
    lines = []
    for room, files in modules().items():
        about = (importlib.import_module(room).__doc__ or "").strip()
        listed = table(("scenario", "content", "options"), rows(files))
        lines += [f"## {title(room)}\n", f"{about}\n", f"{listed}\n"]
    return "\n".join(lines)
