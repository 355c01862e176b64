"""All parameter sets of the project by name, and their files (.ssv). A new one is a line in MACHINES."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from brake_controller.motors import traction_inverter
from brake_controller.ready_sets import ReadySet, qr30_experiment, uic_g, uic_p, with_dump_valve
from fmu_src.parameter_file import parameter_file
from fmu_src.system import ParameterSet
from products.machine import coach_brake
from products.registry import model_of
from rbd_model.track.friction import RailCondition, dry, low, very_low, wet
from rbd_model.track.recovery import RecoveryParameters, assumed_recovery, easy_recovery, hard_recovery, no_recovery
from rbd_model.vehicle.parameters import (
    as_printed,
    coach_with_traction_rods,
    coal_wagon,
    manchester_vehicle_1,
    one_bogie_of,
    tables_4_1_and_4_2,
    tables_5_1_and_5_2,
    tables_8_1_and_8_2,
)
from rbd_model.wheelset.driven import electric_locomotive
from readers.storage import write_whole

#: Description in a file, with the pressure of the experiment.
QR30 = "Brake of one wheelset in the experiment at {} kPa, chapters 6 and 7"


def recovery_under_coach() -> RecoveryParameters:
    """The assumed recovery, over the wheel base of the coach's bogies."""
    return replace(assumed_recovery(), wheel_base=manchester_vehicle_1().wheel_base)


class NamedSet:
    """A set for an FMU of the registry: its description in a line, the functions that give its values, and its rail."""

    def __init__(
        self,
        fmu: str,
        description: str,
        *sources: Callable[[], ParameterSet | ReadySet],
        rail: RailCondition | None = None,
    ) -> None:
        self.fmu, self.description, self.sources, self.rail = fmu, description, sources, rail

    def values(self) -> dict[str, float]:
        """Return the values of all sources and the rail under four wheelsets that the FMU has, in SI units."""
        values = {key: value for source in self.sources for key, value in source().values().items()}
        return values_for(self.fmu, values | (self.rail.values(4) if self.rail else {}))


#: Vehicles, brakes and rails by the name of their file.
MACHINES: dict[str, NamedSet] = {
    "bogie-chapter-5": NamedSet("bogie", "Two-axle bogie of chapter 5, Tables 5.1 and 5.2", tables_5_1_and_5_2),
    "bogie-chapter-5-as-printed": NamedSet(
        "bogie", "The same in the thesis's reading of what reacts where", lambda: as_printed(tables_5_1_and_5_2())
    ),
    "bogie-qr30": NamedSet("bogie", "QR30 bogie of the experiment, Tables 8.1 and 8.2", tables_8_1_and_8_2),
    "bogie-of-coach": NamedSet(
        "bogie", "One bogie of the coach under half its body", lambda: one_bogie_of(manchester_vehicle_1())
    ),
    "bogie-of-coal-wagon": NamedSet(
        "bogie", "One bogie of the coal wagon under half its body", lambda: one_bogie_of(coal_wagon())
    ),
    "wheelset-chapter-4": NamedSet("wheelset", "Wheelset in a frame, Tables 4.1 and 4.2", tables_4_1_and_4_2),
    "coach": NamedSet(
        "vehicle",
        "Passenger coach, vehicle 1 of the Manchester benchmarks with traction rods",
        coach_with_traction_rods,
    ),
    "coach-as-published": NamedSet(
        "vehicle", "Vehicle 1 of the Manchester benchmarks as published", manchester_vehicle_1
    ),
    "coal-wagon": NamedSet("coal-wagon", "Coal wagon on two bogies of chapter 5", coal_wagon),
    "braked-coach": NamedSet("braked-vehicle", "The coach and its brakes", coach_with_traction_rods, coach_brake),
    "driven-wheelset": NamedSet(
        "driven-wheelset", "One of four wheelsets of an assumed locomotive", electric_locomotive, traction_inverter
    ),
    "brake-qr30-130kpa": NamedSet("brake", QR30.format(130), lambda: qr30_experiment(130)),
    "brake-qr30-150kpa": NamedSet("brake", QR30.format(150), lambda: qr30_experiment(150)),
    "brake-qr30-180kpa": NamedSet("brake", QR30.format(180), lambda: qr30_experiment(180)),
    "brake-uic-p": NamedSet("brake", "UIC freight wagon in brake position P", uic_p),
    "brake-uic-p-dump-valve": NamedSet(
        "brake", "The same with the dump valve of a wheel-slide protection", lambda: with_dump_valve(uic_p())
    ),
    "brake-uic-g": NamedSet("brake", "UIC freight wagon in brake position G", uic_g),
    "rail-recovery": NamedSet("rail", "Low adhesion that sliding wheels clean away", assumed_recovery),
    "rail-recovery-easy": NamedSet("rail", "The same with the least energy of cleaning", easy_recovery),
    "rail-recovery-hard": NamedSet("rail", "The same with the most energy of cleaning", hard_recovery),
    "rail-recovery-none": NamedSet("rail", "Low adhesion that stays, whatever slides", no_recovery),
    "rail-recovery-under-coach": NamedSet(
        "rail", "Low adhesion that sliding wheels clean away, under a bogie of the coach", recovery_under_coach
    ),
}
#: Vehicle sets that are also provided on rails whose friction decreases with sliding speed, and these rails.
VEHICLES = ("bogie-chapter-5", "wheelset-chapter-4", "coach", "coal-wagon", "braked-coach", "driven-wheelset")
RAILS = {"dry-rail": dry, "wet-rail": wet, "low-adhesion": low, "very-low-adhesion": very_low}


def on_rail(machine: NamedSet, condition: Callable[[], RailCondition]) -> NamedSet:
    """Return a vehicle's set with a condition of the rail; its friction coefficients are start values of inputs."""
    rail = condition()
    about = f"{machine.description}. Rail: {rail.source}{'' if rail.verified else '; unverified'}"
    return NamedSet(machine.fmu, about, *machine.sources, rail=rail)


#: All by the name of their file.
PARAMETER_SETS: dict[str, NamedSet] = MACHINES | {
    f"{vehicle}-{name}": on_rail(MACHINES[vehicle], condition)
    for vehicle in VEHICLES
    for name, condition in RAILS.items()
}


def values_for(fmu: str, values: Mapping[str, float]) -> dict[str, float]:
    """Return those values that an FMU of the registry has as parameters or inputs."""
    known = {variable.name for variable in model_of(fmu).variables if variable.causality in ("parameter", "input")}
    return {name: value for name, value in values.items() if name in known}


def set_files(fmu: str) -> dict[str, bytes]:
    """The files of the sets of one FMU, by name."""
    return {
        f"{name}.ssv": parameter_file(name, one.description, one.values(), model_of(fmu).variables)
        for name, one in PARAMETER_SETS.items()
        if one.fmu == fmu
    }


def write_sets(names: Sequence[str], out: Path) -> None:
    """Write the parameter sets of the named FMUs into OUT/parameters/, and print how many if there are any."""
    folder = out / "parameters"
    files = {name: data for fmu in names for name, data in set_files(fmu).items()}
    if not files:
        return
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        write_whole(folder / name, data)
    print(f"{folder}  {len(files)} parameter sets (.ssv)")
