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
except ImportError:  # an environment of an earlier version
    raise FileError("A YAML file needs the package PyYAML; it is missing. Install it: pip install pyyaml.") from None

#: Largest file [bytes].
LARGEST = 4_000_000
#: Numbers with an exponent and no point, which YAML 1.1 reads as text.
EXPONENT = re.compile(r"[+-]?\d+(\.\d*)?[eE][+-]?\d+", re.ASCII)


class _Loader(yaml.SafeLoader):
    """Reads plain values: no anchors, each name once, nesting at most DEEPEST deep."""

    depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Return the next node. Raises yaml.MarkedYAMLError for anchors and deep nesting."""
        event = self.peek_event()
        if getattr(event, "anchor", None) is not None:
            raise yaml.MarkedYAMLError(None, None, "anchors (& and *) are not read", event.start_mark)
        if self.depth > DEEPEST:
            raise yaml.MarkedYAMLError(None, None, f"levels are more than {DEEPEST} deep", event.start_mark)
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


_Loader.add_implicit_resolver("tag:yaml.org,2002:float", EXPONENT, list("+-0123456789"))


def yaml_of(path: str | Path, largest: int = LARGEST) -> Any:
    """Return the content of a YAML file with one document: finite numbers, each name once, no anchors.

    Raises
    ------
    FileError
        If the file cannot be read, or is not YAML within the limits.
    """
    text = "\n".join(lines_of(text_of(path, largest)))
    try:
        found = yaml.load(text, _Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f" in row {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise FileError(f"{path} must be YAML; got a fault{place} ({error.problem}).") from None
    except yaml.YAMLError:
        raise FileError(f"{path} must be YAML; got characters that it does not allow.") from None
    except RecursionError:
        raise too_deep(str(path)) from None
    except (ValueError, TypeError):  # days that no month has, digits by thousands, names that are lists
        raise FileError(f"{path} must have plain names and numbers that can be; got another.") from None
    check_tree(found, str(path))
    return found
