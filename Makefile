# Two commands matter: `make reproduce` and `make test`. Both install what they need into .venv first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A .venv that is there may have any version, unless PYTHON asks for one.
ANY_VERSION := $(if $(filter file,$(origin PYTHON)),--any-version)

.PHONY: install reproduce test test-pages test-slow test-lowest test-wheel lint types docs release-notes bench clean

install:
	@$(PYTHON) .ci/install.py $(ANY_VERSION)

reproduce: install
	$(BIN)/runner reproduce all

test: install
	$(BIN)/python -m pytest

# The README and the pages of docs/, followed command by command in a shell, and the scripts that they show.
test-pages: install
	$(BIN)/python -m pytest -m slow tests/end_to_end/test_pages.py tests/end_to_end/test_scripts_of_pages.py

test-slow: install
	$(BIN)/python -m pytest -m slow

# The oldest versions that pyproject.toml allows of what the runner itself needs, in build/lowest.
test-lowest: install
	$(BIN)/uv venv --quiet --clear --python $(BIN)/python build/lowest
	$(BIN)/uv pip install --quiet --python build/lowest/bin/python --resolution lowest-direct --editable '.[dev]'
	build/lowest/bin/python -m pytest -W default tests/test_closed_forms.py tests/api tests/store tests/plants

# The wheel in an environment of its own, build/wheel, away from the checkout.
test-wheel: install
	rm -rf build/wheel
	$(BIN)/python -m hatchling build -t wheel -d build/wheel
	$(BIN)/uv venv --quiet --python $(BIN)/python build/wheel/venv
	$(BIN)/uv pip install --quiet --python build/wheel/venv/bin/python --constraint constraints.txt build/wheel/*.whl
	cd build/wheel && PATH="$$PWD/venv/bin:$$PATH" sh -ec 'runner --version; runner robot=macro duration=0.1; \
		runner example examples; ./examples/own_robot/check.sh'

lint: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: install
	$(BIN)/mypy

# The site of the documentation, in build/site: it works from there as files, and from any server.
docs: install
	$(BIN)/python -m bench.gallery
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

# What is new in the version of pyproject.toml, or what is not released yet.
release-notes:
	@$(PYTHON) .ci/release_notes.py

bench: install
	$(BIN)/python -m bench

clean:
	rm -rf $(VENV) outputs dist build .pytest_cache .mypy_cache .ruff_cache .hypothesis
