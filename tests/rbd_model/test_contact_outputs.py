"""Test outputs of the contacts of each wheel against equilibrium, energy and Hertz' integrals."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import simpson
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import bogie_braking as bb
from fmu_src.kernel import Kernel
from fmu_src.system import model_of
from rbd_model.contact.depth import Contact
from rbd_model.contact.geometry import contact_at, thesis_pair
from rbd_model.contact.hertz import POISSON_RATIO
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.ready import two_axle_bogie
from tests.fmu_src.quick_library import quick_library

WHEELS = [f"{number}_{side}" for number, side in product((1, 2), ("left", "right"))]
PLACES = ("tread", "flange")
#: Share of the lost energy that the balance leaves open: rows every 2 ms, and axles that move against their mean.
ENERGY_BAND = 2e-4
#: Errors of the equilibrium of a wheel, relative to its load. On the outer rail the stiffness of the contacts changes
#: along the profiles, and the force of their energy is not square to them (docs/architecture.md, Pitfalls).
FORCE_BAND = {"left": 1e-5, "right": 2e-2}
#: Error of the fitted semi-axes, twice in an area (`rbd_model.contact.hertz`), and of curvatures over the approach.
AREA_BAND, PLACE_BAND = 5e-3, 2e-5

Rows = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def rolling(tmp_path_factory: pytest.TempPathFactory) -> Rows:
    """A bogie that rolls out of straight track into a narrow curve, in which a flange bears."""
    vehicle = replace(two_axle_bogie(), contact_outputs=True)
    system = spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(2), on_line=True)
    outputs = system.with_integrals(["damping_power"]).with_outputs(["kinetic_energy", "potential_energy"])
    before, curve = bb.straight(20), bb.arc(length=200, radius=150, cant=0.05)
    line = bb.line_of([before, bb.clothoid(30, before, curve), curve])
    path = line.write(Path(tmp_path_factory.mktemp("line")) / "line.csv")
    values = {"initial_speed": 12.0, "rolling_resistance_torque": 0.0, "tolerance": 1e-8}
    kernel = Kernel(quick_library(model_of(outputs, 1e-8)), line_file=str(path), **values)
    names = [one.name for one in outputs.variables if one.causality == "output"]
    return {name: np.array(column) for name, column in kernel.record(10.0, 2e-3, names).items()}


def test_wear_number_times_speed_is_the_energy_that_a_coasting_bogie_loses(rolling: Rows) -> None:
    power = rolling["speed"] * np.sum([rolling[f"wear_number_{wheel}"] for wheel in WHEELS], axis=0)
    worn = simpson(power, x=rolling["time"])
    names = ("kinetic_energy", "potential_energy", "integral_damping_power")
    energy = np.sum([rolling[name] for name in names], axis=0)
    lost = energy[0] - energy[-1]
    assert lost > 3e4
    assert rolling["integral_damping_power"][-1] < 0.2 * lost
    assert worn == pytest.approx(lost, rel=ENERGY_BAND)


def test_wear_number_is_the_sum_of_creep_forces_times_creepages(rolling: Rows) -> None:
    for wheel in WHEELS:
        own = [
            -rolling[f"creep_force_{way}_{place}_{wheel}"] * rolling[f"creepage_{way}_{place}_{wheel}"]
            for way, place in product(("along", "aside"), PLACES)
        ]
        assert sum(own) == pytest.approx(rolling[f"wear_number_{wheel}"], abs=1e-6)
    assert rolling["wear_number_flange_1_right"][-1] > 5 * rolling["wear_number_flange_2_right"][-1] > 0.0


def test_forces_of_the_contacts_are_in_equilibrium_with_wheel_loads(rolling: Rows) -> None:
    for (number, side), sign in zip(product((1, 2), ("left", "right")), (1, -1, 1, -1), strict=True):
        wheel, up, out = f"{number}_{side}", 0.0, 0.0
        for place in PLACES:
            angle, normal = (rolling[f"{name}_{place}_{wheel}"][-1] for name in ("contact_angle", "normal_force"))
            aside = rolling[f"creep_force_aside_{place}_{wheel}"][-1]
            up += normal * np.cos(angle) + sign * aside * np.sin(angle)
            out += normal * np.sin(angle) - sign * aside * np.cos(angle)
        load = rolling[f"wheel_load_{wheel}"][-1]
        assert up == pytest.approx(load, abs=FORCE_BAND[side] * load)
        assert out == pytest.approx(rolling[f"lateral_force_{wheel}"][-1], abs=FORCE_BAND[side] * load)


def test_place_and_area_on_straight_track_are_those_of_rigid_profiles_and_of_hertz(rolling: Rows) -> None:
    pair, vehicle = thesis_pair(), two_axle_bogie()
    place = contact_at(pair, 0.0).position[0]
    assert rolling["contact_position_tread_1_left"][0] == pytest.approx(place, abs=PLACE_BAND)
    load = rolling["normal_force_tread_1_left"][0]
    radius, modulus, head = (vehicle.number(name) for name in ("wheel_radius", "shear_modulus", "rail_head_radius"))
    along, across = 1 / (2 * radius), 1 / (2 * head)

    def integrals(short: float) -> tuple[float, float]:
        return float(ellipk(1 - short**2)), float(ellipe(1 - short**2))

    def ratio(short: float) -> float:  # B / A of semi-axes 1 and short, Johnson (1985), section 4.2
        k, e = integrals(short)
        return (e / short**2 - k) / (k - e)

    less, more = sorted((along, across))
    short = float(brentq(lambda b: ratio(b) - more / less, 1e-3, 1 - 1e-6))
    k, e = integrals(short)
    a = (3 * load * (1 - POISSON_RATIO) / modulus * (k - e) / (2 * np.pi * (1 - short**2) * less)) ** (1 / 3)
    assert rolling["contact_area_tread_1_left"][0] == pytest.approx(np.pi * a**2 * short, rel=AREA_BAND)


def test_contact_outputs_are_refused_where_no_contact_is_computed() -> None:
    with pytest.raises(ValueError, match="contact_outputs must come with level 3 and contact_model 2; got level 2"):
        bb.run("bogie", 1.0, contact_outputs=True)
