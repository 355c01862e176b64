"""A page for each scenario on the site: its purpose, command and options, and the results of its last run.

Results are those in results/, or the committed ones in docs/. Nothing is run for a page.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from catalogue import options
from pages import DOCS, ROOT, table

from bogie_braking.reporting.report import VERDICTS, number, parted
from bogie_braking.reporting.scenario import Scenario
from readers.documents import read_document

RESULTS = ROOT / "results"
HEADS = ("quantity", "unit", "thesis", "simulated", "asked", "holds", "source")


def pictures_of(name: str) -> dict[str, Path]:
    """Return the figures of a scenario by their names on the site, the main one first; empty without a run."""
    main = RESULTS / name / "figure.png"
    if not main.exists():
        main = DOCS / "pictures" / f"{name}.png"
    others = [path for path in sorted(RESULTS.glob(f"{name}/*.png")) if path != main]
    found = {f"{name}.png": main} | {f"{name}-{path.name}": path for path in others}
    return found if main.exists() else {}


def summary_of(name: str) -> Mapping[str, Any] | None:
    """Return the summary of a scenario; None without a run."""
    for path in (RESULTS / name / "summary.json", DOCS / "data" / f"{name}.json"):
        if path.exists():
            found: Mapping[str, Any] = read_document(path)
            return found
    return None


def messages_of(name: str) -> dict[str, str]:
    """Return the messages of a scenario's figures, by their names on the site.

    The scenario's name if a run stored none.
    """
    said = (summary_of(name) or {}).get("pictures", {})
    files = {one: "figure.png" if one == f"{name}.png" else path.name for one, path in pictures_of(name).items()}
    return {one: said.get(file, name) for one, file in files.items()}


def scenario_page(scenario: Scenario, module: ModuleType) -> str:
    """The text of its page; module: the file that holds it."""
    about = re.sub(r"\]\((?=[\w-]+\.md)", "](../", (module.__doc__ or "").strip())
    lines = [f"# {scenario.name}", f"{scenario.summary}.", about]
    lines += [f"```sh\npython -m bogie_braking run {scenario.name}\n```"]
    if found := options(scenario):
        lines += [f"Options: {found.replace('<br>', '; ')}."]
    lines += [f"![{message}]({name})" for name, message in messages_of(scenario.name).items()]
    summary = summary_of(scenario.name)
    if summary is not None:
        lines += [*tables(summary["rows"]), *summary["remarks"]]
        lines += [f"It took {summary['wall_seconds']:.1f} s."]
    elif rows := read_document(DOCS / "data" / "numbers.json").get(scenario.name):
        kept = [[quantity, number(value)] for quantity, value in rows.items()]
        lines += ["Results that these pages cite:", table(("quantity", "simulated"), kept)]
    else:
        lines += ["The command prints its table of results and writes its figure into `results/`."]
    return "\n\n".join([*lines, f"In the code: `{module.__name__.replace('.', '/')}.py`."]) + "\n"


def tables(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the evaluated rows, failed ones first; the others folded."""
    judged, others = parted(rows, lambda one: one["holds"])
    printed = any(one["thesis"] is not None for one in rows)
    heads = [head for head in HEADS if printed or head != "thesis"]
    held, rest = (table(heads, [row(one, heads) for one in some]) for some in (judged, others))
    words = f"{len(others)} rows that are not judged"
    folded = f'<details markdown="1">\n<summary>{words}</summary>\n\n{rest}\n\n</details>'
    return [held] * bool(judged) + [folded] * bool(others)


def row(one: Mapping[str, Any], heads: Sequence[str]) -> list[str]:
    """Return the cells of one comparison."""
    source = f"{one['source']}; {one['assumption']}" if one["assumption"] else one["source"]
    cells = (one["quantity"], one["unit"], number(one["thesis"]), number(one["simulated"]), one["asked"])
    shown = dict(zip(HEADS, (*cells, VERDICTS[one["holds"]], source), strict=True))
    return [shown[head].replace("|", "\\|") for head in heads]
