"""Write docs/scenarios.md from the catalogue: every scenario by its package. --check only compares."""

import importlib
import sys
from types import ModuleType

from pages import DOCS, write_or_check

from bogie_braking.reporting.scenario import Scenario
from scenarios.catalogue import MODULES, scenarios_of

PAGE = DOCS / "scenarios.md"
HEAD = """# Scenarios

`python -m bogie_braking run NAME` runs a scenario. It prints a table that compares the expected values (the thesis, a
closed form, another method) with the simulated ones, and writes `summary.json`, `timeseries.csv` and `figure.png` into
`results/NAME/`. The exit status is 1 if a row fails; [these rows fail](checking.md#known-deviations).

[Running scenarios](running.md) explains options, sweeps and macro steps. [Choosing](choosing.md) explains the figures
of `speed-accuracy`, `throughput`, `stability-atlas`, `coupling-step`, `levels` and `levels-in-curves`, and
[fitted](fitted.md) that of `sensitivity`. In the site that `make docs` builds, each scenario has a page with its figure
and its table. `docs/generate/catalogue.py` writes this page from `scenarios/catalogue.py`.
"""


def modules() -> dict[str, list[ModuleType]]:
    """The files that hold scenarios, by the room they are in."""
    found: dict[str, list[ModuleType]] = {}
    for module in sorted(MODULES, key=lambda one: (one.__name__.startswith("evidence."), one.__name__)):
        found.setdefault(module.__name__.rpartition(".")[0], []).append(module)
    return found


def options(scenario: Scenario) -> str:
    """Return the options on the command line, and the parameters of a sweep."""
    given = ", ".join(f"`--{name.replace('_', '-')}`" for name in sorted(scenario.takes))
    if scenario.sweep is None:
        return given
    varied = ", ".join(f"`{name}`" for name in scenario.sweep.parameters)
    return f"{given}<br>" * bool(given) + f"sweep over {varied}"


def table(files: list[ModuleType]) -> list[str]:
    """Return the rows of one folder: the docstring of a file with one scenario, or the summary of each of several."""
    lines = ["| scenario | content | options |", "|---|---|---|"]
    for module in files:
        held = scenarios_of(module)
        for scenario in held:
            about = " ".join((module.__doc__ or "").split()) if len(held) == 1 else f"{scenario.summary}."
            lines.append(f"| `{scenario.name}` | {about} | {options(scenario)} |")
    return lines


def page() -> str:
    """The text of docs/scenarios.md."""
    lines = [HEAD]
    for room, files in modules().items():
        about = (importlib.import_module(room).__doc__ or "").strip()
        where = ", in a checkout" if room.startswith("evidence") else ""
        lines += [f"## {room.partition('.')[2]}{where}", "", about, "", *table(files), ""]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(write_or_check({PAGE: page()}, sys.argv[1:]))
