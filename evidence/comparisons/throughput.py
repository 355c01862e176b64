"""Error against throughput: stops a second of one instance, of batches, and of SciPy and SUNDIALS on all processors."""

import os
from dataclasses import asdict

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import label_edges, plt, titled
from bogie_braking.reporting.report import Report, Row, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.peers import ensembles, sundials
from evidence.peers.ensembles import ALONE, BATCH, FIXED, IN_PROCESSES, IN_THREADS, PEERS, EnsembleStudy
from evidence.peers.work_precision import table_of
from rbd_model.levels.models import DEFAULT_TOLERANCE
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

#: Relative error of the distance that an engineer needs, and largest error of the default.
WANTED, EXPECTED = 1e-4, 1e-5
#: Colour, marker and dashes of each method. Ours are filled, third-party ones open; fixed steps are dotted.
STYLE = {
    BATCH: ("#0072b2", "o", "-"),
    f"{BATCH}, {FIXED}": ("#0072b2", "s", ":"),
    ALONE: ("#333333", "^", "-"),
    f"{ALONE}, {FIXED}": ("#333333", "v", ":"),
    IN_THREADS: ("#d55e00", "h", "--"),
    **dict(zip(IN_PROCESSES, (("#999999", "D", "--"), ("#999999", "P", "--"), ("#999999", "X", "--")), strict=True)),
}
#: Error at which failures are drawn, and the least error shown.
FAILED, LEAST = 1.0, 1e-11


def level_rows(found: EnsembleStudy, level: str) -> list[Row]:
    """Return the rows with limits, errors and bit identity; and stops a second at the default, and at the needed error
    against third-party methods.
    """
    rows = []
    source = f"measured now, {os.cpu_count()} processors"
    [batch] = [one for one in found.of(level, BATCH) if one.setting == DEFAULT_TOLERANCE]
    [alone] = [one for one in found.of(level, ALONE) if one.setting == DEFAULT_TOLERANCE]
    off = f"{level}: error of a batch at the default"
    apart = f"{level}: largest difference of a batch and single runs"
    words = f"distance, against references that differ by {found.uncertainty[level]:.1e}"
    rows += [
        measured(off, "1", batch.error, words, at_most(EXPECTED)),
        measured(apart, "m", found.apart[level], "the same bits at every setting", at_most(0.0)),
        measured(f"{level}: stops a second, batch at the default", "1/s", batch.stops, source),
        measured(f"{level}: stops a second, one instance at the default", "1/s", alone.stops, source),
    ]
    best, peer = found.fastest(level, [BATCH, f"{BATCH}, {FIXED}"], WANTED), found.fastest(level, PEERS, WANTED)
    if best:
        words = f"{best.way} at {best.setting:g}"
        what = f"{level}: stops a second, best batch to {WANTED:g}"
        rows.append(measured(what, "1/s", best.stops, source, None, words))
    if peer:
        words = f"{peer.way} at {peer.setting:g}"
        what = f"{level}: stops a second, best of others to {WANTED:g}"
        rows.append(measured(what, "1/s", peer.stops, source, None, words))
        what = f"{level}: batch at the default over the best of others to {WANTED:g}"
        rows.append(measured(what, "1", batch.stops / peer.stops, source))
    return rows


def message(found: EnsembleStudy) -> str:
    """Return how many times as many stops a batch makes at its default as others do to WANTED, or as one instance."""
    ways, who = (PEERS, "others'") if found.fastest("planar", PEERS, WANTED) else ((ALONE,), "one instance's")
    times = []
    for level in ensembles.LEVELS:
        [batch] = [one for one in found.of(level, BATCH) if one.setting == DEFAULT_TOLERANCE]
        if other := found.fastest(level, ways, WANTED):
            times.append(f"{batch.stops / other.stops:.0f} ({level})")
    return f"A default batch makes {' and '.join(times)} times {who} stops"


def run(options: Options, quick: bool = False) -> Report:
    extent = ensembles.QUICK if quick else ensembles.StudyExtent()
    found = ensembles.study(extent)
    rows = [row for level in ensembles.LEVELS for row in level_rows(found, level)]
    remarks = [
        f"{rate.level}, {rate.way} at {rate.setting:g}: {rate.reason.rstrip('.')}."
        for rate in found.rates
        if rate.reason
    ]
    if not sundials.is_installed():
        remarks.insert(0, "CVODE is missing: install the extra 'charts' with Python 3.11 or later.")
    parameters = tables_5_1_and_5_2().values() | {
        "torques": extent.torques.tolist(),
        "processors": os.cpu_count(),
        "points": [asdict(one) for one in found.rates],
        "uncertainty": found.uncertainty,
    }
    series = table_of(found.rates, {"setting": "1", "error": "1", "stops": "1/s"})
    return Report(rows, series, lambda: draw(found), parameters, 0.0, remarks)


# ---- the figure ------------------------------------------------------------------------------------------------------


def draw(found: EnsembleStudy) -> Figure:
    figure, grid = plt.subplots(1, len(ensembles.LEVELS), figsize=(11.0, 5.6), sharey=True, squeeze=False)
    handles: dict[str, Artist] = {}
    for axis, level in zip(grid.ravel(), ensembles.LEVELS, strict=True):
        draw_level(axis, found, level, handles)
    label_edges(grid, "stops a second [1/s]", "relative error of the distance (top: failed)")
    figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=4, fontsize=9)
    return titled(figure, message(found))


def draw_level(axis: Axes, found: EnsembleStudy, level: str, handles: dict[str, Artist]) -> None:
    axis.set_title(f"bogie, {level}; lower right is better")
    axis.axhspan(LEAST, max(found.uncertainty[level], LEAST), color="#dddddd", zorder=0)
    axis.axhline(WANTED, color="#999999", linewidth=0.8)
    for way, (colour, marker, dashes) in STYLE.items():
        points = found.of(level, way)
        good = [point for point in points if point.error is not None]
        mine = way.startswith((ALONE, BATCH))
        if not points:
            continue
        (line,) = axis.plot(
            [one.stops for one in good],
            [min(max(one.error or LEAST, LEAST), FAILED / 2) for one in good],
            linestyle=dashes,
            marker=marker,
            color=colour,
            markerfacecolor=colour if mine else "none",
            linewidth=2.0 if mine else 1.0,
            markersize=6,
            zorder=3 if mine else 2,
        )
        bad = [one.stops for one in points if one.error is None and one.stops > 0.0]
        axis.plot(bad, [FAILED] * len(bad), marker, color=colour, markerfacecolor="none", markersize=6)
        handles.setdefault(way, line)
    for way in (ALONE, BATCH):
        for one in found.of(level, way):
            if one.setting == DEFAULT_TOLERANCE:
                axis.plot(
                    one.stops, max(one.error or LEAST, LEAST), "o", color="#333333", markersize=13, fillstyle="none"
                )
    axis.set(xscale="log", yscale="log", ylim=(LEAST, 2 * FAILED))


SCENARIO = Scenario(
    "throughput", "Error against stops a second: one instance, batches, and ensembles of SciPy and SUNDIALS", run
)
