"""Effect of the macro step when brake and bogie are coupled: error, a torque that chatters, feedback that grows."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bogie_braking.reporting.report import Report, Row, at_least, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.master import GAUSS_SEIDEL, JACOBI
from fmu_src.cosimulation.recording import Recording
from products.bogie import BOGIE, FULL_PRESSURE, FULL_TORQUE, brake_values
from scenarios.coupling import error as coupling_error
from scenarios.coupling import feedback_boundary, signed_torque
from scenarios.coupling.error import MASTERS
from scenarios.coupling.figure import draw
from scenarios.coupling.findings import Findings, find

#: Macro steps [s], evenly on a logarithmic axis.
STEPS = (1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 1e-1)
#: Those of a quick run: steps below 1 ms take most of the time and give no further information.
QUICK_STEPS = (1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 2.5e-2, 5e-2, 6e-2, 7.5e-2, 1e-1)
#: Macro step of the rows that compare one step with theory [s]: the usual one.
SHOWN = 1e-3
#: Macro step of the rows that compare the size of the error with theory [s]; larger, because extrapolation has small
#: errors.
SIZED = 5e-3


def error_rows(f: Findings, sized: float, shown: float) -> list[Row]:
    """Return the orders, the sizes, and the error at the usual master and macro step."""
    reference = "reference: one system, SciPy's Radau at 1e-10"
    rows = []
    for name, master in MASTERS.items():
        steps = sorted(f.errors[name])
        slope = coupling_error.order(steps, [f.errors[name][step].distance for step in steps])
        expected = 2.0 if master.extrapolated else 1.0
        quantity, asked = f"{name}: order of the stop distance", near(expected, 0.05)
        rows.append(measured(quantity, "1", slope, "theory", asked, reference))
    for name, master in MASTERS.items():
        size = f.errors[name][sized].distance / coupling_error.error_on_paper(master, sized, f.stop).distance
        source = f"theory: surplus of impulse, {1e3 * sized:g} ms"
        following = "next term: h over the cylinder's lag"
        rows.append(measured(f"{name}: error of distance over paper", "1", size, source, near(1.0, 0.02), following))
    name = "Gauss-Seidel, held"
    error, paper = f.errors[name][shown], coupling_error.error_on_paper(MASTERS[name], shown, f.stop)
    source = f"theory, macro step {1e3 * shown:g} ms"
    for quantity, unit in (("time", "ms"), ("distance", "mm"), ("speed", "mm/s")):
        expected, value = 1e3 * getattr(paper, quantity), 1e3 * getattr(error, quantity)
        place = f"after {coupling_error.MIDWAY:g} s" if quantity == "speed" else f"until {coupling_error.AT_REST:g} m/s"
        note = f"{place}; the suspension sways by some percent of the deceleration"
        asked = near(expected, 0.03 * abs(expected))
        rows.append(measured(f"{name}: error of {quantity}", unit, value, source, asked, note))
    return rows


def chatter_rows(f: Findings, shown: float) -> list[Row]:
    """Return the rows of rest: a capacity torque stops the wheels; a signed one never does, and jumps as far as theory
    predicts.
    """
    at = f"{1e3 * shown:g} ms"
    standing = max(one.standing for one in (*f.stops.values(), *f.skids.values()))
    rest = f.stops[shown].jump / signed_torque.jump_at_rest(shown)
    skid = f.skids[shown].jump / signed_torque.jump_in_skid(shown)
    width = f.width / signed_torque.width_on_paper(shown)
    # A force on the wheels of this share of the brake's makes rises rarer and falls more frequent: 1 - share^2 of the
    # jump remains. It moves tanh off its steepest point, so that 1 - share^2 of the slope remains.
    swaying = f.capacity.adhesion**2
    sways = f"{at}; the suspension still sways with {f.capacity.adhesion:.2f} of the brake force"
    held = "capacity: wheels at rest, share of the time"
    steps = "all macro steps"
    wide = near(1.0, swaying + signed_torque.WIDTH_RESOLUTION)
    creep = f"{at}; creep force not quite constant"
    return [
        measured(held, "1", f.capacity.standing, "a brake holds", at_least(1.0), at),
        measured("signed: wheels at rest, share of the time", "1", standing, "theory", at_most(0.0), steps),
        measured("signed, at rest: jump over h T r/(J + m r2)", "1", rest, "theory", near(1.0, swaying), sways),
        measured("signed, skid: jump over h T r/J", "1", skid, "theory", near(1.0, 0.02), creep),
        measured("smoothed sign: least width over h T/2(J + m r2)", "1", width, "theory: linear", wide, sways),
    ]


def boundary_rows(f: Findings) -> list[Row]:
    """Return the boundary over that of theory, farthest from 1 over all macro steps, for each method."""
    rows = []
    for method, found in f.found.items():
        ratios = [found[step] / f.paper[method][step] for step in found]
        farthest = max(ratios, key=lambda ratio: abs(ratio - 1.0))
        name = f"{method.title()}: boundary found over eigenvalues, farthest"
        theory = "theory: exact sampling of the linearised bogie and brake"
        words = f"all macro steps; bisection to {feedback_boundary.RESOLUTION}"
        rows.append(measured(name, "1", farthest, theory, near(1.0, 0.01), words))
    return rows


def remarks(f: Findings, shown: float) -> list[str]:
    least, largest = min(f.stops), max(f.stops)
    jumps = f"{1e3 * f.stops[least].jump:.2g} mm/s at {1e3 * least:g} ms, {1e3 * f.stops[shown].jump:.2g} mm/s"
    creep = BOGIE.wheel_radius * f.width * np.arctanh(0.5)
    kpa = feedback_boundary.pressure_per_slip(f.plant) / 1e5
    jacobi, gauss_seidel = f.found[JACOBI], f.found[GAUSS_SEIDEL]
    return [
        f"Signed torque: rims jump by {jumps} at {1e3 * shown:g} ms; at {1e3 * largest:g} ms the bogie rolls to and "
        f"fro at up to {1e3 * f.stops[largest].speed:.0f} mm/s. With the capacity it stands, with "
        f"{1e6 * f.capacity.speed:.1f} um/s of swaying left.",
        f"Smoothed to tanh(w/w_eps), the sign stands at {1e3 * shown:g} ms from w_eps = {f.width:.3f} rad/s on; but "
        f"pulled with half of the brake's torque, as on a gradient, the bogie then creeps at {1e3 * creep:.1f} mm/s.",
        f"Feedback of slip: from {1e3 * least:g} to {1e3 * largest:g} ms the gain that grows falls from "
        f"{jacobi[least]:.0f} to {jacobi[largest]:.2g} (Jacobi) and {gauss_seidel[least]:.0f} to "
        f"{gauss_seidel[largest]:.2g} (Gauss-Seidel); at {1e3 * shown:g} ms Gauss-Seidel bears "
        f"{gauss_seidel[shown] / jacobi[shown]:.1f} times as much. Gain 1 is {kpa:.0f} kPa per % of slip, creep in its "
        "linear range. "
        "Jacobi's limit drops above 65 ms, where the bogie's pitching (2 Hz) is what grows.",
    ]


def series_of(f: Findings) -> Recording:
    steps = sorted(f.stops)
    series = Recording({"macro_step": "s"}, [[step] for step in steps])

    def add(name: str, unit: str, values: dict[float, float]) -> None:
        series.add(name, unit, np.array([values.get(step, np.nan) for step in steps]))

    for name, errors in f.errors.items():
        for quantity, unit in (("time", "s"), ("distance", "m"), ("speed", "m/s")):
            add(f"error of {quantity} ({name})", unit, {step: getattr(e, quantity) for step, e in errors.items()})
    for place, chatters in (("at rest", f.stops), ("in a skid", f.skids)):
        add(f"jump {place}", "m/s", {step: one.jump for step, one in chatters.items()})
        add(f"largest speed backward {place}", "m/s", {step: one.backward for step, one in chatters.items()})
    for method in f.found:
        add(f"loop gain on paper ({method})", "1", f.paper[method])
        add(f"loop gain found ({method})", "1", f.found[method])
    return series


def parameters(steps: Sequence[float]) -> dict[str, Any]:
    used = {"full_pressure": FULL_PRESSURE, "full_torque": FULL_TORQUE, "macro_steps": list(steps)}
    feedback = {"feedback_speed": feedback_boundary.SPEED, "feedback_pressure": feedback_boundary.PRESSURE}
    return BOGIE.values() | brake_values() | used | feedback | {"stop_speed": coupling_error.INITIAL_SPEED}


def run(options: Options, quick: bool = False) -> Report:
    steps = QUICK_STEPS if quick else STEPS
    found = find(steps, SHOWN)
    rows = error_rows(found, SIZED, SHOWN) + chatter_rows(found, SHOWN) + boundary_rows(found)
    return Report(
        *(rows, series_of(found), lambda: draw(found), parameters(steps), 0.0, remarks(found, SHOWN), found.guids),
    )


SCENARIO = Scenario("coupling-step", "Error, chatter and stability of coupled brake and bogie over the macro step", run)
