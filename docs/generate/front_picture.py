"""The figure on the first page of the site: one published number over the step of the explicit method."""

import io
import json

from matplotlib import pyplot as plt
from pages import DOCS

from bogie_braking.reporting.plots import BOGIE, LEADING, THESIS, TRAILING

#: Rows of the scenario `thesis-step` that are drawn.
NUMBER = "lateral wave, 15 m/s: spectral peak of the hunting"


def svg() -> str:
    """Return the number at each step, with the values of the thesis and VAMPIRE from docs/data/."""
    rows = json.loads((DOCS / "data" / "thesis-step.json").read_text(encoding="utf-8"))["rows"]
    found = {row["quantity"].removeprefix(f"{NUMBER}, "): row for row in rows if row["quantity"].startswith(NUMBER)}
    accurate = found.pop("accurate")
    steps = {float(words.split()[1]): row["simulated"] for words, row in found.items()}
    figure, axis = plt.subplots(figsize=(7.5, 3.6), layout="constrained")
    axis.axhline(accurate["simulated"], color=LEADING, linewidth=3, label="accurate solution")
    axis.axhline(accurate["vampire"], color=BOGIE, linestyle=":", label="VAMPIRE, as printed")
    axis.axhline(accurate["thesis"], color=THESIS, linestyle="--", label="the thesis, as printed")
    axis.plot(list(steps), list(steps.values()), "o-", color=TRAILING, label="Runge-Kutta with a fixed step")
    axis.set(xlabel="step [ms]", ylabel="hunting frequency [Hz]")
    axis.legend(loc="lower left")
    with io.StringIO() as file, plt.rc_context({"svg.hashsalt": NUMBER}):
        figure.savefig(file, format="svg", metadata={"Date": None})
        plt.close(figure)
        return file.getvalue()
