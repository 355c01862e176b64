"""Test the toothed-wheel sensor against closed forms of the motion that it measures."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from brake_controller.sensors import GATE, TIMER
from brake_controller.slide_protection import RIG
from tests.encoder import Encoder

PERIOD, RADIUS = 5e-3, 0.425
#: Required relative accuracy of a reading.
READING = 1e-3
#: Teeth and their errors as shares of the pitch; the last number of teeth is that of the encoders of the experiment.
TEETH, JITTERS = (80, 100, 128, 10000), (0.0, 0.1, 0.3)


@pytest.mark.parametrize("teeth", TEETH)
@pytest.mark.parametrize("jitter", JITTERS)
def test_constant_speed_is_read_within_the_timer_and_the_errors_of_the_teeth(teeth: int, jitter: float) -> None:
    # With 10000 teeth edges arrive every 9 us, nine times the timer's resolution.
    encoder, omega = Encoder(teeth, jitter), 73.7
    spread = max(encoder.errors) - min(encoder.errors) if encoder.errors else 0.0
    pitches = encoder.gate * omega / encoder.pitch
    timer = 2.0 * encoder.resolution / encoder.gate
    # At least the gate less the errors of two edges. Until a late edge arrives the reading falls.
    low, high = 1.0 / (1.0 + spread), 1.0 + spread / max(1.0, pitches - spread)
    found = [encoder.angular_velocity(number * PERIOD, omega * number * PERIOD) for number in range(400)][20:]
    assert omega * (low - timer) <= min(found)
    assert max(found) <= omega * (high + timer)
    if jitter == 0.0:
        assert found == pytest.approx([omega] * len(found), rel=timer)


@pytest.mark.parametrize("teeth", [60, 100, 300])
@pytest.mark.parametrize("timer", [1e-6, 1e-5])
@pytest.mark.parametrize("speed", [3.0, 11.7, 55.0])
def test_edges_of_a_wheel_that_turns_evenly_tell_its_speed(teeth: int, timer: float, speed: float) -> None:
    """Two times, truncated to the timer's resolution, at least a gate apart: the error is at most timer over gate."""
    encoder, omega = Encoder(teeth, resolution=timer), speed / RADIUS
    found = [encoder.angular_velocity(number * PERIOD, omega * number * PERIOD) for number in range(200)][100:]
    assert max(abs(one / omega - 1.0) for one in found) < 1.01 * timer / GATE < READING


def test_a_sliding_wheel_is_seen_late_by_half_of_the_gate() -> None:
    """At a deceleration a, the mean over a window w that ended t ago is too high by a (w / 2 + t). The reading is
    limited to one pitch over t. It is too high as well, because no edge has arrived since.
    """
    start, slows, encoder = 20.0, 10.0, Encoder(100)
    late = []
    for time in (PERIOD * number for number in range(1, 300)):
        speed = start - slows * time
        if speed < 5.0:
            break
        seen = RADIUS * encoder.angular_velocity(time, (start * time - slows * time**2 / 2) / RADIUS)
        if time > 0.2:
            pitch = encoder.pitch * RADIUS / speed
            late.append((seen - speed) / slows)
            assert 0.0 < late[-1] < (GATE + pitch) / 2 + pitch + TIMER
    assert GATE / 2 < np.median(late) < GATE


@pytest.mark.parametrize("teeth", [80, 100, 128])
def test_uniform_deceleration_reads_the_mean_between_two_edges(teeth: int) -> None:
    """Edge k of theta = w t - a t2 / 2 passes at (w - sqrt(w2 - 2 a theta)) / a."""
    encoder, omega, slows, look = Encoder(teeth), 20.0, 4.0, 1e-3

    def passes(edge: int) -> float:
        return (omega - math.sqrt(omega**2 - 2.0 * slows * edge * encoder.pitch)) / slows

    for number in range(round(4.5 / look)):
        time = number * look
        angle = omega * time - slows * time**2 / 2.0
        found = encoder.angular_velocity(time, angle)
        last = math.floor(angle / encoder.pitch + 1e-9)
        if last > 20:
            # The time of an edge between two samples assumes constant speed: its error is at most a look2 / 8 / w.
            late = 2.0 * (slows * look**2 / 8.0 / (omega - slows * time) + encoder.resolution)
            since, edges = passes(last) - encoder.gate, range(last - 20, last)
            firsts = {max(edge for edge in edges if passes(edge) <= since + shift) for shift in (-late, late)}
            means = [(last - first) * encoder.pitch / (passes(last) - passes(first)) for first in firsts]
            age = max(time - passes(last), encoder.resolution)
            band = late / min(encoder.gate, age) * found
            assert min(abs(found - min(mean, encoder.pitch / age)) for mean in means) <= band


def test_a_wheel_that_stops_is_read_ever_slower_and_then_as_standing() -> None:
    encoder, omega, stops = Encoder(100), 10.0, 1.0
    for number in range(500):
        time = number * PERIOD
        found = encoder.angular_velocity(time, omega * min(time, stops))
        if time > stops + encoder.pitch / omega:
            assert found <= encoder.pitch / (time - stops - encoder.resolution)
        if time > stops + 1.0 / encoder.lowest_frequency:
            assert found == 0.0


def test_a_standing_wheel_and_one_below_the_lowest_frequency_are_read_as_zero() -> None:
    encoder = Encoder(100)
    slow = 0.9 * encoder.lowest_frequency * encoder.pitch
    assert all(Encoder().angular_velocity(number * PERIOD, 1.234) == 0.0 for number in range(50))
    assert all(encoder.angular_velocity(number * PERIOD, slow * number * PERIOD) == 0.0 for number in range(400))


def test_the_reading_does_not_depend_on_how_often_it_is_looked_at() -> None:
    """Two sensors on one wheel at constant speeds with a jump, sampled every 1 and every 5 ms."""
    often, seldom = Encoder(80, jitter=0.2), Encoder(80, jitter=0.2)
    for number in range(2000):
        time = number * 1e-3
        angle = 30.0 * min(time, 1.0) + 12.0 * max(0.0, time - 1.0)
        found = often.angular_velocity(time, angle)
        if number % 5 == 0:
            timer = 2.0 * often.resolution / often.gate
            assert seldom.angular_velocity(time, angle) == pytest.approx(found, rel=2.0 * timer)


def test_one_probe_does_not_see_the_direction() -> None:
    forward, backward = Encoder(), Encoder()
    for number in range(100):
        found = backward.angular_velocity(number * PERIOD, -0.1 * number)
        assert found == forward.angular_velocity(number * PERIOD, 0.1 * number)


def test_jitter_is_the_same_for_the_same_seed() -> None:
    def noisy(seed: int) -> list[float]:
        encoder = Encoder(pulses=200, jitter=0.5, seed=seed)
        return [encoder.angular_velocity(number * PERIOD, 0.1 * number) for number in range(50)]

    assert noisy(1) == noisy(1)
    assert noisy(1) != noisy(2)


def test_a_wheel_that_is_turned_at_the_first_look_shows_its_teeth_sooner() -> None:
    """A phase of 0.4 teeth equals a wheel turned that far. It changes the error of the reading."""
    turned, rate = 0.4 * math.tau / 100, 1.3
    times = [0.01 * n for n in range(60)]

    def seen(sensor: Encoder, begin: float) -> list[float]:
        return [sensor.angular_velocity(time, begin + rate * time) for time in times]

    ahead = seen(Encoder(phase=0.4), 0.0)
    assert ahead == pytest.approx(seen(Encoder(), turned), rel=1e-9)
    assert len(set(ahead)) > 5
    assert ahead != pytest.approx(seen(Encoder(), 0.0), rel=READING)


def test_a_coarse_timer_shows() -> None:
    probe, omega = Encoder(resolution=1e-3), 27.5
    found = [probe.angular_velocity(number * PERIOD, omega * number * PERIOD) for number in range(200)][100:]
    assert max(abs(one / omega - 1.0) for one in found) > READING


#: Number of samples that a sensor stores.
SAMPLES = int(re.findall(r"#define ENCODER_SAMPLES (\d+)", (RIG / "encoder.h").read_text(encoding="utf-8"))[0])


@pytest.mark.parametrize("share", [1.0, 0.5, 0.1, 0.01])
def test_a_sensor_that_is_looked_at_more_often_than_it_remembers_shows_the_speed(share: float) -> None:
    """At 20 m/s2 the reading is between the present speed and that half a gate ago."""
    period, probe = share * GATE / SAMPLES, Encoder(1000)
    for n in range(round(0.2 / period)):
        time = period * n
        shown = probe.angular_velocity(time, (55.0 * time - 10.0 * time**2) / RADIUS)
        if time > 0.1:
            low, high = 55.0 - 20.0 * time, 55.0 - 20.0 * (time - GATE / 2)
            assert low * (1.0 - READING) < shown * RADIUS < high * (1.0 + READING)
