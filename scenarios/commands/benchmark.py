"""Run benchmarks of braking: published cases, answered by this project, by other programs, or by yours.

  bogie-braking benchmark --list                             all cases, each in a sentence
  bogie-braking benchmark en-14531-1-twelve-axles            one case: errors, cost, results/benchmark.html
  bogie-braking benchmark                                    all cases
  bogie-braking benchmark --program mine.py                  your program too: a function answer(question, inputs)
  bogie-braking benchmark --fmu mine.fmu --map mine.toml     an FMU, whose map gives the names of its variables
  bogie-braking benchmark sand-trials --range                also the range over inputs that are not published
  bogie-braking benchmark --answers mine.csv                 answers of any program: case, point, answer, value, unit
  bogie-braking benchmark --cases my_cases                   your cases too: a file NAME.toml, or a folder of them

A dash is an answer that a program cannot give. Docs: docs/benchmark.md.

Exit status: 0 this project answers every judged question within its bound, or gives a dash; 1 it does not; 2 bad input;
3 the results cannot be written.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bogie_braking.common_options import add_out, add_speech, bars, describe
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from fmu_src.suggestion import suggestion
from readers.command_line import check_folder, whole
from readers.text import BadInputError, shown
from scenarios.benchmark.band import DRAWS, Band, bands
from scenarios.benchmark.case import BenchmarkCase
from scenarios.benchmark.case_file import CASES, cases_in, read_case

if TYPE_CHECKING:
    from scenarios.benchmark.score import Scored


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `benchmark`."""
    describe(parser, __doc__)
    parser.add_argument("name", nargs="*", metavar="NAME", help="cases (default: all)")
    parser.add_argument("--list", action="store_true", help="list the cases")
    place = "cases of your own, next to those of the package: a file NAME.toml, or a folder of them"
    parser.add_argument("--cases", type=Path, action="append", default=[], metavar="PATH", help=place)
    program = "a Python file with a function answer(question, inputs), inputs in SI units"
    parser.add_argument("--program", type=Path, action="append", default=[], metavar="FILE", help=program)
    answers = "a CSV file of answers: case, point, answer, value, unit"
    parser.add_argument("--answers", type=Path, action="append", default=[], metavar="FILE", help=answers)
    fmu = "an FMU for co-simulation; the n-th --map belongs to the n-th --fmu"
    parser.add_argument("--fmu", type=Path, action="append", default=[], metavar="FILE", help=fmu)
    mapped = "a TOML file that maps inputs and answers of a question to variables of the FMU"
    parser.add_argument("--map", type=Path, action="append", default=[], metavar="FILE", help=mapped)
    draws = f"also the range over inputs that are not published, from N random draws (default: {DRAWS})"
    reader = whole("--range", 10, 100_000)
    parser.add_argument("--range", type=reader, nargs="?", const=DRAWS, default=0, metavar="N", help=draws)
    add_out(parser, "folder of page, picture, table and document")
    add_speech(parser, "the scores", "no table, only the exit status")


def names() -> Sequence[str]:
    """Return the names of cases."""
    return list(cases_in([CASES]))


def run(chosen: argparse.Namespace) -> int:
    """List the cases, or run some; return DOES_NOT_HOLD if this project misses a bound."""
    files = cases_in([CASES, *chosen.cases])
    for name in chosen.name:
        if name not in files:
            raise BadInputError(f"NAME must be the name of a case; got {shown(name)}; {suggestion(name, files)}")
    cases = [read_case(files[name]) for name in dict.fromkeys(chosen.name or files)]
    if chosen.list:
        idle = [name for name in ("program", "answers", "fmu", "map", "range") if getattr(chosen, name)]
        if idle:
            raise BadInputError(f"--{idle[0]} has no effect with --list, which runs nothing. Leave one out.")
        return _list(cases, chosen)
    check_folder(chosen.out)
    with bars(chosen):
        return _run(cases, files, chosen)


def _list(cases: Sequence[BenchmarkCase], chosen: argparse.Namespace) -> int:
    about = {case.name: case.title for case in cases}
    if chosen.json:
        print(json.dumps(about, indent=2))
    elif chosen.quiet:
        print("\n".join(about))
    else:
        width = max(map(len, about))
        print("\n".join(f"{name:<{width}}  {title}" for name, title in about.items()))
    return HOLDS


def _check_answered(scored: Sequence[Scored]) -> None:
    """Raise BadInputError for a case whose question no program answers, as a misspelt one."""
    for one in scored:
        if not one.failures and all(
            each.cost is None and all(value is None for value in each.values) for each in one.scores
        ):
            raise BadInputError(
                f"question must be one that a program answers; got {shown(one.case.question)} in {one.case.name}. "
                "Correct its spelling, or add a program with --program."
            )


def _run(cases: Sequence[BenchmarkCase], files: dict[str, Path], chosen: argparse.Namespace) -> int:
    from bogie_braking.reporting.progress import counting
    from scenarios.benchmark.answers_file import program_of_answers
    from scenarios.benchmark.fmu_program import program_of_fmu
    from scenarios.benchmark.page import Results, document, text_of, write_results
    from scenarios.benchmark.programs import of_file, programs
    from scenarios.benchmark.score import score

    known, missing = programs()
    known += [of_file(path) for path in chosen.program]
    known += [program_of_answers(path, files) for path in chosen.answers]
    if len(chosen.fmu) != len(chosen.map):
        got = f"{len(chosen.fmu)} and {len(chosen.map)}"
        raise BadInputError(f"--fmu and --map must be given equally often; got {got}. Give a map for each FMU.")
    if chosen.range and not any(case.unknown for case in cases):
        raise BadInputError("--range has no effect on cases without unknown inputs. Leave it out.")
    known += [program_of_fmu(*both) for both in zip(chosen.fmu, chosen.map, strict=True)]
    repeated = {one.name for one in known if sum(one.name == other.name for other in known) > 1}
    if repeated:
        raise BadInputError(f"Programs must have names of their own; got {repeated.pop()} twice. Rename a file.")
    scored, ranges = [], list[Band]()
    for case in counting(cases, "benchmark"):
        scored.append(score(case, known))
        ranges += bands(case, known[0], chosen.range) if chosen.range else []
    _check_answered(scored)
    results = Results(scored, known, missing, ranges)
    places = write_results(results, chosen.out)
    if chosen.json:
        print(json.dumps(document(results), indent=2))
    elif not chosen.quiet:
        print(text_of(results) + "\n" + "".join(f"{place}\n" for place in places), end="")
    own = [one for each in scored for one in each.scores if one.program == known[0].name]
    failed = any(one.holds is False for one in own) or any(known[0].name in one.failures for one in scored)
    return DOES_NOT_HOLD if failed else HOLDS
