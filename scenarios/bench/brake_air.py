"""The flow model of the brake cylinder against closed forms of gas dynamics, and its balances of mass and energy."""

import math
from dataclasses import replace

from bogie_braking.reporting.report import Row, measured, near
from brake_controller.air import HEAT_CAPACITY_RATIO
from brake_controller.cylinder import TIMES, brake_model, flow_brake
from brake_controller.flow_parameters import FlowParameters
from brake_controller.ready_sets import UIC_PRESSURE, ReadySet, uic_p, with_dump_valve
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from scenarios.bench.gas_dynamics import (
    CRITICAL,
    Vessel,
    choked_filling_time,
    choked_mass_flow,
    choked_venting_time,
    unchoked_filling_time,
)

#: Relative tolerance of peaks and times.
RELATIVE = 5e-3
#: Tolerance of the balances, over the inflow, and the integrator's tolerance for them.
BALANCE, TIGHT = 1e-9, 1e-11
GATHERED = ("mass_flow_in", "mass_flow_out", "enthalpy_in", "enthalpy_out", "piston_work", "heat_loss")
SHOWN = ("air_temperature_in_cylinder", "piston_travel", "mass_flow_in")
#: The cylinder of the closed forms: no slack, a volume in the middle of a stroke [m3].
VOLUME = 3e-3
EXPONENTS = {1.0: "isothermal", 1.4: "adiabatic"}
#: Recording interval [s]; crossings are interpolated linearly.
INTERVAL = 1e-3


def library() -> Library:
    """Return the flow model with its observables and their integrals over time."""
    ready = uic_p()
    system = flow_brake(ready.rigging, ready.flow).with_integrals(GATHERED).with_outputs(SHOWN)
    return Library(build_library(brake_model((system,))))


def kernel_of(compiled: Library, ready: ReadySet, **values: float) -> Kernel:
    given = {name: value for name, value in ready.values().items() if name not in TIMES}
    return Kernel(compiled, **given | values)


def crossing(record: dict[str, list[float]], pressure: float) -> float:
    """Return the first time [s] at which the recorded pressure passes a value [Pa], in either direction."""
    found = record["cylinder_pressure"]
    for number in range(1, len(found)):
        before, after = found[number - 1] - pressure, found[number] - pressure
        if before * after <= 0.0 and before != after:
            times = record["time"]
            return times[number - 1] + before / (before - after) * (times[number] - times[number - 1])
    raise ValueError(f"The pressure never passes {pressure / 1e3:g} kPa; record for longer.")


def vessel(flow: FlowParameters, orifice: float) -> Vessel:
    """Return the cylinder with one of its openings, of a diameter in m."""
    area = flow.discharge_coefficient * math.pi / 4 * orifice**2
    return Vessel(flow.dead_volume, area, flow.polytropic_exponent)


def closed_form_rows() -> list[Row]:
    """Return the rows of peak mass flow, filling and vent times at constant volume, isothermal and adiabatic."""
    compiled, rows = library(), []
    for exponent, word in EXPONENTS.items():
        flow = replace(uic_p().flow, piston_slack=0.0, dead_volume=VOLUME, polytropic_exponent=exponent)
        kernel = kernel_of(compiled, ReadySet(uic_p().rigging, flow), pressure_demand=UIC_PRESSURE)
        ambient, temperature = flow.ambient_pressure, flow.air_temperature
        supply = UIC_PRESSURE + ambient
        filling = kernel.record(8.0, INTERVAL, ["cylinder_pressure", "mass_flow_in"])
        opening = vessel(flow, flow.application_orifice)
        critical, full = CRITICAL * supply, 0.95 * supply
        choked = choked_filling_time(opening, supply, temperature, ambient, critical)
        unchoked = unchoked_filling_time(opening, supply, temperature, critical, full)

        start, hot = kernel["cylinder_pressure"] + ambient, kernel["air_temperature_in_cylinder"]
        kernel.set(valve=2)
        venting = kernel.record(10.0, INTERVAL, ["cylinder_pressure"])
        low = 1.01 * ambient / CRITICAL
        vent = choked_venting_time(vessel(flow, flow.vent_orifice), hot, start, low)
        peak = 1e3 * choked_mass_flow(opening.area, supply, temperature)
        source = "closed form, constant volume"
        for text, unit, exact, found in (
            ("peak mass flow", "g/s", peak, 1e3 * max(filling["mass_flow_in"])),
            ("filling, choked part", "s", choked, crossing(filling, critical - ambient)),
            ("filling to 95 % of the absolute supply", "s", choked + unchoked, crossing(filling, full - ambient)),
            ("vent, choked part", "s", vent, crossing(venting, low - ambient) - venting["time"][0]),
        ):
            rows.append(measured(f"{word}: {text}", unit, found, source, near(exact, RELATIVE * exact)))
    return rows


def air_in(kernel: Kernel, flow: FlowParameters) -> tuple[float, float]:
    """Return mass [kg] and internal energy [J] of the air in the cylinder."""
    volume = flow.dead_volume + flow.piston_area * kernel["piston_travel"]
    pressure = kernel["cylinder_pressure"] + flow.ambient_pressure
    return kernel["state_air_mass"], pressure * volume / (HEAT_CAPACITY_RATIO - 1)


def balance_rows() -> list[Row]:
    """Return the rows of missing mass and energy after stroke, application, partial release, hold and vent."""
    ready = with_dump_valve(uic_p())
    ready = replace(ready, flow=replace(ready.flow, polytropic_exponent=1.2))
    kernel = kernel_of(library(), ready, tolerance=TIGHT, pressure_demand=UIC_PRESSURE)
    kernel.initialise()
    before = air_in(kernel, ready.flow)
    commands: tuple[dict[str, float], ...] = ({"valve": 0}, {"pressure_demand": 200e3}, {"valve": 1}, {"valve": 2})
    for command in commands:
        kernel.set(**command)
        kernel.advance(5.0)
    gathered = {name: kernel[f"integral_{name}"] for name in GATHERED}
    mass, energy = (now - then for now, then in zip(air_in(kernel, ready.flow), before, strict=True))
    mass -= gathered["mass_flow_in"] - gathered["mass_flow_out"]
    energy -= gathered["enthalpy_in"] - gathered["enthalpy_out"] - gathered["piston_work"] - gathered["heat_loss"]
    source, how = "conservation", f"exponent 1.2, tolerance {TIGHT:g}, over what went in"
    lost = energy / gathered["enthalpy_in"]
    return [
        measured("mass of air that is missing", "1", mass / gathered["mass_flow_in"], source, near(0.0, BALANCE), how),
        measured("energy of air that is missing", "1", lost, source, near(0.0, BALANCE), how),
    ]
