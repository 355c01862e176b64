"""C of the calls of parts in a generated function, and the arrays for their arguments and results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from fmu_src.chain import NOTHING, Call, Each, Part
from fmu_src.equations import Generated, Slopes, part_name
from fmu_src.symbols import ca
from fmu_src.unique_names_in_c import PREFIX


@dataclass
class CallGroup:
    """Calls of a part that are computed side by side: each number of a call is next to that of the call before.

    calls: their numbers in the function; given, left: where their numbers begin in `given_RANK` and in `left`. alone:
    True for a single call. each: the list of a call that is made for each of its records.
    """

    part: Part
    slopes: Slopes
    conditional: bool
    alone: bool
    each: Each | None = None
    calls: list[int] = field(default_factory=list)
    given: int = 0
    left: int = 0

    @property
    def lanes(self) -> int:
        """Return the number of places: even for a group, which computes the last of an odd number of calls twice."""
        return 1 if self.alone else len(self.calls) + len(self.calls) % 2

    @property
    def arguments(self) -> int:
        """Return how many numbers come before the constants."""
        return self.part.arguments.numel()

    @property
    def numbers(self) -> int:
        """Return how many numbers a call is given, without the condition, which comes last."""
        return self.arguments + self.part.constants.numel()

    @property
    def leaves(self) -> int:
        """Return how many numbers each call leaves."""
        return self.part.results.numel() + len(self.slopes)

    @property
    def function(self) -> str:
        """Return the part's function with this distance between the numbers of a call."""
        return f"{part_name(self.part, self.slopes)}{'' if self.alone else f'_of_{self.lanes}'}"

    @property
    def entry(self) -> str:
        """Return the name of the function that computes some of its lanes, called from functions of one number."""
        return f"{self.function}_where" if self.conditional else f"{self.function}_all"


@dataclass
class Rooms:
    """The arrays of a function for its calls: groups by rank, sizes of the arrays, and the place of each number.

    given: for each rank the places of each number that is given; left: the place of each number that is left.
    """

    groups: list[list[CallGroup]] = field(default_factory=list)
    given: list[list[list[int]]] = field(default_factory=list)
    left: list[int] = field(default_factory=list)
    sizes: dict[str, int] = field(default_factory=dict)

    @classmethod
    def of(cls, generated: Generated, side_by_side: bool) -> Rooms:
        """Lay out the arrays of a function for its calls.

        side_by_side: calls of one rank and part are a group, except for parts in C; otherwise each call is its own
        group.
        """
        made = cls(
            sizes={f"given_{rank}": 0 for rank in range(generated.ranks)} | ({"left": 0} if generated.calls else {})
        )
        left: dict[int, list[int]] = {}
        for rank in range(generated.ranks):
            groups = list(_groups(generated, rank, side_by_side))
            given: dict[int, list[list[int]]] = {}
            for place, group in enumerate(groups):
                group.given, group.left = made.sizes[f"given_{rank}"], made.sizes["left"]
                same = next((each for each in groups[:place] if _given_the_same(generated.calls, each, group)), None)
                if same:
                    group.given = same.given
                else:
                    made.sizes[f"given_{rank}"] += (group.numbers + group.conditional) * group.lanes
                made.sizes["left"] += group.leaves * group.lanes
                for lane, number in enumerate(group.calls):
                    twice = [lane, lane + 1] if lane == len(group.calls) - 1 < group.lanes - 1 else [lane]
                    taken, leaves = generated.sizes(number)
                    given[number] = [
                        [group.given + n * group.lanes + generated for generated in twice] for n in range(taken)
                    ]
                    left[number] = [group.left + n * group.lanes + lane for n in range(leaves)]
            made.groups.append(groups)
            made.given.append([places for number in sorted(given) for places in given[number]])
        made.left = [place for number in sorted(left) for place in left[number]]
        return made


def _given_the_same(calls: Sequence[Call], one: CallGroup, other: CallGroup) -> bool:
    """Return whether two calls for each record of a list have the same arguments, which are then stored once."""
    taken = [ca.vertsplit(calls[group.calls[0]].taken) for group in (one, other) if group.each]
    return len(taken) == 2 and len(taken[0]) == len(taken[1]) and all(map(ca.is_equal, *taken))


def _groups(generated: Generated, rank: int, side_by_side: bool) -> Iterator[CallGroup]:
    found: dict[object, CallGroup] = {}
    for number, call in enumerate(generated.calls):
        if call.rank != rank:
            continue
        alone, conditional = bool(call.part.source) or not side_by_side, not call.when.is_constant()
        key = number if alone else (part_name(call.part, generated.slopes[number]), conditional)
        if call.each and (side_by_side or conditional or (call.each.largest and generated.slopes[number])):
            raise ValueError(f"{call.part.name}: calls for each record belong in a part, without conditions.")
        found.setdefault(
            key, CallGroup(call.part, generated.slopes[number], conditional, alone, call.each)
        ).calls.append(number)
    yield from found.values()


def call_of_group(name: str, rank: int, group: CallGroup) -> str:
    """Return C of a group's call in a function of one number: `mem` is the number of lanes of the processor."""
    if group.part.inline:
        places = group.given, group.given + group.arguments
        arguments, constants = (f"given_{rank} + {place}" for place in places)
        return group.part.source.format(arguments=arguments, constants=constants, left=f"left + {group.left}")
    if group.part.flat:
        return f"real_look_up(&{group.part.name}, given_{rank} + {group.given}, left + {group.left})"
    if group.part.source:
        return _call_of_c(rank, group)
    return f"{name}_{group.entry}_at(mem, given_{rank} + {group.given}, left + {group.left})"


def _call_of_c(rank: int, group: CallGroup) -> str:
    """Return C of a call of a part given in C, in a function of one number."""
    when = ""
    if group.conditional:
        # Cleared before: a call that is left out leaves 0.
        when = f"for (int i = {group.left}; i < {group.left + group.leaves}; ++i) left[i] = 0.0;\n  "
        when += f"if (given_{rank}[{group.given + group.numbers}] > 0.0) "
    slopes = f"left + {group.left + group.part.results.numel()}" if group.slopes else "0"
    given = f"given_{rank} + {group.given}, given_{rank} + {group.given + group.arguments}"
    return f"{when}{PREFIX}{group.part.name}({given}, left + {group.left}, {slopes})"


def call_in_lanes(name: str, rank: int, group: CallGroup) -> str:
    """Return C of a call in a function of several lanes, each of which calls the part."""
    given = [f"given_{rank} + {group.given + place} * LANES" for place in (0, group.arguments, group.numbers)]
    left = f"left + {group.left} * LANES"
    if group.each:
        return call_for_each(name, rank, group, group.each, given[:2], left)
    if group.part.inline:
        call = group.part.source.format(arguments=given[0], constants=given[1], left=left)
    elif group.part.flat:
        call = f"real_look_up(&{group.part.name}, {given[0]}, {left})"
    elif group.part.source:
        call = f"LANES_NAME({name}_each_{group.function})({given[0]}, {given[1]}, {left})"
    else:
        call = f"LANES_NAME({name}_{group.function})({given[0]}, {given[1]}, {left})"
    return call if not group.conditional else where(ASKED + call, given[2], left, group.leaves, "LANES")


def call_for_each(name: str, rank: int, group: CallGroup, each: Each, given: Sequence[str], left: str) -> str:
    """Return C of calls for each record of a list; given: C of arguments and constants."""
    call = f"LANES_NAME({name}_{group.function})({', '.join(given)}, to)"
    first = f"real_record_in(from, {each.place}, 0, record); {{ double *to = {left}; {call}; }}" if each.always else ""
    ask, asked = "", "has"
    if each.asked:
        ask = f"LANES_NAME({name}_{part_name(each.asked, ())})({', '.join(given)}, margin);"
        asked = "real_where(has, real_load(margin)) > 0.0"
    nothing = NOTHING if each.largest else 0.0
    one = f"real_select(asked, {{}}, real_of({nothing}))" if each.largest else "real_where(asked, {})"
    joined = "real_select(own > all, own, all)" if each.largest else "all + own"
    return f"""{{
    LANES_ALIGNED double from[LANES], margin[LANES], more[{group.leaves} * LANES];
    double *record = given_{rank} + {group.given + group.numbers - 1} * LANES;
    int any = {int(each.always)};
    (void)margin;
    real_store(from, real_load(record));
    {first}
    for (int i = {int(each.always)}, most = real_records_in(from, {each.place}); i < most; ++i) {{
      const real_mask has = real_record_in(from, {each.place}, i, record);
      {ask}
      const real_mask asked = {asked};
      if (!real_any(asked)) continue;
      double *to = any ? more : {left};
      {call};
      for (int j = 0; j < {group.leaves}; ++j) {{
        const real own = {one.format("real_load(to + j * LANES)")}, all = real_load({left} + j * LANES);
        real_store({left} + j * LANES, any ? {joined} : own);
      }}
      any = 1;
    }}
    real_store(record, real_load(from));
    for (int j = 0; !any && j < {group.leaves}; ++j) real_store({left} + j * LANES, real_of({nothing}));
  }}"""


#: Place in the C of a conditional call for the computation of its arguments, which is skipped with the call.
ASKED = "/* given */"


def where(call: str, condition: str, left: str, leaves: int, distance: str | int) -> str:
    """Return C of a call that leaves 0 in lanes with a condition of 0 or below; all such lanes: it is skipped."""
    return f"""{{
    const real_mask asked = real_load({condition}) > 0.0;
    if (real_any(asked)) {{
      {call};
      for (int i = 0; i < {leaves}; ++i)
        real_store({left} + i * {distance}, real_where(asked, real_load({left} + i * {distance})));
    }} else {{
      for (int i = 0; i < {leaves}; ++i) real_store({left} + i * {distance}, real_of(0.0));
    }}
  }}"""


def entry_of_group(name: str, group: CallGroup) -> str:
    """Return the function that computes LANES lanes of a group, for functions of one number."""
    distance = group.lanes
    call = f"LANES_NAME({name}_{group.function})(given, given + {group.arguments * distance}, left)"
    if group.conditional:
        call = where(call, f"given + {group.numbers * distance}", "left", group.leaves, distance)
    head = f"RUNTIME_LOCAL void LANES_NAME({name}_{group.entry})(const double *given, double *left)"
    return f"{head} {{\n  {call};\n  LANES_LEAVE;\n}}\n"


def group_at(name: str, group: CallGroup, widths: tuple[int, ...]) -> str:
    """Return the function that computes a group in as many lanes as the processor has, `lanes`."""
    wide = [lanes for lanes in reversed(widths) if lanes <= group.lanes]
    declared, tried = "", ""
    for lanes in wide:
        last = lanes == widths[0]
        entry = f"{name}_{group.entry}_{lanes}"
        declared += (
            f"#if LANES_WIDEST >= {lanes}\n" + f"RUNTIME_LOCAL void {entry}(const double *, double *);\n#endif\n"
        )
        asked = "" if last else f"if (lanes >= {lanes} && lane + {lanes} <= {group.lanes}) "
        step = f"{{ {entry}(given + lane, left + lane); lane += {lanes}; continue; }}"
        tried += f"#if LANES_WIDEST >= {lanes}\n    {asked}{step}\n"
        tried += "#endif\n" if not last else ""
    single = f"{name}_{group.entry}_1"
    declared += f"#if LANES_WIDEST == 1\nRUNTIME_LOCAL void {single}(const double *, double *);\n#endif\n"
    tried += f"#else\n    {single}(given + lane, left + lane); lane += 1;\n#endif\n"
    head = f"static void {name}_{group.entry}_at(int lanes, const double *given, double *left)"
    return f"{declared}{head} {{\n  (void)lanes;\n  for (int lane = 0; lane < {group.lanes};) {{\n{tried}  }}\n}}\n"


def part_in_c_in_lanes(name: str, part: Part, slopes: Slopes) -> str:
    """Return C of a part given in C, called lane by lane."""
    counts = part.arguments.numel(), part.constants.numel(), part.results.numel(), part.slope.nnz()
    arrays = ", ".join(f"{one}[{max(size, 1)}]" for one, size in zip("acrs", counts, strict=True))

    def copy(target: str, size: int, source: str) -> str:
        return f"    for (int i = 0; i < {size}; ++i) {target} = {source};\n" if size else ""

    head = f"LANES_FUNCTION void LANES_NAME({name}_each_{part_name(part, slopes)})"
    given = copy("a[i]", counts[0], "arguments[i * LANES + lane]") + copy(
        "c[i]", counts[1], "constants[i * LANES + lane]"
    )
    left = copy("results[i * LANES + lane]", counts[2], "r[i]")
    left += copy(f"results[({counts[2]} + i) * LANES + lane]", len(slopes), "s[i]")
    call = f"    {PREFIX}{part.name}(a, c, r, {'s' if slopes else '0'});\n"
    return f"""{head}(const double *arguments, const double *constants, double *results) {{
  double {arrays};
  (void)constants, (void)c, (void)s;
  for (int lane = 0; lane < LANES; ++lane) {{
{given}{call}{left}  }}
}}
"""
