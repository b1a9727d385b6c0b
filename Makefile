# Two commands matter to a newcomer: `make model` and `make test`.
PYTHON ?= python3
BIN := .venv/bin
# Without a terminal pip need not say what it downloads.
PIP := $(BIN)/python -m pip --disable-pip-version-check -q

.PHONY: help setup model generated quick test chain lint check-generated benchmarks clean

help:
	@echo "make model       set up, then generate the UR5e's 3-joint observer"
	@echo "make test        set up, then run all tests"
	@echo "make quick       the tests that take seconds"
	@echo "make chain       record, fit, explain, generate, upload, collide, freedrive, on a virtual robot"
	@echo "make lint        ruff and mypy"
	@echo "make generated   generate again what is checked in under generated/"
	@echo "make benchmarks  measure against Pinocchio, SymForce and wrenfold"

setup: .venv/.ready

.venv/.ready: pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(PIP) install -c constraints.txt -e '.[test]'
	mkdir -p build/typing && ln -sfn ../.. build/typing/residuum
	touch $@

model: setup
	$(BIN)/gen-model --dof 3

generated: setup
	$(BIN)/gen-model --dof 3
	$(BIN)/gen-model --dof 6

quick: setup
	$(BIN)/python -m pytest -q -n auto -m "not slow"

test: setup
	$(BIN)/python -m pytest -q -n auto

chain: setup
	$(BIN)/python examples/whole_chain.py --out build/chain

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

check-generated: generated
	git diff --exit-code generated/

.venv/.benchmarks: .venv/.ready
	$(PIP) install -c constraints.txt -e '.[benchmark]'
	touch $@

benchmarks: .venv/.benchmarks
	$(BIN)/python benchmarks/operations.py
	$(BIN)/python benchmarks/generation.py
	$(BIN)/python benchmarks/speed.py

clean:
	rm -rf .venv build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
