# Two commands matter: `make reproduce` and `make test`. Both install what they need into .venv first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A .venv that is there may have any version, unless PYTHON asks for one.
ANY_VERSION := $(if $(filter file,$(origin PYTHON)),--any-version)
# Processes that run tests; a worker that has none left takes those of another one.
WORKERS ?= 2
TESTS := $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal

.PHONY: install reproduce test test-changed test-pages test-study test-slow test-busy record test-lowest test-next test-wheel
.PHONY: mutants coverage-map lint types docs pins release-notes bench checks clean

install:
	@$(PYTHON) .ci/install.py $(ANY_VERSION)

reproduce: install
	$(BIN)/runner reproduce all

test: install
	$(TESTS)

# The tests that a change since the commit BASE can affect, without one since the last commit; by `make coverage-map`.
test-changed: install
	$(BIN)/python -m tools.changed_tests $(BASE)

# The README and the pages of docs/, followed command by command in a shell, the scripts that they show, and the built site.
test-pages: install
	$(TESTS) -m slow tests/end_to_end/test_pages.py tests/end_to_end/test_scripts_of_pages.py \
		tests/end_to_end/test_docs_site.py

# The slow tests of one study: its whole plan, simulated again, against its findings and the recorded runs.
test-study: install
	$(TESTS) -m slow -k xarm7 tests/contract/studies

test-slow: install
	$(TESTS) -m slow

# All committed files that are made from the sources, where they have changed: pages of docs/, and chapters, reports and
# drawings as text in tests/recorded. Not the recorded runs, which CONTRIBUTING.md describes.
record: install
	$(BIN)/python -m tools.docs.reference
	$(BIN)/python -m tools.docs.architecture
	$(BIN)/python -m pytest --record tests/contract -k "recorded or each_condition_can_fail"
	@git status --short docs tests/recorded

# The tests in random order beside four busy loops, with a home folder that is empty and read-only.
test-busy: install
	$(BIN)/python -m tools.busy_tests $(SEED)

# Small errors put into the package: SAMPLE of them drawn by SEED, or without SAMPLE those written by hand.
mutants: install
	$(BIN)/python -m tools.mutants $(if $(SAMPLE),--sample $(SAMPLE)) $(if $(SEED),--seed $(SEED))

# Which tests run which lines and read which files, for `make mutants` and `make test-changed`, in .cache.
coverage-map: install
	$(BIN)/python -m tools.mutants --record --workers $(WORKERS)

# The oldest versions that pyproject.toml allows of what the runner itself needs, in build/lowest.
test-lowest: install
	$(BIN)/uv venv --quiet --clear --python $(BIN)/python build/lowest
	$(BIN)/uv pip install --quiet --python build/lowest/bin/python --resolution lowest-direct --editable '.[dev]'
	build/lowest/bin/python -m pytest -n $(WORKERS) -W default tests/physics/simulation/test_closed_forms.py \
		tests/contract/api tests/contract/store tests/physics/plants

# The next versions of Hydra, OmegaConf and Optuna, whose pins are set aside, in build/next.
NEXT := hydra-core==1.4.0rc3 omegaconf==2.4.1rc1
test-next: install
	$(BIN)/uv venv --quiet --clear --python $(BIN)/python build/next
	$(BIN)/uv pip install --quiet --python build/next/bin/python --constraint constraints.txt --editable '.[dev]'
	$(BIN)/uv pip install --quiet --python build/next/bin/python --prerelease allow --upgrade-package optuna $(NEXT) optuna
	build/next/bin/python -m pytest -n $(WORKERS) tests/unit/config tests/unit/sweeps tests/contract/config tests/contract/sweeps \
		tests/contract/cli

# The wheel in an environment of its own, build/wheel, away from the checkout.
test-wheel: install
	rm -rf build/wheel
	$(BIN)/python -m hatchling build -t wheel -d build/wheel
	$(BIN)/uv venv --quiet --python $(BIN)/python build/wheel/venv
	$(BIN)/uv pip install --quiet --python build/wheel/venv/bin/python --constraint constraints.txt build/wheel/*.whl
	cd build/wheel && PATH="$$PWD/venv/bin:$$PATH" sh -ec 'runner --version; runner robot=macro duration=0.1; \
		runner example examples; ./examples/own_robot/check.sh'

# The pins of `make install` with the digests of their files: the newest versions, or of PIN alone.
pins: install
	printf 'setuptools\nuv\n' | $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
		--no-annotate --custom-compile-command 'make pins' --extra dev --extra docs --extra bench --extra ros \
		$(if $(PIN),--upgrade-package $(PIN),--upgrade) --output-file constraints.txt pyproject.toml -

lint: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

types: install
	$(BIN)/mypy

# The site of the documentation, in build/site: it works from there as files, and from any server.
docs: install
	$(BIN)/python -m tools.docs.gallery
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

# What is new in the version of pyproject.toml, or what is not released yet.
release-notes:
	@$(PYTHON) .ci/release_notes.py

bench: install
	$(BIN)/python -m bench

# Checks that take too long for the tests: killed sweeps, damaged files, mutants, statistics of answers and intervals.
checks: install
	$(BIN)/python -m tools

clean:
	rm -rf $(VENV) .cache outputs dist build .pytest_cache .mypy_cache .ruff_cache .hypothesis
