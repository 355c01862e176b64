"""Running resistance a + b v + c v^2 of kinds of vehicles by published formulas [N, N.s/m, N.s2/m2].

A formula has a rolling part per mass, a rolling part per axle and an air part per vehicle: a load adds no air drag.
"""

from __future__ import annotations

from dataclasses import dataclass

from rbd_model.train.vehicle import GRAVITY

#: Pound-force [N], short ton [kg], mile an hour [m/s], square foot [m2] (NIST SP 811).
POUND, TON, MILE_AN_HOUR, SQUARE_FOOT = 4.4482216, 907.18474, 0.44704, 0.09290304
#: Axles of a vehicle, coaches of a train whose ends are shared, and area of a locomotive's front [m2]. Assumed.
AXLES, COACHES, FRONT = 4, 10, 10.0


@dataclass(frozen=True)
class Formula:
    """R = m (mass + mass_speed v) + axle_force axles + air (v + wind)^2, with v [m/s] and m [kg] in SI units."""

    name: str
    mass: float
    mass_speed: float
    axle_force: float
    air: float
    wind: float = 0.0

    def of(self, mass: float) -> tuple[float, float, float]:
        """Return a, b, c of a vehicle of a mass [kg]."""
        constant = self.mass * mass + self.axle_force * AXLES + self.air * self.wind**2
        return constant, self.mass_speed * mass + 2 * self.air * self.wind, self.air


def _american(name: str, constant: float, axle: float, linear: float, air: float) -> Formula:
    """Return a formula in lb/ton: constant + axle / w + linear V + air V^2 / (w n), w [tons], V [mile/h]."""
    per_mass = POUND / TON
    return Formula(
        name, constant * per_mass, linear * per_mass / MILE_AN_HOUR, axle * POUND, air * POUND / MILE_AN_HOUR**2
    )


#: G. Strahl (1913), Glasers Annalen 73: w = 2.5 + V^2 / k permille, k = 1000 of empty and 4000 of loaded wagons. With
#: 20 t and 80 t these are one air part: 0.02 kg V^2.
#: F. Sauthoff (1932), Die Bewegungswiderstaende der Eisenbahnwagen. It is for n coaches on four axles, V [km/h], G [t]:
#: w = 1.9 + 0.0025 V + 0.0048 (n + 2.7) 1.45 (V + 15)^2 / G permille. The headwind is 15 km/h.
#: AREMA, Manual for Railway Engineering, chapter 16: 0.6 + 20 / w + 0.01 V + 0.07 V^2 / (w n) lb/ton (modified Davis).
#: W. J. Davis (1926), The tractive resistance of electric locomotives and cars: front A [ft2],
#: 1.3 + 29 / w + 0.03 V + 0.0024 A V^2 / (w n) lb/ton.
FORMULAS = {
    "wagon": Formula("Strahl", 2.5e-3 * GRAVITY, 0.0, 0.0, 20e-3 * GRAVITY * 3.6**2),
    "coach": Formula(
        "Sauthoff",
        1.9e-3 * GRAVITY,
        0.0025e-3 * GRAVITY * 3.6,
        0.0,
        0.0048 * GRAVITY * (1 + 2.7 / COACHES) * 1.45 * 3.6**2,
        15.0 / 3.6,
    ),
    "american wagon": _american("modified Davis", 0.6, 20.0, 0.01, 0.07),
    "locomotive": _american("Davis", 1.3, 29.0, 0.03, 0.0024 * FRONT / SQUARE_FOOT),
}


def formula_of(kind: str, american: bool = False) -> Formula:
    """Return the formula of a kind of vehicle; american: whether a wagon has a brake of the AAR."""
    return FORMULAS["american wagon" if kind == "wagon" and american else kind]
