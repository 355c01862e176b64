"""Cost of a creep law as compiled C: value, and value with exact derivatives, at the points of a table."""

import ctypes
import tempfile
from collections.abc import Callable
from functools import lru_cache, partial
from pathlib import Path

import casadi as ca
import numpy as np

from bogie_braking.reporting.timing import least
from fmu_src.chain import Chain
from fmu_src.compile import FLAGS, OPTIMISE_GENERATED, library_suffix, objects_of, run
from fmu_src.equations import function_of
from fmu_src.equations_in_c import equations_in_c
from rbd_model.contact.creep.kalker import Kalker, kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch, CreepLaw

#: Columns of a point: creepages (xi_x, xi_y [1], xi_s [1/m]), load [N], friction, semi-axes a, b [m].
COLUMNS = 7
#: A vehicle needs the derivatives by the first four columns: creepages and load.
DIFFERENTIATED = 4
#: Shear modulus of steel [Pa].
SHEAR_MODULUS = 82e9
#: Calls per measurement, and number of measurements, of which the least counts; those of a quick run.
CALLS, REPEATS, QUICK = 40_000, 5, (1000, 1)

#: Calls a function at each point in turn, so that the compiler cannot predict any.
REPEAT = """
__attribute__((visibility("default")))
void repeat(int calls, int points, int columns, const double *given, double *found) {
    double *results[] = {found};
    for (int call = 0; call < calls; call++) {
        const double *arguments[] = {given + call % points * columns};
        law(arguments, results, 0, 0, 0);
    }
}
"""


def symbols() -> ca.SX:
    """Return a point, followed by Kalker's coefficients, which a vehicle takes from elsewhere."""
    return ca.SX.sym("point", COLUMNS + 3)


def forces(law: CreepLaw, point: ca.SX, chain: Chain) -> ca.SX:
    """Return (F_x, F_y) [N] of a law at a point of `symbols`; calls of the law's parts are links of the chain."""
    creepages, kalker = (point[0], point[1], point[2]), Kalker(point[7], point[8], point[9])
    axes, modulus = (point[5], point[6]), ca.SX(SHEAR_MODULUS)
    return ca.vertcat(*law(ContactPatch(creepages, point[3], point[4], axes, modulus, kalker, chain=chain)))


def with_coefficients(points: np.ndarray) -> np.ndarray:
    """Return the points with Kalker's coefficients of their ellipses, Poisson's ratio 0.25."""
    ratio = ca.SX.sym("ratio")
    kalker = kalker_coefficients(ratio)
    table = ca.Function("kalker", [ratio], [ca.vertcat(kalker.c11, kalker.c22, kalker.c23)])
    return np.column_stack([points, np.array(table.map(len(points))(points[:, 5] / points[:, 6])).T])


def values(law: CreepLaw, points: np.ndarray) -> np.ndarray:
    """Return forces (F_x, F_y) [N] by rows of points."""
    repeat, found = of_law(law), np.zeros((len(points), 2))
    for row, result in zip(np.ascontiguousarray(with_coefficients(points)), found, strict=True):
        repeat(1, 1, row.size, row.ctypes.data, result.ctypes.data)
    return found


@lru_cache
def of_law(law: CreepLaw) -> Callable[..., None]:
    """Return `repeat` of a law's forces; compiled once, since costly laws are evaluated several times."""
    point, chain = symbols(), Chain()
    return compiled(chain, forces(law, point, chain), point)


def cost(law: CreepLaw, points: np.ndarray, derivatives: bool, quick: bool = False) -> float:
    """Return the time of one call, on average over the points, the least of several measurements [s]."""
    point, chain = symbols(), Chain()
    result = forces(law, point, chain)
    if derivatives:
        result = ca.vertcat(result, ca.vec(ca.densify(chain.jacobian(result, point[:DIFFERENTIATED]))))
    given = np.ascontiguousarray(with_coefficients(points))
    found = np.zeros(result.numel())
    repeat = compiled(chain, result, point)
    calls, repeats = QUICK if quick else (CALLS, REPEATS)
    arguments = (len(given), given.shape[1], given.ctypes.data, found.ctypes.data)
    return least(partial(repeat, calls, *arguments), repeats) / calls


def compiled(chain: Chain, result: ca.SX, point: ca.SX) -> Callable[..., None]:
    """Return `repeat` of C that is generated and optimised as the project's own equations."""
    files = equations_in_c("law", {"law": function_of(chain, "law", [result], [point])})
    files["equations_law.c"] += REPEAT
    with tempfile.TemporaryDirectory() as folder:
        objects = objects_of(files, [*FLAGS, OPTIMISE_GENERATED])
        library = f"law{library_suffix()}"
        run([*FLAGS, OPTIMISE_GENERATED, "-shared", "-o", library, *map(str, objects), "-lm"], None, Path(folder))
        repeat = ctypes.CDLL(str(Path(folder) / library)).repeat
    repeat.restype = None
    repeat.argtypes = [*[ctypes.c_int] * 3, *[ctypes.c_void_p] * 2]
    return repeat
