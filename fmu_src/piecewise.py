"""Piecewise polynomials in equations: the search for the piece at a place is a part, the rest are equations."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from fmu_src.c_literals import c_array, c_number
from fmu_src.chain import Chain, Part
from fmu_src.records import Pieces
from fmu_src.symbols import ca

#: Pieces are treated as equally wide if they differ by less than this share: exchanging neighbours then changes a value
#: by round-off alone.
EQUAL = 1e-9


def interpolation(breakpoints: ArrayLike, values: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Return the straight lines through points, for `look_up`.

    Takes breakpoints, values (n,); returns (n,).
    """
    x, y = np.asarray(breakpoints, float), np.asarray(values, float)
    return x, np.column_stack([y[:-1], np.diff(y) / np.diff(x)])


def polynomials(piece: ca.SX, argument: ca.SX, order: int) -> list[ca.SX]:
    """Return value and derivatives of a piece by Horner's rule."""
    distance = argument - piece[0]
    terms = [piece[1 + power] for power in range(piece.numel() - 1)]
    values = []
    for _ in range(order + 1):
        value = terms[-1] if terms else ca.SX(0)
        for term in terms[-2::-1]:
            value = value * distance + term
        values.append(value)
        terms = [power * term for power, term in enumerate(terms)][1:]
    return values


def look_up(chain: Chain, name: str, breakpoints: np.ndarray, coefficients: np.ndarray, argument: ca.SX) -> ca.SX:
    """Return the piece of a piecewise polynomial at a place, for `polynomials`.

    Outside the breakpoints it keeps its end value.
    """
    breakpoints, coefficients = np.asarray(breakpoints, float), np.asarray(coefficients, float)
    if np.any(np.diff(breakpoints) <= 0.0) or coefficients.shape[0] != breakpoints.size - 1:
        raise ValueError(f"Table {name} must have increasing breakpoints and one row of coefficients for each piece.")
    part = _piece_at(breakpoints.tobytes(), coefficients.tobytes(), coefficients.shape[1])
    return chain.call(part, ca.SX(argument), ca.SX(0, 1))


@lru_cache(maxsize=256)
def _piece_at(breakpoints: bytes, coefficients: bytes, terms: int) -> Part:
    """Return the look-up in these tables, one part for all that have the same."""
    rows = rows_of(np.frombuffer(breakpoints), np.frombuffer(coefficients).reshape(-1, terms))
    name = f"piece_{hashlib.sha256(breakpoints + coefficients).hexdigest()[:12]}"
    at = ca.SX.sym("at")
    return Part(name, at, ca.SX.sym("none", 0), _chosen(rows, at), source=_in_c(name, rows), flat=True)


def look_up_in(chain: Chain, record: ca.SX, table: int, terms: int, argument: ca.SX) -> ca.SX:
    """Return the piece (origin, c0, ..., c_degree) of a table of a record (records.py) at `argument`."""
    return chain.call(_piece_in(table, terms), ca.SX(argument), ca.SX(record))


def numbers_in(chain: Chain, record: ca.SX, count: int) -> list[ca.SX]:
    """Return the first `count` numbers of a record (records.py)."""
    return ca.vertsplit(chain.call(_numbers_in(count), ca.SX(0, 1), ca.SX(record)))


@lru_cache
def _piece_in(table: int, terms: int) -> Part:
    given = ca.SX.sym("at"), ca.SX.sym("record")
    c = f"real_look_up_in({{constants}}, {table}, {{arguments}}, {{left}})"
    results = ca.repmat(math.nan * sum(given), 1 + terms, 1)
    return Part(f"piece_{table}_{terms}_in_record", *given, results, source=c, flat=True, inline=True)


@lru_cache
def _numbers_in(count: int) -> Part:
    record = ca.SX.sym("record")
    c = f"real_numbers_in({{constants}}, {count}, {{left}})"
    results = ca.repmat(math.nan * record, count, 1)
    return Part(f"numbers_{count}_in_record", ca.SX(0, 1), record, results, source=c, flat=True, inline=True)


def rows_of(breakpoints: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Return a row (origin, c0, ..., c_degree) for each piece, between those of the constant end values."""
    last = np.polynomial.polynomial.polyval(breakpoints[-1] - breakpoints[-2], coefficients[-1])
    held = np.zeros((2, coefficients.shape[1]))
    held[:, 0] = coefficients[0, 0], last
    origins = [breakpoints[0], *breakpoints]
    return np.column_stack([origins, np.vstack([held[:1], coefficients, held[1:]])])


def _chosen(rows: np.ndarray, at: ca.SX) -> ca.SX:
    """Return the row of the piece at `at`, by bisection."""
    if len(rows) == 1:
        return ca.SX(rows[0])
    half = len(rows) // 2
    return ca.if_else(at >= rows[half, 0], _chosen(rows[half:], at), _chosen(rows[:half], at))


def _in_c(name: str, rows: np.ndarray) -> str:
    """Return C of the table, a `piecewise` (piecewise.h)."""
    array = c_array("double", f"{name}_row", map(c_number, rows.ravel()))
    return f"{array}\nRUNTIME_LOCAL const piecewise {name} = {_members(rows, f'{name}_row')};\n"


def _members(rows: np.ndarray, array: str) -> str:
    """Return the members of a `piecewise` in C; array: name of its rows."""
    pieces, terms, origins = len(rows) - 2, rows.shape[1], rows[1:, 0]
    equal = np.allclose(np.diff(origins), (origins[-1] - origins[0]) / pieces, rtol=EQUAL, atol=0.0)
    per_unit = c_number(pieces / (origins[-1] - origins[0]))
    return f"{{{pieces}, {terms}, {int(equal)}, {per_unit}, {array}}}"


def piecewise_in_c(table: Pieces, array_of: Callable[[Iterable[str]], str]) -> str:
    """Return the members of a `piecewise` in C; array_of: writes an array of numbers and returns its name."""
    rows = rows_of(*map(np.array, table))
    return _members(rows, array_of(map(c_number, rows.ravel())))
