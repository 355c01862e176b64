"""Each term of the supervision limits against the text of the standard, at random trains, lines and countries."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from products.supervision import (
    FixedValues,
    Gradients,
    NationalValues,
    Steps,
    SupervisedTrain,
    supervise,
    without_effect,
)
from products.supervision.conversion import BRAKE_POSITIONS
from tests.products.supervision.by_the_text import Case

#: Largest difference of places, sums and roots of numbers of up to 1e6 m [m], also relative to the place [1].
ROUNDED = 1e-6


def steps(rng: np.random.Generator, least: float, most: float, largest: int = 5) -> Steps:
    count = int(rng.integers(1, largest + 1))
    return Steps(np.sort(rng.uniform(1.0, 70.0, count - 1)), rng.uniform(least, most, count))


def times_ten(rng: np.random.Generator, value: float) -> float:
    """Return a value between a tenth and ten times a default."""
    return float(value * 10.0 ** rng.uniform(-1.0, 1.0))


def train(rng: np.random.Generator) -> SupervisedTrain:
    command = bool(rng.random() < 0.6)
    others = {
        "T_traction_cut_off": float(rng.choice([0.0, times_ten(rng, 3.0)])),
        "traction_command": bool(rng.random() < 0.5),
        "service_command": command,
        "service_feedback": command and bool(rng.random() < 0.4),
        "rotating": rng.choice([None, float(rng.uniform(0.3, 15.0))]),
        "A_brake_normal_service": steps(rng, 0.2, 1.0),
        "Kn_plus": steps(rng, 0.0, 0.01),
        "Kn_minus": steps(rng, 0.0, 0.01),
        "without_adhesion": bool(rng.random() < 0.5),
    }
    if rng.random() < 0.5:
        position = str(rng.choice(list(BRAKE_POSITIONS)))
        length = float(rng.uniform(5.0, BRAKE_POSITIONS[position]))
        return SupervisedTrain.of_percentage(float(rng.uniform(30.0, 250.0)), position, length, **others)
    brake = steps(rng, 0.07, 1.4, 7)
    return SupervisedTrain(
        min(times_ten(rng, 300.0), 4095.0),
        Steps(brake.boundaries, brake.values * times_ten(rng, 1.0) ** 0.8),
        steps(rng, 0.05, 1.3, 7),
        times_ten(rng, 3.0),
        times_ten(rng, 3.0),
        Kdry_rst=steps(rng, 0.5, 1.0),
        Kwet_rst=steps(rng, 0.5, 1.0),
        freight=bool(rng.random() < 0.5),
        **others,
    )


def case(rng: np.random.Generator) -> Case:
    kind = str(rng.choice(["EOA", "LOA", "MRSP"]))
    count = int(rng.integers(1, 9))
    country = NationalValues(
        M_NVAVADH=float(rng.uniform(0.0, 1.0)),
        Kv_int=Steps([20.0, 40.0], rng.uniform(0.6, 1.0, 3)),
        Kv_int_b=Steps([20.0, 40.0], rng.uniform(0.6, 1.0, 3)) if rng.random() < 0.7 else None,
        A_NVP12=0.8,
        A_NVP23=1.3,
        Kr_int=Steps([300.0, 700.0], [1.0, 0.9, 0.8]),
        Kt_int=float(rng.uniform(1.0, 1.3)),
        reduced_adhesion=(1.0, 0.7, 0.6),
        guidance=bool(rng.random() < 0.7),
        feedback=bool(count % 4),
    )
    return Case(
        train(rng),
        Gradients(
            np.sort(rng.uniform(-9000.0, 500.0, count)), rng.uniform(-1.0, 1.0, count) * times_ten(rng, 8.0), "permille"
        ),
        country,
        FixedValues(T_warning=2.0, T_indication_more=float(rng.choice([0.0, 4.0]))),
        kind,
        0.0,
        0.0 if kind == "EOA" else float(rng.uniform(0.0, 25.0)),
        times_ten(rng, 100.0) if kind == "EOA" and rng.random() < 0.7 else 0.0,
        float(rng.choice([0.0, -0.5, 0.2, times_ten(rng, 0.4)])),
        [None, 0.0, 0.7][int(rng.integers(3))],
        bool(rng.random() < 0.3),
        float(rng.choice([0.0, 20e3, 45e3, 70e3])),
    )


def test_values_without_effect_are_those_that_change_no_limit() -> None:
    """Each value of a country alone, on trains of all kinds; the values that change a limit are never among them."""
    rng, speeds, seen = np.random.default_rng(61), np.linspace(1.0, 50.0, 9), set()
    changes = {
        "M_NVAVADH": {"M_NVAVADH": 0.5},
        "M_NVKVINT": {"Kv_int": Steps.constant(0.6)},
        "M_NVKVINT_b": {"Kv_int_b": Steps.constant(0.95), "A_NVP23": 0.1},
        "M_NVKRINT": {"Kr_int": Steps.constant(0.7)},
        "M_NVKTINT": {"Kt_int": 1.3},
        "A_NVMAXREDADH1": {"reduced_adhesion": (0.2, 0.7, 0.7)},
        "A_NVMAXREDADH2": {"reduced_adhesion": (1.0, 0.2, 0.7)},
        "A_NVMAXREDADH3": {"reduced_adhesion": (1.0, 0.7, 0.2)},
        "Q_NVGUIPERM": {"guidance": True},
        "Q_NVSBFBPERM": {"feedback": True},
    }
    for _ in range(40):
        own = replace(train(rng), Kwet_rst=Steps.constant(float(rng.choice([1.0, 0.8]))))
        own = replace(own, A_brake_normal_service=None) if rng.random() < 0.3 else own
        slippery = bool(rng.random() < 0.5)
        set_up = {"pipe_fall": 45e3, "slippery": slippery}
        before = supervise(own, 0.0, speeds, **set_up)  # type: ignore[arg-type]
        for name, change in changes.items():
            country = NationalValues(**change)  # type: ignore[arg-type]
            after = supervise(own, 0.0, speeds, national=country, **set_up)  # type: ignore[arg-type]
            same = all(np.array_equal(getattr(before, one), getattr(after, one)) for one in ("EBI", "P", "I"))
            silent = any(one.startswith(f"{name} ") for one in without_effect(own, country, slippery))
            assert same or not silent, name
            seen.add((name, same, silent))
    for name in changes:
        assert {(name, False, False), (name, True, True)} <= seen


@pytest.mark.study
def test_every_limit_is_that_of_the_text() -> None:
    rng = np.random.default_rng(52)
    seen: set[str] = set()
    for _ in range(150):
        one = case(rng)
        speeds = np.sort(rng.uniform(max(one.target, 0.5), 55.0, 3))
        found = supervise(
            one.train,
            one.place,
            speeds,
            kind=one.kind,
            target_speed=one.target,
            beyond=one.beyond,
            gradients=one.line,
            national=one.country,
            fixed=one.fixed,
            A_est=one.A_est,
            V_ura=one.V_ura,
            slippery=one.slippery,
            pipe_fall=one.pipe_fall,
        )
        for n, speed in enumerate(speeds.tolist()):
            for name, place in one.limits(speed).items():
                assert getattr(found, name)[n] == pytest.approx(place, rel=ROUNDED, abs=ROUNDED), (name, one, speed)
                seen.add(name)
    assert seen == {"EBD", "EBI", "SBI2", "SBD", "SBI1", "W", "P", "GUI", "I"}
