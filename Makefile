# Every target makes .venv when there is none; only Python 3.11 or newer, make and git are needed.
PYTHON ?= python3
BIN := .venv/bin
INSTALLED := .venv/.installed
PACKAGES := lqd_envs lqd_search llm
FOLDERS := $(PACKAGES) benchmarks examples tests

export PIP_DISABLE_PIP_VERSION_CHECK := 1

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-slow tables-smoke lint format types wheel clean

help: ## Show this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

setup: $(INSTALLED) ## Make .venv with pinned versions

$(INSTALLED): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "Python 3.11 or newer is needed, this is " + sys.version.split()[0] + ": run make PYTHON=/path/to/a/newer/python3")'
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	PIP_CONSTRAINT=$(CURDIR)/constraints.txt $(BIN)/python -m pip install --quiet --editable '.[dev]'
	touch $@

demo: $(INSTALLED) ## Run the faucet search at 8,192 evaluations (a minute or two)
	$(BIN)/lqd run LQD/Faucet-v0 --evaluations 8192

# In the order of the files: by their number of tests, the longest would come last and alone.
test: $(INSTALLED) ## Run the fast tests
	$(BIN)/python -m pytest -m 'not slow' --numprocesses auto --dist loadfile --no-loadscope-reorder

test-slow: $(INSTALLED) ## Run the tests that take minutes
	$(BIN)/python -m pytest -m slow

tables-smoke: $(INSTALLED) ## Run the paper's tables as small as can be (minutes)
	$(BIN)/python -m benchmarks.tables --scale smoke --out runs/tables-smoke

lint: $(INSTALLED) ## Check style and docstrings
	$(BIN)/ruff check $(FOLDERS)
	$(BIN)/ruff format --check $(FOLDERS)

format: $(INSTALLED) ## Format the code
	$(BIN)/ruff check --fix $(FOLDERS)
	$(BIN)/ruff format $(FOLDERS)

# Against the wheel's contents: the editable install hides lqd_llm, whose folder is called llm.
types: $(INSTALLED) wheel ## Check types against the installed wheel
	rm -rf build/types
	$(BIN)/python -m pip install --quiet --no-deps --no-index --target build/types dist/*.whl
	cd build/types && ../../$(BIN)/mypy --config-file ../../pyproject.toml -p lqd_envs -p lqd_search -p lqd_llm

wheel: $(INSTALLED) ## Build the wheel into dist/
	rm -rf dist build/lib build/bdist.*
	PIP_CONSTRAINT=$(CURDIR)/constraints.txt $(BIN)/python -m build --wheel . > /dev/null
	@ls dist/*.whl

clean: ## Remove .venv and everything built
	rm -rf .venv build dist *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis
