"""What a page makes hard for people who hear it, enlarge it or use no mouse, as axe-core finds it.

The rules are those of https://dequeuniversity.com/rules/axe/4.4.
"""

from __future__ import annotations

import json

from tests.browser import Page
from tests.needed import needed_package

#: The levels A and AA of the Web Content Accessibility Guidelines 2.0 and 2.1, as axe-core names its rules for them.
TAGS = ("wcag2a", "wcag2aa", "wcag21a", "wcag21aa")


def violations(page: Page, *more: str) -> list[str]:
    """A line for each element that breaks a rule: the rule, where the element is, and what would mend it.

    Hidden elements, such as those in a closed `<details>`, and pages within the page are not looked at. more: names of
    rules beside those of the levels A and AA, such as "heading-order".
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
