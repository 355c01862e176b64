"""Copies the figures of `make charts` next to the text, and their measured values into it.

  python docs/generate/charts.py              updates docs/choosing.md from the JSON in docs/data/
  python docs/generate/charts.py --collect    first copies the figures and the JSON from results/ to docs/
  python docs/generate/charts.py --check      exit status 1 if a text differs from the numbers of the JSON

In the template here, `[[scenario | quantity | format]]` is replaced by a measured value: choosing.md.in becomes
docs/choosing.md.
"""

import json
import re
import shutil
import sys
import textwrap
from pathlib import Path

from pages import DOCS, ROOT, write_or_check

from readers.documents import read_document, text_in

HERE, DATA, PICTURES = DOCS / "generate", DOCS / "data", DOCS / "pictures"
CHARTS = (
    "speed-accuracy",
    "throughput",
    "stability-atlas",
    "coupling-step",
    "levels",
    "levels-in-curves",
    "contact-model",
    "thesis-step",
    "train-brake-evidence",
)
#: Characters in a line of text.
WIDTH = 118


def collect() -> None:
    """Copy figures and tables of the scenarios, and the needed values of the JSON, from results/ to docs/."""
    for name in CHARTS:
        folder = ROOT / "results" / name
        summary = read_document(folder / "summary.json")
        if (scenario := text_in(summary, "scenario", f"{folder}/summary.json")) != name:
            sys.exit(f"{folder} must hold the results of {name}; got those of {scenario}. Run {name} again.")
        shutil.copyfile(folder / "figure.png", PICTURES / f"{name}.png")
        kept = {key: summary[key] for key in ("scenario", "rows", "pictures", "remarks", "versions", "wall_seconds")}
        (DATA / f"{name}.json").write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


def measured() -> dict[tuple[str, str], float]:
    """Return the values of the JSON in docs/data/, by scenario and quantity."""
    found = {}
    for name in CHARTS:
        summary = json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))
        found[name, "wall_seconds"] = summary["wall_seconds"]
        found |= {(name, row["quantity"]): row["simulated"] for row in summary["rows"]}
    kept = json.loads((DATA / "numbers.json").read_text(encoding="utf-8"))  # of numbers_of_pages.py
    return found | {(name, quantity): of for name, rows in kept.items() for quantity, of in rows.items()}


def filled(template: Path, values: dict[tuple[str, str], float]) -> str:
    """The text of a template with its numbers. Raises KeyError for a quantity that no scenario measured."""

    def number(match: re.Match[str]) -> str:
        scenario, quantity, form = (part.strip() for part in match.group(1).split("|"))
        return format(abs(values[scenario, quantity]), form)

    text = re.sub(r"\[\[([^\]]+)\]\]", number, template.read_text(encoding="utf-8"))
    return "\n\n".join(wrapped(block) for block in text.rstrip("\n").split("\n\n")) + "\n"


def wrapped(block: str) -> str:
    """Return a paragraph or list with lines of even length; tables, headings and figures are not changed."""
    if block.startswith(("|", "#", "!", "<")):
        return block
    items = re.split(r"\n(?=\* )", block)
    return "\n".join(
        textwrap.fill(
            " ".join(item.split()),
            WIDTH,
            subsequent_indent="  " if item.startswith("* ") else "",
            break_long_words=False,
            break_on_hyphens=False,
        )
        for item in items
    )


def texts() -> dict[Path, str]:
    """Return the updated pages."""
    return {DOCS / "choosing.md": filled(HERE / "choosing.md.in", measured())}


def main(arguments: list[str]) -> int:
    if "--collect" in arguments:
        collect()
    return write_or_check(texts(), arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
