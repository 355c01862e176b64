"""Vehicles of a train in detail: any step of the host, momentum and energy, curves, saved states, files, refusals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking.__main__ import main
from fmu_src.compile import build_library
from fmu_src.cosimulation import CosimulationError
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.kernel import Library
from fmu_src.system import System, model_of
from products.building import write_in_c
from products.coach import COACH, NUMBERS
from products.train import detailed_kernel, train
from products.train.consist import Consist
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.detail_columns import detail_of
from products.train.detailed_kernel import Compiled
from products.train.fmu import train_fmu
from products.train.train import Train
from rbd_model.levels.planar import planar_vehicle
from rbd_model.train.coupler import screw_coupler
from rbd_model.vehicle.ready import passenger_coach
from rbd_model.vehicle.variables import initial_speed, inputs, outputs
from scenarios.bench import mixed_train
from scenarios.bench.mixed_train import PLACE, SPEED, mixed
from scenarios.bench.pushed_in_a_curve import RADIUS, curve, on_paper
from tests.products.train.chains import chain, spring

#: Share by which forces of different communication steps may differ.
SAME_FORCE = 1e-3
#: Duration of a run [s], and stiffness of couplers without friction [N/m].
LONG, STIFFNESS = 8.0, 5e6
POWERS, ENERGIES = ("creep_power", "damping_power"), ("kinetic_energy", "potential_energy")


def coaches(level: int, *places: int) -> Consist:
    """Return the train of the benchmark, coaches at these places in detail."""
    return mixed_train.consist_of(screw_coupler(), level, *places)


def braked(consist: Consist, step: float, long: float = LONG) -> tuple[Train, np.ndarray]:
    """Return a train after an emergency, and its coupler forces each 0.2 s."""
    own = Train(consist, speed=SPEED)
    own.drive("emergency")
    forces = []
    for n in range(round(long / step)):
        own.advance(step)
        if (n + 1) * step % 0.2 < 1e-9 or -(n + 1) * step % 0.2 < 1e-9:
            forces.append(own.coupler_force)
    return own, np.array(forces)


def test_forces_do_not_depend_on_the_step_of_the_host() -> None:
    _, fine = braked(coaches(2), 1e-3)
    for step in (0.01, 0.05, 0.2):
        _, forces = braked(coaches(2), step)
        np.testing.assert_array_equal(forces, fine)
    size = np.abs(fine).max()
    _, uneven = braked(coaches(2), 0.2 / 60)  # steps end beside the train's own grid
    assert size > 20e3
    assert np.abs(uneven - fine).max() < SAME_FORCE * size


@pytest.mark.parametrize("level", [1, 2])
def test_a_train_in_detail_is_the_pair_of_fmus_coupled_each_millisecond(level: int) -> None:
    """At level 2 the pair lacks the pitch of the couplers' points, 0.8 m below the centre of the body."""
    pair = mixed(screw_coupler(), level, "corrected")
    pair.train.drive("emergency")
    for _ in range(round(LONG * 1e3)):
        pair.step(1e-3)
    own, _ = braked(coaches(level), 0.1)
    assert own.largest_compression == pytest.approx(pair.train.largest_compression, rel=1e-5 if level == 1 else 2e-3)
    assert own.distance[0] == pytest.approx(float(pair.train.distance[0]), abs=1e-4)


def take_kernel(monkeypatch: pytest.MonkeyPatch, system: System) -> None:
    """Compute vehicles in detail by these equations."""
    model = model_of(system, 1e-9)
    made = Compiled(Library(build_library(model)), {one.name: one for one in model.variables})
    for module in (detailed_kernel, train):
        monkeypatch.setattr(module, "compiled", lambda detail, on_line: made)


def point_mass(mass: float, radius: float) -> System:
    """Return a mass that the couplers pull, with wheels that turn as it moves: Newton's law alone."""
    system = System("PointMass", "A mass between two couplers")
    own = inputs(passenger_coach())
    pulls = [system.input(own[f"coupler_force_{end}"]) for end in ("front", "rear")]
    for n in NUMBERS:
        for name in ("brake_torque", "traction_torque", "friction"):
            system.input(own[f"{name}_{n}"])
    start = system.parameter(initial_speed(0.0))
    place, speed = system.state("distance", "m", 0.0, 1.0), system.state("speed", "m/s", start, 1.0)
    system.derivative(place, speed)
    system.derivative(speed, (pulls[0] + pulls[1]) / mass)
    shown = outputs(passenger_coach())
    system.output(shown["speed"], speed)
    for n in NUMBERS:
        system.output(shown[f"angular_velocity_{n}"], speed / radius)
        system.output(shown[f"creep_force_{n}"], 0)
    return system


def test_a_point_mass_in_detail_is_the_train_without_detail(monkeypatch: pytest.MonkeyPatch) -> None:
    """The step of Stoermer and Verlet is exact for a constant force, so both are equal up to rounding."""
    take_kernel(monkeypatch, point_mass(60e3, COACH.wheel_radius))
    detail = detail_of({"detail": "coach", "level": 1})
    ways = []
    for own_detail in (detail, None):
        vehicles = list(chain([60e3] * 6, screw_coupler()).consist.vehicles)
        vehicles[2] = replace(vehicles[2], detail=own_detail)
        own = Train(Consist(tuple(vehicles)), speed=10.0)
        motion = own.motion
        motion[1:3, 0] = 12.0
        own.motion = motion
        for _ in range(2000):
            own.advance(1e-3)
        ways.append(own)
    assert ways[1].largest_tension > 100e3
    assert ways[0].coupler_force == pytest.approx(ways[1].coupler_force, abs=1e-6 * ways[1].largest_tension)
    assert ways[0].distance == pytest.approx(ways[1].distance, abs=1e-9)


def collided(monkeypatch: pytest.MonkeyPatch, places: Sequence[int]) -> tuple[Train, Any]:
    """Return a train of six on springs, with vehicles in detail and random speeds of the others; and its energies.

    The kernels are the planar coach with its energies as outputs.
    """
    take_kernel(monkeypatch, planar_vehicle(passenger_coach()).with_integrals(POWERS).with_outputs(ENERGIES))
    detail = detail_of({"detail": "coach"})
    assert detail is not None
    vehicles = list(chain([60e3] * 6, spring(STIFFNESS)).consist.vehicles)
    for place in places:
        share = detail.rotating_mass / detail.mass
        vehicles[place] = replace(vehicles[place], detail=detail, mass=detail.mass, rotating_share=share)
    own = Train(Consist(tuple(vehicles)), speed=20.0)
    free = [n for n in range(6) if n not in places]
    motion, rng = own.motion, np.random.default_rng(3)
    motion[0, free] += rng.normal(0.0, 0.01, len(free))
    motion[1:3, free] += rng.normal(0.0, 0.2, len(free))
    own.motion = motion

    def energies() -> tuple[float, float]:
        place, speed, _, _ = own.motion
        stored = STIFFNESS / 2 * np.sum(np.diff(place) ** 2)
        kinetic = sum(vehicles[n].mass * speed[n] ** 2 / 2 for n in free)
        kernels = sum(
            kernel[name]
            for kernel in own.details.values()
            for name in (*ENERGIES, *(f"integral_{power}" for power in POWERS))
        )
        return kinetic + stored + kernels, stored

    return own, energies


def momentum(own: Train) -> float:
    """Return the momentum of a train [N.s], with that of rotation at the rims: it changes by outside forces alone."""
    total = 0.0
    for n, vehicle in enumerate(own.consist.vehicles):
        kernel = own.details.get(n + 1)
        if kernel is None:
            total += vehicle.mass * own.motion[1, n]
            continue
        shifts = sum(COACH.frame_mass * kernel[f"state_{end}_frame_shift_speed"] for end in ("front", "rear"))
        shifts += sum(COACH.wheelset_mass * kernel[f"state_shift_speed_{k}"] for k in NUMBERS)
        turning = sum(kernel[f"angular_velocity_{k}"] for k in NUMBERS)
        total += vehicle.detail.mass * kernel["state_body_speed"] + shifts  # type: ignore[union-attr]
        total += COACH.wheelset_pitch_inertia / COACH.wheel_radius * turning
    return total


@pytest.mark.parametrize("places", [(0,), (2, 3), (5,)])
def test_momentum_and_energy_are_conserved(monkeypatch: pytest.MonkeyPatch, places: Sequence[int]) -> None:
    """At the head, two neighbours, and at the end; no brakes, no resistance, springs without friction."""
    own, energies = collided(monkeypatch, places)
    before, size = energies()[0], 0.0
    impulse, gained = momentum(own), 0.0
    for _ in range(40):
        own.advance(0.05)
        energy, stored = energies()
        size = max(size, stored)
        gained = max(gained, abs(energy - before))
    assert size > 5e3
    assert gained < 5e-4 * size  # 4e-2 with couplers at the height of the centre
    exchanged = STIFFNESS * 0.01  # of a spring stretched by 10 mm, in a second [N.s]
    assert momentum(own) == pytest.approx(impulse, abs=1e-4 * exchanged)


@pytest.mark.study
def test_a_compression_pushes_outwards_in_a_curve() -> None:
    """2 F a / R (docs/train-couplers.md), by forces at both ends of the train; level 3."""
    pushed = []
    for force in (0.0, 300e3):
        rows: list[dict[str, Any]] = [
            {"kind": "locomotive", "detail": "coach", "level": 3, "brake": "none", "resistance_a": 0}
        ]
        own = bb.train(rows * 2, speed=10.0, line=curve())
        own.inputs["end_force"] = -force
        own.drive("shut-off")
        own.advance(25.0)
        pushed.append(sum(own.details[2][f"guiding_force_{n}"] for n in NUMBERS))
    assert own.distance[1] > 120.0
    assert pushed[1] - pushed[0] == pytest.approx(on_paper(300e3), rel=5e-3)
    assert RADIUS == 300.0


def test_gravity_and_resistance_act_once() -> None:
    """Coasting down 5 permille, the coupling of a coach in detail transmits what its neighbours' do."""
    line = bb.line_of([bb.straight(3000, gradient=-0.005)], start=-500)
    sizes = detail_of({"detail": "coach"}).columns()  # type: ignore[union-attr]
    ways = []
    for one in ({"detail": "coach"}, sizes):
        row = {"kind": "coach", "lambda": 135}
        own = bb.train([{"kind": "locomotive"}, row, row | one, row], speed=20.0, line=line)
        own.drive("shut-off")
        own.advance(20.0)
        ways.append(own.distance)
    assert ways[0] == pytest.approx(ways[1], abs=5e-3)


def test_a_saved_state_continues_bit_for_bit() -> None:
    own, _ = braked(coaches(2, 0, PLACE), 0.1, 3.0)
    state = own.state
    own.advance(1.0)
    after = own.state
    own.state = state
    own.advance(1.0)
    np.testing.assert_array_equal(own.state, after)


def test_a_stop_ends_the_recording_and_has_the_outputs_of_the_vehicle() -> None:
    rows = [{"kind": "locomotive"}, {"kind": "coach", "detail": "coach"}]
    own = bb.train(rows, speed=5.0)
    own.drive("emergency")
    stop = own.record(60.0)
    assert stop["time"][-1] < 20.0
    assert stop["vehicle_2.axle_load_1"][0] > 100e3
    assert stop["vehicle_2.speed"][-1] == 0.0


def test_a_refused_step_of_a_kernel_leaves_the_train_at_its_start() -> None:
    rows = [{"kind": "locomotive"}, {"kind": "coach", "detail": "coach", "level": 3}]
    own = bb.train(rows, speed=20.0)
    own.inputs["end_force"] = [0.0, -1e8]
    with pytest.raises(ValueError, match="Vehicle 2: "):
        own.advance(5.0)
    assert own.time == 0.0
    own.inputs["end_force"] = 0.0
    own.advance(1.0)
    assert own.speed[1] == pytest.approx(20.0, abs=0.2)


def test_a_vehicle_file_beside_the_consist_is_computed_in_detail(tmp_path: Path) -> None:
    """Mass and length are those of the file, also after writing the consist."""
    (tmp_path / "long.toml").write_text(
        'like = "coach"\ntare = "50 t"\nlength = 24\n[resistance]\nconstant = 500\n'
        '[brake]\nacts_on = "discs"\ndeceleration = 1.1\n'
    )
    (tmp_path / "train.toml").write_text(
        '[[vehicle]]\nkind = "locomotive"\n[[vehicle]]\nkind = "coach"\ndetail = "long.toml"\nlevel = 1\n'
    )
    consist = read_consist(tmp_path / "train.toml")
    assert consist.vehicles[1].mass == pytest.approx(50e3)
    assert consist.vehicles[1].resistance == (500.0, 0.0, 0.0)
    write_consist(consist, tmp_path / "again.toml")
    assert read_consist(tmp_path / "again.toml").vehicles[1].mass == pytest.approx(50e3)
    own = Train(consist, speed=10.0)
    assert own.record(0.1).messages == [
        "Vehicle 2: The [brake] of long has no effect in a train, which has the brake of its row."
    ]
    assert own.details[2]["davis_constant"] == 500.0


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"detail": "coach", "mass": 46}, "mass must be left out with detail"),
        ({"detail": "tram"}, "detail must be coach, coal-wagon or a vehicle file"),
        ({"level": 3}, "level must come with detail"),
        ({"detail": "coach", "contact_model": 3}, "contact_model has no effect at level 2"),
        ({"detail": "coach", "magnetic_attraction": 100}, "magnetic_attraction must be left out with detail"),
    ],
)
def test_contradictions_are_refused(row: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        consist_of([{"kind": "locomotive"}, {"kind": "coach"} | row])


def test_a_page_whose_vehicles_are_points_refuses_one_in_detail(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "own.csv").write_text("kind,detail\nlocomotive,\ncoach,coach\n")
    assert main(["live", "--consist", str(tmp_path / "own.csv"), "--out", str(tmp_path / "pages")]) == 2
    assert capsys.readouterr().err.startswith("detail must be left out on a page")
    assert not (tmp_path / "pages").exists()


def test_a_controller_reaches_the_torque_and_speed_of_each_wheelset() -> None:
    """By the functions of detail.h: a wheelset whose share is 0 is not braked."""
    own = Train(coaches(2), speed=SPEED)
    shares, speeds = own._call.train_detail_brake(own._own, PLACE), own._call.train_detail_turning(own._own, PLACE)
    shares[1] = 0.0
    own.drive("emergency")
    own.advance(5.0)
    kernel = own.details[PLACE + 1]
    assert kernel["brake_torque_1"] > 1e3
    assert kernel["brake_torque_2"] == 0.0
    assert [speeds[n] for n in range(4)] == [kernel[f"angular_velocity_{n}"] for n in NUMBERS]
    assert speeds[1] > speeds[0]


def test_a_vehicle_in_detail_takes_no_speed_from_outside() -> None:
    own = Train(coaches(1), speed=SPEED)
    own.lead(PLACE, 20.0)
    with pytest.raises(ValueError, match="this train computes that vehicle in detail"):
        own.advance(0.1)


@pytest.mark.parametrize("version", [2, 3])
def test_the_fmu_is_the_train_in_python(tmp_path: Path, version: int) -> None:
    """Two vehicles on a line, with steps of 50 ms, and a saved state in between; the line begins at the train."""
    path, line = tmp_path / "train.fmu", bb.line_of([bb.straight(3000, gradient=-0.005)], start=-500)
    row = {"kind": "coach", "detail": "coach", "level": 1}
    consist = consist_of([{"kind": "locomotive"}, row, row | {"lambda": 80}])
    write_in_c(train_fmu(consist, line=line), path, version)
    own = Train(consist, speed=SPEED, line=line)
    own.drive("emergency")
    with FmuInstance(path, start_speed=SPEED) as fmu:
        fmu.start(driver_position=4)
        for n in range(60):
            fmu.step(0.05 * n, 0.05)
            own.advance(0.05)
        assert fmu["largest_compression"] == own.largest_compression > 0.0
        assert fmu["vehicle_3.angular_velocity_1"] == own.details[3]["angular_velocity_1"]
        state, after = fmu.save(), []
        for _ in range(2):
            fmu.step(3.0, 0.2)
            forces = fmu["rail_force[3]"] if version == 2 else float(fmu.array("rail_force")[2])
            after.append([fmu["vehicle_3.creep_force_1"], forces])
            fmu.fmu.reset()  # a state needs no initialised instance
            fmu.restore(state)
        with FmuInstance(path) as another:
            another.restore(state)
            another.step(3.0, 0.2)
            assert another["vehicle_3.creep_force_1"] == after[0][0]
        assert after[0] == after[1]
        assert after[0][0] != own.details[3]["creep_force_1"]
    with FmuInstance(path, start_distance=50.0) as fmu:
        fmu.start()
        with pytest.raises(CosimulationError, match="start_distance must be 0 m with vehicles in detail on a line"):
            fmu.step(0.0, 0.05)


def test_steps_beyond_the_limit_of_a_coupled_vehicle_are_refused(tmp_path: Path) -> None:
    """1 / omega for a held speed and half of it for a corrected one, omega^2 = 2 K / m: K 50 MN/m, m with rotation."""
    consist = mixed_train.consist_of(screw_coupler())
    mass = consist.vehicles[PLACE].mass * (1 + consist.vehicles[PLACE].rotating_share)
    limit = (mass / 2 / 50e6) ** 0.5
    path = tmp_path / "train.fmu"
    write_in_c(train_fmu(consist), path, 2)
    place = PLACE + 1
    for way, most in ((1, limit), (2, limit / 2)):
        with FmuInstance(path, start_speed=SPEED) as fmu:
            fmu.start(**{f"external_vehicle[{place}]": way, f"external_vehicle_speed[{place}]": SPEED})
            fmu.step(0.0, 0.99 * most)
            with pytest.raises(
                CosimulationError, match=rf"external_vehicle\[{place}\] = {way} must be at most {most:.3g}"
            ):
                fmu.step(0.99 * most, 1.01 * most)
