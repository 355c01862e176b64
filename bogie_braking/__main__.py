"""The command line of bogie-braking; `python -m bogie_braking` is the same.

  bogie-braking list                                             all scenarios, each in a sentence
  bogie-braking run qr30-180kpa                                  runs one: table, data, figure in results/qr30-180kpa/
  bogie-braking run bogie-heavy-braking --kind python            with the pythonfmu FMUs
  bogie-braking run qr30-180kpa --step 0.1ms                     with another macro step
  bogie-braking run qr30-180kpa --coupling-tolerance 1e-4        with macro steps chosen by the error of the coupling
  bogie-braking run qr30-180kpa --torque-csv measured.csv        with a measured torque (time [s], torque [N.m])
  bogie-braking run contact-geometry --wheel left.csv right.csv --rail 60e1.csv --diameter 920 918
                                                                 equivalent conicity (EN 15302) of your profiles
  bogie-braking profile wheel.prw rail.prr --out pair.csv        contact table of your profiles, and its picture
  bogie-braking run line-from-file --line mine.csv               a bogie along your line
  bogie-braking run bogie-lateral --html                         also report.html: charts that zoom, the motion in space
  bogie-braking report                                           results/index.html: all results on one page
  bogie-braking sweep bogie-heavy-braking --vary friction=0.1:0.3:11 --vary frame_height=0.4,0.8,1.2 --jobs 2
                                                                 every combination in one table; the same command
                                                                 resumes a sweep that was interrupted
  bogie-braking sweep levels --vary utilisation=0.5:1.3:81 --scheduler tcp://127.0.0.1:8786
                                                                 on a Dask cluster
  bogie-braking pace spatial --step 1ms --seconds 10             in real time on this machine: longest step, overruns
  bogie-braking controllers compare mine.py:PI                   scores wheel-slide controllers, in Python and in C
  bogie-braking line check mine.csv --speed 120km/h              what a line demands, and a picture
  bogie-braking line import points.csv --out mine.csv            a line of points, elements, or of another program
  bogie-braking consist import freight.con --out train.toml      a train of Open Rails, OSRD, ALTRIOS, OpenBVE, railML
  bogie-braking consist check train.toml                         masses, brakes, stops of a consist
  bogie-braking live                                             pages that brake a coach, a bogie or a train
  bogie-braking vehicle check mine.toml                          your vehicle from a file: loads, modes, stops, its FMU
  bogie-braking benchmark                                        published cases, by this project and other programs
  bogie-braking build bogie                                      FMUs; build --help says more
  bogie-braking run levels --json | jq .rows                     the summary for a program
  for name in $(bogie-braking list --quiet); do ...              the names alone
  bogie-braking doctor                                           what is installed, what is missing, what to do
  eval "$(bogie-braking completion bash)"                        completion of this command in a shell

Exit status: 0 all rows hold, or all points of a sweep were run; 1 a row does not hold, a point failed, a paced step
overran, or doctor misses something that is needed; 2 bad input; 3 a simulation, a sweep or this program failed; 130
interrupted with Ctrl-C: earlier results and the finished points of a sweep stay; 141 the program that read the output
has ended.
"""

from __future__ import annotations

import os
import sys
import traceback

from bogie_braking.commands import COMMANDS, module_of, parser_of
from bogie_braking.exit_status import BAD_INPUT, FAILED, NOBODY_READS
from readers.text import BadInputError


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit status, as in the description."""
    try:
        status = answer(sys.argv[1:] if arguments is None else arguments)
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left would be written at the exit
        return NOBODY_READS
    except BadInputError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except Exception:
        traceback.print_exc()  # Python would end with the status of a failed row
        return FAILED
    return status


def answer(given: list[str]) -> int:
    """Run a command and return its exit status. The module of that command alone is imported."""
    loaded = {*given[:1]} & COMMANDS.keys()
    chosen = parser_of(loaded, __doc__).parse_args(given)
    try:
        status: int = module_of(chosen.command).run(chosen)
    except (Exception, KeyboardInterrupt) as error:
        from bogie_braking.commands.failures import status_of  # heavy: FMUs, equations

        return status_of(error, chosen)
    return status


if __name__ == "__main__":
    sys.exit(main())
