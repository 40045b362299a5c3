# `make` sets up an environment and runs the default campaign; `make test` sets it up and runs the tests; `make verify`
# runs every extreme case, also those that take too long for the tests.
VENV ?= .venv
PYTHON ?= python3
CORES ?= all
# Files of tests that run beside each other.
WORKERS ?= 2
PYTEST_ARGS ?=

# Neither make nor the scripts of an environment work below a folder whose path has spaces.
ifneq ($(words $(CURDIR)),1)
$(error The path of this clone has spaces, "$(CURDIR)"; move it to a path without any)
endif

bin := $(abspath $(VENV))/bin
installed := $(VENV)/.installed

.PHONY: all environment test verify

# In an environment that is not activated, snakemake would find the system's python: hence PATH. Steps are compiled
# first, so that no two packings at once compile the same.
all: environment
	PATH="$(bin):$$PATH" python -m simcore compile
	PATH="$(bin):$$PATH" snakemake --cores $(CORES)
	@echo
	@echo "Report:  results/report.html"
	@echo "Tables:  results/models/*.csv (models), results/tables/*.csv (studies), results/grains/"
	@echo "Figures: results/figures/"

test: environment
	PATH="$(bin):$$PATH" python -m pytest -n $(WORKERS) --dist loadfile $(PYTEST_ARGS)

verify: environment
	PATH="$(bin):$$PATH" python -m pytest tests/extremes -m "extremes or not extremes" $(PYTEST_ARGS)
	PATH="$(bin):$$PATH" python -m pytest tests/dem -m extremes $(PYTEST_ARGS)

environment: $(installed)

$(installed): environment.txt pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "Python 3.11 or newer is needed; name one with: make PYTHON=python3.12"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(bin)/python -m pip install --quiet --disable-pip-version-check -r environment.txt -e .
	touch $@
