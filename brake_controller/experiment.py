"""Values of the thesis for the brake of the experiment, the QR30 bogie, chapters 6 and 7."""

from dataclasses import dataclass

#: Normal force of all shoes for each pressure [N/Pa], and the largest pressure [Pa] (section 6.2.3).
FORCE_PER_PRESSURE, SUPPLY_PRESSURE = 0.164, 350e3
#: Shoes of the bogie; two of them act on the braked wheelset.
SHOES = 4.0
#: Time to the set pressure [s] (section 7.1).
APPLICATION_TIME = 0.8


@dataclass(frozen=True)
class ExperimentCase:
    """Values of the thesis for one pressure of the experiment."""

    rigging_efficiency: float
    shoe_friction: float
    lowest_shoe_friction: float
    highest_shoe_friction: float


#: Cases by pressure [kPa]: efficiency of the refurbished rigging (rod force 18, 19, 15 % below the specification,
#: sections 7.2.1, 7.3.1, 7.4.1), average shoe friction (section 7.5) and its range (sections 7.2.1, 7.3.1, 7.4.1).
EXPERIMENT = {
    130: ExperimentCase(0.82, 0.30, 0.27, 0.33),
    150: ExperimentCase(0.81, 0.27, 0.23, 0.30),
    180: ExperimentCase(0.85, 0.25, 0.21, 0.28),
}
