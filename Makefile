# `make demo` and `make test` do all their own set-up in .venv.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.installed
export PYTHONPATH :=

.PHONY: setup demo test lint types imports unit nojit plc pages clean
setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "expected Python 3.11 or newer, got " + sys.version.split()[0] + "; set PYTHON=python3.x")'
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	touch $@

demo: $(STAMP)
	$(BIN)/python examples/demo.py

test: lint types imports plc unit nojit

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(STAMP)
	$(BIN)/mypy

imports: $(STAMP)
	$(BIN)/lint-imports

# One worker a core; the kernels are compiled once and cached before the workers start.
unit: $(STAMP)
	$(BIN)/python -m lostmotion.cli.warm_up
	$(BIN)/pytest -n 2 --dist worksteal

nojit: $(STAMP)
	NUMBA_DISABLE_JIT=1 $(BIN)/pytest -n 2 --dist worksteal -m "not statistics and not processes"

# A PLC for the tests of exported blocks: ST machine, parsers, schema, in an environment of its own.
plc: .venv-plc/.installed

.venv-plc/.installed: tests/plc/constraints.txt tests/plc/build.py tests/plc/machine.cpp
	$(PYTHON) -m venv .venv-plc
	.venv-plc/bin/pip install --quiet --disable-pip-version-check -c tests/plc/constraints.txt \
	    blark lxml pybind11 scikit-build-core setuptools tree-sitter tree-sitter-iec61131-3-st wheel
	.venv-plc/bin/python tests/plc/build.py
	touch $@

# Makes the pages of docs/ again that are older than their source, oldest first; stop it and start it at any time.
pages: $(STAMP) plc
	$(BIN)/python -m benchmarks.pages $(PAGES)

clean:
	rm -rf .cache .venv .venv-plc .venv-rivals .venv-tep .mypy_cache .ruff_cache .pytest_cache .import_linter_cache demo-output
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
