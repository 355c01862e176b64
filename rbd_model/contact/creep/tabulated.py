"""A table of another creep law, or of exact theory: a law that takes microseconds is replaced by interpolation.

By similarity the forces of an elliptical patch over mu N follow from four numbers alone, Kalker (1990): those of
`Measures`, with a/b for one of the two of spin.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.linalg import solve_banded

from fmu_src.chain import Part, part_in_c
from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch, CreepLaw
from readers.columns import Column, TableError
from readers.tables import read_table

#: Intervals along each coordinate of `place_in_table`, its first values and its last; a/b from 1 : 20 to 20 : 1.
INTERVALS = (12, 24, 14, 8)
FIRST, LAST = (0.0, -1.0, 0.0, -math.log(20.0)), (1.0, 1.0, 1.0, math.log(20.0))
#: Spin in the middle of the table, and spin from which creepage must be larger to make the patch slide. Both are as in
#: `Measures`, chosen with FASTSIM for the smallest error between the table's places. The third is the place of infinite
#: values.
MIDDLE_SPIN, SLIDING_SPIN, INFINITE = 6.0, 1.5, 1 - 1e-6
#: Largest distance of a row of a file from its place, in intervals, because written numbers are rounded.
OFF_PLACE = 1e-4
COLUMNS = ("ahead", "aside", "spin", "log_axis_ratio", "force_ahead", "force_aside")


@dataclass(frozen=True)
class CreepTable:
    """Forces over mu N at all places of the table, shape (15, 27, 17, 11, 2): see INTERVALS; one row beyond each end.

    Raises
    ------
    ValueError
        If the shape is another one, or a force is not a number.
    """

    forces: np.ndarray

    def __post_init__(self) -> None:
        wanted = (*(count + 3 for count in INTERVALS), 2)
        if self.forces.shape != wanted or not np.all(np.isfinite(self.forces)):
            raise ValueError(f"A creep table has {wanted} finite forces; there were {self.forces.shape}.")


@dataclass(frozen=True)
class Measures:
    """Linear forces over mu N of a patch, from longitudinal creepage (u) and lateral creepage (v).

    `w_x` (ahead) and `w_y` (to the side) are the linear forces from creepages as large as those of the spin at the ends
    of the semi-axes.
    """

    u: ca.SX
    v: ca.SX
    w_x: ca.SX
    w_y: ca.SX

    @property
    def spin(self) -> ca.SX:
        """The norm of both forces from spin."""
        return ca.sqrt(self.w_x**2 + self.w_y**2)


def measures(patch: ContactPatch) -> Measures:
    """Return the measures of a patch, Kalker (1990). They are smaller if contamination reduces the slope of its law."""
    (a, b), (x, y, spin), kalker = patch.semi_axes, patch.creepages, patch.kalker
    strain = patch.reduction.adhesion * patch.shear_modulus * a * b / (patch.friction * patch.load)
    ahead, aside = strain * kalker.c11, strain * kalker.c22
    return Measures(ahead * x, aside * y, ahead * spin * b, aside * spin * a)


def place_in_table(found: Measures) -> ca.SX:
    """Return the coordinates of a patch with u, w >= 0: from no creepage to infinite ones, Kalker (1990).

    If spin is large, they depend on the ratio of creepage to spin, which then determines the forces. The spin in that
    ratio is the total one: on a long ellipse that of its ends turns the sliding everywhere, so that it also reduces the
    force ahead.
    """
    larger = larger_by(found.spin)
    ahead, aside = found.u / larger, found.v / larger
    size = ca.sqrt(1 + ahead**2 + aside**2)
    return ca.vertcat(ahead / size, aside / size, found.spin / (MIDDLE_SPIN + found.spin))


def larger_by(spin: ca.SX) -> ca.SX:
    """Return the additional creepage at which a patch with this spin slides: our own form, proportional to large
    spin.
    """
    return ca.sqrt(1 + (spin / SLIDING_SPIN) ** 2)


def patch_at(place: ca.SX) -> ContactPatch:
    """Return a patch with unit load, friction and size at a place of the table.

    Its forces are over mu N, Kalker (1990).
    """
    stretch, kalker = ca.exp(place[3] / 2), kalker_coefficients(ca.exp(place[3]))
    axes = (stretch, 1 / stretch)
    whole = MIDDLE_SPIN * place[2] / (1 - ca.fabs(place[2]))
    spin = whole / ca.sqrt((kalker.c11 * axes[1]) ** 2 + (kalker.c22 * axes[0]) ** 2)
    # Creepages lie within a circle, at whose edge they are infinite. Beyond it the forces are constant.
    size = ca.sqrt(place[0] ** 2 + place[1] ** 2)
    within = INFINITE / ca.fmax(size, INFINITE)
    u, v = (within * place[i] / ca.sqrt(1 - (within * size) ** 2) for i in (0, 1))
    larger = larger_by(ca.fabs(whole))
    creepages = (larger * u / kalker.c11, larger * v / kalker.c22, spin)
    return ContactPatch(creepages, ca.SX(1.0), ca.SX(1.0), axes, ca.SX(1.0), kalker)


def axes() -> list[np.ndarray]:
    """Return the coordinates of the table's places, one beyond each end."""
    return [
        first + (last - first) / count * np.arange(-1, count + 2)
        for first, last, count in zip(FIRST, LAST, INTERVALS, strict=True)
    ]


def table_of(law: CreepLaw) -> CreepTable:
    """Return the table of a law, Kalker (1990)."""
    places = axes()
    inside = [*(np.clip(place, -INFINITE, INFINITE) for place in places[:3]), np.clip(places[3], FIRST[3], LAST[3])]
    grid = np.stack([one.ravel() for one in np.meshgrid(*inside, indexing="ij")])
    place = ca.SX.sym("place", len(places))
    function = ca.Function("law", [place], [ca.vertcat(*law(patch_at(place)))])
    forces = np.array(function.map(grid.shape[1])(grid)).T.reshape(*(place.size for place in places), 2)
    return continued(forces)


def continued(forces: np.ndarray) -> CreepTable:
    """Return the table of forces whose outermost rows are undefined: linear extrapolation beyond an end.

    At zero creepage ahead or zero spin these rows are known, because the patch is mirrored there, Kalker (1990).
    """
    for axis, first in enumerate(FIRST):
        along = np.moveaxis(forces, axis, 0)
        along[-1] = 2 * along[-2] - along[-3]
        if first < 0.0:
            along[0] = 2 * along[1] - along[2]
    return CreepTable(forces)


def coefficients(table: CreepTable) -> np.ndarray:
    """Return the coefficients of quadratic splines through the forces, along each coordinate.

    de Boor (1978), chapter XIII.
    """
    found = table.forces
    for axis in range(len(INTERVALS)):
        count = found.shape[axis]
        bands = np.array([[0.125] * count, [0.75] * count, [0.125] * count])
        # The outermost coefficients, beyond the table, equal the forces there.
        bands[1, [0, -1]], bands[0, 1], bands[2, -2] = 1.0, 0.0, 0.0
        along = np.moveaxis(found, axis, 0)
        solved = solve_banded((1, 1), bands, along.reshape(count, -1)).reshape(along.shape)
        found = np.moveaxis(solved, 0, axis)
    return found


def tabulated(table: CreepTable) -> CreepLaw:
    """Return the law of a table, Kalker (1990): splines through its forces, with exact derivatives.

    A patch and its mirror images, ahead and behind, left and right, have the same forces. The law does not include the
    reduction of the gradient in the area of slip by contamination.
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
    """Return a part in C for the forces over mu N at a place of the table; see table.c."""
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
    """Return a table from a file of COLUMNS, in any order of rows."""
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
    """Write the table as a CSV file of COLUMNS for `read_creep_table`.

    Another program, such as CONTACT, may fill it.
    """
    grid = np.stack([one.ravel() for one in np.meshgrid(*axes(), indexing="ij")], axis=1)
    np.savetxt(
        path,
        np.column_stack([grid, table.forces.reshape(-1, 2)]),
        delimiter=",",
        header=",".join(COLUMNS),
        comments="",
        fmt="%.8g",
    )
