"""Polach's creep forces (eqs 3.89-3.105) against Kalker's exact theory: the error of the fast law."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, LINES, THREE, plt, titled
from bogie_braking.reporting.report import Report, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.polach import polach

#: One contact: semi-axes [m], load [N], friction, shear modulus [Pa].
SEMI_AXES, LOAD, FRICTION, SHEAR_MODULUS = (6e-3, 5e-3), 80e3, 0.3, 82e9
#: Kalker's exact theory as CONTACT v25.2 computes it (61 x 61 elements) for this contact, Poisson's ratio 0.25:
#: creepages xi_x, xi_y, spin [1/m], and forces F_x, F_y [N].
EXACT = np.array(
    [
        (0.0001, 0.0, 0.0, -1062, 0),
        (0.001, 0.0, 0.0, -9343, 0),
        (0.003, 0.0, 0.0, -20450, 0),
        (0.01, 0.0, 0.0, -24000, 0),
        (0.0, 0.0005, 0.0, 0, -4596),
        (0.0, 0.002, 0.0, 0, -14960),
        (0.0, 0.006, 0.0, 0, -23970),
        (0.0, 0.0, 0.1176, 0, -2699),
        (0.0, 0.0, 1.0, 0, -15650),
        (0.0, -0.0005, 0.1176, 0, 1853),
        (0.0, -0.001, 0.1176, 0, 5950),
        (0.0, -0.002, 0.1176, 0, 12660),
        (0.0, -0.0005, 0.5, 0, -6588),
        (0.0, -0.001, 0.5, 0, -2659),
        (0.0, -0.002, 0.5, 0, 4432),
        (0.0, -0.0005, 1.0, 0, -13760),
        (0.0, -0.001, 1.0, 0, -11240),
        (0.0, -0.002, 1.0, 0, -5110),
        (0.003, 0.0015, 0.1176, -19040, -10760),
        (0.001, 0.0005, 1.0, -4765, -16750),
    ]
)
#: Tolerance of every law alike, as in `creep-laws` [% of mu N].
BAND = 5.0
SPINS = (0.1176, 0.5, 1.0)


def forces(creepages: np.ndarray) -> np.ndarray:
    """Return F_x, F_y [N] for rows of creepages (xi_x, xi_y, spin)."""
    symbols = ca.SX.sym("creepages", 3)
    axes = (ca.SX(SEMI_AXES[0]), ca.SX(SEMI_AXES[1]))
    kalker = kalker_coefficients(axes[0] / axes[1])
    parts = (symbols[0], symbols[1], symbols[2])
    law = polach(ContactPatch(parts, ca.SX(LOAD), ca.SX(FRICTION), axes, ca.SX(SHEAR_MODULUS), kalker))
    return np.array(ca.Function("law", [symbols], [ca.vertcat(*law)]).map(len(creepages))(creepages.T)).T


def distance_from_exact() -> np.ndarray:
    """Return the distance of the force vectors from the exact ones for each row of EXACT [% of mu N]."""
    off = forces(EXACT[:, :3]) - EXACT[:, 3:]
    return np.asarray(100 * np.hypot(off[:, 0], off[:, 1]) / (FRICTION * LOAD))


def run(options: Options, quick: bool = False) -> Report:
    distance = distance_from_exact()
    with_spin = EXACT[:, 2] != 0
    source = "Kalker's exact theory (CONTACT v25.2)"
    rows = []
    for name, chosen, assumption in (
        ("pure longitudinal creepage", ~with_spin & (EXACT[:, 1] == 0), ""),
        ("pure lateral creepage", ~with_spin & (EXACT[:, 0] == 0), ""),
        ("with spin", with_spin, "Polach's own limit, largest where spin works against the creepage"),
    ):
        quantity = f"largest distance from exact theory, {name}"
        rows.append(measured(quantity, "% of mu N", distance[chosen].max(), source, at_most(BAND), assumption))
    series = Recording({"creepage": "1"}, [[c] for c in np.linspace(0.0, 0.01, 201)])
    creepage = series["creepage"]
    zero = np.zeros_like(creepage)
    series.add("force_longitudinal", "N", forces(np.column_stack([creepage, zero, zero]))[:, 0])
    for spin in (0.0, *SPINS):
        series.add(f"force_lateral_spin_{spin}", "N", forces(np.column_stack([zero, -creepage, zero + spin]))[:, 1])
    parameters = {
        "semi_axes": SEMI_AXES,
        "load": LOAD,
        "friction": FRICTION,
        "shear_modulus": SHEAR_MODULUS,
        "exact": EXACT.tolist(),
    }
    return Report(rows, series, lambda: draw(series), parameters, 0.0)


def draw(series: Recording) -> Figure:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.4))
    scale = FRICTION * LOAD
    creepage = 1e3 * series["creepage"]
    left.plot(creepage, -series["force_longitudinal"] / scale, color=LEADING, label="longitudinal")
    left.plot(creepage, series["force_lateral_spin_0.0"] / scale, "--", color=BOGIE, label="lateral")
    plain = EXACT[EXACT[:, 2] == 0]
    left.plot(1e3 * plain[:4, 0], -plain[:4, 3] / scale, "o", color=LEADING)
    left.plot(1e3 * plain[4:, 1], -plain[4:, 4] / scale, "s", color=BOGIE)
    left.set_title("without spin: creep force over mu N; points: exact")
    for spin, line, marker, colour in zip(SPINS, LINES, "os^", THREE, strict=False):
        force = series[f"force_lateral_spin_{spin}"] / scale
        right.plot(creepage, force, line, color=colour, label=f"spin {spin} 1/m")
        exact = EXACT[(EXACT[:, 2] == spin) & (EXACT[:, 0] == 0)]
        right.plot(-1e3 * exact[:, 1], exact[:, 4] / scale, marker, color=colour)
    right.set(title="lateral force over mu N, spin against the creepage", xlim=(0, 4))
    for axis in (left, right):
        axis.set_xlabel("creepage [1/1000]")
        axis.legend(loc="lower right")
    distance, with_spin = distance_from_exact(), EXACT[:, 2] != 0
    plain, spun = float(distance[~with_spin].max()), float(distance[with_spin].max())
    return titled(figure, f"Polach's law is {plain:.0f}% off exact theory, with spin {spun:.0f}% off")


SCENARIO = Scenario("creep-forces", "Polach's creep law against Kalker's exact theory, with and without spin", run)
