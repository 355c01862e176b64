"""Table files of models other than railways, with their own columns, limits and pieces, by fmu_src alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fmu_src.kernel import Kernel, Library, SimulationError
from fmu_src.system import System, Variable, model_of
from fmu_src.user_files import TableFile, TablePiece
from readers.columns import Column
from tests.fmu_src.quick_library import quick_library

#: Head and volume flow of a pump over time; the integral of the flow is the volume.
MAP = TableFile(
    Variable("map_file", "parameter", "1", "Path of the pump's map", kind="string"),
    noun="map",
    preposition="by",
    resource="map.csv",
    columns=(
        Column("time", "s", 0.0, 1e6, required=True),
        Column("flow", "m3/s", 0.0, 2.0, required=True),
        Column("head", "m", 0.0, 80.0),
    ),
    least_growth=0.1,
    rounding=0.25,
    known="time, flow and, where known, head",
    added=("volume",),
    pieces=(TablePiece("flow", "m3/s", 1), TablePiece("head", "m", 5), TablePiece("volume", "m3", 4, goes_on=True)),
    source="""
static int parts_before(const table_file *self, int row, char *problem, size_t size) {
    const double change = self->column[COLUMN_FLOW][row] - self->column[COLUMN_FLOW][row - 1];
    if (fabs(change) <= 1.0) return 1;
    snprintf(problem, size, "the flow changes by %g m3/s at once; give rows between", change);
    return 0;
}

static void complete(const table_file *self) {
    double c[MOST_TERMS], *volume = self->column[COLUMN_VOLUME];
    volume[0] = 0.0;
    table_part part[MOST_PARTS];
    for (int row = 0; row + 1 < self->rows; ++row) {
        const table_part *last = &part[table_parts(self, row, part) - 1];
        table_integral(self, COLUMN_FLOW, last, volume[row], c);
        volume[row + 1] = table_value(c, last->to - last->from);
    }
}

static void piece_between(const table_file *self, int piece, const table_part *part, double *c) {
    if (piece == PIECE_FLOW) table_straight(self, COLUMN_FLOW, part, c);
    if (piece == PIECE_HEAD && self->column[COLUMN_HEAD]) table_smooth(self, COLUMN_HEAD, part, c);
    if (piece == PIECE_VOLUME) table_integral(self, COLUMN_FLOW, part, self->column[COLUMN_VOLUME][part->row], c);
}
""",
)


@pytest.fixture(scope="module")
def pump() -> Library:
    """Return a tank that a pump fills as in its table."""
    system = System("Pump", "fills a tank")
    level = system.state("level", "m3", 0.0, 1.0)
    flow, slope = system.from_file(MAP, "flow", system.time, 1)
    system.derivative(level, flow)
    shown = {"level": level, "flow": flow, "slope": slope, "volume": system.from_file(MAP, "volume", system.time)[0]}
    shown["head"] = system.from_file(MAP, "head", system.time)[0]
    for name, value in shown.items():
        system.output(Variable(f"{name}_out", "output", "1", "Looked up"), value)
    return quick_library(model_of(system, 1e-9))


def test_a_tank_is_filled_by_the_map_of_its_pump(pump: Library, tmp_path: Path) -> None:
    """A flow that grows linearly from 0 to 1 m3/s in 10 s moves t^2 / 20, then 5 + (t - 10)."""
    path = tmp_path / "map.csv"
    path.write_text("flow,time,head\n" + "".join(f"{min(t / 10, 1)},{t},{t + 1}\n" for t in range(20)))
    kernel = Kernel(pump, map_file=str(path))
    kernel.advance(1.0)
    first = kernel["volume_out"]  # the slope at the first row is 0, so the deviation before it is small
    kernel.advance(4.5)
    assert kernel["flow_out"] == pytest.approx(0.55)
    assert kernel["slope_out"] == pytest.approx(0.1)
    assert kernel["head_out"] == pytest.approx(6.5)
    assert kernel["level_out"] == pytest.approx(5.5**2 / 20, rel=1e-6)
    assert kernel["volume_out"] - first == pytest.approx((5.5**2 - 1.0) / 20, rel=1e-12)
    kernel.advance(24.5)  # beyond the end: constant flow and head, growing volume
    assert [kernel[name] for name in ("flow_out", "head_out")] == pytest.approx([1.0, 20.0])
    assert kernel["level_out"] == pytest.approx(25.0, rel=1e-6)
    assert kernel["volume_out"] == pytest.approx(kernel["level_out"], abs=2e-3)  # corners are rounded


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        (
            "time,flow\n0,0\n1,3\n",
            r"^Map .*row 3, column flow: .* from 0 to 2 m3/s; got '3' m3/s\..* The map before it",
        ),
        ("time,flow\n0,0\n1,1.5\n", r"row 3: the flow changes by 1.5 m3/s at once; give rows between\."),
        ("time,flow\n0,0\n0,1\n", r"row 3, column time: values must grow by at least 0.1 s; got 0 s after 0 s\."),
        ("time,head\n0,0\n1,1\n", r"row 1: the column flow is missing"),
        ("time,flow,kind\n", r"row 1: the column 'kind' is unknown. Columns are time, flow and, where known, head"),
        ("time,flow,haed\n", r"row 1: the column 'haed' is unknown. Did you mean head"),
        (
            "time,flow [m3]\n",
            r"the unit 'm3' of flow is unknown. Use m3/s, l/s, m3/min, m3/h, l/min, ft3/min; none means m3/s",
        ),
    ],
)
def test_a_bad_map_is_refused_in_its_own_words(pump: Library, tmp_path: Path, rows: str, sentence: str) -> None:
    path = tmp_path / "map.csv"
    path.write_text(rows)
    with pytest.raises(SimulationError, match=sentence):
        Kernel(pump, map_file=str(path))


def test_a_pump_without_a_map_asks_for_one(pump: Library) -> None:
    with pytest.raises(SimulationError, match=r"map_file must be the path of a file with a map; got no path"):
        Kernel(pump).initialise()


def test_a_column_that_c_does_not_read_is_refused() -> None:
    for odd in (Column("kind", words=("a",)), Column("gap", filled=False), Column("count", whole=True)):
        with pytest.raises(ValueError, match=f"must be numbers, one in each row; got {odd.name}"):
            replace(MAP, columns=(*MAP.columns, odd))


def test_a_model_whose_name_is_too_long_for_files_is_refused() -> None:
    with pytest.raises(ValueError, match=r"name of a model must have at most 200 bytes, .* got 201 in 'aaaa"):
        model_of(System("a" * 201, "A long name"), 1e-6)
