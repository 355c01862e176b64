"""The pages inside an FMU: its description, its variables, and the tested rules of the standards."""

from __future__ import annotations

import html
from collections.abc import Collection, Mapping, Sequence

from fmu_src.compliance import CHECKS
from fmu_src.model_description import cells
from fmu_src.model_exchange import exchanged_states
from fmu_src.references import PAGE
from fmu_src.system import Model

#: Text of the page about steps that end the run and about refused values, by kind of FMU.
ENDS = {
    "native": (
        "FMI 2.0 co-simulation. A step that reaches the end of the run (derailment, wheel lift) returns fmi2Discard "
        "with a sentence; fmi2LastSuccessfulTime is the instant, and the values are those of it. Refused values return "
        "fmi2Error and keep the old one."
    ),
    "fmi3": (
        "FMI 3.0 co-simulation. A step that reaches the end of the run (derailment, wheel lift) logs a sentence and "
        "asks to terminate; it returns early with OK where that is allowed. Where it is not, the step returns "
        "fmi3Discard and all is as before it; shorter steps lead up to the end, whose time the sentence tells. Refused "
        "values return fmi3Error and keep the old one. Nothing is logged when logging is off."
    ),
    "python": (
        "FMI 2.0 co-simulation through pythonfmu, which needs Python on the host. A step that reaches the end of the "
        "run (derailment, wheel lift) returns fmi2Discard with a sentence. A refused value keeps the old one, is told "
        "with a sentence, and discards every step until that variable has a good value."
    ),
}
#: The same for FMUs around an object in C, whose variables are arrays.
ENDS_OF_ARRAYS = {
    2: (
        "FMI 2.0 co-simulation. An element of an array has the name of the array and its number, from 1: name[1]. "
        "Refused values return fmi2Error and keep the old one. A step that cannot be made returns fmi2Discard with a "
        "sentence."
    ),
    3: (
        "FMI 3.0 co-simulation. An array is one variable. Refused values return fmi3Error and keep the old one. A step "
        "that cannot be made returns fmi3Discard with a sentence."
    ),
}
STYLE = (
    "<style>body{font-family:sans-serif;max-width:80em;margin:2em auto}td,th{text-align:left;padding:0 .8em .2em 0}"
    "</style>\n"
)


BESIDE = " Beside this page lie programs that run the FMU, host.c and others."
#: Place of the page's figure in the archive.
PICTURE = "documentation/picture.png"


def pages(model: Model, kind: str, beside: Collection[str] = ()) -> dict[str, bytes]:
    """Return the pages of one `kind` of FMU (a key of ENDS), by name; beside: other files in the archive."""
    found = {"index": documentation(model, kind, beside), "compliance": compliance(model, kind)}
    return {f"documentation/{name}.html": text.encode() for name, text in found.items()}


def documentation(model: Model, kind: str, beside: Collection[str] = ()) -> str:
    """Return a page about the FMU: its description, how a run ends, and its variables."""
    picture = f'<p><img src="picture.png" alt="A run of {model.name}" style="max-width:100%"></p>\n'
    shown = picture if PICTURE in beside else ""
    sets = ' <a href="fmi-ls-ref.html">Parameter sets and experiments.</a>' if PAGE in beside else ""
    host = "" if kind == "python" else BESIDE
    solved = "" if kind == "python" else f" {integrated(model)}"
    text = f'{ENDS[kind]}{solved} <a href="compliance.html">What of the standard is tested.</a>{host}{sets}'
    return page(model.name, model.description, text, [cells(variable) for variable in model.variables], shown)


def page(name: str, description: str, text: str, told: Sequence[Mapping[str, str]], shown: str = "") -> str:
    """Return a page with the variables of an FMU as a table; text, shown: HTML below its description."""
    heads = "".join(f'<th scope="col">{head}</th>' for head in told[0])
    rows = [row(list(one.values())) for one in told]
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{name}</title>\n{STYLE}'
        f"<h1>{name}</h1>\n<p>{html.escape(description)}.</p>\n{shown}<p>{text}</p>\n"
        f"<table><tr>{heads}</tr>\n" + "\n".join(rows) + "\n</table></html>\n"
    )


def row(texts: Sequence[str]) -> str:
    """Return a variable in the table: its name heads the row."""
    name, *others = map(html.escape, texts)
    return f'<tr><th scope="row"><code>{name}</code></th>{"".join(f"<td>{text}</td>" for text in others)}</tr>'


def integrated(model: Model) -> str:
    """Return the text of the page about model exchange."""
    states = exchanged_states(model)
    if not states:
        return "There is no model exchange, for these equations have algebraic states."
    fixed = f" and {' and '.join(model.selectors)} stay at their start values" if model.selectors else ""
    return f"In model exchange the host integrates {len(states)} states{fixed}."


def compliance(model: Model, kind: str) -> str:
    """Return a page about the tested rules of the standard, each with its test."""
    rows = [
        f"<tr><td>{check.of[kind]}</td><td>{html.escape(check.what)}</td><td><code>{check.test}</code></td></tr>"
        for check in CHECKS
        if kind in check.of
    ]
    interfaces = "co-simulation" if kind == "python" else "co-simulation and model exchange"
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{model.name}: compliance</title>\n{STYLE}'
        f"<h1>{model.name}: what of the standard is tested</h1>\n"
        f"<p>FMI {'3.0' if kind == 'fmi3' else '2.0'} for {interfaces}. The tests are in "
        "<code>tests/fmu_src/fmi</code> of the project that made this FMU.</p>\n"
        "<table><tr><th>of</th><th>what is kept</th><th>test</th></tr>\n" + "\n".join(rows) + "\n</table>\n"
        f"{_answered_by_pythonfmu() if kind == 'python' else ''}</html>\n"
    )


def _answered_by_pythonfmu() -> str:
    others = [html.escape(check.what) for check in CHECKS if "native" in check.of and "python" not in check.of]
    return (
        "<p>Between the host and this FMU stands pythonfmu, which answers by itself or has no such call. What follows "
        "is tested of the native FMU and does not apply here:</p>\n<ul>"
        + "\n".join(f"<li>{what}</li>" for what in others)
        + "</ul>\n"
    )
