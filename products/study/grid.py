"""From --vary to a grid of points: every combination of the given values, the first parameter varying slowest."""

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product

from fmu_src.suggestion import suggestion
from readers.text import BadInputError

#: Values of each varied parameter, in the order of the command line.
Grid = Mapping[str, Sequence[float]]
#: Most points of a sweep.
LARGEST_GRID = 1_000_000
FORMS = "write name=first:last:count or name=a,b,c"


def grid_of(texts: Sequence[str], parameters: Mapping[str, str], scenario: str) -> Grid:
    """The grid of all --vary of a command; `parameters` are those of the scenario. Raises BadInputError."""
    if not texts:
        raise BadInputError(f"--vary must be given; got none: {FORMS}; {scenario} has {', '.join(parameters)}.")
    grid: dict[str, list[float]] = {}
    for text in texts:
        name, equals, values = text.partition("=")
        if not (name and equals):
            raise BadInputError(f"--vary {text} cannot be read; {FORMS}.")
        if name not in parameters:
            advice = suggestion(name, parameters, f"it has {', '.join(parameters)}.")
            raise BadInputError(f"{scenario} has no parameter {name} to vary; {advice}")
        if name in grid:
            raise BadInputError(f"{name} must be varied once; got --vary {text} as the second.")
        grid[name] = values_of(text, values)
    if (size := math.prod(map(len, grid.values()))) > LARGEST_GRID:
        raise BadInputError(f"The grid must have at most {LARGEST_GRID} points; got {size}.")
    return grid


def values_of(text: str, values: str) -> list[float]:
    """Return the values of one --vary; `text` is all of it, for the message."""
    if ":" not in values:
        found = [number(text, part) for part in values.split(",")]
        if len(set(found)) < len(found):
            raise BadInputError(f"Each value must be given once; got --vary {text}, which repeats one.")
        return found
    parts = values.split(":")
    if len(parts) != 3:
        raise BadInputError(f"--vary {text} cannot be read; {FORMS}.")
    first, last = number(text, parts[0]), number(text, parts[1])
    try:
        count = int(parts[2])
    except ValueError:
        raise BadInputError(f"--vary {text} must have an integer as its count; got '{parts[2]}'.") from None
    if not 1 <= count <= LARGEST_GRID:
        raise BadInputError(f"--vary {text} must have a count from 1 to {LARGEST_GRID}; got {count}.")
    if count > 1 and first == last:
        raise BadInputError(f"Each value must be given once; got --vary {text}, which begins where it ends.")
    return evenly_spaced(first, last, count)


def number(text: str, part: str) -> float:
    """A finite number of one --vary."""
    try:
        found = float(part)
    except ValueError:
        raise BadInputError(f"--vary {text} cannot be read: '{part}' is not a number; {FORMS}.") from None
    if not math.isfinite(found):
        raise BadInputError(f"--vary {text} needs finite numbers: {part} is not.")
    return found


def evenly_spaced(first: float, last: float, count: int) -> list[float]:
    """Return equally spaced values from first to last; the first alone for a count of 1."""
    # As decimals, so that 0:0.3:4 holds 0.1 and 0.2 and not their neighbours.
    begin, end = Fraction(repr(first)), Fraction(repr(last))
    return [float(begin + (end - begin) * Fraction(i, max(1, count - 1))) for i in range(count)]


def points_of(grid: Grid) -> list[dict[str, float]]:
    """Return all points by parameter name, in the order of the table."""
    return [dict(zip(grid, values, strict=True)) for values in product(*grid.values())]
