"""A table of another creep law, or of exact theory: what took microseconds costs a look-up among its values.

By similarity the forces of an elliptical patch over mu N follow from four numbers alone, Kalker (1990):
those of `Measures`, with a/b for one of the two of spin.
"""

import hashlib
import math
from dataclasses import dataclass, replace
from pathlib import Path

import casadi as ca
import numpy as np
from scipy.linalg import solve_banded

from fmu_src.chain import Part, part_in_c
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch, CreepLaw
from readers.tables import Column, TableError, read_table

#: Intervals along each coordinate of `place_in_table`, its first values and its last; a/b from 1 : 20 to 20 : 1.
INTERVALS = (12, 24, 14, 8)
FIRST, LAST = (0.0, -1.0, 0.0, -math.log(20.0)), (1.0, 1.0, 1.0, math.log(20.0))
#: Spin in the middle of the table, that from which creepage has to be larger to make the patch slide, both as in
#: `Measures`, chosen so that tables err least between their places; and what stands for infinite ones.
MIDDLE_SPIN, SLIDING_SPIN, INFINITE = 4.0, 1.0, 1 - 1e-6
#: How far a row of a file may be from its place, in intervals: the digits of a number that is written.
OFF_PLACE = 1e-4
COLUMNS = ("longitudinal", "lateral", "spin", "log_axis_ratio", "force_longitudinal", "force_lateral")


@dataclass(frozen=True)
class CreepTable:
    """Forces over mu N at all places of the table, shape (15, 27, 17, 11, 2): see INTERVALS; one row beyond each end.

    Raises ValueError for another shape and where one is no number.
    """

    forces: np.ndarray

    def __post_init__(self) -> None:
        wanted = (*(count + 3 for count in INTERVALS), 2)
        if self.forces.shape != wanted or not np.all(np.isfinite(self.forces)):
            raise ValueError(f"A creep table has {wanted} finite forces; there were {self.forces.shape}.")


@dataclass(frozen=True)
class Measures:
    """What the creepages of a patch ask for: linear forces over mu N, from longitudinal creepage (u), lateral (v), and
    from creepages as large as those that spin makes at the ends of the semi-axes, ahead (w_x) and to the side (w_y).
    """

    u: ca.SX
    v: ca.SX
    w_x: ca.SX
    w_y: ca.SX

    @property
    def spin(self) -> ca.SX:
        """Of both together."""
        return ca.sqrt(self.w_x**2 + self.w_y**2)


def measures(patch: ContactPatch) -> Measures:
    """Of a patch, Kalker (1990); less where a contaminated surface is less steep."""
    (a, b), (x, y, spin), kalker = patch.semi_axes, patch.creepages, patch.kalker
    strain = patch.reduction.adhesion * patch.shear_modulus * a * b / (patch.friction * patch.load)
    ahead, aside = strain * kalker.c11, strain * kalker.c22
    return Measures(ahead * x, aside * y, ahead * spin * b, aside * spin * a)


def place_in_table(found: Measures) -> ca.SX:
    """Coordinates of a patch with u, w >= 0: from no creepage to infinite ones, and where spin is large by the ratio to
    it, which is what counts then; Kalker (1990).
    """
    ahead, aside = found.u / larger_by(found.w_x), found.v / larger_by(found.w_y)
    size = ca.sqrt(1 + ahead**2 + aside**2)
    return ca.vertcat(ahead / size, aside / size, found.spin / (MIDDLE_SPIN + found.spin))


def larger_by(spin: ca.SX) -> ca.SX:
    """By how much more creepage it takes to slide against spin: our own form, in proportion where spin is large."""
    return ca.sqrt(1 + (spin / SLIDING_SPIN) ** 2)


def patch_at(place: ca.SX) -> ContactPatch:
    """A patch with unit load, friction and size at a place of the table; forces of it are over mu N, Kalker (1990)."""
    stretch, kalker = ca.exp(place[3] / 2), kalker_coefficients(ca.exp(place[3]))
    axes = (stretch, 1 / stretch)
    whole = MIDDLE_SPIN * place[2] / (1 - ca.fabs(place[2]))
    spin = whole / ca.sqrt((kalker.c11 * axes[1]) ** 2 + (kalker.c22 * axes[0]) ** 2)
    # Creepages lie within a circle, at whose edge they are infinite; beyond it nothing changes any more.
    size = ca.sqrt(place[0] ** 2 + place[1] ** 2)
    within = INFINITE / ca.fmax(size, INFINITE)
    u, v = (within * place[i] / ca.sqrt(1 - (within * size) ** 2) for i in (0, 1))
    u, v = u * larger_by(kalker.c11 * spin * axes[1]), v * larger_by(kalker.c22 * spin * axes[0])
    creepages = (u / kalker.c11, v / kalker.c22, spin)
    return ContactPatch(creepages, ca.SX(1.0), ca.SX(1.0), axes, ca.SX(1.0), kalker)


def axes() -> list[np.ndarray]:
    """The coordinates of the table's places, one beyond each end."""
    return [
        first + (last - first) / count * np.arange(-1, count + 2)
        for first, last, count in zip(FIRST, LAST, INTERVALS, strict=True)
    ]


def table_of(law: CreepLaw) -> CreepTable:
    """The table of a law, Kalker (1990)."""
    places = axes()
    inside = [*(np.clip(place, -INFINITE, INFINITE) for place in places[:3]), np.clip(places[3], FIRST[3], LAST[3])]
    grid = np.stack([one.ravel() for one in np.meshgrid(*inside, indexing="ij")])
    place = ca.SX.sym("place", len(places))
    function = ca.Function("law", [place], [ca.vertcat(*law(patch_at(place)))])
    forces = np.array(function.map(grid.shape[1])(grid)).T.reshape(*(place.size for place in places), 2)
    return continued(forces)


def continued(forces: np.ndarray) -> CreepTable:
    """The table of forces whose outermost rows are open: beyond an end as a straight line goes on; where the creepage
    ahead or the spin is 0 they are known, since the patch is mirrored there, Kalker (1990).
    """
    for axis, first in enumerate(FIRST):
        along = np.moveaxis(forces, axis, 0)
        along[-1] = 2 * along[-2] - along[-3]
        if first < 0.0:
            along[0] = 2 * along[1] - along[2]
    return CreepTable(forces)


def coefficients(table: CreepTable) -> np.ndarray:
    """Of the quadratic splines through the forces, one coordinate after the other, de Boor (1978), chapter XIII."""
    found = table.forces
    for axis in range(len(INTERVALS)):
        count = found.shape[axis]
        bands = np.array([[0.125] * count, [0.75] * count, [0.125] * count])
        # The outermost, which lie beyond the table, are the forces there.
        bands[1, [0, -1]], bands[0, 1], bands[2, -2] = 1.0, 0.0, 0.0
        along = np.moveaxis(found, axis, 0)
        solved = solve_banded((1, 1), bands, along.reshape(count, -1)).reshape(along.shape)
        found = np.moveaxis(solved, 0, axis)
    return found


def tabulated(table: CreepTable) -> CreepLaw:
    """The law of a table, Kalker (1990): splines through its forces, with exact derivatives.

    The mirror images of a patch, ahead and behind, left and right, do what it does. What a contaminated surface leaves
    of the gradient in the area of slip is not known to it.
    """
    part = part_of(table)

    def law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        (a, b), limit, found = patch.semi_axes, patch.friction * patch.load, measures(patch)
        ahead, turn = ca.if_else(found.u < 0, -1, 1), ca.if_else(found.w_x < 0, -1, 1)
        place = place_in_table(replace(found, u=ahead * found.u, v=turn * found.v))
        forces = patch.chain.call(part, ca.vertcat(place, ca.log(a / b)), ca.SX(0, 1))
        return limit * ahead * forces[0], limit * turn * forces[1]

    return law


def part_of(table: CreepTable) -> Part:
    """Forces over mu N at a place of the table as a part in C; see table.c."""
    values = coefficients(table).astype(np.float32)
    name = f"creep_table_{hashlib.sha256(values.tobytes()).hexdigest()[:8]}"
    widths = [(last - first) / count for first, last, count in zip(FIRST, LAST, INTERVALS, strict=True)]
    rows = [", ".join(map(str, INTERVALS)), *(", ".join(repr(float(x)) for x in row) for row in (FIRST, widths))]
    own = f"""
static const float {name}_coefficient[] = {{{", ".join(f"{value:.6e}f" for value in values.ravel())}}};
static void {name}(const double *arguments, const double *constants, double *results, double *slopes) {{
    static const four_way_table TABLE = {{{", ".join("{" + row + "}" for row in rows)}, {name}_coefficient}};
    look_up(&TABLE, arguments, results, slopes);
    (void)constants;
}}
"""
    common = (Path(__file__).parent / "table.c").read_text(encoding="utf-8")
    return part_in_c(name, (len(INTERVALS), 0, 2), own, common)


def read_creep_table(path: Path) -> CreepTable:
    """Return a table from a file of COLUMNS, in any order of rows.

    Raises
    ------
    FileError
        If the file cannot be read as it is meant, a row is at no place of the table, at that of another row, or places
        are missing.
    """
    read = read_table(path, [Column(name, required=True) for name in COLUMNS])
    rows = np.column_stack([read.numbers[name] for name in COLUMNS])
    places = axes()
    away = [(row - place[0]) / (place[1] - place[0]) for row, place in zip(rows.T, places, strict=False)]
    for name, one, place in zip(COLUMNS, away, places, strict=False):
        whole = np.rint(one)
        off = np.flatnonzero((np.abs(one - whole) > OFF_PLACE) | (whole < 0) | (whole >= place.size))
        if off.size:
            row = int(off[0])
            text = f"the value must be at a place of the creep table; got {read.numbers[name][row]:g}"
            raise read.refusal(row, name, f"{text}. Give those places that write_table writes.")
    index = tuple(np.rint(one).astype(int) for one in away)
    shape = tuple(place.size for place in places)
    flat = np.ravel_multi_index(index, shape)
    first = np.unique(flat, return_index=True)[1]
    if first.size < flat.size:
        row = int(np.setdiff1d(np.arange(flat.size), first)[0])
        text = "a place of the creep table must be there once; it is there twice. Remove one."
        raise read.refusal(row, COLUMNS[0], text)
    values = np.full((*shape, 2), np.nan)
    values[index] = rows[:, 4:]
    missing = int(np.sum(np.isnan(values[..., 0])))
    if missing:
        all_places = f"all {values[..., 0].size} places of the creep table"
        raise TableError(f"{path} must have {all_places}; {missing} are missing. Add them.")
    return CreepTable(values)


def write_table(table: CreepTable, path: Path) -> None:
    """The table as a CSV file of COLUMNS, for `read_creep_table`: to be filled by another program, CONTACT for one."""
    grid = np.stack([one.ravel() for one in np.meshgrid(*axes(), indexing="ij")], axis=1)
    np.savetxt(
        path,
        np.column_stack([grid, table.forces.reshape(-1, 2)]),
        delimiter=",",
        header=",".join(COLUMNS),
        comments="",
        fmt="%.8g",
    )
