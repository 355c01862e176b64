"""Messages of a kernel about refused values, for places without a run that could continue with the value before."""

from __future__ import annotations

import re

#: A kernel keeps the value before: runtime/variables.c, and for strings runtime/text.c.
VALUE_BEFORE = re.compile(r" [-+\w.]*\w(?: [^\s;]+)? stays in force\.| The [\w ]+ before it stays in force\.")


def without_value_before(sentence: str) -> str:
    """Return the message without the value that stays in force."""
    return VALUE_BEFORE.sub("", sentence)
