# `make demo` and `make test` do all their own set-up in .venv.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.installed
OPCUA := tests/opcua/node_modules/.installed
COMPILED := .venv/.compiled
export PYTHONPATH :=

.PHONY: setup demo test test-all ready lint types imports short all nojit plc web opcua pages sbom clean
setup: $(STAMP)

$(STAMP): pyproject.toml locked.txt
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "expected Python 3.11 or newer, got " + sys.version.split()[0] + "; set PYTHON=python3.x")'
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r locked.txt
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	$(BIN)/pip check --quiet --disable-pip-version-check
	-command -v npm >/dev/null && $(MAKE) --no-print-directory web
	touch $@

demo: $(STAMP)
	$(BIN)/lostmotion demo demo-output --force

# Before a pull request: at most ten minutes on two cores once all is set up. What needs one core each goes by twos.
test: $(STAMP)
	$(MAKE) --no-print-directory -j 2 ready
	$(MAKE) --no-print-directory short

# Everything, in random order and with coverage, and what tests kernels once more as Python.
test-all: $(STAMP)
	$(MAKE) --no-print-directory -j 2 $(COMPILED) plc opcua
	$(MAKE) --no-print-directory all nojit

ready: $(COMPILED) lint types imports

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

# For each system that users have.
types: $(STAMP)
	$(BIN)/mypy --platform linux
	$(BIN)/mypy --platform win32
	$(BIN)/mypy --platform darwin

imports: $(STAMP)
	$(BIN)/lint-imports

# The kernels, compiled once and cached before workers start.
$(COMPILED): $(STAMP) $(shell find src/lostmotion/kernels -name '*.py')
	$(BIN)/lostmotion warm-up
	touch $@

# Three workers for two cores: a part of the time is waiting for plants, servers and clocks.
short: $(COMPILED)
	$(BIN)/pytest -n 3 --dist worksteal -m "not long"

# The order is random, its seed is printed (again with SEED=..). Coverage of lines and branches was 96.3 %; a point is left
# for machines on which a browser or a compiler is missing. `.venv/bin/coverage report --skip-covered` says what is left out. Not `--dist loadgroup`: it waits for
# ever for a worker that died.
SEED ?= default
COVERED := 95
all: $(COMPILED)
	$(BIN)/pytest -n 3 --dist worksteal -p randomly --randomly-seed=$(SEED) --randomly-dont-reset-seed \
	    --cov --cov-report= --cov-fail-under=$(COVERED)

# What is compiled, as Python: indices out of range are errors there.
nojit: $(STAMP)
	NUMBA_DISABLE_JIT=1 $(BIN)/pytest -n 2 --dist worksteal -m "kernels and not long and not statistics"

# A PLC for the tests of exported blocks: ST machine, parsers, schema, in an environment of its own.
plc: .venv-plc/.installed

.venv-plc/.installed: tests/plc/constraints.txt tests/plc/build.py tests/plc/machine.cpp
	$(PYTHON) -m venv .venv-plc
	.venv-plc/bin/pip install --quiet --disable-pip-version-check -c tests/plc/constraints.txt \
	    blark lxml pybind11 scikit-build-core setuptools tree-sitter tree-sitter-iec61131-3-st wheel
	.venv-plc/bin/python tests/plc/build.py
	touch $@

# What the page draws with and is checked by, from npm: uPlot into the package (git-ignored), axe-core for the tests.
# Without them trends are drawn as SVG, and the check of accessibility is skipped, saying so.
VENDOR := src/lostmotion/web/static/vendor
AXE_SHA512 := 1477dafa598d8d065f273d6af302aa203c02e83131707b7fa648cd41bd3d6b734f8c22a0dab86ee6a6f64b8afbe804b214d36db85a2826965edfb3a0b9d546b5

web: $(VENDOR)/uPlot.iife.min.js .cache/web/axe.min.js

$(VENDOR)/uPlot.iife.min.js:
	$(PYTHON) fetch_uplot.py

.cache/web/axe.min.js:
	mkdir -p .cache/web
	cd .cache/web && npm pack --silent axe-core@4.14.1 && echo "$(AXE_SHA512)  axe-core-4.14.1.tgz" | sha512sum --check --quiet
	tar -xzmf .cache/web/axe-core-4.14.1.tgz -C .cache/web --strip-components 1 package/axe.min.js

# An OPC UA server that is not ours (node-opcua) for the tests of the live link, which skip where npm is not there.
opcua:
	@if command -v npm >/dev/null; then $(MAKE) --no-print-directory $(OPCUA) || echo "npm gave nothing: tests against node-opcua skip"; else echo "no npm: tests against node-opcua skip"; fi

# Each package against the digest of the lock file, which names no host. Renewed by the same words with `npm install
# --package-lock-only --omit-lockfile-registry-resolved`, less its "funding".
$(OPCUA): tests/opcua/package.json tests/opcua/package-lock.json
	cd tests/opcua && npm ci --ignore-scripts --omit=optional --no-audit --no-fund --loglevel=error
	touch $@

# Makes the pages of docs/ again that are older than their source, oldest first; stop it and start it at any time.
pages: $(STAMP) plc
	$(BIN)/python -m benchmarks.pages --at-once 2 $(PAGES)

# What a release consists of (CycloneDX): the packages of .venv, with versions and licences, into sbom.json.
sbom: $(STAMP)
	$(PYTHON) -m venv .venv-sbom
	.venv-sbom/bin/pip install --quiet --disable-pip-version-check cyclonedx-bom==7.5.0
	.venv-sbom/bin/cyclonedx-py environment --pyproject pyproject.toml --output-reproducible -o sbom.json $(BIN)/python

clean:
	rm -rf $(VENDOR) .cache .venv .venv-plc .venv-sbom sbom.json .venv-rivals .venv-tep tests/opcua/node_modules .mypy_cache .ruff_cache .pytest_cache .import_linter_cache demo-output
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
