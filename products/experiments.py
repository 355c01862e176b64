"""Experiments in the FMUs with their results, to check an importing host."""

from collections.abc import Mapping
from dataclasses import dataclass

from fmu_src.references import Experiment
from products.coach import brakes
from products.machine import FULL_PRESSURE, FULL_TORQUE
from products.parameter_sets import PARAMETER_SETS

#: Recorded outputs of the motion along the track, of a wheelset's lateral motion, and of a brake.
ALONG = (
    *("speed", "distance", "angular_velocity_1", "angular_velocity_2", "locked_1", "locked_2"),
    *("axle_load_1", "axle_load_2"),
)
SIDEWAYS = ("speed", "distance", "lateral_1", "yaw_1", "wheel_load_1_left", "flange_force_1")
DRIVEN = ("speed", "wheel_speed_1", "wheel_speed_2", "creep_force_1", "axle_torque", "drive_torque", "rotor_torque")
BRAKE = ("cylinder_pressure", "shoe_force", "brake_torque")


@dataclass(frozen=True)
class FmuExperiment:
    """An experiment of the FMU of a parameter set: further values, constant inputs, recorded outputs.

    duration and step [s]: of the run and of its host.
    """

    description: str
    set_name: str
    parameters: Mapping[str, float]
    inputs: Mapping[str, float]
    outputs: tuple[str, ...]
    duration: float
    step: float


#: Experiments by name; those of an FMU, that of their parameter set, are in its archive.
SCENES: dict[str, FmuExperiment] = {
    "lock-up": FmuExperiment(
        "60 kN.m on the leading wheelset, which locks (Fig. 5.44)",
        "bogie-chapter-5-as-printed",
        {"level": 2, "initial_speed": 25.0},
        {"brake_torque_1": 60e3},
        ALONG,
        2.0,
        0.01,
    ),
    "stop": FmuExperiment(
        "Service brake to rest at level 1",
        "bogie-chapter-5",
        {"level": 1, "initial_speed": 20.0},
        {"brake_torque_1": 15e3, "brake_torque_2": 15e3},
        ALONG,
        25.0,
        0.1,
    ),
    "experiment-180kpa": FmuExperiment(
        "QR30 bogie, 1.8 kN.m on the trailing wheelset at friction 0.18",
        "bogie-qr30",
        {"level": 2, "initial_speed": 2.9},
        {"brake_torque_2": 1.8e3, "friction_1": 0.18, "friction_2": 0.18},
        ALONG,
        3.0,
        0.01,
    ),
    "sideways": FmuExperiment(
        "Wheelsets 4 mm beside the track's middle at level 3",
        "bogie-chapter-5",
        {"level": 3, "initial_speed": 15.0, "initial_lateral": 4e-3},
        {},
        SIDEWAYS,
        2.0,
        0.01,
    ),
    "coach-stop": FmuExperiment(
        "Full brake of the coach at level 2",
        "coach",
        {"level": 2, "initial_speed": 25.0},
        brakes(FULL_TORQUE),
        (*ALONG, "front_frame_pitch"),
        10.0,
        0.05,
    ),
    "coach-pull": FmuExperiment(
        "Pulled by 20 kN at the front coupler at level 1",
        "coach",
        {"level": 1, "initial_speed": 5.0},
        {"coupler_force_front": 20e3},
        ALONG,
        10.0,
        0.1,
    ),
    "coach-sideways": FmuExperiment(
        "Wheelsets 4 mm beside the track's middle at level 3",
        "coach",
        {"level": 3, "initial_speed": 15.0, "initial_lateral": 4e-3},
        {},
        SIDEWAYS,
        1.0,
        0.01,
    ),
    "wagon-stop": FmuExperiment(
        "15 kN.m on each wheelset at level 2",
        "coal-wagon",
        {"level": 2, "initial_speed": 25.0},
        brakes(15e3),
        ALONG,
        10.0,
        0.05,
    ),
    "wagon-locks-on-wet-rail": FmuExperiment(
        "60 kN.m on each wheelset at level 2 on a wet rail",
        "coal-wagon-wet-rail",
        {"level": 2, "initial_speed": 20.0},
        brakes(60e3),
        ALONG,
        5.0,
        0.05,
    ),
    "wagon-down-a-slope": FmuExperiment(
        "Falls from rest down 20 per mille at level 1",
        "coal-wagon",
        {"level": 1, "initial_speed": 0.0},
        {"gradient": -0.02},
        ALONG,
        10.0,
        0.1,
    ),
    "braked-coach-stop": FmuExperiment(
        "Full brake at level 2",
        "braked-coach",
        {"level": 2, "initial_speed": 25.0},
        {f"pressure_demand_{n}": FULL_PRESSURE for n in (1, 2, 3, 4)},
        (*ALONG, "cylinder_pressure_1"),
        10.0,
        0.05,
    ),
    "braked-coach-on-wet-rail": FmuExperiment(
        "Full brake at level 2 on a wet rail",
        "braked-coach-wet-rail",
        {"level": 2, "initial_speed": 25.0},
        {f"pressure_demand_{n}": FULL_PRESSURE for n in (1, 2, 3, 4)},
        (*ALONG, "cylinder_pressure_1"),
        5.0,
        0.05,
    ),
    "braked-coach-without-its-front": FmuExperiment(
        "Half the pressure at level 1, the valves of the front bogie hold it back",
        "braked-coach",
        {"level": 1, "initial_speed": 15.0},
        {"valve_1": 2, "valve_2": 2} | {f"pressure_demand_{n}": FULL_PRESSURE / 2 for n in (1, 2, 3, 4)},
        (*ALONG, "cylinder_pressure_1", "cylinder_pressure_4"),
        10.0,
        0.1,
    ),
    "wheelset-sideways": FmuExperiment(
        "4 mm beside the track's middle at 15 m/s",
        "wheelset-chapter-4",
        {"initial_speed": 15.0, "initial_lateral": 4e-3},
        {},
        SIDEWAYS,
        2.0,
        0.01,
    ),
    "wheelset-braked": FmuExperiment(
        "5 kN.m on it, 4 mm beside the track's middle",
        "wheelset-chapter-4",
        {"initial_speed": 15.0, "initial_lateral": 4e-3},
        {"brake_torque_1": 5e3},
        SIDEWAYS,
        2.0,
        0.01,
    ),
    "wheelset-over-a-wave": FmuExperiment(
        "Over a lateral wave of 3 mm at 10 m/s on a dry rail",
        "wheelset-chapter-4-dry-rail",
        {"initial_speed": 10.0, "lateral_irregularity": 3e-3},
        {},
        SIDEWAYS,
        2.0,
        0.01,
    ),
    "cleaning": FmuExperiment(
        "A sliding leading wheelset cleans the rail for both",
        "rail-recovery",
        {},
        {"speed": 10.0, "creep_force_1": -5e3, "slip_1": 2.0},
        ("friction_1", "friction_2"),
        5.0,
        0.05,
    ),
    "cleaning-by-both": FmuExperiment(
        "Both wheelsets slide at 15 m/s",
        "rail-recovery",
        {},
        {"speed": 15.0, "creep_force_1": -5e3, "slip_1": 1.0, "creep_force_2": -5e3, "slip_2": 1.5},
        ("friction_1", "friction_2"),
        5.0,
        0.05,
    ),
    "cleaning-backwards": FmuExperiment(
        "Going backwards, the trailing wheelset is the first and cleans the rail for both",
        "rail-recovery",
        {},
        {"speed": -8.0, "creep_force_2": 5e3, "slip_2": -2.0},
        ("friction_1", "friction_2"),
        5.0,
        0.05,
    ),
    "pulling": FmuExperiment(
        "The motor pulls with 6 kN.m from 10 m/s",
        "driven-wheelset",
        {"initial_speed": 10.0},
        {"torque_demand": 6e3},
        DRIVEN,
        2.0,
        0.01,
    ),
    "spinning": FmuExperiment(
        "The motor pulls with more than a slippery rail carries, up to its power",
        "driven-wheelset-low-adhesion",
        {"initial_speed": 5.0},
        {"torque_demand": 6e3},
        DRIVEN,
        2.0,
        0.01,
    ),
    "electric-brake": FmuExperiment(
        "Motor and brakes slow the wheelset down, rigid shafts",
        "driven-wheelset",
        {"initial_speed": 20.0, "shafts": 1},
        {"torque_demand": -2e3, "brake_torque_1": 4e3, "brake_torque_2": 4e3},
        DRIVEN,
        5.0,
        0.05,
    ),
    "application-180kpa": FmuExperiment(
        "Brake of the experiment by application time",
        "brake-qr30-180kpa",
        {"cylinder_model": 1},
        {"pressure_demand": 180e3},
        BRAKE,
        3.0,
        0.02,
    ),
    "flow-180kpa": FmuExperiment(
        "Brake of the experiment by flow of air",
        "brake-qr30-180kpa",
        {"cylinder_model": 2},
        {"pressure_demand": 180e3},
        BRAKE,
        3.0,
        0.02,
    ),
    "flow-uic-g": FmuExperiment(
        "Freight brake, position G, by flow of air",
        "brake-uic-g",
        {"cylinder_model": 2},
        {"pressure_demand": 380e3, "angular_velocity": 30.0},
        BRAKE,
        40.0,
        0.2,
    ),
}


def experiments_of(fmu: str) -> list[Experiment]:
    """The experiments of one FMU of the registry."""
    return [
        Experiment(
            name,
            one.description,
            PARAMETER_SETS[one.set_name].values() | dict(one.parameters),
            one.inputs,
            one.outputs,
            one.duration,
            one.step,
        )
        for name, one in SCENES.items()
        if PARAMETER_SETS[one.set_name].fmu == fmu
    ]
