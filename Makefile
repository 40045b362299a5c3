# `make` sets up an environment and runs the default campaign. `make check` sets it up, checks the style and runs some
# tests of each package within two minutes. `make test` runs the tests. `make verify` runs every extreme case, also
# those that take too long for the tests. `make docs` builds the documentation site and fails on a dead link.
VENV ?= .venv
PYTHON ?= python3
CORES ?= all
# Number of test files that run at the same time.
WORKERS ?= 2
PYTEST_ARGS ?=
# Tests of `make check`: some of each package, in total 75 s of CPU time once their kernels are compiled.
QUICK_TESTS := $(addprefix tests/,test_structure.py test_command_line.py \
  $(addprefix grains/,test_form.py test_mesh.py test_sieve.py) \
  $(addprefix scene/,test_specification.py test_identity.py) \
  $(addprefix dem/,test_vectors.py forces/test_spring_dashpot.py contact/pairs/test_ellipsoids.py step/test_candidate_pairs.py step/test_close_spheres.py) \
  physics/test_contact_law.py \
  $(addprefix packing/,test_cost.py test_file.py test_watch.py) \
  $(addprefix evaluation/,test_slicing.py test_porosity.py) \
  reference \
  $(addprefix models/,test_regression.py test_formulas.py) \
  $(addprefix pores/,test_surface.py test_kozeny_carman.py) \
  $(addprefix campaign/,test_plan.py test_study_tables.py) \
  $(addprefix report/,test_sections.py test_page.py) \
  verification/test_work_precision_tables.py provenance)

# make and the scripts of an environment do not work if the path of the folder has spaces.
ifneq ($(words $(CURDIR)),1)
$(error The path of this clone, "$(CURDIR)", has spaces; move it to a path without spaces)
endif

bin := $(abspath $(VENV))/bin
installed := $(VENV)/.installed

.PHONY: all environment check test verify docs

# PATH is set because snakemake would find the system's python if the environment is not activated. Steps are compiled
# first, so that packings which start together do not compile the same step.
all: environment
	PATH="$(bin):$$PATH" python -m simcore compile
	PATH="$(bin):$$PATH" snakemake --cores $(CORES)
	@echo
	@echo "Report:  results/report.html"
	@echo "Tables:  results/models/*.csv (models), results/tables/*.csv (studies), results/grains/"
	@echo "Figures: results/figures/"

check: environment
	$(bin)/ruff check .
	$(bin)/ruff format --check .
	$(bin)/snakefmt --check Snakefile workflow
	PATH="$(bin):$$PATH" python -m pytest -n $(WORKERS) --dist loadfile $(QUICK_TESTS)

test: environment
	PATH="$(bin):$$PATH" python -m pytest -n $(WORKERS) --dist loadfile $(PYTEST_ARGS)

verify: environment
	PATH="$(bin):$$PATH" python -m pytest tests/physics/extremes -m "extremes or not extremes" $(PYTEST_ARGS)
	PATH="$(bin):$$PATH" python -m pytest tests/dem tests/physics/test_settled_packings.py -m extremes $(PYTEST_ARGS)

docs: environment
	NO_MKDOCS_2_WARNING=1 PATH="$(bin):$$PATH" mkdocs build
	@echo "Site: results/site/index.html; for its search, run: python3 -m http.server --directory results/site"

environment: $(installed)

$(installed): environment.txt pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "Python 3.11 or newer is needed; name one with: make PYTHON=python3.12"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(bin)/python -m pip install --quiet --disable-pip-version-check -r environment.txt -e .
	touch $@
