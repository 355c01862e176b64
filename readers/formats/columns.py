"""Tables of y and z with or without a header of `key=value` rows; MiniProf files of one profile are such tables."""

from __future__ import annotations

import re

from readers.contours import CELLS, Contour, Rows, other_kind, refusal
from readers.formats.miniprof import MARKS, Header, contour_of, is_taken_out
from readers.tables import BLANKS, cells_of, separator_of_numbers
from readers.text import REMARKS, lines_of, quoted

#: A key of a header, and the sign before its value.
KEY, ASSIGNS = re.compile(r"[A-Za-z][\w .()/-]*"), re.compile("[=:]")
#: Words of a free text that indicate another unit or a change.
TELLING = re.compile(r"\b(inch(es)?|met(er|re)s?|microns?|feet|mirrored|scaled|rotated|shifted)\b", re.I)
TRAILING = re.compile("[#%!]|//")
HEAD = re.compile(r"[A-Za-z]\w*\s*([\[(][^\[\]()]*[\])])?")
#: A quote of which a header's row is taken out, with or without one at its end.
QUOTE = '"'


def read(rows: Rows, text: str, source: str, kind: str) -> Contour:
    """Return the contour of a table of y, z, with keys or a head before it."""
    header = Header(source, of_miniprof=bool(MARKS.search("\n".join(lines_of(text)))))
    taken_out = 0
    if header.of_miniprof:
        taken_out = sum(is_taken_out(row) for _, row in rows)
        rows = [(at, row) for at, row in rows if not is_taken_out(row) and not _quoted_key(row)]
    first = next((place for place, (_, row) in enumerate(rows) if separator_of_numbers([_bare(row)])), len(rows))
    first = max(first, _behind_header(rows, text)) if header.of_miniprof else first
    before, body = rows[:first], [(at, bare) for at, row in rows[first:] if CELLS.search(bare := _bare(row))]
    keys = {at: found for at, row in before if (found := key_and_value(row))}
    for at, row in _remarks(text):
        if found := key_and_value(row):
            header.take(at, *found)
    for at, found in keys.items():
        header.take(at, *found)
    _take_free_texts(header, before, keys, bool(body))
    body = [(at, _without_words(row, len(header.columns))) for at, row in body] if header.columns else body
    if header.count and header.count[0] == len(body) + taken_out:
        header.count = len(body), header.count[1]
    if before and body and before[-1][0] not in keys and _is_head(before[-1][1], body[0][1]):
        body = [before[-1], *body]
    if kind and header.kind not in ("", kind):
        raise other_kind(source, kind, header.kind, "its header has the type of this instrument")
    return contour_of(header, body, kind or header.kind)


def _behind_header(rows: Rows, text: str) -> int:
    """Return the place of the first row behind the empty row that ends the header of old MiniProf files, or 0.

    The header may hold numbers, as the dimensions of the flange.
    """
    empty = next((at for at, row in enumerate(lines_of(text), 1) if not row.strip()), 0)
    place = next((place for place, (at, _) in enumerate(rows) if at > empty), 0)
    return place if any(separator_of_numbers([row]) is None for _, row in rows[:place]) else 0


def _take_free_texts(header: Header, before: Rows, keys: dict[int, tuple[str, str]], body: bool) -> None:
    """Take a number of points that stands alone; refuse a text that may change the points."""
    for place, (at, row) in enumerate(before):
        if at in keys:
            continue
        if row.strip().isdecimal() and place == len(before) - 1 and body:
            header.count = int(row.strip()[:9]), at
        elif TELLING.search(row):
            raise refusal(
                header.source,
                at,
                f"the text {quoted(row)} may change the points. Give y and z in mm, and remove it.",
            )


def _remarks(text: str) -> Rows:
    """Return the remarks of a text with their rows, without the marks."""
    return [
        (at, row.lstrip().lstrip("#%!/").strip())
        for at, row in enumerate(lines_of(text), 1)
        if row.lstrip().startswith(REMARKS)
    ]


def _quoted_key(row: str) -> bool:
    """Return whether a key of a header is taken out by quotes."""
    bare = row.strip()
    return bare.startswith(QUOTE) and key_and_value(bare.strip(QUOTE)) is not None


def _bare(row: str) -> str:
    """Return a row without the remark behind its numbers."""
    found = TRAILING.search(row)
    return row[: found.start()].rstrip() if found else row


def _without_words(row: str, count: int) -> str:
    """Return a row without a remark of words behind its `count` numbers."""
    cells = row.split()
    words = any(re.search("[A-Za-z]{2}", cell) for cell in cells[count:])
    return " ".join(cells[:count]) if words and '"' not in "".join(cells[:count]) else row


def key_and_value(row: str) -> tuple[str, str] | None:
    """Return key and value of a row of a header, or None; dots and blanks may lead from one to the other."""
    key, *value = ASSIGNS.split(row, maxsplit=1)
    key = key.lstrip().rstrip("." + "".join(filter(str.isspace, set(key))))
    return (key, value[0].strip()) if value and KEY.fullmatch(key) else None


def _is_head(row: str, first: str) -> bool:
    """Return whether a row names the columns of the row of numbers behind it."""
    separator = separator_of_numbers([first]) or BLANKS
    cells = [cell for cell in cells_of(row.replace('"', ""), separator, "") if cell]
    count = len([cell for cell in cells_of(first.replace('"', ""), separator, "") if cell])
    return len(cells) == count and all(HEAD.fullmatch(cell) for cell in cells)
