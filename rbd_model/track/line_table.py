"""The line as a table file: its columns with units and limits, and the values that models look up, declared once.

Between rows all values are linear. Corners at rows are rounded (fmu_src/runtime/table_pieces.c). Integrals along the
line are computed in line.c.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fmu_src.symbols import ca
from fmu_src.system import System, Variable
from fmu_src.user_files import TableFile, TablePiece
from readers.columns import Column

#: Distance of the rails' heads over which cant is measured, EN 13803 [m]: its angle is asin(cant / GAUGE).
GAUGE = 1.5
#: Length on either side of a row over which a corner is rounded [m], so that the values are smooth for an integrator;
#: assumed (the stiffness of rails has about this effect).
ROUNDING = 1.0
#: Largest turn between two rows [rad], between which the plan is a quintic; rows are added between rows of a file that
#: are further apart. The quintic deviates from an arc by the radius times the sixth power of the turn over 46080: 0.3
#: um where a curve of 50 m has rows every 12.5 m. Largest turn between two rows of a file [rad], that of a loop.
LARGEST_TURN, WHOLE_TURN = 0.25, 6.3
#: Number of rows in the shortest feature of a line that steps resolve.
RESOLVING_ROWS = 8.0
#: Least change of gradient [1], curvature [1/m] or factor on friction [1] relative to a straight line that makes a row
#: a corner: 1e-6 m/s2.
LEAST_CORNER = 1e-7
#: Largest share of the distance to a corner in one step, because no step lets a speed grow by more than half
#: (`follow_creep`).
SHARE_TO_CORNER = 0.8
#: Limits: the tightest curve is that of a depot, 50 m; cant by EN 13803 is at most 0.18 m; the steepest rack railway
#: rises by 0.48.
COLUMNS = (
    Column("distance", "m", -1e7, 1e7, required=True),
    Column("curvature", "1/m", -0.02, 0.02, required=True),
    Column("cant", "m", -0.3, 0.3, required=True),
    Column("gradient", "1", -0.5, 0.5, required=True),
    Column("gauge_widening", "m", -0.02, 0.1),
    Column("left_lateral", "m", -0.1, 0.1),
    Column("left_vertical", "m", -0.1, 0.1),
    Column("right_lateral", "m", -0.1, 0.1),
    Column("right_vertical", "m", -0.1, 0.1),
    Column("left_friction", "1", 0.0, 10.0),
    Column("right_friction", "1", 0.0, 10.0),
)
#: The values that models look up. A place in the plan, and the distance in the plan, are whole metres (`_far`) and a
#: rest.
PIECES = (
    TablePiece("heading", "rad", 4),  # to the left
    TablePiece("cant", "1", 5),  # sine of the track's roll: negative where the right rail is the higher one
    TablePiece("rise", "m", 4, goes_on=True),
    TablePiece("ahead", "m", 5, goes_on=True),  # along the first heading
    TablePiece("ahead_far", "m", 0),
    TablePiece("aside", "m", 5, goes_on=True),  # to the left of it
    TablePiece("aside_far", "m", 0),
    TablePiece("level", "m", 5, goes_on=True),  # the distance in the plan
    TablePiece("level_far", "m", 0),
    TablePiece("lateral", "m", 5),  # of both rails, the mean
    TablePiece("spread", "m", 5),  # of each rail, outwards
    TablePiece("left", "m", 5),  # height of the left rail
    TablePiece("right", "m", 5),
    TablePiece("left_friction", "1", 1),  # factor
    TablePiece("right_friction", "1", 1),
    TablePiece("friction", "1", 1),  # the mean of both
    TablePiece(
        "corner_before", "m", 0
    ),  # place of the corner of gradient, curvature or friction behind, and of that ahead
    TablePiece("corner_behind", "m", 0),
    TablePiece("half_stretch", "m", 0),  # half of the shortest way between two corners: here, before and behind
    TablePiece("shortest", "m", 0),  # length of the shortest thing that steps resolve
)
SOURCE = f"""static const double GAUGE = {GAUGE}, ROUNDING = {ROUNDING}, LARGEST_TURN = {LARGEST_TURN};
static const double WHOLE_TURN = {WHOLE_TURN}, RESOLVING_ROWS = {RESOLVING_ROWS}, LEAST_CORNER = {LEAST_CORNER};
{(Path(__file__).parent / "line.c").read_text(encoding="utf-8")}"""

LINE = TableFile(
    Variable(
        "line_file",
        "parameter",
        "1",
        "Path of a file with the line (docs/line.md), read when it is set; empty: line.csv in the resources of the FMU "
        "where there is one, else straight and level track",
        kind="string",
    ),
    noun="line",
    preposition="on",
    resource="line.csv",
    columns=COLUMNS,
    least_growth=1e-3,
    rounding=ROUNDING,
    known="distance, curvature, cant, gradient, and where known gauge_widening and, behind left_ and right_, lateral, "
    "vertical, friction",
    added=(
        *("heading", "rise", "ahead", "ahead_far", "aside", "aside_far", "level", "level_far"),
        *("corner_before", "corner_behind", "half_stretch"),
    ),
    pieces=PIECES,
    source=SOURCE,
)


def along_line(system: System, name: str, distance: ca.SX, order: int = 0) -> list[ca.SX]:
    """Return the value of one of PIECES at a distance [m] on an instance's line, and its derivatives up to `order`."""
    return system.from_file(LINE, name, distance, order)


def mean_friction(system: System, distance: ca.SX) -> ca.SX:
    """Return the factor of a line on the friction of an axle [1] at a distance [m]: the mean of both rails.

    The force of two equally loaded wheels that slide is exactly that of this mean; Coulomb's law, end of (3.97).
    """
    return along_line(system, "friction", distance)[0]


def follow_line(system: System, distance: ca.SX, places: Sequence[ca.SX]) -> None:
    """Limit steps so that none passes a corner of gradient, curvature or friction.

    No step is longer than half of the distance between two corners.

    A step under a constant force may have any length, and none of its stages would meet a hill of some metres
    (section 2.3.1: gravity pulls along the gradient).

    Takes distance [m], places [m].
    """
    ways = []
    for place in places:
        before, behind, half = (
            along_line(system, name, place)[0] for name in ("corner_before", "corner_behind", "half_stretch")
        )
        ways.append(half + SHARE_TO_CORNER * ca.fmin(ca.fabs(place - before), ca.fabs(behind - place)))
    system.limit_change(ca.mmin(ca.vertcat(*ways)), distance)
