"""Test quantities of running behaviour against closed forms and other published formulas."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.signal import lsim

import bogie_braking as bb
from fmu_src.kernel import Kernel
from fmu_src.system import model_of
from rbd_model.contact.depth import Contact
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.ready import two_axle_bogie
from tests.fmu_src.quick_library import quick_library

STEP, SPEED = 2e-3, 20.0
#: Errors: percentiles of a sampled sine; filters on windows that do not end with a period.
PERCENTILE_BAND, WINDOW_BAND = 2e-3, 5e-3
#: Sperling's formulas of 1941 (amplitudes) and of 1956 (weighting) for one vibration.
SPERLING_BAND = 0.03


def recording(duration: float, **columns: object) -> bb.Recording:
    """Return rows at a constant speed; columns: numbers, or functions of time [s]."""
    time = STEP * np.arange(round(duration / STEP) + 1)
    whole = {"time": time, "distance": SPEED * time, "speed": SPEED, "acceleration": 0.0} | columns
    rows = [one(time) if callable(one) else one + np.zeros_like(time) for one in whole.values()]
    return bb.Recording(dict.fromkeys(whole, "1"), np.column_stack(rows))


def on_rails(duration: float, **columns: object) -> bb.Recording:
    """Return rows of one wheelset of 120 kN."""
    forces = {"axle_load_1": 120e3, "guiding_force_1": 0.0}
    for side in ("left", "right"):
        wheel = f"1_{side}"
        forces |= {f"wheel_load_{wheel}": 60e3, f"lateral_force_{wheel}": 0.0, f"derailment_quotient_{wheel}": 0.0}
    return recording(duration, **(forces | columns))


@pytest.mark.parametrize("frequency", [1.3, 4.1, 12.7])
def test_a_sine_of_the_guiding_force_passes_low_pass_mean_and_percentile(frequency: float) -> None:
    """Butterworth's response by the bilinear transform, the mean of a sine over 2 m, and its distribution."""
    force = 30e3
    ride = on_rails(60.0, guiding_force_1=lambda t: force * np.sin(2 * np.pi * frequency * t))
    table = bb.running.en14363(ride, [(100.0, 1100.0)])
    ratio = np.tan(np.pi * frequency * STEP) / np.tan(np.pi * 20.0 * STEP)
    low_passed = force / np.sqrt(1 + ratio**8)
    expected = low_passed * abs(np.sinc(2.0 * frequency / SPEED)) * np.sin(np.pi * (0.9985 - 0.5))
    assert abs(table["guiding_force_1_2m"][0]) == pytest.approx(expected, abs=PERCENTILE_BAND * force)


def test_a_run_without_lateral_motion_is_refused() -> None:
    flat = bb.run("coach", 2.0, level=2, initial_speed=20.0, interval=5e-3)
    with pytest.raises(ValueError, match=r"wheel loads must be above 0; got 0 N .* Run with level=3\."):
        bb.running.en14363(flat)
    with pytest.raises(ValueError, match=r"body must move sideways; .* Run with level=3"):
        bb.running.floor_accelerations(flat, "coach", (0.0, 0.0, 1.2))


def test_quasi_static_and_extreme_values_are_percentiles_of_each_section() -> None:
    """A wheel load that grows linearly is evenly distributed, and the low-pass delays it by a constant time."""
    delay = 2.6131 / (2 * np.pi * 20.0)  # sum of the terms of first order of Butterworth's fourth
    ride = on_rails(50.0, wheel_load_1_left=lambda t: 50e3 + 400.0 * t)
    table = bb.running.en14363(ride, [(200.0, 400.0), (400.0, 1000.0)])
    for row, (begin, end) in enumerate(((10.0, 20.0), (20.0, 50.0))):
        middle, upper = (50e3 + 400.0 * (begin + share * (end - begin) - delay) for share in (0.5, 0.9985))
        assert table["wheel_load_1_left_quasi_static"][row] == pytest.approx(middle, abs=1.0)
        assert table["wheel_load_1_left_largest"][row] == pytest.approx(upper, abs=1.0)


@pytest.mark.parametrize("frequency", [0.3, 2.3, 12.0])
def test_a_sine_of_the_floor_passes_the_band_of_the_ride(frequency: float) -> None:
    """Butterworth's band-pass of order four by the bilinear transform."""
    size, middle = 0.8, 0.25
    ride = recording(
        100.0, acceleration_y=lambda t: middle + size * np.sin(2 * np.pi * frequency * t), acceleration_z=0.0
    )
    table = bb.running.ride_accelerations(ride, [(600.0, 2000.0)])
    low, high, own = np.tan(np.pi * STEP * np.array([0.4, 10.0, frequency]))
    passed = size / np.sqrt(1 + ((own**2 - low * high) / (own * (high - low))) ** 8)
    assert table["acceleration_y_rms"][0] == pytest.approx(passed / np.sqrt(2), abs=PERCENTILE_BAND)
    assert abs(table["acceleration_y_extreme"][0]) == pytest.approx(passed, abs=PERCENTILE_BAND)
    assert table["acceleration_y_quasi_static"][0] == pytest.approx(middle, abs=2 * PERCENTILE_BAND)
    assert table["acceleration_z_rms"][0] == 0.0


def test_the_verdict_names_the_value_that_is_nearest_to_its_limit() -> None:
    table = bb.running.en14363(on_rails(5.0, guiding_force_1=-55e3, derailment_quotient_1_right=0.6))
    assert table.messages[0] == (
        "Sum of guiding forces, mean over 2 m: 55.0 kN, ABOVE the limit of 50.0 kN (wheelset 1, section 1)."
    )
    assert table.messages[1] == "Y/Q, mean over 2 m: 0.60, within the limit of 0.80 (wheelset 1 right, section 1)."


#: Factors of Wd at third octaves [Hz], ISO 2631-1:1997, table 3.
PRINTED = {0.5: 0.853, 1.0: 1.011, 2.0: 0.890, 4.0: 0.512, 8.0: 0.253}


@pytest.mark.parametrize("frequency", PRINTED)
def test_mean_comfort_of_a_lateral_sine_has_the_printed_factor(frequency: float) -> None:
    ride = recording(
        320.0, acceleration_x=0.0, acceleration_y=lambda t: np.sin(2 * np.pi * frequency * t), acceleration_z=0.0
    )
    found = bb.running.mean_comfort(ride)
    assert found["windows"][0] == 64
    assert found["mean_comfort"][0] == pytest.approx(6 * PRINTED[frequency] / np.sqrt(2), rel=WINDOW_BAND)


def test_mean_comfort_of_a_vertical_sine_is_that_of_the_filter_in_time() -> None:
    """Wb as one differential equation, integrated by SciPy: the product multiplies spectra by its response."""
    ride = recording(20.0, acceleration_x=0.0, acceleration_y=0.0, acceleration_z=lambda t: np.sin(40.0 * t))

    def second(own: float, resonance: float) -> np.ndarray:
        return np.array([1 / (2 * np.pi * own) ** 2, 1 / (resonance * 2 * np.pi * own), 1.0])

    above = np.polymul(
        [0.4 / (2 * np.pi * 0.4) ** 2, 0.0, 0.0], np.polymul([1 / (2 * np.pi * 16.0), 1.0], second(2.5, 0.8))
    )
    below = np.polymul(
        np.polymul(second(0.4, 0.5**0.5), second(100.0, 0.5**0.5)), np.polymul(second(16.0, 0.63), second(4.0, 0.8))
    )
    _, passed, _ = lsim((above, below), ride["acceleration_z"], ride["time"])
    sizes = np.sqrt(np.mean(passed[: 4 * 2500].reshape(4, 2500) ** 2, axis=1))
    found = bb.running.mean_comfort(ride)
    assert found["mean_comfort"][0] == pytest.approx(6 * np.percentile(sizes, 95.0), rel=WINDOW_BAND)
    assert found.status == "Mean comfort from 4 windows of 5 s; EN 12299 takes 60."


@pytest.mark.parametrize("frequency", [1.0, 3.0, 5.0, 10.0])
def test_sperlings_index_of_a_sine_is_that_of_his_formula_for_amplitudes(frequency: float) -> None:
    """W_z = 0.896 (a^3 F(f) / f)^(1/10) with a in cm/s2: Sperling's first formula has other factors of frequency."""
    ride = recording(
        60.0,
        acceleration_y=lambda t: 0.1 * np.sin(2 * np.pi * frequency * t),
        acceleration_z=lambda t: 0.2 * np.sin(2 * np.pi * frequency * t),
    )
    found = bb.running.sperling(ride)
    of_lateral = 0.8 * frequency**2 if frequency < 5.4 else 650 / frequency**2
    of_vertical = 0.325 * frequency**2 if frequency < 5.9 else 400 / frequency**2
    for name, amplitude, factor in (("lateral", 10.0, of_lateral), ("vertical", 20.0, of_vertical)):
        expected = 0.896 * (amplitude**3 * factor / frequency) ** 0.1
        assert found[f"sperling_{name}"][0] == pytest.approx(expected, rel=SPERLING_BAND)


def turn(axis: int, angle: np.ndarray) -> np.ndarray:
    """Return matrices that turn about an axis of 0 to 2."""
    one, two = (axis + 1) % 3, (axis + 2) % 3
    found = np.zeros((angle.size, 3, 3))
    found[:, axis, axis], found[:, one, one], found[:, two, two] = 1.0, np.cos(angle), np.cos(angle)
    found[:, one, two], found[:, two, one] = -np.sin(angle), np.sin(angle)
    return found


@pytest.mark.parametrize("size", [0.1, 1.0])
def test_accelerations_of_a_point_are_those_of_its_place_in_space(size: float) -> None:
    """Its path by integrals and matrices, with curve, cant, gradient, roll, pitch and yaw at once."""
    sizes = {"lateral": 5e-3, "bounce": 4e-3, "roll": 1e-2, "pitch": 3e-3, "yaw": 2e-3}
    waves = {
        f"body_{name}": lambda t, a=a, n=n: size * a * np.sin((2 + 0.5 * n) * t + n)
        for n, (name, a) in enumerate(sizes.items())
    }
    ride, places = recording(12.0, **waves), np.linspace(0.0, 250.0, 2501)
    grows = 0.5 - 0.5 * np.cos(np.pi * np.clip((places - 50.0) / 100.0, 0.0, 1.0))
    rows = {"curvature": grows / 300.0, "cant": 0.12 * grows, "gradient": 0.02 * grows}
    line = bb.Line({"distance": places, **rows})
    curvature, cant, gradient = (line.value(name, ride["distance"]) for name in rows)
    coach, time = bb.vehicle("coach"), ride["time"]
    height = coach.number(coach.wheelsets[0].mean_radius) + coach.number(coach.bodies[0].height)
    heading, slope, cants = (
        SPEED * STEP * (np.cumsum(curvature) - curvature / 2),
        np.arcsin(gradient),
        np.arcsin(cant / 1.5),
    )
    velocity = SPEED * np.cos(slope)
    path = STEP * np.cumsum([velocity * np.cos(heading), velocity * np.sin(heading), SPEED * gradient], axis=1).T
    lateral, bounce, roll, pitch, yaw = (ride[name] for name in waves)
    offset = np.column_stack([0.0 * time, lateral, height + bounce])[:, :, None]
    axes = turn(2, heading) @ turn(1, -slope) @ turn(0, -cants) @ turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)
    arms = turn(2, heading) @ turn(0, -cants) @ offset + axes @ np.array([[9.0], [1.2], [1.2 - height]])
    weight = np.array([0.0, 0.0, 9.81])
    felt = make_interp_spline(time, path + arms[:, :, 0], 5).derivative(2)(time) + weight
    found = bb.running.floor_accelerations(ride, "coach", (9.0, 1.2, 1.2), line=line)
    expected = (axes.transpose(0, 2, 1) @ felt[:, :, None])[:, :, 0] - weight
    for axis, values in zip("xyz", expected.T, strict=True):
        assert np.ptp(values) > 0.05
        assert found[f"acceleration_{axis}"][5:-5] == pytest.approx(values[5:-5], abs=1e-3)


def test_a_body_that_stays_level_in_a_vertical_curve_rises_alike_at_both_ends() -> None:
    """v^2 / R everywhere, and no gravity ahead: only v cos(slope) changes."""
    before, behind = bb.straight(100), bb.straight(100, 0.02)
    line = bb.line_of([before, bb.clothoid(40, before, behind), behind])
    levelled = {"body_pitch": lambda t: np.arcsin(line.value("gradient", SPEED * t)), "body_lateral": 1e-3}
    ride = recording(10.0, body_bounce=0.0, body_roll=0.0, body_yaw=0.0, **levelled)
    for ahead in (-9.0, 0.0, 9.0):
        found = bb.running.floor_accelerations(ride, "coach", (ahead, 0.0, 1.2), line=line)
        rising = SPEED**2 * 0.02 / 40 * ((ride["distance"] > 102.0) & (ride["distance"] < 138.0))
        inside = np.abs(np.abs(ride["distance"] - 120.0) - 20.0) > 2.0  # corners are rounded
        assert found["acceleration_z"][inside] == pytest.approx(rising[inside], abs=1e-4)
        slower = -rising * line.value("gradient", ride["distance"])
        assert found["acceleration_x"][inside] == pytest.approx(slower[inside], abs=1e-6)


def test_accelerations_in_a_curve_are_those_of_the_place_in_space(tmp_path: Path) -> None:
    """Derivatives of the frame's place in inertial axes, turned by its heading and roll."""
    vehicle = two_axle_bogie()
    system = spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(2), on_line=True)
    system = system.with_outputs([f"frame_{name}" for name in ("ahead", "aside", "above", "heading")])
    before, curve = bb.straight(20), bb.arc(length=60, radius=150, cant=0.05)
    line = bb.line_of([before, bb.clothoid(30, before, curve), curve])
    path = str(line.write(tmp_path / "line.csv"))
    kernel = Kernel(quick_library(model_of(system, 1e-8)), line_file=path, initial_speed=12.0, tolerance=1e-8)
    names = [one.name for one in system.variables if one.causality == "output"]
    table = kernel.record(6.0, STEP, names)
    ride = bb.Recording(dict.fromkeys(table, "1"), np.column_stack(list(table.values())))
    time, body = ride["time"], vehicle.bodies[0]
    height = vehicle.number(vehicle.wheelsets[0].mean_radius) + vehicle.number(body.height)
    found = bb.running.floor_accelerations(ride, vehicle, (0.0, 0.0, height), "frame", line)
    ahead, aside, above = (
        make_interp_spline(time, ride[f"frame_{name}"], 5).derivative(2)(time) for name in ("ahead", "aside", "above")
    )
    heading = ride["frame_heading"]
    inwards = np.cos(heading) * aside - np.sin(heading) * ahead
    roll = ride[body.variable("roll")] - np.arcsin(line.value("cant", ride["distance"]) / 1.5)
    expected = inwards * np.cos(roll) + (9.81 + above) * np.sin(roll)
    assert expected.max() > 0.7
    assert found["acceleration_y"] == pytest.approx(expected, abs=2e-3)
    assert found["acceleration_z"] == pytest.approx(
        (9.81 + above) * np.cos(roll) - inwards * np.sin(roll) - 9.81, abs=1e-4
    )


def test_a_wear_map_keeps_the_energy_and_finds_the_curve() -> None:
    before, curve = bb.straight(100), bb.arc(length=200, radius=500)
    line = bb.line_of([before, bb.clothoid(50, before, curve), curve])
    ride = recording(15.0, wear_number_1_left=lambda t: np.where(SPEED * t > 150.0, 200.0, 10.0))
    along = bb.running.wear_map(ride, 30.0)
    worn = np.trapezoid(ride["wear_number_1_left"], ride["distance"])
    assert along["length"] @ along["wear_number_1_left"] == pytest.approx(worn, rel=1e-12)
    assert along["distance"].tolist() == [15.0 + 30.0 * n for n in range(10)]
    by_curvature = bb.running.wear_map(ride, 1e-3, line)
    assert by_curvature["curvature"] == pytest.approx([0.0, 1e-3, 2e-3])
    assert by_curvature["wear_number_1_left"][[0, 2]] == pytest.approx([10.0, 200.0], rel=0.2)


def test_recordings_that_cannot_be_assessed_are_refused() -> None:
    ride = on_rails(2.0)
    coarse = bb.Recording(ride.units, np.column_stack([ride[name][::5] for name in ride.names]))
    with pytest.raises(ValueError, match=r"interval of the rows must be at most 0\.005 s; got 0\.01 s"):
        bb.running.en14363(coarse)
    with pytest.raises(ValueError, match="within the run, 0 to 40 m; got 0 to 50 m"):
        bb.running.en14363(ride, [(0, 50)])
    with pytest.raises(ValueError, match="distance must grow from row to row"):
        bb.running.en14363(on_rails(2.0, distance=0.0))
    with pytest.raises(ValueError, match="must last at least 5 s"):
        bb.running.mean_comfort(recording(2.0, acceleration_x=0.0, acceleration_y=0.0, acceleration_z=0.0))
    with pytest.raises(KeyError, match="run with contact_outputs=True"):
        bb.running.wear_map(ride, 10.0)
    with pytest.raises(ValueError, match="must have at least 2 rows; got 1"):
        bb.running.wear_map(bb.Recording({"distance": "m", "wear_number_1_left": "N"}, [[0.0, 1.0]]), 10.0)
    with pytest.raises(ValueError, match="place must be three numbers within 50 m"):
        bb.running.floor_accelerations(ride, "coach", (9000.0, 0.0, 1.0))
