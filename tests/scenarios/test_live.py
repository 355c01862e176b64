"""The live page in a real browser: controls, pictures, and its kernel and protection against those of Python."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import pytest

from brake_controller.sensors import Encoder
from brake_controller.wheel_slide import APPLY, HOLD, VENT, SlideProtection
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from products.braked_vehicle import FULL_PRESSURE
from rbd_model.vehicle.description import size_of
from scenarios.live.machines import MACHINES, model_of
from scenarios.live.page import write_page
from tests.browser import Browser, Page, browser

__all__ = ["browser"]

#: Period of the page's controls [s], PERIOD in simulation.js.
PERIOD = 5e-3
#: Wet rail with leaves: friction, and that from a place on over some metres.
FRICTION, LEAVES, AHEAD, LENGTH = 0.08, 0.05, 50.0, 40.0
#: Of outputs that may be small: forces of contacts, loads [N].
NOMINAL = {"lateral_force": 1e3, "flange_force": 1e3, "guiding_force": 1e3, "creep_force": 1e3}
#: Looks of a stop without and with protection, 20 and 8 s: valves that act on sliding wheels enlarge rounding in time.
STEPS = {"false": round(20 / PERIOD), "true": round(8 / PERIOD)}
#: Amplitude of the rails' wave at level 3 [m].
WAVE = 5e-3
#: Resolution of the timers of the wheels' sensors [s], so fine that it does not enlarge rounding; the real one is that
#: of `test_sensors_and_protection_of_the_page_give_the_same_commands`.
FINE_TIMER = 1e-12
#: Rounding of two mathematical libraries, relative; and what becomes of it where valves act on what the wheels do: the
#: local error that is allowed, the default `tolerance`.
BANDS = {False: 1e-9, True: 1e-6}
#: Bytes that a telephone should be asked to load at most.
LARGEST = 3_000_000


#: What a person does, and the drive of `in_python`, in the language of the page.
HANDS = f"""
function move(values) {{
  for (const [name, value] of Object.entries(values)) {{
    const control = document.getElementById(name);
    if (typeof value === "boolean") control.checked = value; else control.value = value;
    control.dispatchEvent(new Event(control.tagName === "SELECT" ? "change" : "input"));
  }}
}}
const isLocked = () => live.simulation.read("locked").includes(1);
async function stop(name, level, protection, outputs) {{
  const machine = DATA.machines[name];
  const kernel = await Kernel.create(await moduleOf(name), machine.variables);
  const sensor = {{ ...DATA.protection.sensor, resolution: {FINE_TIMER} }};
  const simulation = new Simulation(kernel, machine, {{ ...DATA.protection, sensor }});
  simulation.restart({{ level, initial_speed: 25, lateral_irregularity: level === 3 ? {WAVE} : 0 }});
  Object.assign(simulation.controls, {{ handle: -1, friction: {FRICTION}, protection }});
  simulation.addPatch({AHEAD}, {LENGTH}, {LEAVES});
  let vented = 0;
  for (let step = 0; step < {json.dumps(STEPS)}[protection]; step += 1) {{
    simulation.advance({PERIOD});
    vented += simulation.valves.filter((valve) => valve === VENT).length;
  }}
  return {{ vented, values: outputs.map((output) => kernel.get(output)) }};
}}
async function commandsOnDryRail(name, level) {{
  const machine = DATA.machines[name];
  const kernel = await Kernel.create(await moduleOf(name), machine.variables);
  const simulation = new Simulation(kernel, machine, DATA.protection);
  simulation.restart({{ level, initial_speed: 25 }});
  let commands = 0;
  for (let step = 0; step < {round(40 / PERIOD)}; step += 1) {{
    simulation.controls.handle = step < {round(3 / PERIOD)} ? -0.5 : -1;
    simulation.advance({PERIOD});
    commands += simulation.valves.filter((valve) => valve !== APPLY).length;
  }}
  return [commands, kernel.get("speed")];
}}
function commandsOf(rotations) {{
  const encoders = rotations[0].map(() => new Encoder(DATA.protection.sensor));
  const guard = new SlideProtection(DATA.protection.thresholds);
  return rotations.map((angles, step) => guard.step(
    step * {PERIOD}, angles.map((angle, i) => encoders[i].angularVelocity(step * {PERIOD}, angle))));
}}
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_page(tmp_path_factory.mktemp("live") / "live.html")


def opened(browser: Browser, file: Path, width: int) -> Iterator[Page]:
    page = browser.open(file, width)
    page.evaluate(HANDS)
    page.evaluate("live.ready")
    yield page
    page.close()
    assert page.errors == []
    assert page.requests == []


@pytest.fixture(scope="module", params=[1440, 390])
def page(browser: Browser, file: Path, request: pytest.FixtureRequest) -> Iterator[Page]:
    yield from opened(browser, file, request.param)


@pytest.fixture(scope="module")
def still(browser: Browser, file: Path) -> Iterator[Page]:
    """A page that does not go on by itself."""
    for page in opened(browser, file, 800):
        page.evaluate("live.running = false")
        yield page


def test_the_page_is_small(file: Path) -> None:
    assert file.stat().st_size <= LARGEST


def test_the_handle_brakes_and_wheels_lock(page: Page) -> None:
    """Controls as a person moves them: without protection on wet rail wheels lock; charts move."""
    page.evaluate("move({ level: 3, rails: 5, handle: -60 }), live.simulation.advance(8)")
    page.evaluate(f"move({{ pace: 4, friction: {FRICTION}, protection: false, handle: -100 }})")
    moved = "chart.toDataURL() !== before"
    page.evaluate("globalThis.chart = at('chart-speed'), globalThis.before = chart.toDataURL(), null")
    page.evaluate(f"new Promise((found) => setInterval(() => isLocked() && {moved} && found(), 50))")
    assert "locked" in page.evaluate("at('sentences').textContent")
    assert page.evaluate("live.simulation.history.at(-1).speed") < 90.0
    name = f"live-{page.evaluate('innerWidth')}.png"
    if "BOGIE_BRAKING_PICTURES" in os.environ:
        page.screenshot(Path(os.environ["BOGIE_BRAKING_PICTURES"]) / name)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_page_that_stands_still_costs_nothing(still: Page) -> None:
    """Nothing is drawn while it is paused, until a control moves."""
    frames = (
        "new Promise((done) => { let n = 0; const on = () => (n++ < 20 ? requestAnimationFrame(on) : done()); on(); })"
    )
    still.evaluate(f"globalThis.drawn = 0, live.side.draw = () => {{ drawn += 1; }}, {frames}")
    still.evaluate(f"drawn = 0, {frames}")
    assert still.evaluate("drawn") == 0
    still.evaluate(f"move({{ friction: {FRICTION} }}), {frames}")
    assert 0 < still.evaluate("drawn") < 10


@pytest.mark.parametrize("protection", [False, True])
@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("name", MACHINES)
def test_the_page_computes_what_python_does(still: Page, name: str, level: int, protection: bool) -> None:
    """A stop on wet rail with leaves, at level 3 over a wave: all outputs, and how often valves vent."""
    outputs = [variable.name for variable in model_of(name).variables if variable.causality == "output"]
    found = still.evaluate(f"stop({name!r}, {level}, {json.dumps(protection)}, {outputs})")
    kernel, vented = stopped_in_python(name, level, protection)
    assert found["vented"] == vented
    assert (vented > 10) == protection
    for output, one in zip(outputs, found["values"], strict=True):
        size = BANDS[protection] * max(abs(kernel[output]), NOMINAL.get(output.rstrip("_1234"), 1.0))
        assert abs(one - kernel[output]) <= size, (output, one, kernel[output])


@pytest.mark.parametrize("level", [1, 2])
@pytest.mark.parametrize("name", MACHINES)
def test_no_valve_of_the_page_leaves_apply_on_dry_rail(still: Page, name: str, level: int) -> None:
    """Half the brake and then all of it, to rest and beyond, on rails with the friction that the page starts with."""
    commands, speed = still.evaluate(f"commandsOnDryRail({name!r}, {level})")
    assert commands == 0
    assert abs(speed) < 0.01


def test_sensors_and_protection_of_the_page_give_the_same_commands(still: Page) -> None:
    """Wheels that roll, that slide away again and again, with a sensor that fails for a second, with a dead one."""
    angles, rotations, protection = [0.0, 0.1, 0.2, 0.3], [], SlideProtection()
    encoders = [Encoder() for _ in angles]
    for step in range(4000):
        time = step * PERIOD
        speed = max(0.0, 22.0 - 1.1 * time)
        slips = [0.0, 0.3 * abs(math.sin(time)) if time > 3.0 else 0.0, 1.0 if 5.0 < time < 6.0 else 0.01, 1.0]
        angles = [angle + PERIOD * speed * (1.0 - slip) for angle, slip in zip(angles, slips, strict=True)]
        rotations.append(angles)
    commands, believed = [], []
    for step, turned in enumerate(rotations):
        time = step * PERIOD
        seen = [one.angular_velocity(time, angle) for one, angle in zip(encoders, turned, strict=True)]
        commands.append(protection.step(time, seen))
        believed.append([wheel.believed for wheel in protection.wheels])
    assert [True, True, True, False] == believed[900] == believed[2500]
    assert believed[1100] == [True, True, False, False]
    assert {APPLY, HOLD, VENT} == {command for one in commands for command in one}
    assert still.evaluate(f"commandsOf({json.dumps(rotations)})") == commands


@lru_cache
def stopped_in_python(name: str, level: int, protected: bool) -> tuple[Kernel, int]:
    """The drive of the page's `Simulation` with the kernel and the protection of Python; how often a valve vented."""
    vehicle = MACHINES[name].vehicle()
    sizes = vehicle.parameters.values()
    along = [float(size_of(wheelset.along, sizes)) for wheelset in vehicle.wheelsets]
    radii = [float(size_of(wheelset.mean_radius, sizes)) for wheelset in vehicle.wheelsets]
    kernel, protection, vented = Kernel(Library(build_library(model_of(name)))), SlideProtection(), 0
    encoders = [Encoder(resolution=FINE_TIMER) for _ in radii]
    kernel.set(level=level, initial_speed=25.0, lateral_irregularity=WAVE if level == 3 else 0.0)
    kernel.set(**{f"pressure_demand_{number}": 0.0 for number, _ in enumerate(along, 1)})
    kernel.initialise()
    begin = kernel["distance"] + along[0] + AHEAD
    for step in range(STEPS[str(protected).lower()]):
        turned = [kernel[f"rotation_{number}"] for number, _ in enumerate(radii, 1)]
        seen = [one.angular_velocity(step * PERIOD, angle) for one, angle in zip(encoders, turned, strict=True)]
        speeds = [radius * omega for radius, omega in zip(radii, seen, strict=True)]
        valves, distance = protection.step(step * PERIOD, speeds), kernel["distance"]
        valves = valves if protected else [APPLY] * len(valves)
        vented += valves.count(VENT)
        for number, (valve, place) in enumerate(zip(valves, along, strict=True), 1):
            leaves = begin <= distance + place < begin + LENGTH
            inputs = {"pressure_demand": FULL_PRESSURE, "valve": valve, "friction": LEAVES if leaves else FRICTION}
            kernel.set(**{f"{one}_{number}": value for one, value in inputs.items()})
        kernel.step(step * PERIOD, PERIOD)
    return kernel, vented
