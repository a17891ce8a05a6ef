# make run    set up and run the main job       make test   set up and run the tests
# make check  ruff, type checker and tests      make test-long  the long tests, which are none of these
# make clean  remove what was set up
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PYTEST := $(BIN)/python -m pytest -n 2 --dist loadfile
export PIP_CONSTRAINT := $(CURDIR)/constraints.txt
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export NUMBA_CACHE_DIR ?= $(CURDIR)/$(VENV)/numba

.PHONY: run test test-long check clean setup
run: setup
	$(BIN)/loopgap $(ARGS)

test: setup
	$(PYTEST) -m "not long" $(ARGS)

test-long: setup
	$(PYTEST) -m long $(ARGS)

check: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(MAKE) --no-print-directory test

setup: $(VENV)/installed

$(VENV)/installed: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "loopgap needs Python 3.11 or newer; $(PYTHON) is $$($(PYTHON) --version 2>&1)." \
	       "Install it (Debian: apt-get install python3) or say make PYTHON=/path/to/python3.11"; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo "Python's venv is missing: install it (Debian: apt-get install python3-venv), then make again."; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --editable '.[dev]'
	@touch $@

clean:
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache
