# Two commands matter: `make reproduce` and `make test`. Both install what they need into .venv first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A .venv that is there may have any version, unless PYTHON asks for one.
ANY_VERSION := $(if $(filter file,$(origin PYTHON)),--any-version)

.PHONY: install reproduce test test-pages test-slow lint bench clean

install:
	@$(PYTHON) .ci/install.py $(ANY_VERSION)

reproduce: install
	$(BIN)/runner reproduce all

test: install
	$(BIN)/python -m pytest

# The README and the pages of docs/ that are followed command by command in a shell: what takes minutes of them.
test-pages: install
	$(BIN)/python -m pytest -m slow tests/test_readme.py tests/test_tutorial.py tests/test_compare_page.py \
		tests/test_figures_and_tables_docs.py tests/test_how_sure_page.py tests/test_sensitivity_page.py

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
