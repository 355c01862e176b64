# Two commands for a newcomer: make demo, make test. Both make their own virtual environment in .venv.
PYTHON ?= python3
VENV := .venv
RUN := $(VENV)/bin/python

# Matrices here are small: two processes with two threads of BLAS each take three times as long as with one each.
export OPENBLAS_NUM_THREADS ?= 1

# A C compiler comes from PyPI where the machine has none: what this finds is a comma and the extra, or nothing.
COMPILER := $(shell for name in $$CC cc gcc clang; do command -v $$name > /dev/null && exit; done; echo ,compiler)

# pip shows bars on a terminal; it writes none into a file.
PIP = [ -t 1 ] && quiet= || quiet="--quiet --progress-bar off"; $(RUN) -m pip install --disable-pip-version-check $$quiet

.PHONY: demo foretold live test test-all test-long check charts screenshots pages docs release clean

demo: foretold $(VENV)/demo-installed
	$(RUN) build_fmu.py ssp
	$(RUN) build_fmu.py braked-vehicle --kind native
	$(RUN) -m bogie_braking run demo

foretold:
	@[ -e $(VENV)/demo-installed ] || echo "The first make demo installs Python packages into $(VENV), compiles four FMUs" \
		"and stops three vehicles: 3 minutes of processor time and a download, 0.95 GB on disk. Repeated: 20 s."

# The page that brakes a bogie in a browser; zig compiles its kernels, no other compiler here does.
live: $(VENV)/compiler-installed
	$(RUN) -m bogie_braking live

# Every module's contract, every FMU built once and stepped, the examples of the pages.
test: $(VENV)/test-installed check
	$(RUN) -m pytest -n 2 --dist worksteal

# The rest: evidence, long studies, second contact models, random inputs.
test-all: $(VENV)/test-installed
	$(RUN) -m pytest -n 2 --dist worksteal -m "study and not long"

# Before a release, what the other tests show in part: binaries for all platforms, the site, chapter 3 at two steps.
test-long: $(VENV)/test-installed
	$(RUN) -m pytest -n 2 -m long

# Rooms with C of ours; hosts/*.c are templates.
C_ROOMS := fmu_src rbd_model brake_controller products evidence tests
check: $(VENV)/test-installed
	$(RUN) -m ruff check .
	$(RUN) -m ruff format --check .
	$(RUN) -m mypy
	PYTHONPATH=. $(VENV)/bin/lint-imports --no-cache
	$(VENV)/bin/clang-format --dry-run -Werror $$(find $(C_ROOMS) -name '*.[ch]' ! -path '*/hosts/*.c')

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/demo-installed: pyproject.toml | $(VENV)/bin/python
	$(PIP) -e ".[scenarios$(COMPILER)]"
	touch $@

$(VENV)/compiler-installed: pyproject.toml | $(VENV)/bin/python
	$(PIP) -e ".[scenarios,compiler]"
	touch $@ $(VENV)/demo-installed

$(VENV)/test-installed: pyproject.toml | $(VENV)/bin/python
	$(PIP) -e ".[test,masters,charts,sweep,docs]"
	touch $@ $(VENV)/demo-installed $(VENV)/compiler-installed

# Draws the pictures of docs/choosing.md and docs/controller.md again, some 20 minutes; `make pages` then updates numbers.
CHARTS := speed-accuracy throughput stability-atlas coupling-step levels levels-in-curves contact-model thesis-step \
	train-brake-evidence
charts: $(VENV)/charts-installed
	for name in $(CHARTS); do $(RUN) -m bogie_braking run $$name || [ $$? = 1 ] || exit 1; done  # 1: a row does not hold
	$(RUN) docs/generate/numbers_of_pages.py --collect
	$(RUN) -m evidence.measuring.slide_bound --measure

$(VENV)/charts-installed: pyproject.toml | $(VENV)/bin/python
	$(PIP) -e ".[charts,scenarios$(COMPILER)]"
	touch $@ $(VENV)/demo-installed

# The screenshots of the documentation, by the tests of the pages in a browser.
screenshots: $(VENV)/test-installed
	BOGIE_BRAKING_PICTURES=docs/pictures $(RUN) -m pytest -p no:xdist tests/bogie_braking/test_live.py tests/bogie_braking/test_train_page.py

# Updates the measured numbers on the pages, and writes pages with generated tables into build/pages/.
pages: $(VENV)/demo-installed
	$(RUN) docs/generate/numbers_of_pages.py
	$(RUN) docs/generate/pages.py

# Wheels with compiled FMUs inside, sdist, archive of FMUs, live page, checksums, into dist/: 15 min the first time.
release: $(VENV)/test-installed
	rm -rf dist
	$(RUN) release.py

# The site, into build/site, in some two minutes: its notebooks run, its live pages are compiled.
docs: $(VENV)/docs-installed
	$(RUN) docs/generate/website.py

$(VENV)/docs-installed: pyproject.toml | $(VENV)/bin/python
	$(PIP) -e ".[docs,scenarios,compiler]"
	touch $@ $(VENV)/demo-installed

clean:
	rm -rf $(VENV) build dist results
