"""YAML files that users bring: read within limits on size, depth and numbers, without anchors."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Any

from readers.documents import DEEPEST, check_tree, too_deep
from readers.text import FileError, lines_of, shown, text_of

try:
    import yaml
    from yaml.composer import Composer
except ImportError:  # an environment of an earlier version
    raise FileError("A YAML file needs the package PyYAML; it is missing. Install it: pip install pyyaml.") from None

#: Largest file [bytes].
LARGEST = 4_000_000
#: Fault of a file that nests too deeply, and that of the parser in C, from 1000 levels on.
TOO_DEEP = f"levels are more than {DEEPEST} deep"
TOO_DEEP_IN_C = "exceeded maximum nesting depth"
#: Numbers in decimal writing. Other numbers of YAML 1.1 are text here: 012 is 10 there, 1:30 is 90, 1_000 is 1000.
NUMBERS = {
    "tag:yaml.org,2002:int": re.compile(r"[+-]?(0|[1-9]\d*)\Z", re.ASCII),
    "tag:yaml.org,2002:float": re.compile(
        r"([+-]?(\d+\.\d*|\.\d+|\d+(?=[eE]))([eE][+-]?\d+)?|[+-]?\.(inf|Inf|INF)|\.(nan|NaN|NAN))\Z", re.ASCII
    ),
}


#: Splits text into events: in C if PyYAML has it, in a third of the time. Nodes are composed in Python, with checks.
_PARSER: Any = yaml.CSafeLoader if yaml.__with_libyaml__ else yaml.SafeLoader
_BASE: Any = type("_Base", (Composer, _PARSER), {}) if yaml.__with_libyaml__ else _PARSER


class _Loader(_BASE):
    """Reads plain values: no anchors, each name once, nesting at most DEEPEST deep."""

    def __init__(self, text: str) -> None:
        self.anchors: dict[str, Any] = {}  # as Composer sets it
        _PARSER.__init__(self, text)

    depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Return the next node. Raises yaml.MarkedYAMLError for anchors and deep nesting."""
        event = self.peek_event()
        if getattr(event, "anchor", None) is not None:
            raise yaml.MarkedYAMLError(None, None, "anchors (& and *) are not read", event.start_mark)
        if self.depth > DEEPEST:
            raise yaml.MarkedYAMLError(None, None, TOO_DEEP, event.start_mark)
        self.depth += 1
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        """Return a mapping. Raises yaml.MarkedYAMLError for a name that occurs twice."""
        found = super().construct_mapping(node, deep)
        if len(found) < len(node.value):
            names = [self.construct_object(name, deep=True) for name, _ in node.value]
            twice = Counter(names).most_common(1)[0][0]
            raise yaml.MarkedYAMLError(None, None, f"the name {shown(twice)} occurs twice", node.start_mark)
        return found


_Loader.yaml_implicit_resolvers = {
    letter: [one for one in those if one[0] not in NUMBERS] for letter, those in _Loader.yaml_implicit_resolvers.items()
}
for _tag, _form in NUMBERS.items():
    _Loader.add_implicit_resolver(_tag, _form, list("+-.0123456789"))


def yaml_of(path: str | Path, largest: int = LARGEST) -> Any:
    """Return the content of a YAML file with one document: finite numbers, each name once, no anchors."""
    text = "\n".join(lines_of(text_of(path, largest)))
    try:
        found = yaml.load(text, _Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f" in row {mark.line + 1}, column {mark.column + 1}" if mark else ""
        fault = TOO_DEEP if error.problem == TOO_DEEP_IN_C else error.problem
        raise FileError(f"{path} must be YAML; got a fault{place} ({fault}).") from None
    except yaml.YAMLError:
        raise FileError(f"{path} must be YAML; got characters that it does not allow.") from None
    except RecursionError:
        raise too_deep(str(path)) from None
    except (ValueError, TypeError):  # days that no month has, digits by thousands, names that are lists
        raise FileError(f"{path} must have plain names and numbers that can be; got another.") from None
    check_tree(found, str(path))
    return found
