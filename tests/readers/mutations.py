"""Randomly damaged files of users: valid ones in the forms of several countries, and the strings inserted."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

#: Inserted anywhere into a valid file, instead of up to three of its characters.
ODD = (
    *("\0", '"', '""', ",", ";", "\t", "[", "(", "]", ")", "e", "-", "+", ".", " ", "#", "//", "\r", "\n", "\r\n"),
    *(
        "\u2212",
        "\ufeff",
        "\u00a0",
        "\u202f",
        "\u2003",
        "\x1a",
        "\f",
        "\x7f",
        "\x85",
        "\u00b5",
        "\ud7ff",
        "%",
        "=",
        "'",
    ),
    *("nan", "inf", "1_0", "0x1p3", "1e400", "-1e400", "1e-400", "4.9e-324", "2.2250738585072011e-308", "-0", "true"),
    *("9" * 19, "9" * 400, "0." + "0" * 400 + "1", "0.1000000000000000055511151231257827", "1.5.2", "sep=,\n", ",,,\n"),
    *("x" * 30, "x" * 20_001, "[" * 3000, "\U0001f683", "9007199254740993", "12345678901234567e-21"),
)
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "cp1252")


def mutated(good: Sequence[str], count: int, seed: int) -> Iterator[bytes]:
    """Yield `count` files: each a valid one with up to four changes in its text, some with one byte changed as well."""
    chance = random.Random(seed)
    for _ in range(count):
        text = chance.choice(good)
        for _ in range(chance.randint(0, 4)):
            at = chance.randrange(len(text) + 1)
            text = text[:at] + chance.choice(ODD) + text[at + chance.randint(0, 3) :]
        data = bytearray(text.encode(chance.choice(ENCODINGS), errors="replace"))
        if data and chance.random() < 0.2:
            data[chance.randrange(len(data))] = chance.randrange(256)
        if chance.random() < 0.1:
            del data[chance.randrange(len(data) + 1) :]
        yield bytes(data)


#: Lines; they have numbers with many digits, which would show differences of two readers first.
LINES = (
    "distance,curvature,cant,gradient\n0,0,0,0\n20,0.002,0.1,0.01\n35.5,-1e-3,0.05,-0.015\n",
    "sep=;\r\nDistance [km];curvature (1/km);Cant [mm];gradient [\u2030]\r\n"
    "0;0;0;0\r\n0,02;2;100;10,5\r\n0,0355;-1;50;-15\r\n",
    '# "a line\n"distance"\t"curvature"\t"cant"\t"gradient [%]"\n"0"\t0\t0\t0\n\n"12,25"\t"2,0e-3"\t"0,1"\t1\n\t\t\t\n',
    "left-friction,Left\u00a0Vertical (um\f),distance,curvature,cant,gradient,,\n"
    "1,3,-5,0,0,0,,\n,,,,,,,\n0.5,-4.4,5,0,0,0.01,,\n",
    "distance,curvature,cant,gradient,right_lateral\n"
    "-7.30000000000000071,0.00123456789012345678,-0.012345678901234567,1.2345678901234567e-05,3.1e-23\n"
    "0.1234567890123456789,1.2345678901234567e-07,4.9406564584124654e-324,-9007199254740993e-18,+.05\n"
    "1.0000000000000002220446049250313,1e-22,123456789012345678901e-24,0.3333333333333333148296162562474,\u22121e-9\n",
    "Laufweg [km];Krümmung [1/km];ÜBERHÖHUNG [mm];Déclivité [\u2030]\n0;0;0;5\n0,05;2;100;5\n",
)
CONSISTS = (
    "kind,count,load,position\nlocomotive,1,,G\nwagon,3,40,P\n",
    "Fahrzeugart;nombre;Länge;Bremshundertstel\nlocomotive;1;19;120\nwagon;20;15,5;65\n",
    "Kind;Count;mass [kg];length;lambda\r\nlocomotive;;84000;;\r\nwagon;12;80000,5;12,5;65\r\n;;;;\r\n",
    'kind\tcount\tvalve\tdelay [ms]\n"locomotive"\t1\thead\t\ncoach\t5\t\t\nlocomotive\t1\tsecond\t1500\n',
)
CONSISTS_IN_TOML = (
    '[[vehicle]]\nkind = "locomotive"\nmass = 84.0\nvalve = "head"\n[[vehicle]]\nkind = "wagon"\nat = 0.25\n',
    "vehicle = [{kind = 'wagon', count = 10, load = '40,5'}, {kind = \"locomotive\", leak = 2, branch = 1e0}]\n",
)
LOGS = (
    "time [s],wheel_speed_1 [m/s],wheel_speed_2 [m/s],valve_1 [1]\n0,20,20,0\n0.01,19.9,19.8,2\n0.02,19.8,19.7,2\n",
    "Time [ms];Wheel speed 1 [km/h];speed [km/h]\r\n5000;72,0;72\r\n5010;71,9;71,5\r\n5020;71,8;71,4\r\n",
    "\n# a logger\ntime (min)\twheel-speed-1 (mph)\tpressure [bar]\n0\t10\t3,5\n1\t9\t3,6\n",
)
TORQUES = ("0,0\n0.5,1000\n2,3000.5\n", "0;0\n0,5;1000\n2;3000,5\n", "time [ms]\ttorque [kN.m]\n0\t0\n500\t1\n")
PROGRAMMES = (
    '[[case]]\nname = "low, 160 km/h"\nrail = "low"\nspeed = "160km/h"\nbrake_ratio = 0.8\nload = 1.2\n'
    '[[case]]\nname = "fault"\nrail = "wet"\nfriction = 0.12\nvalues = { gradient = -0.02 }\n'
    'fault = [{ wheelset = 1, sensor = "zero", sensor_from = 2 }]\nequipment = ["discs"]\n',
)
CRITERIA = (
    '[[criterion]]\nname = "distance"\nmeasure = "over_ideal"\nmost = 1.25\nunit = "1"\ngroups = ["low", "dry"]\n'
    'source = "assumed"\n[[criterion]]\nname = "reservoir"\nmeasure = "reservoir"\nleast = 150\nunit = "kPa"\n'
    'cases = ["low, 160 km/h"]\nsource = "from memory"\n',
)
