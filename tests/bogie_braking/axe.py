"""List the accessibility faults of a page, as found by axe-core.

The rules are those of https://dequeuniversity.com/rules/axe/4.4.
"""

from __future__ import annotations

import json

from tests.bogie_braking.browser import Page
from tests.needed import needed_package

#: The levels A and AA of the Web Content Accessibility Guidelines 2.0 and 2.1, as axe-core names its rules for them.
TAGS = ("wcag2a", "wcag2aa", "wcag21a", "wcag21aa")


def violations(page: Page, *more: str) -> list[str]:
    """Return one line for each element that breaks a rule: the rule, the element's place and the remedy.

    Hidden elements, such as those in a closed `<details>`, and embedded pages are not checked. more: names of rules to
    check in addition to the levels A and AA, such as "heading-order".
    """
    script = needed_package("axe_core_python") / "axe.min.js"
    page.evaluate(script.read_text(encoding="utf-8") + "; undefined")
    asked = {
        "runOnly": {"type": "tag", "values": TAGS},
        "rules": {name: {"enabled": True} for name in more},
        "resultTypes": ["violations"],
        "iframes": False,
    }
    found: list[str] = page.evaluate(
        f"""axe.run(document, {json.dumps(asked)}).then(({{ violations }}) => violations.flatMap((rule) =>
            rule.nodes.map((node) => [rule.id, node.target.flat().join(" "), node.failureSummary].join(": "))))"""
    )
    return [" ".join(line.split()) for line in found]
