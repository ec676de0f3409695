# make demo: set up and run the main job on the bundled captures.  make test: set up and test.

PYTHON ?= python3
VENV := .venv
# Where an environment has its programs.
PROGRAMS := $(if $(filter Windows_NT,$(OS)),Scripts,bin)
BIN := $(VENV)/$(PROGRAMS)
PIP := -m pip install --quiet --disable-pip-version-check
# The wheels of Blender for blender-test, 350 MB each; each wants its own Python.
BLENDERS ?= 5.0.1 4.5.15 4.2.23 5.2.3 5.3.0
BLENDER_PYTHON_4 ?= python3.11
BLENDER_PYTHON_5.0 ?= python3.11
BLENDER_PYTHON ?= python3.13
blender_python = $(or $(BLENDER_PYTHON_$(firstword $(subst ., ,$*))),\
	$(BLENDER_PYTHON_$(basename $*)),$(BLENDER_PYTHON))
CAPTURES := 01_01 01_03 Boxing_Toes

.PHONY: demo demo-begins test page-test studio-test players-test docs figures check setup clean blender-extension blender-test
.PHONY: fuzz lowest-test mutation-test sanitize
.PHONY: wheels wheels-test wheel-test sdist sdist-test pipx-test container release release-check

demo: demo-begins $(VENV)/.installed
	@mkdir -p out
	@for name in $(CAPTURES); do \
		$(BIN)/roundelay loop data/captures/$$name.bvh -o out; status=$$?; \
		if [ $$status -ne 0 ] && [ $$status -ne 3 ]; then exit $$status; fi; \
	done
	@$(BIN)/roundelay view data/captures/01_01.bvh -o out/01_01.html
	@echo
	@echo "Open out/01_01.html in a browser: the capture, what repeats in it, and the loop beside it."
	@echo "out/01_01_loop.bvh is the loop, for Blender or an engine; out/01_01_loop.png is its picture."
	@echo "On a capture of yours: $(BIN)/roundelay loop walk.bvh -o out"

demo-begins:
	@echo "Three captures from data/captures become loops in out/, with nothing set by hand:"
	@echo "forward jumps (01_01), climbing and swinging (01_03), sparring (Boxing_Toes)."
	@echo "What repeats is found, timed and closed; what does not is left out, and why is told."
	@echo

test: $(VENV)/.tested
	$(BIN)/python -m pytest -n 2

page-test: $(VENV)/.browser
	@command -v chromium >/dev/null || { echo "page-test needs Chromium: apt-get install chromium"; exit 1; }
	$(BIN)/python -m pytest tests/output/page

studio-test: $(VENV)/.browser
	@command -v chromium >/dev/null || { echo "studio-test needs Chromium: apt-get install chromium"; exit 1; }
	$(BIN)/python -m pytest tests/studio

players-test: $(VENV)/.browser build/players/node_modules/three
	@command -v chromium >/dev/null || { echo "players-test needs Chromium: apt-get install chromium"; exit 1; }
	$(BIN)/python -m pytest tests/loops/test_players.py

build/players/node_modules/three:
	@command -v npm >/dev/null || { echo "players-test needs npm: apt-get install npm"; exit 1; }
	mkdir -p build/players
	npm install --silent --no-audit --no-fund --prefix build/players three@0.187

# Files by a grammar, and the kept corpus changed, into all readers: RUNS of them.
RUNS ?= 20000
fuzz: $(VENV)/.tested
	$(BIN)/python -m tests.fuzz --runs $(RUNS)

# The lowest versions that pyproject.toml allows; old Matplotlib warns of new pyparsing.
lowest-test: build/lowest/.ready
	build/lowest/bin/python -m pytest -n 2 -W ignore::DeprecationWarning

build/lowest/.ready: pyproject.toml tests/lowest.py
	$(PYTHON) -m venv build/lowest
	$(PYTHON) tests/lowest.py > build/lowest/constraints.txt
	build/lowest/bin/pip install --quiet --disable-pip-version-check -c build/lowest/constraints.txt '.[test]'
	@touch $@

# The kernel with AddressSanitizer and UndefinedBehaviorSanitizer, under its tests.
KERNEL := src/roundelay/topology/kernel
SANITIZERS := -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined
sanitize: $(VENV)/.tested
	@mkdir -p build/sanitized
	$(CC) $(SANITIZERS) -std=c11 -fPIC -shared -ffp-contract=off -fvisibility=hidden \
		-o build/sanitized/_kernel.so $(addprefix $(KERNEL)/,dispatch.c distances.c rips.c \
		propagate.c harmonic.c table.c) -lm
	ASAN_OPTIONS=detect_leaks=0 \
		LD_PRELOAD="$$($(CC) -print-file-name=libasan.so) $$($(CC) -print-file-name=libubsan.so)" \
		$(BIN)/python -m tests.sanitized build/sanitized

# Changes of the code that no test notices; MUTATED names a module, TESTS what is to notice it.
MUTATED ?= src/roundelay/base/files.py
TESTS ?= tests/base tests/library
mutation-test: $(VENV)/.tested build/mutation/.ready
	build/mutation/bin/python -m tests.mutation $(MUTATED) $(TESTS)

build/mutation/.ready: | $(VENV)/.tested
	$(PYTHON) -m venv build/mutation
	build/mutation/bin/pip install --quiet --disable-pip-version-check 'mutmut>=3.8' '.[test]'
	build/mutation/bin/pip uninstall --quiet --yes roundelay
	@touch $@

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

# What is given out: wheels for six systems, cross-compiled by zig, and the sources; all into dist/.
wheels: $(VENV)/.released
	$(BIN)/python -m release.wheels --output dist
	$(BIN)/python -m twine check --strict dist/*.whl

# The recorded cases on the binaries that run here: natively, under qemu-user and wine64.
wheels-test: $(VENV)/.released
	$(BIN)/python -m release.replay --wheels dist
	$(BIN)/python -m pytest tests/releasing

# The wheel for this system, as pip chooses it, with the newest dependencies, under the tests.
WHEEL_TESTS ?= tests
wheel-test:
	rm -rf build/wheel-test
	$(PYTHON) -m venv build/wheel-test
	build/wheel-test/$(PROGRAMS)/python $(PIP) --no-index --no-deps --find-links dist roundelay
	build/wheel-test/$(PROGRAMS)/python $(PIP) 'roundelay[test]'
	build/wheel-test/$(PROGRAMS)/python -m release.installed build/wheel-test
	build/wheel-test/$(PROGRAMS)/python -m pytest -n 2 $(WHEEL_TESTS)

sdist: $(VENV)/.released
	$(BIN)/python -m build --sdist --outdir dist .
	$(BIN)/python -m twine check --strict dist/*.tar.gz

# The sources as they are given out, unpacked and compiled, under their own tests.
sdist-test: sdist
	rm -rf build/sdist build/sdist-test
	mkdir -p build/sdist
	tar -xzf dist/roundelay-*.tar.gz -C build/sdist --strip-components=1
	$(PYTHON) -m venv build/sdist-test
	cd build/sdist && ../sdist-test/$(PROGRAMS)/python $(PIP) '.[test]'
	cd build/sdist && ../sdist-test/$(PROGRAMS)/python -m release.installed ../sdist-test
	cd build/sdist && ../sdist-test/$(PROGRAMS)/python -m pytest -n 2 $(WHEEL_TESTS)

# The program from the wheel alone, without an installation.
pipx-test: $(VENV)/.released
	@mkdir -p out
	$(BIN)/python -m pipx run --no-cache --spec \
		$$($(BIN)/python -m release.targets dist) roundelay loop data/captures/01_03.bvh -o out/pipx

# podman and docker both build it: make container CONTAINER=docker
CONTAINER ?= podman
container:
	$(CONTAINER) build --tag roundelay --file Containerfile .

# Version and date in all places, changes/ gathered into CHANGELOG.md; then look, commit and tag.
release: $(VENV)/.released
	$(BIN)/python -m release.versions set $(VERSION)
	$(BIN)/python -m towncrier build --yes --version $(VERSION)

release-check: $(VENV)/.released
	$(BIN)/python -m release.versions check $(TAG)

blender-extension: $(VENV)/.installed build/bpy-$(firstword $(BLENDERS))/.ready
	$(BIN)/python blender/build.py --bpy build/bpy-$(firstword $(BLENDERS)) \
		$(if $(wildcard build/kernels),--kernels build/kernels)

blender-test: blender-extension $(BLENDERS:%=build/bpy-%/.ready)
	@for version in $(BLENDERS); do \
		echo "Blender $$version"; \
		$(BIN)/python blender/tests/run.py build/bpy-$$version dist || exit 1; \
	done

build/bpy-%/.ready:
	@$(blender_python) -c "" || { echo "Blender $* wants $(blender_python), which is missing:" \
		"install it, or leave $* out of BLENDERS"; exit 1; }
	$(blender_python) -m venv build/bpy-$*
	build/bpy-$*/bin/python -m pip install --quiet --disable-pip-version-check bpy==$* pytest
	@touch $@

setup: $(VENV)/.installed

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "roundelay needs Python 3.11 or newer")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: pyproject.toml cmake/CMakeLists.txt $(wildcard src/roundelay/topology/kernel/*.[ch]) | $(VENV)/bin/python
	@echo "Setting up $(VENV), once: NumPy, Matplotlib and a few more are fetched, some 50 MB, and"
	@echo "a small kernel in C is compiled; a minute or two ..."
	@$(BIN)/python $(PIP) --editable .
	@touch $@

$(VENV)/.tested: $(VENV)/.installed
	$(BIN)/python $(PIP) --editable '.[test,lint]'
	@touch $@

$(VENV)/.browser: $(VENV)/.tested
	$(BIN)/python $(PIP) --editable '.[browser,studio]'
	@touch $@

$(VENV)/.released: $(VENV)/.tested
	$(BIN)/python $(PIP) --editable '.[release]'
	@touch $@

$(VENV)/.documented: $(VENV)/.installed
	$(BIN)/python $(PIP) --editable '.[docs]'
	@touch $@

clean:
	rm -rf $(VENV) out build dist
