"""The brake pipe: air in a long pipe that is divided into cells, by finite volumes.

One-dimensional flow of an ideal gas with friction and heat at the wall: Euler's equations of gas dynamics (E. F. Toro,
Riemann Solvers and Numerical Methods for Fluid Dynamics, 3rd ed. (2009), section 1.6). Densities, speeds and pressures
are linear in each cell, with slopes limited as in van Leer (1977) (MUSCL). The flux through a face is that of Harten,
Lax and van Leer (1983), with the speeds of Davis (1988). A first-order method cannot reproduce the friction of a steady
flow with two cells a vehicle.

Functions here are for one cell, one face or one end. C code computes them for all cells, several at a time
(products/train/c/pipe.c).
"""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.air import GAS_CONSTANT, HEAT_CAPACITY, HEAT_CAPACITY_RATIO, elliptic_flow, mass_flow
from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.variables import Field

_K = HEAT_CAPACITY_RATIO
#: Heat capacity at constant volume [J/(kg.K)].
HEAT_CAPACITY_AT_VOLUME = HEAT_CAPACITY / _K
#: Dynamic viscosity [Pa.s] and heat conductivity [W/(m.K)] of air at 20 C (any table); Prandtl number taken as 1.
VISCOSITY, CONDUCTIVITY = 1.81e-5, 0.026
#: Friction factor of a smooth pipe over Re^-0.25 (Blasius (1913)), and Nusselt number of laminar flow between walls of
#: one temperature.
BLASIUS, LAMINAR_NUSSELT = 0.3164, 3.66


#: Least mass flow [kg/s] and area [m2] in denominators.
LEAST_MASS, LEAST_AREA = 1e-12, 1e-9
#: Steps of Newton's method at an end; least ratio of its pressure after a step to that before.
TURNS, LEAST_SHARE = 4, 0.05


@dataclass(frozen=True)
class Air:
    """Air at a place: density [kg/m3], speed [m/s], absolute pressure [Pa]."""

    density: ca.SX
    speed: ca.SX
    pressure: ca.SX

    @property
    def temperature(self) -> ca.SX:
        """Temperature of an ideal gas [K]."""
        return self.pressure / (self.density * GAS_CONSTANT)

    @property
    def sound(self) -> ca.SX:
        """Speed of sound of an ideal gas [m/s]."""
        return ca.sqrt(_K * self.pressure / self.density)

    @property
    def conserved(self) -> ca.SX:
        """Density, momentum [kg/(m2.s)] and energy [J/m3], Toro (2009), eq. (1.1)."""
        energy = self.pressure / (_K - 1) + self.density * self.speed**2 / 2
        return ca.vertcat(self.density, self.density * self.speed, energy)

    @property
    def flux(self) -> ca.SX:
        """Flow of each conserved quantity per square metre and second, Toro (2009), section 1.6.2."""
        _, momentum, energy = ca.vertsplit(self.conserved)
        return ca.vertcat(momentum, momentum * self.speed + self.pressure, self.speed * (energy + self.pressure))


def air_of(conserved: ca.SX) -> Air:
    """Return the air with this density, momentum and energy, Toro (2009), section 1.6.2."""
    density, momentum, energy = ca.vertsplit(conserved)
    speed = momentum / density
    return Air(density, speed, (_K - 1) * (energy - momentum * speed / 2))


def limited(behind: ca.SX, ahead: ca.SX) -> ca.SX:
    """Return the slope of a cell from differences to its neighbours: harmonic mean, 0 at an extreme.

    van Leer (1977).
    """
    product = behind * ahead
    together = behind + ahead
    return ca.if_else(product > 0, 2 * product / ca.if_else(together == 0, 1, together), 0)


def sides() -> ca.Function:
    """Return the function of three cells for air at both sides of the middle one and its fastest wave.

    van Leer (1977).
    """
    cells = [ca.SX.sym(name, 3) for name in ("before", "own", "behind")]
    before, own, behind = (ca.vertcat(one.density, one.speed, one.pressure) for one in map(air_of, cells))
    differences = zip(ca.vertsplit(own - before), ca.vertsplit(behind - own), strict=True)
    half = ca.vertcat(*[limited(*pair) / 2 for pair in differences])
    air = air_of(cells[1])
    return function_of("sides", cells, ca.vertcat(own - half, own + half, ca.fabs(air.speed) + air.sound))


def _air(name: str) -> tuple[ca.SX, Air]:
    symbols = ca.SX.sym(name, 3)
    return symbols, Air(*ca.vertsplit(symbols))


def passing() -> ca.Function:
    """Return the function of the air on both sides of a face for the flux of Harten, Lax and van Leer (1983).

    Toro (2009), section 10.3.
    """
    (left_symbols, left), (right_symbols, right) = _air("behind"), _air("ahead")
    slow = ca.fmin(ca.fmin(left.speed - left.sound, right.speed - right.sound), 0)
    fast = ca.fmax(ca.fmax(left.speed + left.sound, right.speed + right.sound), 0)
    jump = slow * fast * (right.conserved - left.conserved)
    flux = (fast * left.flux - slow * right.flux + jump) / (fast - slow)
    return function_of("passing", [left_symbols, right_symbols], flux)


#: Constants of a cell. Shares of friction and heat at the wall are 1 without scaling; areas are effective.
CELL = (
    Field("length", "m", 1e-3, 1e6, "the length of a cell"),
    Field("diameter", "m", 1e-4, 10.0, "the diameter of the pipe"),
    Field("wall_temperature", "K", 50.0, 1e4, "the temperature of the pipe's wall"),
    Field("friction", "1", 0.0, 1e6, "friction or heat in the pipe"),
    Field("heat", "1", 0.0, 1e6, "friction or heat in the pipe"),
    Field("leak_area", "m2", 0.0, 1.0, "a leak"),
    Field("ambient_pressure", "Pa", 1.0, 1e8, "the pressure around the pipe"),
    Field("branch", "m", 0.0, 1e6, "a branch of the pipe"),
)


def _root(air: Air, diameter: ca.SX) -> ca.SX:
    """Return |u| / Re^(1/4) [m/s], without a quotient of zeros at rest."""
    fast = ca.fabs(air.speed)
    return ca.sqrt(ca.sqrt(VISCOSITY / (air.density * diameter))) * ca.sqrt(fast) * ca.sqrt(ca.sqrt(fast))


def rates() -> ca.Function:
    """Return the function of a cell, the fluxes at its faces, and its constants for rates of density, momentum, energy.

    Air in branches is at rest and has the state of the cell: it increases the volume of the cell, not the flow.

    Conservation laws with wall friction (Darcy and Weisbach, f of Blasius (1913) or laminar, 64 / Re). The heat of the
    wall is in `warmed`, leaks are in `leaking`.
    """
    cell, behind, ahead, given = (
        ca.SX.sym(name, size) for name, size in (("cell", 3), ("first", 3), ("last", 3), ("given", len(CELL)))
    )
    length, diameter, _, friction, _, _, _, branch = ca.vertsplit(given)
    air = air_of(cell)
    fast = ca.fabs(air.speed)
    turbulent = BLASIUS * air.density * fast * _root(air, diameter) / (2 * diameter)
    laminar = 32 * VISCOSITY * fast / diameter**2
    drag = friction * ca.fmax(turbulent, laminar) * ca.if_else(air.speed > 0, 1, -1)
    over = ca.vertcat(length + branch, length, length + branch)
    return function_of("rates", [cell, behind, ahead, given], (behind - ahead) / over - ca.vertcat(0, drag, 0))


def dragging() -> ca.Function:
    """Return the function of a cell for the rate at which wall friction takes changes of its momentum away [1/s].

    Derivative of the friction of `rates` over the momentum: 7/4 f |u| / (2 D) with f of Blasius (1913), or laminar.
    """
    cell, given = ca.SX.sym("cell", 3), ca.SX.sym("given", len(CELL))
    _, diameter, _, friction, _, _, _, _ = ca.vertsplit(given)
    air = air_of(cell)
    turbulent = 1.75 * BLASIUS * _root(air, diameter) / (2 * diameter)
    laminar = 32 * VISCOSITY / (air.density * diameter**2)
    return function_of("dragging", [cell, given], friction * ca.fmax(turbulent, laminar))


def leaking() -> ca.Function:
    """Return the function of a cell for mass [kg/(m3.s)] and energy [W/m3] that leave through leaks (ISO 6358-1).

    Air enters a pipe below ambient pressure, at the temperature of the walls.
    """
    cell, given = ca.SX.sym("cell", 3), ca.SX.sym("given", len(CELL))
    length, diameter, wall, _, _, leak_area, ambient, branch = ca.vertsplit(given)
    air = air_of(cell)
    volume = ca.pi / 4 * diameter**2 * (length + branch)
    leak = mass_flow(leak_area, air.pressure, air.temperature, ambient) / volume
    enters = mass_flow(leak_area, ambient, wall, air.pressure) / volume
    energy = leak * HEAT_CAPACITY * air.temperature - enters * HEAT_CAPACITY * wall
    return function_of("leaking", [cell, given], ca.vertcat(leak - enters, energy))


def warmed() -> ca.Function:
    """Return the function of a cell, its constants and a time [s] for its energy after heat exchange with the wall
    [J/m3].

    First law, m c_v dT/dt = h S (T_w - T), solved exactly; h by the Reynolds analogy with friction, or laminar. With a
    large share of heat the air is isothermal, without heat adiabatic.
    """
    cell, given, time = ca.SX.sym("cell", 3), ca.SX.sym("given", len(CELL)), ca.SX.sym("time")
    _, diameter, wall, _, heat, _, _, _ = ca.vertsplit(given)
    air = air_of(cell)
    fast = ca.fabs(air.speed)
    factor = BLASIUS * ca.sqrt(ca.sqrt(VISCOSITY / (air.density * ca.fmax(fast, 1e-6) * diameter)))
    film = ca.fmax(factor / 8 * air.density * fast * HEAT_CAPACITY, LAMINAR_NUSSELT * CONDUCTIVITY / diameter)
    pace = heat * film * 4 / (diameter * air.density * HEAT_CAPACITY_AT_VOLUME)
    gained = (wall - air.temperature) * (1 - ca.exp(-pace * time))
    return function_of("warmed", [cell, given, time], cell[2] + air.density * HEAT_CAPACITY_AT_VOLUME * gained)


def _wall_pressure(air: Air) -> ca.SX:
    """Return the pressure of air that runs against a wall, p + rho c u, Toro (2009), section 9.3 [Pa]."""
    return ca.fmax(air.pressure + air.density * air.sound * air.speed, LEAST_SHARE * air.pressure)


def walled() -> ca.Function:
    """Return the function of the air at a shut end, as `ending`: a wall takes momentum alone.

    Toro (2009), section 9.3.
    """
    symbols, air = _air("air")
    return function_of("walled", [symbols], ca.vertcat(0, _wall_pressure(air), 0, 0))


def ending() -> ca.Function:
    """Return the function of the air at an end, its speed outwards, and the air outside, for the flux outwards.

    Mass [kg/(m2.s)] is the first component. The second result is the speed of the passing air. Outside is an effective
    opening [m2] of a pipe of an area [m2] to air of a pressure [Pa] and temperature [K]. The wave reflected at the end
    and isentropic flow through the opening (ISO 6358-1) have one pressure. It is between the outside pressure and that
    of a wall, p + rho c u. Newton's method finds it, starting from the pressure without compressibility.
    """
    symbols, air = _air("air")
    outside = ca.SX.sym("outside", 4)
    opening, area, pressure, temperature = ca.vertsplit(outside)
    wall = _wall_pressure(air)
    at = ca.SX.sym("at")
    out = mass_flow(opening, at, air.temperature, pressure)
    into = mass_flow(opening, pressure, temperature, at)
    # Air that enters keeps its enthalpy: u = G R (T - u^2 / (2 c_p)) / p.
    per_pressure = into / area * GAS_CONSTANT / at
    enters = 2 * per_pressure * temperature / (1 + ca.sqrt(1 + 2 * per_pressure**2 * temperature / HEAT_CAPACITY))
    leaves_at = out / (area * air.density)
    missed = wall - at - (leaves_at - enters) * air.density * air.sound
    newton = ca.Function("newton", [at, symbols, outside], [at - missed / ca.jacobian(missed, at)])
    leaves = ca.if_else(wall > pressure, 1, -1)
    half = opening / area * air.sound * ca.sqrt(air.density / 2)
    root = ca.sqrt(half**2 + ca.fabs(wall - pressure)) - half
    low, high = ca.fmin(wall, pressure), ca.fmax(wall, pressure)
    meet = pressure + leaves * root**2
    for _ in range(TURNS):
        meet = ca.fmin(ca.fmax(newton(meet, symbols, outside), low), high)
    out, into, through = ca.substitute([out, into, leaves_at - enters], [at], [meet])
    mass = (out - into) / area
    whole = HEAT_CAPACITY * air.temperature + through**2 / 2
    energy = (out * whole - into * HEAT_CAPACITY * temperature) / area
    return function_of("ending", [symbols, outside], ca.vertcat(mass, meet + mass * through, energy, ca.fabs(through)))


#: State of a driver's valve at a moment. Effective areas that feed, vent, and vent in an emergency [m2]. Controlled
#: pressure, and band in which the valve opens [Pa]. Pressure [Pa] and temperature [K] of its supply, ambient pressure
#: [Pa]. Inner areas of the pipe behind and ahead of it [m2], 0 at an end of the pipe.
VALVE = (
    *("feeding", "exhaust", "emergency", "held", "band", "supply_pressure", "supply_temperature", "ambient_pressure"),
    *("area_behind", "area_ahead"),
)


def _valve_between(at: ca.SX) -> tuple[list[ca.SX], Air, Air, dict[str, ca.SX], ca.SX, ca.SX]:
    """Return symbols, air behind and ahead, the valve, and its mass flows out and in at a pressure [kg/s].

    ISO 6358-1.
    """
    (first, behind), (last, ahead) = _air("behind"), _air("ahead")
    given = ca.SX.sym("given", len(VALVE))
    valve = dict(zip(VALVE, ca.vertsplit(given), strict=True))
    air_temperature = ca.if_else(valve["area_behind"] > 0, behind.temperature, ahead.temperature)
    over = (at - valve["held"]) / valve["band"]
    area_out = valve["exhaust"] * ca.fmax(ca.fmin(over, 1), 0) + valve["emergency"]
    area_in = valve["feeding"] * ca.fmax(ca.fmin(-over, 1), 0)
    out = elliptic_flow(area_out, at, air_temperature, valve["ambient_pressure"])
    into = elliptic_flow(area_in, valve["supply_pressure"], valve["supply_temperature"], at)
    return [first, last, given], behind, ahead, valve, out, into


def _arriving(air: Air, area: ca.SX, at: ca.SX) -> ca.SX:
    """Return the mass flow [kg/s] to a place of a pressure, by the wave that it reflects, Toro (2009), section 9.3."""
    return area * (air.density * air.speed + (air.pressure - at) / air.sound)


def tapping() -> ca.Function:
    """Return the function of a pressure at a driver's valve for the mass that is missing [kg/s], and its slope.

    Other arguments are the air behind and ahead of it, and the valve. Waves from both sides meet the flow through the
    valve (Toro (2009), section 9.3, and ISO 6358-1).
    """
    at = ca.SX.sym("at")
    symbols, behind, ahead, valve, out, into = _valve_between(at)
    ahead = Air(ahead.density, -ahead.speed, ahead.pressure)
    missed = _arriving(behind, valve["area_behind"], at) + _arriving(ahead, valve["area_ahead"], at) - out + into
    return function_of("tapping", [at, *symbols], ca.vertcat(missed, ca.jacobian(missed, at)))


def tapped() -> ca.Function:
    """Return the function for fluxes behind and ahead of a driver's valve; mass [kg/s], energy [W] out, mass in.

    Toro (2009). The air that leaves has the temperature of the side that it comes from. The air that enters mixes with
    the air in the pipe.
    """
    at = ca.SX.sym("at")
    symbols, behind, ahead, valve, _, into = _valve_between(at)
    mirrored = Air(ahead.density, -ahead.speed, ahead.pressure)
    arrive = [_arriving(behind, valve["area_behind"], at), _arriving(mirrored, valve["area_ahead"], at)]
    here = [HEAT_CAPACITY * air.temperature + air.speed**2 / 2 for air in (behind, ahead)]
    brought = [ca.fmax(mass, 0) * own for mass, own in zip(arrive, here, strict=True)]
    together = ca.fmax(arrive[0], 0) + ca.fmax(arrive[1], 0) + into
    whole = brought[0] + brought[1] + into * HEAT_CAPACITY * valve["supply_temperature"]
    mixed = whole / ca.fmax(together, LEAST_MASS)
    carried = [own + ca.fmin(mass, 0) * mixed for mass, own in zip(arrive, brought, strict=True)]
    fluxes = []
    for air, mass, energy, area, sense in (
        (behind, arrive[0], carried[0], valve["area_behind"], 1),
        (ahead, arrive[1], carried[1], valve["area_ahead"], -1),
    ):
        size = ca.fmax(area, LEAST_AREA)
        fluxes += [sense * mass / size, at + mass**2 / (size**2 * air.density), sense * energy / size]
    net = arrive[0] + arrive[1]
    return function_of("tapped", [at, *symbols], ca.vertcat(*fluxes, net, carried[0] + carried[1], into))
