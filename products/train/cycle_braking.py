"""Braking on a descent with valves that release wholly: balanced by a dynamic brake or power, else in cycles.

So is balanced and cycle braking described in North America (no rule book was read). The dynamic brake comes first. Then
one reduction gives the force that the gradient needs, and small further ones correct it. If this slows the train, air
is released at a lower bound, the reservoirs charge while retainers and the dynamic brake hold, and air is applied
again before an upper bound. A train that would gain more than both bounds while it charges is not released, and stops.
Numbers without a source are assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from products.train.consist import forces_of
from products.train.driver_forces import SPEEDS, line_force, moved_mass, resistance_of, train_forces
from products.train.train import Train

#: Times [s]: of the estimate of the balancing force, of a correction of speed by the fast brakes and by air, by which
#: an application is made ahead, in which brakes build up, by which a release is made ahead, and between two reductions
#: beside 1 s for each SECOND_OVER m of train.
FEELS, FAST, SLOW, LEADS, BUILDS, RELEASES, WAITS, SECOND_OVER = 6.0, 8.0, 40.0, 10.0, 5.0, 6.0, 12.0, 100.0
#: Deviations of speed [m/s]: at which air is applied if it balances the train, and if it slows the train; below, at
#: which air is released; the largest one of a cycle.
ABOVE, LATER, BELOW, BOUND = 0.2, 1.0, 1.1, 1.5
#: Shares of the whole brake: of a minimum reduction, 1.2 to 1.4 of 3.57 bar, and of the air that quick service adds.
#: The auxiliary reservoir fills the cylinder to 2.5 times the fall of the pipe.
MINIMUM, QUICK = 0.36, 0.09
#: Share of the dynamic brake that air leaves to trim the speed; least and largest further reduction, of the air brake;
#: deceleration of a cycle [m/s2].
TRIMS, SMALLEST, LARGEST, FALLS = 0.5, 0.01, 0.08, 0.02
#: Falls of the pipe in full service and at which it is taken as charged [Pa] (UIC 540; assumed).
SERVICE, CHARGED = 1.5e5, 0.1e5
#: The root of the pressure that reservoirs lack falls by 1 bar^0.5 in CHARGES + (length / DIFFUSES)^2 [s]: a choke at
#: a small difference (ISO 6358-1), and a pipe that fills as by diffusion. Fitted to releases of 1 to 100 cars of this
#: model.
CHARGES, DIFFUSES = 35.0, 90.0
#: Pressure of cylinders in full service [Pa]; volume of the auxiliary reservoir over that of the cylinder.
FULL, FILLS = 3.57e5, 2.5
#: Speed below which a train is taken as at rest [m/s].
STANDS = 0.1
#: Length of train for each second in which the dynamic brake falls to 0 [m/s]: faster, slack runs out behind it.
EASES = 50.0


@dataclass
class CycleBraking:
    """The brakes of a descent: the air in use as a share of all, and what the driver has felt."""

    train: Train
    least: float
    air: float = 0.0
    dynamic: float = 0.0
    traction: float = 0.0
    refused: str = ""
    _balance: float = math.nan
    _rate: float = 0.0
    _speed: float = math.nan
    _electric: float = 0.0
    _time: float = 0.0
    _changed: float = -math.inf
    _charged: float = 0.0
    _empty: float = 0.0

    def __post_init__(self) -> None:
        vehicles = self.train.consist.vehicles
        kept = [np.full(SPEEDS.size, getattr(one.distributor, "retained_pressure", 0.0)) for one in vehicles]
        retained = np.sum([forces_of(one.brake, p, SPEEDS) for one, p in zip(vehicles, kept, strict=True)], axis=0)
        self._forces: NDArray[np.float64] = np.vstack([train_forces(self.train.consist)[:3], retained])
        self._mass = moved_mass(self.train.consist)
        self._pulls = bool(self._forces[0].any())
        self._charging = CHARGES + (self.train.consist.length / DIFFUSES) ** 2

    def act(self, wanted: float, fast: bool) -> None:
        """Set shares of air, dynamic brake and traction for a speed [m/s]; fast: whether the dynamic brake is used."""
        speed = float(np.mean(self.train.speed))
        motors, electric, full, retained = (float(np.interp(speed, SPEEDS, row)) for row in self._forces)
        able, over = electric if fast else 0.0, speed - wanted
        period = self.train.time - self._time
        air = self._feel(speed)
        self._charged = max(self._charged, float(self.train.pipe_pressure[0]))
        charging = not self.air and float(self.train.pipe_pressure[-1]) < self._charged - CHARGED
        # a train that charges is held at its speed, not pulled: its rear still brakes
        trim = self._balance + self._mass * (max(over, 0.0) if charging else over) / FAST - air
        eased = self.dynamic - EASES / self.train.consist.length * period
        self.dynamic = min(max(trim / able, eased, 0.0), 1.0) if able else 0.0
        self.traction = min(max(-trim / motors, 0.0), 1.0) if motors and not charging else 0.0
        before = self.air
        if not self.air:
            self._apply(over, air, able, trim, full)
        elif self._slows(over) and self._gains(able, full, retained):
            self._empty, self.air = self._charged - float(self.train.pipe_pressure[-1]), 0.0
        else:
            self.air = self._added(over, air, able, full)
        if self.air != before:
            self._changed = self.train.time

    def _feel(self, speed: float) -> float:
        """Update the force of brakes that would keep the speed [N], and return that of the air brake."""
        train = self.train
        step, brakes = train.time - self._time, float(np.sum(train.brake_force))
        if math.isnan(self._speed) or step <= 0.0:
            front = np.array([train.distance[0] + train.consist.vehicles[0].length / 2])
            a, b, c = resistance_of(train.consist)
            self._balance = -float(line_force(train.consist, train.line, front)[0]) - a - b * speed - c * speed**2
            self._speed, self._time = speed, train.time
            self._electric = float(np.sum(train.electric_brake_energy))
            return brakes
        energy = float(np.sum(train.electric_brake_energy))
        electric = (energy - self._electric) / max(abs(speed) * step, 0.1)
        rate = (speed - self._speed) / step
        felt = brakes - float(np.sum(train.traction_force)) + self._mass * rate
        share = min(step / FEELS, 1.0) if speed > STANDS else 0.0  # at rest brakes hold what the gradient pulls
        self._balance += (felt - self._balance) * share
        self._rate += (rate - self._rate) * share
        self._speed, self._electric, self._time = speed, energy, train.time
        return max(brakes - electric, 0.0)

    def _lacks(self, air: float, able: float, rate: float) -> float:
        """Return the force that air lacks to balance the gradient with a dynamic brake, or to slow at a rate [N]."""
        return self._balance - air + (-TRIMS * able if able else self._mass * rate)

    def _apply(self, over: float, air: float, able: float, trim: float, full: float) -> None:
        """Apply the air that the gradient needs, below the pressure that an end-of-train device shows."""
        lacks = self._lacks(air, able, FALLS)
        balances = (able or self._pulls) and lacks > MINIMUM * full
        if over + self._rate * LEADS > (ABOVE if balances else LATER) and trim > 0.9 * able:
            quick = QUICK if air < QUICK * full else 0.0  # not into cylinders that retainers keep filled
            self.air = min(self._missing() / SERVICE + max(lacks / full - quick, self.least), 1.0)

    def _missing(self) -> float:
        """Return the pressure that reservoirs lack [Pa], as a mean of those at both ends of the train."""
        since, lacked = self.train.time - self._changed, (max(self._empty, 0.0) / 1e5) ** 0.5
        return 1e5 * float(np.mean([max(lacked - since / t, 0.0) ** 2 for t in (CHARGES, self._charging)]))

    def _slows(self, over: float) -> bool:
        """Return whether the air slows the train to the lower bound, and nothing else can hold its speed."""
        trimmed = self.dynamic == 0.0 and (self.traction >= 0.95 or not self._pulls)
        return trimmed and over + self._rate * RELEASES < -BELOW and self._rate < 0.0

    def _gains(self, able: float, full: float, retained: float) -> bool:
        """Return whether the train, released, charges before it gains twice the bound; else note why it does not."""
        rate = max(self._balance - able - retained, 0.0) / self._mass
        fall = FULL / FILLS * max(self._lacks(retained, able, FALLS) / full, MINIMUM)
        time = self._charging * max((fall / 1e5) ** 0.5 - (CHARGED / 1e5) ** 0.5, 0.0)
        gained = rate * (time + BUILDS)
        if gained <= 2 * BOUND:
            self.refused = ""
        elif not self.refused:  # at the bound, before the train slows further
            more = self._mass * (rate - 2 * BOUND / (time + BUILDS)) / 1e3
            self.refused = (
                f"Released, it would gain {gained:.1f} m/s before it brakes again, because its reservoirs charge in "
                f"{time:.0f} s; the driver allows {2 * BOUND:g} m/s. State {more:.0f} kN more of a dynamic brake or of "
                "retainers."
            )
        return not self.refused

    def _added(self, over: float, air: float, able: float, full: float) -> float:
        """Return the share of air with a further small reduction, where the brakes need it and have answered."""
        lacks = self._lacks(air, able, over / SLOW)
        waited = self.train.time - self._changed
        if waited < WAITS + self.train.consist.length / SECOND_OVER or lacks < SMALLEST * full:
            return self.air
        return min(self.air + min(max(lacks / full, SMALLEST), LARGEST), 1.0)
