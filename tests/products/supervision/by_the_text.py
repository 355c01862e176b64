"""SUBSET-026, 3.13.4 to 3.13.9, for one train, one target and one speed, paragraph by paragraph and without arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import inf, sqrt

from products.supervision import FixedValues, Gradients, NationalValues, Steps, SupervisedTrain

KMH = 1.0 / 3.6
#: Distance behind a boundary at which a value is read [m], [m/s].
BEHIND = 1e-9
#: Shares of longer build-up where the target speed is above 0, A.3.8.5.
LONGER = {"passenger P": 0.2, "freight P": 0.2, "freight G": 0.16}


def value(steps: Steps, at: float) -> float:
    """Return AD_n for V_n < V <= V_(n + 1), 3.13.2.2.3.1.3."""
    n = 0
    for boundary in steps.boundaries.tolist():
        if at > boundary:
            n += 1
    return float(steps.values[n])


@dataclass(frozen=True)
class Case:
    """All inputs of a case; `target` is the speed of the target [m/s]."""

    train: SupervisedTrain
    line: Gradients
    country: NationalValues
    fixed: FixedValues
    kind: str
    place: float
    target: float
    beyond: float
    A_est: float
    V_ura: float | None
    slippery: bool
    pipe_fall: float

    def lowest(self, front: float) -> float:
        """Return the lowest gradient between front and rear, 3.13.4.2.1."""
        starts = [-inf, *self.line.starts[1:].tolist(), inf]
        under = [
            gradient
            for (first, last), gradient in zip(pairwise(starts), self.line.permille.tolist(), strict=True)
            if first < front and last > front - float(self.train.length)
        ]
        return min(under)

    def by_gradient(self, front: float) -> float:
        """Return A_gradient, 3.13.4.3.2."""
        gradient, known = self.lowest(front), self.train.rotating
        mass = known if known is not None else 15.0 if gradient > 0.0 else 2.0
        return 9.81 * gradient / (1000.0 + 10.0 * float(mass))

    def safe(self, V: float, front: float) -> float:
        """Return A_safe, 3.13.6.2.1."""
        train, country = self.train, self.country
        brake = value(train.A_brake_emergency, V)
        if train.position is None:
            wet = value(train.Kwet_rst, V)
            brake *= value(train.Kdry_rst, V) * (wet + country.M_NVAVADH * (1.0 - wet))
        else:
            brake *= self.Kv_int(V) * value(country.Kr_int, float(train.length))
        if self.slippery:
            freight = train.freight if train.position is None else train.position.startswith("freight")
            brake = min(brake, country.reduced_adhesion[2 if freight else 0 if train.without_adhesion else 1])
        return brake + self.by_gradient(front)

    def Kv_int(self, V: float) -> float:
        """Return the correction by speed, between two sets for passenger trains, 3.13.6.2.1.8."""
        low, high = self.country.Kv_int, self.country.Kv_int_b
        if high is None or self.train.position != "passenger P":
            return value(low, V)
        a, first, last = self.A_ebmax, self.country.A_NVP12, self.country.A_NVP23
        if a <= first:
            return value(low, V)
        if a >= last:
            return value(high, V)
        return value(low, V) + (a - first) / (last - first) * (value(high, V) - value(low, V))

    @cached_property
    def A_ebmax(self) -> float:
        """Return the largest deceleration at any speed, 3.13.6.2.1.8.2."""
        brake = self.train.A_brake_emergency
        return max(value(brake, V + BEHIND) for V in [0.0, *brake.boundaries.tolist()])

    def expected(self, V: float, front: float) -> float:
        """Return A_expected, 3.13.6.3.1.3."""
        return value(self.train.A_brake_service, V) + self.by_gradient(front)

    def normal(self, V: float, front: float) -> float:
        """Return A_normal_service, 3.13.6.4.3."""
        train, gradient = self.train, self.lowest(front)
        assert train.A_brake_normal_service is not None
        factor = train.Kn_plus if gradient > 0.0 else train.Kn_minus
        return value(train.A_brake_normal_service, V) + self.by_gradient(front) - value(factor, V) * gradient

    def curve(self, brake: Callable[[float, float], float], foot: tuple[float, float], V: float) -> float:
        """Return where the curve through a foot has a speed, 3.13.8.1.3: arcs of parabola."""
        train, country = self.train, self.country
        factors = (train.Kdry_rst, train.Kwet_rst, train.Kn_plus, train.Kn_minus, country.Kv_int)
        brakes = (train.A_brake_emergency, train.A_brake_service, train.A_brake_normal_service, country.Kv_int_b)
        speeds = [V, *(b for one in (*brakes, *factors) if one is not None for b in one.boundaries.tolist())]
        changes = self.line.starts[1:].tolist()
        places = changes + [one + float(train.length) for one in changes]
        place, speed = foot
        way = 1 if speed < V else -1
        while (V - speed) * way > 0.0:
            a = brake(speed + way * BEHIND, place - way * BEHIND)
            if a <= 0.0:
                return -inf if way > 0 else place
            until = min((one for one in speeds if (one - speed) * way > BEHIND), key=lambda one: (one - speed) * way)
            ahead = [one for one in places if (place - one) * way > BEHIND]
            edge = min(ahead, key=lambda one: abs(place - one), default=-inf * way)
            far = abs(until**2 - speed**2) / (2.0 * a)
            if abs(place - edge) < far:
                place, speed = edge, sqrt(speed**2 + way * 2.0 * a * abs(place - edge))
            else:
                place, speed = place - way * far, until
        return place

    def f41(self, V: float) -> float:
        """Return the predicted error of the speed, SUBSET-041, 5.3.1.2."""
        if self.V_ura == 0.0:
            return 0.0
        return (2.0 + 10.0 * min(max(V / KMH - 30.0, 0.0), 470.0) / 470.0) * KMH

    def times(self) -> tuple[float, float, float]:
        """Return T_be, T_bs of the target, 3.13.6.2.2.3 and A.3.8.4, and T_bs of the train."""
        train = self.train
        T_be, T_bs = float(train.T_brake_emergency), float(train.T_brake_service)
        if train.position is not None:
            longer = 1.0 + LONGER[train.position] if self.target > 0.0 else 1.0
            T_be, T_bs = T_be * longer * self.country.Kt_int, T_bs * longer
        return T_be, T_bs, T_bs

    def service(self) -> tuple[float, float]:
        """Return T_bs1 and T_bs2, 3.13.9.3.3.3 to 5, A.3.10.4.8."""
        T_bs, train, fall = self.times()[1], self.train, self.pipe_fall / 1e3
        if not train.service_command:
            return 0.0, 0.0
        if not (train.service_feedback and self.country.feedback):
            return T_bs, T_bs
        if fall >= 60.0:
            return 0.0, 2.0
        with_feedback = T_bs * (150.0 - fall) / 150.0 if fall >= 30.0 else T_bs
        return with_feedback, max(with_feedback, 2.0)

    def foot(self) -> tuple[float, float]:
        """Return the foot of EBD, 3.13.8.3: V_target + dV_ebi at the target, or rest at the SvL."""
        if self.kind == "EOA":
            return self.place + self.beyond, 0.0
        margin = 7.5 + 7.5 * min(max(self.target / KMH - 110.0, 0.0), 100.0) / 100.0
        return self.place, self.target + margin * KMH

    def EBD(self, V: float) -> float:
        return self.curve(self.safe, self.foot(), V)

    def EBI(self, V: float, error: float, A_est: float) -> float:
        """Return d_EBI, 3.13.9.3.2."""
        T_be, cut_off = self.times()[0], float(self.train.T_traction_cut_off)
        if self.train.traction_command:
            cut_off = max(cut_off - (self.fixed.T_warning + self.service()[1]), 0.0)
        T_berem = max(T_be - cut_off, 0.0)
        V_delta1, V_delta2 = max(A_est, 0.0) * cut_off, min(max(A_est, 0.0), 0.4) * T_berem
        V_bec = max(V + error + V_delta1, self.target) + V_delta2
        D_bec = max(V + error + V_delta1 / 2.0, self.target) * cut_off
        D_bec += (max(V + error + V_delta1, self.target) + V_delta2 / 2.0) * T_berem
        return self.EBD(V_bec) - D_bec

    def limits(self, V: float) -> dict[str, float]:
        """Return the places of all limits, 3.13.9.3."""
        T_bs1, T_bs2 = self.service()
        error = self.f41(V) if self.V_ura is None else self.V_ura
        found = {"EBD": self.EBD(V), "EBI": self.EBI(V, error, self.A_est)}
        found["SBI2"] = SBI = found["EBI"] - V * T_bs2
        if self.kind == "EOA":
            found["SBD"] = self.curve(self.expected, (self.place, 0.0), V)
            found["SBI1"] = found["SBD"] - V * T_bs1
            SBI = min(SBI, found["SBI1"])
        found["W"], found["P"] = SBI - V * self.fixed.T_warning, SBI - V * self.fixed.T_driver
        if self.country.guidance and self.train.A_brake_normal_service is not None:
            start = self.place
            if self.kind != "EOA":
                start = self.EBI(self.target, self.f41(self.target), 0.0)
                start -= self.target * (self.fixed.T_driver + T_bs2)
            found["GUI"] = self.curve(self.normal, (start, self.target), V) if start > -inf else -inf
            found["P"] = min(found["P"], found["GUI"])
        T_indication = 5.0 if self.train.service_feedback and self.country.feedback else max(0.8 * self.times()[2], 5.0)
        found["I"] = found["P"] - V * (T_indication + self.fixed.T_indication_more)
        return found
