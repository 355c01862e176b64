"""C headers with the content of products/train/layout.py: names of rows, their number, limits."""

from __future__ import annotations

from collections.abc import Iterable

from brake_controller.air import AMBIENT, GAS_CONSTANT, WALL
from brake_controller.brake_heat import HEATED, SURROUNDINGS, WORKED
from brake_controller.brake_pipe import VALVE as TAP
from brake_controller.direct_brake import COMMANDED as DIRECTLY
from brake_controller.direct_brake import PRESSED
from brake_controller.distributors import DISTRIBUTORS
from brake_controller.distributors.distributor import ANSWERED, COMMANDED, CYLINDER, STARTS
from brake_controller.drive import MOST_DRIVE_POINTS
from brake_controller.electric_brake import DEMANDED, INTERLOCK
from brake_controller.main_reservoir import PUMPED
from brake_controller.parking_brake import SCREWED
from brake_controller.pneumatics import TIME_CONSTANTS_TO_95_PERCENT
from brake_controller.protection_fmu import LARGEST_MEMORY
from brake_controller.sensors import GATE, LOWEST_FREQUENCY, TIMER
from brake_controller.track_brakes import ORDERED
from brake_controller.traction import COMMANDED as DRIVEN
from brake_controller.vigilance import STANDS
from fmu_src.c_literals import c_array, c_number, c_text
from fmu_src.variables import Field
from products.train.layout import BRAKE_MODELS, INPUTS, MOST_VALVES, OUTPUTS, START_FRICTION, SUMS, UNBREAKABLE, layout
from rbd_model.train.coupler import CURVES, FEW_POINTS, POINTS
from rbd_model.train.vehicle import ACTING, GRAVITY

HEAD = "/* Written by products/train/layout_in_c.py. */"


def _enum(prefix: str, names: Iterable[str], last: str) -> str:
    return f"enum {{ {', '.join([*(f'{prefix}_{name}'.upper() for name in names), last])} }};"


def _owners() -> dict[str, str]:
    """Return the C expressions of the number of owners, by name."""
    counted = {name: f"(long long int)head[HEAD_{name.upper()}]" for name in ("cells", "vehicles", "valves", "points")}
    counted |= {
        f"distributor_{distributor}": f"(long long int)head[HEAD_DISTRIBUTOR_{distributor.upper()}]"
        for distributor in DISTRIBUTORS
    }
    return {"one": "1", "ends": "2"} | counted | {"couplings": f"{counted['vehicles']} - 1"}


def layout_in_c() -> str:
    """Return train_layout.h: names of rows and arrays, their number, and constants shared with Python."""
    shared = {"GRAVITY": GRAVITY, "GAS_CONSTANT": GAS_CONSTANT, "AMBIENT": AMBIENT, "START_FRICTION": START_FRICTION}
    shared |= {"UNBREAKABLE": UNBREAKABLE, "SURROUNDINGS": SURROUNDINGS}
    shared |= {"ENCODER_GATE": GATE, "ENCODER_TIMER": TIMER, "ENCODER_LOWEST_FREQUENCY": LOWEST_FREQUENCY}
    shared |= {"TIME_CONSTANTS_TO_95_PERCENT": TIME_CONSTANTS_TO_95_PERCENT}
    shared |= {"WALL": WALL, "STANDS": STANDS, "INTERLOCK": float(INTERLOCK)}
    counts = [f"    counts[OF_{name.upper()}] = {text};" for name, text in _owners().items()]
    return "\n".join(
        [
            HEAD,
            "#ifndef TRAIN_LAYOUT_H\n#define TRAIN_LAYOUT_H\n",
            *(f"static const double {name} = {value!r};" for name, value in shared.items()),
            f"enum {{ MOST_VALVES = {MOST_VALVES} }};",
            f"enum {{ MOST_DRIVE_POINTS = {MOST_DRIVE_POINTS}, LARGEST_MEMORY = {LARGEST_MEMORY} }};",
            f"enum {{ CURVES = {len(CURVES)}, POINTS = {POINTS}, FEW_POINTS = {FEW_POINTS} }};",
            _enum("of", _owners(), "LAYOUT_OWNERS"),
            _enum("group", (one.name for one in layout()), "LAYOUT_GROUPS"),
            "enum { GROUP_FIRST_KIND = GROUP_PLACE + 1 };",
            *(_enum(one.name, (f.name for f in one.fields), f"{one.name.upper()}_ROWS") for one in layout()),
            "enum { HEAD_FIRST_KIND = HEAD_POINTS + 1 };",
            _enum("in", (input_.name for input_ in INPUTS), "TRAIN_INPUTS"),
            *(_enum(one.name, one.choices, f"{one.name.upper()}_CHOICES") for one in INPUTS if one.choices),
            _enum("out", (output.name for output in OUTPUTS), "OUT_SUMS"),
            _enum("sum", (one.name for one in SUMS), "TRAIN_SUMS"),
            _enum("brake_model", BRAKE_MODELS, "BRAKE_MODELS"),
            _enum("acting", ACTING, "ACTING_ROWS"),
            _enum("tap", TAP, "TAP_ROWS"),
            *_kinds_in_c(),
            "static inline void layout_count(const double *head, long long int counts[LAYOUT_OWNERS])",
            "\n".join(["{", *counts, "}"]),
            "\n#endif\n",
        ]
    )


def _kinds_in_c() -> list[str]:
    """Return the distributors in C: states, start values, the cylinder's number, functions of each brake model."""
    most = max(len(distributor.states) for distributor in DISTRIBUTORS.values())
    rows, forms = list[str](), list[str]()
    for name, one in DISTRIBUTORS.items():
        starts = ", ".join(f"START_{start.upper()}" for _, start in one.states)
        cylinder = [state for state, _ in one.states].index(CYLINDER)
        flags = f"{int(one.assisted)}, {int(one.pressing is not None)}"
        rows.append(f"{{{len(one.states)}, DISTRIBUTOR_{name.upper()}_ROWS, {cylinder}, {flags}, {{{starts}}}}}")
        forms += [f"form({len(forms) + n}, {name}_{brake_model})" for n, brake_model in enumerate(one.brake_models())]
    pressings = [f"form(KIND_{name.upper()}, {name}_pressing)" for name, one in DISTRIBUTORS.items() if one.pressing]
    return [
        _enum("start", STARTS, "STARTS"),
        _enum("command", COMMANDED, "COMMAND_ROWS"),
        _enum("electrically", DEMANDED, "ELECTRICALLY_ROWS"),
        _enum("worked", WORKED, "WORKED_ROWS"),
        _enum("heated", HEATED, "HEATED_ROWS"),
        _enum("ordered", ORDERED, "ORDERED_ROWS"),
        _enum("screwed", SCREWED, "SCREWED_ROWS"),
        _enum("driven", DRIVEN, "DRIVEN_ROWS"),
        _enum("pressed", PRESSED, "PRESSED_ROWS"),
        _enum("directly", DIRECTLY, "DIRECTLY_ROWS"),
        _enum("pumped", PUMPED, "PUMPED_ROWS"),
        _enum("answer", ANSWERED, "ANSWER_ROWS"),
        _enum("kind", DISTRIBUTORS, "KINDS"),
        f"typedef struct {{\n    int states, given, cylinder, assisted, presses, start[{most}];\n}} distributor_kind;",
        c_array("distributor_kind", "KIND", rows),
        f"#define DISTRIBUTOR_FORMS(form) {' '.join(forms)}",
        f"#define DISTRIBUTOR_PRESSINGS(form) {' '.join(pressings)}",
    ]


def fields_in_c() -> str:
    """Return train_fields.h: owners and limits of all fields and inputs."""
    of_groups = [f"{{OF_{one.of.upper()}, {len(one.fields)}}}" for one in layout()]
    own = [_field(field, group.of) for group in layout() for field in group.fields]
    return "\n".join(
        [
            HEAD,
            "typedef struct {\n    int of, rows;\n} layout_group;",
            "typedef struct {\n    double least, most;\n    int of, whole, counts, rises;",
            "    const char *what;\n} layout_field;",
            c_array("layout_group", "GROUPS", of_groups),
            c_array("layout_field", "FIELDS", own),
            c_array("layout_field", "INPUTS", (_field(input_, input_.of) for input_ in INPUTS)),
            c_array("int", "OUTPUT_OF", (f"OF_{output.of.upper()}" for output in OUTPUTS)) + "\n",
        ]
    )


def _field(field: Field, of: str) -> str:
    counts = f"OF_{(field.counts or 'one').upper()}"
    limits = f"{c_number(field.least)}, {c_number(field.most)}"
    return f"{{{limits}, OF_{of.upper()}, {int(field.whole)}, {counts}, {int(field.rises)}, {c_text(field.text)}}}"
