"""First stops of FMUs: a coach on a dry and on a wet rail, and a bogie coupled with its brake cylinder.

The coach is BrakedVehicle.fmu, run by `fmpy.simulate_fmu`: full brake from 160 km/h with a heavier body. The bogie and
its brake are two FMUs of FMI 2.0, BogieDynamics.fmu and BrakeCylinder.fmu. `bb.cosimulate` loads them with FMPy and
couples them in macro steps, of 1 ms by default: the cylinder gives the brake torque, the bogie returns the speed of
rotation.
"""

import math

import numpy as np
from fmpy import simulate_fmu
from matplotlib.figure import Figure

from bogie_braking.reporting import plots
from bogie_braking.reporting.report import Bound, Report, Row, measured, near, rounding
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.master import cosimulate
from fmu_src.cosimulation.recording import Recording
from products import machine
from products.bogie import TORQUE_PER_PRESSURE, brake_values
from products.building import units_of, up_to_date
from products.coach import COACH, NUMBERS
from scenarios.bench.braked_bogie import acceleration_per_torque, connections
from scenarios.bench.open_fmus import open_bogie, open_brake

#: Initial speed of all stops [m/s], and mass of the coach's body [kg]; the published vehicle has 32 t.
SPEED, BODY_MASS = 160 / 3.6, 38e3
#: Wheel-rail friction of the rails [1]. Assumed: constant, also while wheels slide.
RAILS = {"dry": 0.30, "wet": 0.08}
#: Torque on each wheelset of the bogie [N.m], and the deceleration that the thesis reports for it [m/s2] (section
#: 5.4.1).
TORQUE, PRINTED = 15e3, "1.109"
#: Time from 0 to 95 % of the demanded pressure of the bogie's cylinder [s].
APPLICATION_TIME = brake_values()["application_time"]
#: Simulated time [s], interval of the coach's outputs [s], and when the cylinders are full and nothing rocks [s].
COACH_DURATION, BOGIE_DURATION, INTERVAL, SETTLED = 70.0, 45.0, 0.01, 12.0
#: Speeds below which the vehicle is at rest, and below which a deceleration is not measured [m/s].
AT_REST, SLOW = 0.01, 2.0
#: Relative tolerance of the closed forms. They neglect creep (0.02 of 963 m on the dry rail, 3e-5 of the deceleration)
#: and the time in which wheels slow down until they lock (0.3 of 1274 m on the wet rail).
BAND = 1e-3
#: Outputs of the coach, and those of the bogie.
OF_COACH = (
    *("speed", "distance", "cylinder_pressure_1"),
    *(f"{name}_{number}" for number in NUMBERS for name in ("locked", "angular_velocity")),
)
OF_BOGIE = ("speed", "distance")


def stop_of_coach(friction: float) -> Recording:
    """Stop the coach with full brake from the start by `fmpy.simulate_fmu`."""
    values = {"level": 2, "initial_speed": SPEED, "body_mass": BODY_MASS}
    values |= {f"pressure_demand_{number}": machine.FULL_PRESSURE for number in NUMBERS}
    values |= {f"friction_{number}": friction for number in NUMBERS}
    found = simulate_fmu(
        str(up_to_date("braked-vehicle", "native")),
        stop_time=COACH_DURATION,
        output_interval=INTERVAL,
        start_values=values,
        output=OF_COACH,
        fmi_type="CoSimulation",
    )
    units = units_of("braked-vehicle")
    rows = np.column_stack([found[name] for name in ("time", *OF_COACH)])
    return until_rest(Recording({"time": "s"} | {name: units[name] for name in OF_COACH}, rows))


def stop_of_bogie(options: Options) -> tuple[Recording, dict[str, str]]:
    """Couple bogie and brake cylinder, and stop them. Return the recording, and the GUIDs of both FMUs by name."""
    demand = TORQUE / TORQUE_PER_PRESSURE
    with open_brake(options, **brake_values()) as brake, open_bogie(options, level=2, initial_speed=SPEED) as bogie:
        brake.start(pressure_demand=demand)
        bogie.start()
        record = [(brake, "cylinder_pressure"), (brake, "brake_torque"), *((bogie, name) for name in OF_BOGIE)]
        series = cosimulate(
            *([brake, bogie], connections(brake, bogie), BOGIE_DURATION, options.macro_step(), record),
            label="bogie and brake",
        )
        return until_rest(series), {one.name: one.guid for one in (brake, bogie)}


def until_rest(series: Recording) -> Recording:
    """Return the rows of a stop up to the first one at rest."""
    standing = np.flatnonzero(series["speed"] < AT_REST)
    end = int(standing[0]) + 1 if standing.size else len(series["time"])
    return Recording(series.units, np.column_stack([series[name][:end] for name in series.names]))


def closed_form_distance(deceleration: float, application_time: float, limit: float = math.inf) -> float:
    """Return the stopping distance of rolling wheels whose brake force builds up as 1 - exp(-t / T) [m].

    Takes deceleration [m/s2], application_time [s], limit [m/s2].
    """
    constant = application_time / math.log(20.0)
    most = min(deceleration, limit)
    if most == deceleration:
        return SPEED**2 / (2 * most) + SPEED * constant - most * constant**2 / 2
    share = limit / deceleration
    begin = -constant * math.log(1.0 - share)
    lost = deceleration * (begin - constant * share)
    way = SPEED * begin - deceleration * (begin**2 / 2 - constant * begin + constant**2 * share)
    return way + (SPEED - lost) ** 2 / (2 * limit)


def mean_deceleration(series: Recording) -> float:
    """Return the slope of the speed while the brake is full [m/s2]."""
    chosen = (series["time"] > SETTLED) & (series["speed"] > SLOW)
    return -float(np.polyfit(series["time"][chosen], series["speed"][chosen], 1)[0])


def locked_wheelsets(series: Recording) -> int:
    """Return how many wheelsets of the coach were locked at some time."""
    return sum(bool(np.any(series[f"locked_{number}"] > 0.5)) for number in NUMBERS)


def rows_of_bogie(series: Recording) -> list[Row]:
    """Compare the coupled FMUs with the thesis and with a closed form."""
    demand = TORQUE / TORQUE_PER_PRESSURE / 1e3
    reached = float(np.interp(APPLICATION_TIME, series["time"], series["cylinder_pressure"])) / 1e3
    distance = closed_form_distance(TORQUE * acceleration_per_torque(), APPLICATION_TIME)
    definition, sections = rounding("0.95") * demand, "thesis, sections 2.4.2 and 7.1"
    name = "bogie + brake, coupled"
    return [
        Row(f"{name}: pressure after {APPLICATION_TIME} s", "kPa", 0.95 * demand, reached, definition, sections),
        Row(
            *(f"{name}: deceleration", "m/s2", float(PRINTED), mean_deceleration(series), rounding(PRINTED)),
            f"thesis, section 5.4.1: {TORQUE / 1e3:g} kN.m on each wheelset",
        ),
        compared(f"{name}: stopping distance", "m", float(series["distance"][-1]), distance, "2 T/r / (m + 2 J/r2)"),
    ]


def rows_of_coach(stops: dict[str, Recording]) -> list[Row]:
    """Compare the stops of the coach with closed forms."""
    braked = machine.coach().deceleration(machine.FULL_TORQUE, BODY_MASS - COACH.body_mass)
    rows = []
    for rail, friction in RAILS.items():
        series, limit, name = stops[rail], friction * COACH.gravity, f"coach, {rail} rail"
        slides = braked > limit
        full, way = min(braked, limit), closed_form_distance(braked, machine.APPLICATION_TIME, limit)
        law = f"friction {friction:g} times gravity" if slides else "4 T/r / (m + 4 J/r2)"
        distance = float(series["distance"][-1])
        asked = f"adhesion of {braked / COACH.gravity:.3f} is needed, friction is {friction:g}"
        moving, count = "sliding" if slides else "rolling", len(NUMBERS) * slides
        found, wanted = locked_wheelsets(series), Bound(count, count, str(count))
        rows += [
            compared(f"{name}: deceleration, {moving}", "m/s2", mean_deceleration(series), full, law),
            compared(f"{name}: stopping distance", "m", distance, way, f"{law}, pressure 1 - exp(-t/T)"),
            measured(f"{name}: locked wheelsets", "1", found, asked, wanted),
        ]
    return rows


def compared(quantity: str, unit: str, value: float, expected: float, law: str) -> Row:
    """Return a row whose limits are those of a closed form, within BAND."""
    return measured(quantity, unit, value, f"closed form: {law}", near(expected, BAND * expected))


def run(options: Options, quick: bool = False) -> Report:
    """Run the three stops."""
    stops = {rail: stop_of_coach(friction) for rail, friction in RAILS.items()}
    bogie, guids = stop_of_bogie(options)
    series = Recording(stops["wet"].units, np.column_stack([stops["wet"][name] for name in stops["wet"].names]))
    for name in OF_COACH:
        series.add_from(f"{name} (dry)", stops["dry"], name)
    for name in ("speed", "distance", "cylinder_pressure", "brake_torque"):
        series.add_from(f"{name} (bogie)", bogie, name)
    distances = {rail: one["distance"][-1] for rail, one in stops.items()}
    remarks = [
        f"The coach stops from {SPEED * 3.6:.0f} km/h in {distances['dry']:.0f} m on the dry rail, in "
        f"{distances['wet']:.0f} m on the wet one, where {locked_wheelsets(stops['wet'])} wheelsets lock.",
        "Assumed: the coach's brake; friction of 0.3 and 0.08, the same at all speeds of sliding.",
        "The experiment of the thesis: python -m bogie_braking run qr30-180kpa",
    ]
    simulated = sum(float(one["time"][-1]) for one in (*stops.values(), bogie))
    parameters = {"initial_speed": SPEED, "body_mass": BODY_MASS, "friction": RAILS}
    rows = [*rows_of_bogie(bogie), *rows_of_coach(stops)]
    return Report(rows, series, lambda: draw(stops, bogie), parameters, simulated, remarks, guids)


def draw(stops: dict[str, Recording], bogie: Recording) -> Figure:
    """Draw speed over distance: the coach on both rails with its wheels, and the bogie."""
    dry, wet = (float(stops[rail]["distance"][-1]) for rail in RAILS)
    verb = "wheels lock" if locked_wheelsets(stops["wet"]) else "no wheel locks"
    message = f"{3.6 * SPEED:.0f} km/h, friction {RAILS['wet']:g}: {verb}, {wet:.0f} instead of {dry:.0f} m"
    figure, axis = plots.single(message, "distance [m]", "speed [km/h]")
    names = {"dry": ("coach, dry rail", plots.LEADING), "wet": ("coach, wet rail", plots.TRAILING)}
    for rail, series in stops.items():
        label, colour = names[rail]
        axis.plot(series["distance"], 3.6 * series["speed"], color=colour, label=label, linewidth=2.4)
    wheels = "its four wheelsets, circumferential speed"
    for number in NUMBERS:
        speed = 3.6 * COACH.wheel_radius * stops["wet"][f"angular_velocity_{number}"]
        label = wheels if number == 1 else "_"
        axis.plot(stops["wet"]["distance"], speed, "--", color=plots.TRAILING, linewidth=1.2, label=label)
    text = "bogie + brake cylinder: two FMUs, coupled"
    axis.plot(bogie["distance"], 3.6 * bogie["speed"], "-.", color=plots.BOGIE, linewidth=1.4, label=text)
    axis.set(xlim=(0.0, None), ylim=(0.0, 1.3 * 3.6 * SPEED))
    axis.legend(loc="upper right")
    plots.write_at(axis, (380.0, 8.0), "wheels locked", plots.TRAILING)
    return figure


SCENARIO = Scenario(
    "demo",
    "First stops of FMUs: a coach on dry and wet rail, a bogie coupled with its brake cylinder",
    run,
    takes=frozenset({"step"}),
)
