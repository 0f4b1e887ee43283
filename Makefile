# Two commands matter: `make reproduce` and `make test`. Both install what they need into .venv first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A .venv that is there may have any version, unless PYTHON asks for one.
ANY_VERSION := $(if $(filter file,$(origin PYTHON)),--any-version)

.PHONY: install reproduce test test-slow lint bench clean

install:
	@$(PYTHON) .ci/install.py $(ANY_VERSION)

reproduce: install
	$(BIN)/runner reproduce all

test: install
	$(BIN)/python -m pytest

test-slow: install
	$(BIN)/python -m pytest -m slow

lint: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: install
	$(BIN)/python -m bench

clean:
	rm -rf $(VENV) outputs dist build .pytest_cache .mypy_cache .ruff_cache .hypothesis
