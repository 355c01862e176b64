"""C of the functions of a system: those that the runtime calls, of one number, and those of its parts, in lanes.

A part that is called for each repeated component, such as the wheels of a vehicle, computes two, four or eight at a
time (lanes.h). Calls of one rank are a group, whose numbers are side by side. The runtime sets the number of lanes at
each call.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import count

from fmu_src.calls_in_c import (
    ASKED,
    CallGroup,
    Rooms,
    call_in_lanes,
    call_of_group,
    entry_of_group,
    group_at,
    part_in_c_in_lanes,
)
from fmu_src.chain import Part
from fmu_src.equations import Generated, Slopes, is_shared, part_function, part_name
from fmu_src.paired_functions import paired
from fmu_src.statements import Memory, Statement, statements_of
from fmu_src.symbols import ca
from fmu_src.unique_names_in_c import with_own_names

#: A function with more statements than WHOLE is cut into pieces of LONGEST: the coach's FMU takes 25 s to compile, with
#: pieces of 3000 statements 31 s. With pieces of 700 it takes 24 s, and steps of 1 ms are 6 % slower.
WHOLE, LONGEST = 4500, 1500
#: The numbers of lanes that parts are compiled for, where the compiler has them; otherwise for one.
WIDTHS = (2, 4, 8)
#: Prefix of the names of files with a table; in one unit they come before the files that use it.
TABLE_FILE = "table_"
#: The runtime gives all generated functions some arguments that none needs; everything else stays a warning.
HEAD = (
    '#pragma GCC diagnostic ignored "-Wunused-parameter"',
    "#include <math.h>",
    '#include "lanes_widest.h"',
    '#include "model.h"',
    '#include "piecewise.h"',
)


def equations_in_c(name: str, made: Mapping[str, Generated]) -> dict[str, str]:
    """Return C files by name: all functions, their parts in lanes, a file for each number of lanes, and tables."""
    own = list(made.values())
    parts = _functions_of_parts(own)
    shared, own = [one for one in own if is_shared(one)], [one for one in own if not is_shared(one)]
    bodies = [_of_one_number(name, one) for one in own]
    every = [group for body in bodies for group in body.groups]
    groups = {group.entry: group for group in every if not group.alone}
    given = _given([group.part for group in every if group.alone])
    calls = [group_at(name, group, WIDTHS) for group in groups.values()]
    scalar = ['#include "lanes_pairs.h"', "#define LANES 1", *_in_lanes(map(_written, bodies))]
    files = _tables([*own, *parts.values()]) | {f"{one.function.name()}.c": _alone(one) for one in shared}
    files[f"equations_{name}.c"] = "\n".join([*HEAD, *given, *calls, *scalar, ""])
    for file, some in _by_file(f"parts_{name}", parts, groups).items():
        files[f"{file}.h"] = _parts(name, parts, some)
        widest = max(group.lanes for group in some.values())
        files |= {f"{file}_{lanes}.c": _at_width(file, lanes) for lanes in WIDTHS if lanes <= widest}
    return files


def _by_file(
    name: str, parts: Mapping[str, Generated], groups: Mapping[str, CallGroup]
) -> dict[str, dict[str, CallGroup]]:
    """Return groups by their files: a long part that calls no other has a file of its own.

    So vehicles with the same wheels and other springs have files in common, which are compiled once.
    """
    files: dict[str, dict[str, CallGroup]] = {}
    for entry, group in groups.items():
        functions = [
            parts[part_name(one.part, one.slopes)] for one in groups.values() if one.part.name == group.part.name
        ]
        calls = any(not call.part.flat for function in functions for call in function.calls)
        apart = not calls and max(one.function.n_instructions() for one in functions) > LONGEST
        files.setdefault(f"{name}_{group.part.name}" if apart else name, {})[entry] = group
    return files


def _alone(generated: Generated) -> str:
    """Return the file of a function that several systems have."""
    body = _of_one_number(generated.function.name(), generated)
    return "\n".join([*HEAD, '#include "lanes_pairs.h"', "#define LANES 1", *_in_lanes([_written(body)]), ""])


def _in_lanes(functions: Iterable[str]) -> list[str]:
    """Return functions of a `real` of LANES lanes."""
    return ['#include "lanes.h"', *functions, '#include "lanes_end.h"']


def _at_width(file: str, lanes: int) -> str:
    """Return the file that compiles the parts for `lanes` lanes; the narrowest also for compilers with one lane."""
    include = f'#include "{file}.h"\n'
    own = f'#include "lanes_widest.h"\n#if LANES_WIDEST >= {lanes}\n#define LANES {lanes}\n{include}'
    return own + (f"#else\n#define LANES 1\n{include}#endif\n" if lanes == WIDTHS[0] else "#endif\n")


def _given(in_c: Sequence[Part]) -> list[str]:
    """Return C of these parts, once if several files with the same become one unit; of tables, a declaration."""
    flat = dict.fromkeys(part.name for part in in_c if part.flat and not part.inline)
    known = [f"extern const piecewise {name};" for name in flat]
    parts = {part.name: part for part in in_c if not part.flat}.values()
    texts = with_own_names([*dict.fromkeys(part.common for part in parts), *(part.source for part in parts)])
    names = [f"GIVEN_{hashlib.sha256(text.encode()).hexdigest()[:16].upper()}" for text in texts]
    once = [f"#ifndef {name}\n#define {name}\n{text}\n#endif" for name, text in zip(names, texts, strict=True) if text]
    # In one unit the tables come first.
    return [*(["#ifndef ONE_UNIT", *known, "#endif"] if known else []), *once]


def _tables(functions: Sequence[Generated]) -> dict[str, str]:
    """Return a file for each table that is looked up."""
    head = '#include "model.h"\n#include "piecewise.h"\n'
    found = {
        call.part.name: call.part
        for function in functions
        for call in function.calls
        if call.part.flat and not call.part.inline
    }
    return {f"{TABLE_FILE}{name}.c": head + part.source for name, part in found.items()}


def _functions_of_parts(own: Sequence[Generated]) -> dict[str, Generated]:
    """Return the needed functions of each part, also of parts that other parts call; called functions come first."""
    made: dict[str, Generated] = {}
    parts: dict[str, Part] = {}

    def make_calls(generated: Generated) -> None:
        for call, needed in zip(generated.calls, generated.slopes, strict=True):
            make(call.part, needed)
            if call.each and call.each.asked:
                make(call.each.asked, ())

    def make(part: Part, slopes: Slopes) -> None:
        if parts.setdefault(part.name, part) is not part:
            raise ValueError(f"Two parts have one name, {part.name}; give each part a name of its own.")
        if part.source or part_name(part, slopes) in made:
            return
        one = part_function(part, slopes)
        make_calls(one)
        made[part_name(part, slopes)] = one

    for one in own:
        make_calls(one)
    return made


def _parts(name: str, parts: Mapping[str, Generated], groups: Mapping[str, CallGroup]) -> str:
    """Return the header with the parts in lanes: parts that other parts call, parts in a group, and the groups."""
    own: dict[str, CallGroup] = {group.function: group for group in groups.values()}
    users = [(parts[part_name(one.part, one.slopes)], one.lanes) for one in own.values()]
    given, texts = _parts_within(name, parts, users)
    for group in own.values():
        one = parts[part_name(group.part, group.slopes)]
        texts.append(_up_to(group.lanes, _written(_of_part(name, one, group.function, str(group.lanes)))))
    texts += [_up_to(group.lanes, entry_of_group(name, group)) for group in groups.values()]
    return "\n".join([*HEAD, *given, *_in_lanes(texts), ""])


def _up_to(lanes: int, text: str) -> str:
    """Return C that is compiled for at most `lanes` lanes."""
    return text if lanes >= WIDTHS[-1] else f"#if LANES <= {lanes}\n{text}#endif\n"


def _parts_within(
    name: str, parts: Mapping[str, Generated], users: Iterable[tuple[Generated, int]]
) -> tuple[list[str], list[str]]:
    """Return C of the parts given in C, and C of all other parts that functions in lanes call; called parts come first.

    users: these functions, and the largest number of lanes for which each is compiled.
    """
    called: dict[str, CallGroup] = {}
    most: dict[str, int] = {}

    def find(generated: Generated, lanes: int) -> None:
        groups = [group for rank in Rooms.of(generated, False).groups for group in rank]
        asked = [group.each.asked for group in groups if group.each and group.each.asked]
        for group in [*(CallGroup(part, (), False, True) for part in asked), *groups]:
            if lanes > most.get(group.function, 0):
                most[group.function] = lanes
                if not group.part.source:
                    find(parts[group.function], lanes)
                called.setdefault(group.function, group)

    for one, lanes in users:
        find(one, lanes)
    texts = []
    for function, group in called.items():
        if group.part.source and not group.part.flat:
            texts.append(_up_to(most[function], part_in_c_in_lanes(name, group.part, group.slopes)))
        elif not group.part.source:
            body = _of_part(name, parts[function], function, "LANES")
            texts.append(_up_to(most[function], _written(body)))
    return _given([group.part for group in called.values() if group.part.source]), texts


def functions_in_lanes(name: str, made: Mapping[str, Generated]) -> tuple[list[str], list[str]]:
    """Return C of the parts given in C, and of all functions over several instances, LANES_NAME(NAME_FUNCTION)."""
    own = list(made.values())
    given, texts = _parts_within(name, _functions_of_parts(own), [(one, WIDTHS[-1]) for one in own])
    return given, [*texts, *(_written(_of_all_lanes(name, one)) for one in own)]


# -- functions --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class GeneratedFunction:
    """A function: its declaration, the parameters and arguments of its pieces, its statements and arrays.

    lanes: C of the number of lanes; groups: of its calls.
    """

    name: str
    head: str
    parameters: str
    given: str
    statements: list[Statement]
    rooms: dict[str, int]
    lanes: str
    groups: list[CallGroup]
    end: str = ""


def _of_one_number(name: str, generated: Generated) -> GeneratedFunction:
    """Return a function as the runtime calls it, `generated_function` in model.h."""
    function, rooms = generated.function, Rooms.of(generated, True)
    parameters = "const double **arg, double **res, long long int *iw, double *w, int mem"
    left = function.n_in() - 1 if generated.calls else function.n_in()

    def read(number: int, place: int) -> str:
        return f"arg[{number}][{place}]" if number < left else f"left[{rooms.left[place]}]"

    def write(number: int, place: int) -> list[str]:
        if number >= generated.ranks:
            return [f"res[{number - generated.ranks}][{place}] = {{}}"]
        return [f"given_{number}[{where}] = {{}}" for where in rooms.given[number][place]]

    def calls(number: int) -> list[Statement]:
        found = rooms.groups[number] if number < generated.ranks else []
        return [Statement(_plain(call_of_group(name, number, group))) for group in found]

    statements = paired(statements_of(function, Memory(read, write), calls))
    groups = [group for rank in rooms.groups for group in rank]
    head = f"RUNTIME_LOCAL int {function.name()}({parameters})"
    piece = f"{name}_piece_of_{function.name()}"
    return GeneratedFunction(
        piece, head, parameters, "arg, res, iw, w, mem", statements, rooms.sizes, "1", groups, "  return 0;\n"
    )


def _of_part(name: str, generated: Generated, own_name: str, distance: str) -> GeneratedFunction:
    """Return a part in lanes: distance, C of a number, is how far the numbers of a lane are from each other."""
    parameters = "const double *arguments, const double *constants, double *results"
    face = LanesFace(parameters, "arguments, constants, results", ["arguments", "constants"], ["results"])
    return _of_lanes(name, generated, own_name, face, distance)


def _of_all_lanes(name: str, generated: Generated) -> GeneratedFunction:
    """Return a function of a system in lanes, `lanes_function` in batch.h."""
    inputs = [f"arg[{number}]" for number in range(generated.function.n_in())]
    results = [f"res[{number}]" for number in range(generated.function.n_out() - generated.ranks)]
    face = LanesFace("const double *const *arg, double *const *res", "arg, res", inputs, results)
    return _of_lanes(name, generated, generated.function.name(), face, "LANES")


def function_of_cells(function: ca.Function) -> str:
    """Return C of a function of many cells, LANES at a time: LANES_NAME(cells_NAME)(INPUT, ..., result, stride).

    Each input and the result is a pointer to the first number of the first cell. The number of the next cell follows
    it, and the next number of a cell is `stride` further. Raises ValueError if an operation has no C.
    """
    names = function.name_in()
    parameters = ", ".join([*(f"const double *{name}" for name in names), "double *result", "long long int stride"])
    face = LanesFace(parameters, ", ".join([*names, "result", "stride"]), names, ["result"])
    return _written(_of_lanes("cells", Generated(function, [], []), function.name(), face, "stride"))


@dataclass(frozen=True)
class LanesFace:
    """C of the parameters of a function in lanes, of the arguments of its pieces, of its inputs and of its results."""

    parameters: str
    given: str
    inputs: Sequence[str]
    results: Sequence[str]


def _of_lanes(name: str, generated: Generated, own_name: str, face: LanesFace, distance: str) -> GeneratedFunction:
    function, rooms = generated.function, Rooms.of(generated, False)
    inputs = [*face.inputs[: function.n_in() - 1], "left"] if generated.calls else face.inputs

    def at(array: str, place: int, by: str) -> str:
        return f"{array} + {place * int(by)}" if by.isdigit() else f"{array} + {place} * {by}"

    def read(number: int, place: int) -> str:
        if inputs[number] == "left":
            return f"real_load({at('left', rooms.left[place], 'LANES')})"
        return f"real_load({at(inputs[number], place, distance)})"

    def write(number: int, place: int) -> list[str]:
        if number >= generated.ranks:
            return [f"real_store({at(face.results[number - generated.ranks], place, distance)}, {{}})"]
        return [give(number, where) for where in rooms.given[number][place]]

    def give(rank: int, place: int) -> str:
        return f"real_store({at(f'given_{rank}', place, 'LANES')}, {{}})"

    def calls(number: int) -> list[Statement]:
        found = rooms.groups[number] if number < generated.ranks else []
        return [Statement(_plain(call_in_lanes(name, number, group))) for group in found]

    statements = statements_of(function, Memory(read, write), calls)
    for rank, groups in enumerate(rooms.groups):
        for group in (generated for generated in groups if generated.conditional):
            gives = {give(rank, group.given + place) for place in range(group.numbers)}
            statements = given_where_asked(statements, gives, _plain(call_in_lanes(name, rank, group)))
    head = f"static void LANES_NAME({name}_{own_name})({face.parameters})"
    piece = f"LANES_NAME({name}_piece_of_{own_name})"
    return GeneratedFunction(piece, head, face.parameters, face.given, statements, rooms.sizes, "LANES", [])


def given_where_asked(statements: Sequence[Statement], gives: set[str], call: str) -> list[Statement]:
    """Return the statements with those of these forms moved into the call, after ASKED, and their loads with them."""
    stores = [statement for statement in statements if statement.form in gives]
    loads = {one.values[0]: one.form for one in statements if one.form.startswith("real_load(") and not one.operands}
    given = [
        loads.get(operand, operand) if isinstance(operand, int) else operand
        for store in stores
        for operand in store.operands
    ]
    inside = "".join(f"{one.form};\n      " for one in stores)
    made = [
        Statement(one.form.replace(ASKED, inside), tuple(given)) if one.form == call else one
        for one in statements
        if one.form not in gives
    ]
    read = {value for one in made for value in one.reads}
    return [one for one in made if not (one.values and one.values[0] in loads and one.values[0] not in read)]


def _plain(text: str) -> str:
    """Return a form without operands."""
    return text.replace("{", "{{").replace("}", "}}")


def _written(body: GeneratedFunction) -> str:
    """Return C of a function; a long one is cut into pieces, which pass numbers to each other in `kept`."""
    bodies, kept = _bodies(body)
    rooms = {"kept": kept} | body.rooms
    rooms = {room: size for room, size in rooms.items() if size}
    by = "" if body.lanes == "1" else " * LANES"
    room = "".join(f"  LANES_ALIGNED double {room}[{size}{by}];\n" for room, size in rooms.items())
    if len(bodies) == 1:
        return f"{body.head} {{\n{room}{bodies[0]}{body.end}}}\n"
    parameters = ", ".join([body.parameters, *(f"double *{room}" for room in rooms)])
    piece = [body.name.replace("piece_of", f"piece_{n}_of") for n in range(len(bodies))]
    pieces = "".join(f"static void {own}({parameters}) {{\n{text}}}\n" for own, text in zip(piece, bodies, strict=True))
    given = ", ".join([body.given, *rooms])
    calls = "".join(f"  {own}({given});\n" for own in piece)
    return f"{pieces}{body.head} {{\n{room}{calls}{body.end}}}\n"


def _locals(statements: Sequence[Statement]) -> dict[int, str]:
    """Return a local name for each value; names are reused after the last read. Those of masks begin with m."""
    last = {value: number for number, statement in enumerate(statements) for value in statement.reads}
    masks = {value for one in statements if one.mask for value in one.values}
    names: dict[int, str] = {}
    free: dict[bool, list[str]] = {True: [], False: []}
    new = {True: (f"m{number}" for number in count()), False: (f"a{number}" for number in count())}
    for number, one in enumerate(statements):
        ends = [value for value in dict.fromkeys(one.reads) if last[value] == number]
        if not one.written:  # it reads before it writes
            for value in ends:
                free[value in masks].append(names[value])
        for value in one.values:
            names[value] = free[one.mask].pop() if free[one.mask] else next(new[one.mask])
        for value in [*(ends if one.written else []), *(value for value in one.values if value not in last)]:
            free[value in masks].append(names[value])
    return names


def _bodies(body: GeneratedFunction) -> tuple[list[str], int]:
    """Return C of the statements as a whole or in pieces, and how many numbers the pieces leave to later ones.

    A number that is left is stored as soon as it is computed, and loaded where it is first needed. A processor has few
    registers, and a compiler takes 1.6 times as long to distribute them if all are loaded at the beginning.
    """
    statements = body.statements
    longest = LONGEST if len(statements) > WHOLE else WHOLE
    pieces = [statements[start : start + longest] for start in range(0, len(statements), longest)]
    born = {value: n for n, piece in enumerate(pieces) for one in piece for value in one.values}
    left = {value for n, piece in enumerate(pieces) for one in piece for value in one.reads if born[value] < n}
    names, masks = (
        _locals(statements),
        {value for statement in statements if statement.mask for value in statement.values},
    )
    by = "" if body.lanes == "1" else " * LANES"
    numbered = enumerate(dict.fromkeys(names[value] for value in sorted(left)))
    places = {name: f"kept + {number}{by}" for number, name in numbered}
    texts = []
    for n, piece in enumerate(pieces):
        used = {value for one in piece for value in one.reads}
        taken = {value for value in used if born[value] < n}
        used |= {value for one in piece for value in one.values}
        lines = [_declared("real", sorted({names[value] for value in used - masks}))]
        lines.append(_declared("real_mask", sorted({names[value] for value in used & masks})))
        for one in piece:
            for value in one.reads:
                if value in taken:
                    load = f"real_load({places[names[value]]})"
                    lines.append(f"{names[value]} = {f'real_is({load})' if value in masks else load};")
            taken.difference_update(one.reads)
            lines.append(one.text(names))
            for own in (names[value] for value in one.values if value in left):
                lines.append(f"real_store({places[own]}, {f'real_of_mask({own})' if one.mask else own});")
        texts.append("".join(f"  {line}\n" for line in lines if line))
    return texts or [""], len(places)


def _declared(kind: str, names: Sequence[str]) -> str:
    return f"{kind} {', '.join(names)};" if names else ""
