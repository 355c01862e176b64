"""The lines of the live page at level 3: straight, or a curve to the left, in the format of a line's file."""

from rbd_model.track.line import Line, arc, clothoid, line_of, straight

#: First place of lines, astern of the vehicle, and their length [m]; straight track and transition ahead of a curve
#: [m].
BEGIN, LENGTH, BEFORE, TRANSITION = -50.0, 4000.0, 80.0, 60.0
#: Cant [m] of the curves by radius [m], 0 for straight track; assumed.
CANTS = {0: 0.0, 1000: 0.06, 500: 0.10, 300: 0.12}


def line_for(radius: float, gradient: float = 0.0) -> Line:
    """Return the line with a radius of CANTS, on one gradient [1]."""
    if radius == 0:
        return line_of([straight(LENGTH, gradient)], BEGIN)
    before = straight(BEFORE, gradient)
    curve = arc(LENGTH, radius, CANTS[int(radius)], gradient)
    return line_of([before, clothoid(TRANSITION, before, curve), curve], BEGIN)


def rows_of(radius: float) -> list[str]:
    """Return the rows of its file without the last column, the gradient."""
    return line_for(radius).lines_of(("distance", "curvature", "cant"))
