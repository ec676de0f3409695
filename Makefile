# make demo: set up and run the main job on the bundled captures.  make test: set up and test.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# The wheels of Blender for blender-test, 350 MB each, want one Python; 4.2.23 is there, too.
BLENDER_PYTHON ?= python3.11
BLENDERS ?= 5.0.1 4.5.15
CAPTURES := 01_01 01_03 Boxing_Toes

.PHONY: demo test page-test players-test docs figures check setup clean blender-extension blender-test

demo: $(VENV)/.installed
	@mkdir -p out
	@for name in $(CAPTURES); do \
		$(BIN)/roundelay loop data/captures/$$name.bvh -o out; status=$$?; \
		if [ $$status -ne 0 ] && [ $$status -ne 3 ]; then exit $$status; fi; \
	done
	@$(BIN)/roundelay view data/captures/01_01.bvh -o out/01_01.html
	@echo "Loops, pictures and figures are in out/; open out/01_01.html in a browser."

test: $(VENV)/.tested
	$(BIN)/python -m pytest -n 2

page-test: $(VENV)/.browser
	@command -v chromium >/dev/null || { echo "page-test needs Chromium: apt-get install chromium"; exit 1; }
	$(BIN)/python -m pytest tests/output/page

players-test: $(VENV)/.browser build/players/node_modules/three
	@command -v chromium >/dev/null || { echo "players-test needs Chromium: apt-get install chromium"; exit 1; }
	$(BIN)/python -m pytest tests/loops/test_players.py

build/players/node_modules/three:
	@command -v npm >/dev/null || { echo "players-test needs npm: apt-get install npm"; exit 1; }
	mkdir -p build/players
	npm install --silent --no-audit --no-fund --prefix build/players three@0.187

docs: $(VENV)/.documented
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs out/docs
	@echo "The documentation is in out/docs/index.html."

figures: $(VENV)/.installed
	@$(BIN)/python -m benchmarks.figures

check: $(VENV)/.tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

blender-extension: $(VENV)/.installed build/bpy-$(firstword $(BLENDERS))/.ready
	$(BIN)/python blender/build.py --bpy build/bpy-$(firstword $(BLENDERS))

blender-test: blender-extension $(BLENDERS:%=build/bpy-%/.ready)
	@for version in $(BLENDERS); do \
		echo "Blender $$version"; \
		$(BIN)/python blender/tests/run.py build/bpy-$$version dist || exit 1; \
	done

build/bpy-%/.ready:
	$(BLENDER_PYTHON) -m venv build/bpy-$*
	build/bpy-$*/bin/python -m pip install --quiet --disable-pip-version-check bpy==$* pytest
	@touch $@

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

$(VENV)/.browser: $(VENV)/.tested
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[browser]'
	@touch $@

$(VENV)/.documented: $(VENV)/.installed
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@

clean:
	rm -rf $(VENV) out build dist
