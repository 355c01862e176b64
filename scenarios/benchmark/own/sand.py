"""A stop on a sanded rail: wheelsets that use all adhesion, and the fitted law of sand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rbd_model.track.sand import common_sand
from scenarios.bench.sanded_train import way

#: Rate of a fixed sander, and largest rate [kg/s] and sand for each metre [kg/m] of a variable one: from memory.
FIXED, VARIABLE, LIMIT = 2 / 60, 4 / 60, 7.5e-3
#: Cars of the train model.
CARS = 4


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the stopping distance [m]; none for another number of cars."""
    if inputs["cars"] != CARS:
        return {}
    varies, sand = inputs["variable"] == "yes", common_sand()
    rate = (VARIABLE if varies else FIXED) * inputs["rate_factor"]
    places = [inputs["wheelset_of_first"], inputs["wheelset_of_second"]][: round(inputs["sanders"])]
    values = {f"sand_rate_{place:.0f}": rate for place in places}
    values |= {"initial_speed": inputs["speed"], "asked": inputs["demanded"]}
    values |= {"application_time": inputs["application_time"]}
    law = replace(sand, sand_limit=LIMIT) if varies else sand
    return {"distance": way(values, law, inputs["untreated"])}
