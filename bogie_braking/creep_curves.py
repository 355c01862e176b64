"""Curves of the creep force over creepage, of any creep law."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from bogie_braking.checks import known, number, shown, whole
from bogie_braking.machines import law_named
from bogie_braking.simulation import run
from fmu_src.cosimulation.recording import Recording
from rbd_model.contact.creep.kalker import checked_ratio
from rbd_model.contact.creep.laws import DEFAULT_LAW, LAWS
from rbd_model.contact.creep_curve import CREEPAGES, creeping_patch
from rbd_model.contact.depth import DEFAULT_LAWS
from rbd_model.contact.hertz import POISSON_RATIO

#: Contact model whose law is the default; largest creepage [1] or [1/m]; largest number of rows.
MODEL, LARGEST, MOST_ROWS = 2, 10.0, 1_000_000


def creep_curve(
    law: str | Callable[..., Any] = DEFAULT_LAW,
    largest: float = 0.05,
    over: str = "creepage_along",
    rows: int = 201,
    poisson_ratio: float = POISSON_RATIO,
    **values: float,
) -> Recording:
    """Return the creep force of one wheel over one of its creepages, from 0 on.

    Parameters
    ----------
    law : str or function
        Name of a creep law or a function of a `ContactPatch`, as `creep_law` of `run`. "default" is that of contact
        model 2.
    largest : float
        Largest creepage [1], or spin [1/m]. It is negative for the other direction.
    over : str
        The creepage that changes. It is "creepage_along", "creepage_aside" or "creepage_spin".
    rows : int
        Number of rows.
    poisson_ratio : float
        Poisson's ratio of wheel and rail. That of steel is 0.28.
    **values
        The other creepages, by default 0, and by name in SI units: `normal_force` (100 kN), `friction` (0.3), `speed`
        (20 m/s), `wheel_radius` (0.46 m), `rail_head_radius` (0.3 m), `shear_modulus`. A rail whose friction falls has
        `friction_ratio`, `friction_decay`, `adhesion_reduction` and `slip_reduction`.

    Returns
    -------
    Recording
        The creepage, then `creep_force_along`, `creep_force_aside` [N] on the wheel and `adhesion`, the size of the
        force over the normal force [1].

    Raises
    ------
    KeyError
        If `over` is not a creepage.
    ValueError
        If the law is unknown, or a number is not in its range.
    SimulationError
        If the name or the value of a parameter is invalid.
    """
    known(over, CREEPAGES, "creepage")
    if not 0.0 < abs(number(largest)) <= LARGEST:
        raise ValueError(f"largest must be a creepage up to {LARGEST:g}, and not 0; got {shown(largest)}.")
    if whole("the number of rows", rows, 2) > MOST_ROWS:
        raise ValueError(f"The number of rows must be at most {MOST_ROWS}; got {rows}.")
    name = law_named(law)
    equations = DEFAULT_LAWS[MODEL] if name == DEFAULT_LAW else LAWS[name]
    if over in values:
        raise ValueError(f"{over} must be given as largest; got {shown(values[over])} too. Leave it out.")
    system = creeping_patch(equations, checked_ratio(poisson_ratio), over)
    names = ["creepage", "creep_force_along", "creep_force_aside", "adhesion"]
    found = run(system, 1.0, None, names, 1.0 / (rows - 1), **values, **{over: float(largest)})
    units = {over if column == "creepage" else column: found.units[column] for column in names}
    return Recording(units, np.column_stack([found[column] for column in names]))
