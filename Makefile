# make demo: set up and run the main job on the bundled captures.  make test: set up and test.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CAPTURES := 01_01 01_03 Boxing_Toes

.PHONY: demo test check setup clean

demo: $(VENV)/.installed
	@mkdir -p out
	@for name in $(CAPTURES); do \
		$(BIN)/roundelay loop data/captures/$$name.bvh -o out; status=$$?; \
		if [ $$status -ne 0 ] && [ $$status -ne 3 ]; then exit $$status; fi; \
	done
	@echo "Loops, pictures and figures are in out/."

test: $(VENV)/.tested
	$(BIN)/python -m pytest -n 2

check: $(VENV)/.tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

setup: $(VENV)/.installed

$(VENV)/bin/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "roundelay needs Python 3.11 or newer")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: pyproject.toml cmake/CMakeLists.txt $(wildcard src/roundelay/topology/kernel/*.[ch]) | $(VENV)/bin/python
	$(BIN)/pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(VENV)/.tested: $(VENV)/.installed
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[test,lint]'
	@touch $@

clean:
	rm -rf $(VENV) out build dist
