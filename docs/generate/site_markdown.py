"""An extension of Python-Markdown for the site: formulas as MathML, and links of public names in the code to the API.

The generator of the site loads it by its name, in a process of its own (`website.py`).
"""

import html
import re
from typing import Any

from latex2mathml.converter import convert
from markdown import Extension, Markdown
from markdown.postprocessors import Postprocessor

from products.sources import HOUSE

#: Path of a Python file of the project, and a name in it; the same as a name with dots; a public name.
PLACE = rf"(?<![\w/])((?:{'|'.join(HOUSE)})/[\w/]+|build_fmu)\.py(?::\s(\w+(?:\.\w+)*))?"
DOTTED = rf"((?:{'|'.join(HOUSE)})(?:\.\w+)+)"
PUBLIC = r"bb((?:\.\w+)+)"
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def makeExtension(**_: Any) -> Extension:  # noqa: N802
    """Return the extension; Python-Markdown calls it by this name."""
    return SiteMarkdown()


class SiteMarkdown(Extension):
    """Adds the last step of each page."""

    def extendMarkdown(self, md: Markdown) -> None:  # noqa: N802
        """Register the step; Python-Markdown calls it by this name."""
        md.postprocessors.register(LastStep(md), "site_markdown", -1000)


class LastStep(Postprocessor):
    """Converts formulas, links names, and lets keys reach code that scrolls."""

    def run(self, text: str) -> str:
        """Return the HTML of a page, changed."""
        text = FORMULA.sub(formula, text)
        text = text.replace("<pre><span></span>", '<pre tabindex="0"><span></span>')
        text = re.sub(f"<code>{PLACE}</code>", reference, text)
        text = re.sub(f"<code>{DOTTED}</code>", reference, text)
        return re.sub(f"<code>{PUBLIC}</code>", lambda one: to_api(f"bogie_braking{one[1]}", one[0]), text)


def formula(match: re.Match[str]) -> str:
    """Return the MathML of a formula that arithmatex found: in a line, or a separate one, which may scroll."""
    source = html.unescape(match.group(2))
    if match.group(1) == "span":
        return str(convert(source))
    return f'<div class="formula" tabindex="0">{convert(source, display="block")}</div>'


def reference(match: re.Match[str]) -> str:
    """Return a place in the code as a link to its entry in the API."""
    return to_api(".".join(part for part in match.groups() if part).replace("/", "."), match.group())


def to_api(name: str, shown: str) -> str:
    """Return a link to the entry of a dotted name in the API; without an entry the shown text is not changed."""
    return f'<autoref identifier="{name}" optional>{shown}</autoref>'
