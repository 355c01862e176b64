"""A recording as HTML for notebooks: its size, first rows with units, and messages, in the colours of the notebook."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from fmu_src.cosimulation.quantities import Table, quantities_with_units

#: Rows, columns, further names and messages that are shown.
MOST_ROWS, MOST_COLUMNS, MOST_NAMES, MOST_MESSAGES = 5, 8, 60, 10
#: Styles; colours are those of the notebook, light or dark.
ALL, TABLE = "overflow-x:auto;font-size:90%", "color:inherit;font-size:inherit"
CELL = "text-align:right;padding:0.1em 0.8em"


def html_of(recording: Table) -> str:
    """Return the HTML of a recording; names, units and messages are escaped."""
    names, count = recording.names[:MOST_COLUMNS], recording.rows
    parts = [f"<div>Recording of {_counted(count, 'row')} and {_counted(len(recording.names), 'column')}</div>"]
    rows = [_row(names, "th"), _row((f"[{recording.units[name]}]" for name in names), "td")]
    rows += [_row((f"{recording[name][row]:.6g}" for name in names), "td") for row in range(min(count, MOST_ROWS))]
    rows += [_row("…" for _ in names)] if count > MOST_ROWS else []
    parts.append(f"<table style={TABLE!r}>{''.join(rows)}</table>")
    if texts := quantities_with_units({name: recording.units[name] for name in recording.names[MOST_COLUMNS:]}):
        more = ["…"] if len(texts) > MOST_NAMES else []
        parts.append(f"<div>Further columns: {escape(', '.join(texts[:MOST_NAMES] + more))}</div>")
    lines = recording.messages[:MOST_MESSAGES]
    left = len(recording.messages) - len(lines)
    lines += [f"and {left} more messages"] if left else []
    parts += [f"<ul>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul>"] if lines else []
    return f'<div style="{ALL}">{"".join(parts)}</div>'


def _row(cells: Iterable[str], tag: str = "td") -> str:
    return f"<tr>{''.join(f'<{tag} style={CELL!r}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
