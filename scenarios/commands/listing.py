"""The command `list`: prints all scenarios."""

from __future__ import annotations

import argparse
import json

from bogie_braking.common_options import add_speech
from bogie_braking.exit_status import HOLDS
from scenarios.catalogue import SCENARIOS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `list`."""
    add_speech(parser, "names, summaries and options", "names alone")


def run(chosen: argparse.Namespace) -> int:
    """Print all scenarios, as text, as names alone or as JSON."""
    width = max(len(scenario.name) for scenario in SCENARIOS)
    if chosen.json:
        about = [
            {"name": one.name, "group": one.group, "summary": one.summary, "options": sorted(one.takes)}
            for one in SCENARIOS
        ]
        print(json.dumps(about, indent=2))
        return HOLDS
    if chosen.quiet:
        print(*(one.name for one in SCENARIOS), sep="\n")
        return HOLDS
    for number, group in enumerate(dict.fromkeys(one.group for one in SCENARIOS)):
        print("\n" * bool(number) + f"{group}:")
        for scenario in SCENARIOS:
            if scenario.group == group:
                print(f"  {scenario.name.ljust(width)}  {scenario.summary}")
    return HOLDS
