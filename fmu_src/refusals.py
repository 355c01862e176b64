"""What a kernel says of a value that it refuses, where there is no run that could go on with the value before."""

from __future__ import annotations

import re

#: A kernel keeps the value before: runtime/variables.c, and of texts runtime/text.c.
VALUE_BEFORE = re.compile(r", and [^,]*? stays in force| The \w+ before it stays in force\.")


def without_value_before(sentence: str) -> str:
    """Return the sentence without what stays in force."""
    return VALUE_BEFORE.sub("", sentence)
