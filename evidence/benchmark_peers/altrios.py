"""ALTRIOS (National Laboratory of the Rockies, PyPI `altrios`): freight trains that follow speed limits.

A train stops at the end of its path by the brake force that its rail vehicles have. The force rises linearly within
`ramp_up_time`; `ramp_up_coeff` of it is the time by which the train brakes earlier. ALTRIOS has its own gravity and
density of air, so that resistances are converted by them.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

NAME = "ALTRIOS"
PACKAGE = "altrios"
#: Gravity [m/s2] and density of air [kg/m3] of ALTRIOS; its drag has no factor 1/2 (resistance/kind/aerodynamic.rs).
GRAVITY, AIR = 9.801548494963, 1.225
#: Time step [s]; ALTRIOS's own is 1 s, whose error at 45 m/s is 2 %.
STEP = 0.02
#: Length of the path, and of the train [m]; its cars, and axles of each.
PATH, LENGTH = 40e3, 100.0
CARS, AXLES = 10, 4
#: Power of the locomotive [W], too small to pull, and its largest force [N].
POWER, FORCE = 1.0, 1e6
#: Share of the ramp-up time by which a train brakes earlier: half of a linear rise.
EARLIER = 0.5
#: Loaded car of ALTRIOS (rolling_stock/Manifest_Loaded.yaml): length [m], rolling resistance over weight, resistance of
#: an axle's bearings [N], drag area [m2], rotating mass of an axle [kg].
CAR_LENGTH, ROLLING, BEARING, DRAG, ROTATING = 18.0, 0.001546, 40.26, 4.087, 750.0
#: Brake force over weight by length [m] and mass of the wagons [kg], fitted to the distances of ARTC's GW40, GW16
#: and MSP120 from 80 km/h on level track.
FITTED = {(1500.0, 3480e3): 0.01794, (680.0, 1392e3): 0.02815, (200.0, 360e3): 0.06278}
#: Speed limit over the speed, as ALTRIOS ends at a speed that rounding puts above its limit.
ABOVE = 1.0 + 1e-9
#: Speed below which ALTRIOS refuses to go on without power [m/s]; a run to rest is extended from there.
SLOWEST = 0.05


def version() -> str:
    """Return the version of ALTRIOS. Raises ImportError if it is not installed."""
    try:
        return version_of(PACKAGE)
    except PackageNotFoundError:
        raise ImportError(f"install it by pip install {PACKAGE}") from None


@dataclass(frozen=True)
class AltriosTrain:
    """A train: mass and rotating mass [kg], coefficients of its resistance [N], [N.s/m], [N.s2/m2], brake force [N] and
    the time of its rise [s], and the gradient of its path.
    """

    mass: float
    rotating: float
    resistance: tuple[float, float, float]
    force: float
    ramp: float = 0.0
    gradient: float = 0.0


def answer(question: str, inputs: Mapping[str, Any]) -> dict[str, float] | None:
    """Return distance [m], time [s] and brake force [N]; None to other questions."""
    served = {"stop-of-axles": stop_of_axles, "stop-with-full-brakes": full_brakes, "coasting": coasting}
    served["train-stop"] = train_stop
    return served[question](inputs) if question in served else None


def stop_of_axles(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return distance [m] and brake force [N] of a stop; the rise is twice the mean build-up time of the axles."""
    axles = [axle_of(kind, inputs) for kind in inputs["axles"]]
    mass, rotating, force = (sum(axle[name] for axle in axles) for name in ("mass", "rotating", "force"))
    late = sum(one["force"] * (one["delay"] + one["rise"] / 2) for one in axles) / force
    distance, _, largest = stop(AltriosTrain(mass, rotating, resistance_of(inputs), force, 2 * late), inputs["speed"])
    return {"distance": distance, "brake_force": largest}


def full_brakes(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return distance [m] and time [s] of a stop without a rise of the brake force."""
    masses = inputs["mass"], inputs["rotating_mass"]
    train = AltriosTrain(*masses, resistance_of(inputs), inputs["brake_force"], 0.0, inputs["gradient"])
    distance, time, _ = stop(train, inputs["speed"])
    return {"distance": distance, "time": time}


def train_stop(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the distance [m] of a freight train of ALTRIOS's loaded cars; none without a fitted force.

    ALTRIOS has no brake weight percentage, so that its brake force is fitted to the distance to which the percentage of
    the case is fitted. It has no delay either.
    """
    share = FITTED.get((inputs["length"], inputs["wagons.mass"]))
    if share is None or inputs["delay"] > 0.0 or share + inputs["gradient"] <= 0.0:
        return {}
    locomotives = inputs["locomotives"]
    cars = (inputs["length"] - locomotives * inputs["locomotive.length"]) / CAR_LENGTH
    mass = inputs["wagons.mass"] + locomotives * inputs["locomotive.mass"]
    rotating = ROTATING * AXLES * (cars + locomotives)
    resistance = ROLLING * mass * GRAVITY + BEARING * AXLES * cars, 0.0, AIR * DRAG * cars
    train = AltriosTrain(mass, rotating, resistance, share * mass * GRAVITY, 0.0, inputs["gradient"])
    return {"distance": stop(train, inputs["speed"])[0]}


def coasting(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return distance [m] and time [s] of a train whose locomotive has no power, on a line with a high speed limit."""
    mass = inputs["mass"]
    train = AltriosTrain(mass, inputs["rotating_mass"], resistance_of(inputs), mass * GRAVITY, 0.0, inputs["gradient"])
    run = simulation(train, inputs["speed"], LENGTH, 2 * inputs["speed"])
    with suppress(RuntimeError):  # at rest, for want of power
        run.walk()
    history = run.to_pydict()["history"]
    names = ("speed_meters_per_second", "time_seconds", "offset_meters")
    speeds, *others = (history[name] for name in names)
    last = next((number for number, speed in enumerate(speeds) if speed <= inputs["end_speed"]), len(speeds) - 1)
    if speeds[last] > inputs["end_speed"] + SLOWEST:
        raise ValueError(
            f"the train does not slow down to {inputs['end_speed']:g} m/s; it still has {speeds[-1]:g} m/s"
        )
    share = (speeds[last - 1] - inputs["end_speed"]) / (speeds[last - 1] - speeds[last])
    time, place = (other[last - 1] + share * (other[last] - other[last - 1]) for other in others)
    return {"distance": place - LENGTH, "time": time}


def resistance_of(inputs: Mapping[str, Any]) -> tuple[float, float, float]:
    """Return the coefficients of the running resistance, [N], [N.s/m], [N.s2/m2]."""
    constant, linear, square = (float(inputs[f"resistance.{name}"]) for name in ("constant", "linear", "square"))
    return constant, linear, square


def axle_of(kind: str, inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return mass, rotating mass [kg], brake force at the rims [N], delay and rise [s] of an axle."""
    own = {name.partition(".")[2]: one for name, one in inputs.items() if name.startswith(f"{kind}.")}
    cylinder = own["cylinder_pressure"] * own["piston_area"] * own["cylinder_efficiency"] + own["cylinder_spring"]
    pressing = cylinder * own["rigging_ratio"] * own["rigging_efficiency"] + own["rigging_spring"]
    force = pressing * own["friction"] * own["friction_radius"] / (own["wheel_diameter"] / 2)
    return {name: own[name] for name in ("mass", "delay", "rise")} | {"force": force, "rotating": own["rotating_mass"]}


def stop(train: AltriosTrain, speed: float) -> tuple[float, float, float]:
    """Return distance [m] and time [s] from the first brake force to rest, and the largest brake force [N].

    The train starts two steps before the place where ALTRIOS brakes, as its locomotive has no power.
    """
    points = simulation(train, speed, LENGTH, ABOVE * speed).to_pydict()["braking_points"]["points"]
    to_rest = [point for point in points if point["speed_target_meters_per_second"] == 0.0]
    brakes = max(one["offset_meters"] for one in to_rest if one["speed_limit_meters_per_second"] >= speed)
    run = simulation(train, speed, brakes - speed * (EARLIER * train.ramp + 2 * STEP), ABOVE * speed)
    try:
        run.walk()
    except RuntimeError as error:
        raise ValueError("ALTRIOS ended the run before the train stopped") from error
    found = run.to_pydict()
    forces = found["fric_brake"]["history"]["force_newtons"]
    names = ("offset_meters", "time_seconds", "speed_meters_per_second")
    places, times, speeds = (found["history"][name] for name in names)
    if speeds[-1] > 0.0:
        raise ValueError(f"the train passed the end of its path at {speeds[-1]:g} m/s")
    first = next(number for number, force in enumerate(forces) if force > 0.0)
    return places[-1] - places[first - 1], times[-1] - times[first - 1], max(forces)


def simulation(train: AltriosTrain, speed: float, place: float, limit: float) -> Any:
    """Return a train of equal cars on a path of one gradient, with its front at `place` [m], under a speed limit."""
    import altrios as alt

    builder = alt.TrainSimBuilder(
        train_id="train",
        train_config=alt.TrainConfig(rail_vehicles=[car_of(train, limit)], n_cars_by_type={"car": CARS}),
        loco_con=alt.Consist([locomotive()]),
        origin_id="A",
        destination_id="B",
        init_train_state=alt.InitTrainState(speed_meters_per_second=speed, offset_meters=place),
    )
    ends = {name: [location(name, offset)] for name, offset in (("A", 0.0), ("B", PATH))}
    values = builder.make_speed_limit_train_sim(location_map=ends, save_interval=1).to_pydict()
    values["state"]["dt_seconds"] = STEP
    values["fric_brake"] |= {"ramp_up_time_seconds": train.ramp, "ramp_up_coeff": EARLIER}
    made = alt.SpeedLimitTrainSim.from_pydict(values)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "network.json"
        path.write_text(json.dumps(network(train.gradient, limit)), encoding="utf-8")
        made.extend_path(str(path), [alt.LinkIdx(1)])
    return made


def car_of(train: AltriosTrain, limit: float) -> Any:
    """Return one of the equal cars of a train."""
    import altrios as alt

    constant, linear, square = train.resistance
    weight = train.mass * GRAVITY
    return alt.RailVehicle.from_pydict(
        {"car_type": "car", "freight_type": "none", "length_meters": LENGTH / CARS, "axle_count": AXLES}
        | {"brake_count": 1, "mass_static_base_kilograms": train.mass / CARS, "mass_freight_kilograms": 0.0}
        | {"speed_max_meters_per_second": limit, "braking_ratio": train.force / weight}
        | {"mass_rot_per_axle_kilograms": train.rotating / (CARS * AXLES)}
        | {"bearing_res_per_axle_newtons": constant / (CARS * AXLES), "rolling_ratio": 0.0}
        | {"davis_b_seconds_per_meter": linear / weight, "cd_area_square_meters": square / AIR / CARS}
        | {f"curve_coeff_{number}": 0.0 for number in range(3)}
    )


def locomotive() -> Any:
    """Return a locomotive without mass and power."""
    import altrios as alt

    values = alt.Locomotive.default().to_pydict()
    for part in ("fc", "gen", "edrv"):
        values["loco_type"]["ConventionalLoco"][part]["pwr_out_max_watts"] = POWER
    values["loco_type"]["ConventionalLoco"]["fc"]["pwr_idle_fuel_watts"] = 0.0
    values |= {"mass_kilograms": None, "force_max_newtons": FORCE, "assert_limits": False}
    return alt.Locomotive.from_pydict(values | {"pwr_aux_offset_watts": 0.0, "pwr_aux_traction_coeff": 0.0})


def location(name: str, place: float) -> Any:
    """Return a place on the first link of the network, by the columns of ALTRIOS's own files."""
    import altrios as alt

    regions = {f"{kind} Region": "none" for kind in ("Grid Emissions", "Electricity Price", "Liquid Fuel Price")}
    at = {"Location ID": name, "Offset (m)": place, "Link Index": 1, "Is Front End": name == "B"}
    return alt.Location.from_pydict(at | regions)


def network(gradient: float, limit: float) -> list[dict[str, Any]]:
    """Return a network of one link of one gradient, forwards and backwards; ALTRIOS does not use link 0."""
    first, last = max(0.0, -gradient * PATH), max(0.0, gradient * PATH)
    none: dict[str, Any] = {f"idx_{name}": 0 for name in ("curr", "flip", "next", "next_alt", "prev", "prev_alt")}
    none |= {"osm_id": None, "length_meters": 0.0, "elevs": [], "headings": [], "speed_sets": {}, "speed_set": None}
    none |= {"cat_power_limits": [], "link_idxs_lockout": []}
    limits = [{"offset_start_meters": 0.0, "offset_end_meters": PATH, "speed_meters_per_second": limit}]

    def link(number: int, other: int, heights: tuple[float, float]) -> dict[str, Any]:
        return none | {
            "idx_curr": number,
            "idx_flip": other,
            "length_meters": PATH,
            "elevs": [{"offset_meters": x, "elev_meters": z} for x, z in zip((0.0, PATH), heights, strict=True)],
            "headings": [{"offset_meters": x, "heading_radians": 0.0, "lat": None, "lon": None} for x in (0.0, PATH)],
            "speed_set": {"speed_limits": limits, "speed_params": [], "is_head_end": False},
        }

    return [none, link(1, 2, (first, last)), link(2, 1, (last, first))]
