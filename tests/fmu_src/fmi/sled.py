"""A small model that has every feature and a known motion: a sled on a track that ends."""

from __future__ import annotations

from pathlib import Path

from fmu_src.native_fmu import build_native_fmu, build_native_fmu3
from fmu_src.python_fmu import build_python_fmu
from fmu_src.system import Model, System, Variable, model_of

MASS, SPEED, LENGTH = 10.0, 2.0, 3.0
#: Time at which the sled reaches the end of the track without push or brake [s].
END = LENGTH / SPEED
#: Brake force that stops the sled after 1 s, before the end [N].
STOPPING = 20.0


def sled() -> Model:
    system = System("Sled", "A sled on a track that ends")
    mass = system.parameter(Variable("mass", "parameter", "kg", "Mass", MASS, 1e-3))
    speed = system.parameter(Variable("initial_speed", "parameter", "m/s", "Speed at the start", SPEED))
    length = system.parameter(Variable("length", "parameter", "m", "Length of the track", LENGTH, 1e-3))
    growth = system.parameter(Variable("push_growth", "parameter", "N", "Force forward that comes in each second"))
    push = system.input(Variable("push", "input", "N", "Force forward"))
    brake = system.input(Variable("brake", "input", "N", "Largest force of the brake", 0.0, 0.0))
    lift = system.input(Variable("lift", "input", "N", "Force upward"))
    x = system.state("distance", "m", 0.0, 1.0)
    v = system.state("speed", "m/s", speed, 1.0)
    load = system.algebraic("load", "N", mass * 9.81, 100.0)
    direction, drive = system.direction("direction"), push + growth * system.time
    system.derivative(x, v)
    system.derivative(v, (drive - direction * brake) / mass * (direction * direction))
    system.residual(load, load - mass * 9.81 + lift)
    system.dry_friction("Sled", direction, [v], drive, brake, ("stopped", "moved again"))
    system.end_when_negative(1.0 - x / length, "The sled left the track at %s s.")
    system.output(Variable("distance", "output", "m", "Distance"), x)
    system.output(Variable("speed", "output", "m/s", "Speed"), v)
    system.output(Variable("load", "output", "N", "Force on the track"), load)
    system.output(Variable("stopped", "output", "1", "The brake holds the sled", kind="boolean"), direction == 0)
    system.output(Variable("pace", "output", "m/s", "Speed and a share of the push"), v + 1e-3 * push)
    return model_of(system, 1e-6)


BUILDERS = {"native": build_native_fmu, "fmi3": build_native_fmu3, "python": build_python_fmu}


def build_sled(folder: Path) -> dict[str, Path]:
    """Build the sled's FMUs; return the paths by kind."""
    paths = {kind: folder / kind / "Sled.fmu" for kind in BUILDERS}
    for kind, build in BUILDERS.items():
        build(sled(), paths[kind])
    return paths
