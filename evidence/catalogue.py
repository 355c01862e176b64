"""All scenarios of evidence. A new one is a file, one entry here, and its name in `scenarios/catalogue.py`."""

from bogie_braking.reporting.scenario import Scenario
from evidence.comparisons import speed_accuracy, throughput, train_methods
from evidence.contact import contact_model, creep_laws
from evidence.numerics import levels, levels_in_curves, oracle, sensitivity, speed, stability_atlas, thesis_step
from evidence.trains import train_brake_evidence

SCENARIOS: list[Scenario] = [
    train_brake_evidence.SCENARIO,
    contact_model.SCENARIO,
    creep_laws.SCENARIO,
    sensitivity.SCENARIO,
    oracle.SCENARIO,
    levels.SCENARIO,
    levels_in_curves.SCENARIO,
    speed.SCENARIO,
    stability_atlas.SCENARIO,
    thesis_step.SCENARIO,
    speed_accuracy.SCENARIO,
    throughput.SCENARIO,
    train_methods.SCENARIO,
]
