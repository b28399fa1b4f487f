# The front door: `make` builds, `make help` lists the rest. CMake and Ninja do the work.

PRESET ?= default
PREFIX ?= /usr/local
WARNINGS_AS_ERRORS ?= $(if $(filter dev,$(PRESET)),ON,OFF)
BUILD := $(if $(filter default,$(PRESET)),build,build/$(PRESET))

# the rooms whose tests `make test` builds and runs, empty: all tests; and which tests are left out, a regular expression
TESTED ?=
LEFT_OUT ?=

# `make fuzz`: seconds in all; `make soak`: disturbed runs, and what they are drawn from
FUZZ_SECONDS ?= 600
SOAK_RUNS ?= 300
SOAK_SEED ?= 1

# what `make studies` computes
STUDIES ?= $(patsubst studies/cases/study_%.toml,%,$(sort $(wildcard studies/cases/study_*.toml)))
DEVICE ?= auto

# As many jobs as cores, but no more than the free memory holds compilers (1.5 GB each).
JOBS ?= $(shell cores=$$(nproc 2>/dev/null || echo 2); \
	fit=$$(awk '/^MemAvailable:/ {print int($$2 / 1500000)}' /proc/meminfo 2>/dev/null); \
	[ "$${fit:-$$cores}" -ge 1 ] || fit=1; [ "$${fit:-$$cores}" -lt "$$cores" ] && echo $$fit || echo $$cores)

# All from Debian bookworm. OpenCV's three small packages instead of libopencv-dev, which draws in two hundred others.
PACKAGES := g++ cmake ninja-build pkg-config libeigen3-dev libtbb-dev libfmt-dev libspdlog-dev nlohmann-json3-dev \
	libcli11-dev libtomlplusplus-dev libhdf5-dev libopenimageio-dev libopencv-core-dev libopencv-imgproc-dev \
	libopencv-video-dev libceres-dev libnlopt-cxx-dev zlib1g-dev libbz2-dev libpugixml-dev liblz4-dev liblzma-dev libssl-dev gnuplot-nox fonts-dejavu-core node-d3 libgtest-dev libgmock-dev libbenchmark-dev
LINT_PACKAGES := clang-format python3-venv
# from PyPI: unlike Debian's clang-tidy 14 it skips the system's headers, and so takes a third of the time
CLANG_TIDY := clang-tidy==23.1.4
# the compiler of PRESET=dev, with libFuzzer, and what makes its reports readable
DEV_PACKAGES := clang libclang-rt-dev llvm
PACKAGES += $(if $(filter dev,$(PRESET)),$(DEV_PACKAGES))
# programs that only tests call; without them those are skipped
TEST_PACKAGES := munge slurmctld slurmd slurm-client chromium chromium-driver python3-selenium tidy

ROOMS := render analysis cuda studies
space := $(subst ,, )
SOURCES = $(shell find $(ROOMS) tests -name '*.h' -o -name '*.cpp' -o -name '*.cu' -o -name '*.cuh')
# the files that a build compiles: those of a room, or of one of its folders together
TIDY_SOURCES = sed -n 's|^ *"file": "\(.*\.c[px][px]\)".*|\1|p' $(BUILD)/compile_commands.json | \
	grep -E '^$(CURDIR)/($(subst $(space),|,$(strip $(ROOMS))))/|/Unity/unity_($(subst $(space),|,$(strip $(ROOMS))))_'

.PHONY: build test demo gallery studies bench fuzz soak check-long lint format install clean help packages configure
.DEFAULT_GOAL := build

build: configure  ## build/bin/gladstone, after installing the Debian packages that are missing
	cmake --build $(BUILD) --parallel $(JOBS) --target gladstone

test: OPTIONAL_PACKAGES = $(TEST_PACKAGES)
test: configure  ## build and run every test; of some rooms: TESTED='base medium'; once more: ctest --test-dir build -R medium/
	cmake --build $(BUILD) --parallel $(JOBS) $(if $(TESTED),--target $(TESTED:%=%_tests))
	ctest --test-dir $(BUILD) --output-on-failure --parallel $(JOBS) \
		$(if $(TESTED),--label-regex '^($(subst $(space),|,$(strip $(TESTED))))$$') \
		$(if $(LEFT_OUT),--exclude-regex '$(LEFT_OUT)')

demo: build  ## the seed's experiment from setup to error report, into out/demo; README's passage and figures: DOCS=1
	$(BUILD)/bin/gladstone demo -o out/demo
	@[ -z "$(DOCS)" ] || { cp out/demo/figure4.png out/demo/agreement.png docs && awk ' \
		FNR == NR { if (/^## /) told = 1; if (FNR > 1 && !told) { gsub(/\]\(/, "](docs/"); story = story $$0 "\n" } next } \
		/^## / { inside = 0 } !inside; /^## What the demo shows/ { inside = 1; printf "%s", story }' \
		out/demo/summary.md README.md > out/demo/README.md && cp out/demo/README.md README.md; }

gallery: build  ## particle images with what spoils them, the seed's Figure 1, into out/gallery; the document's figure: DOCS=1
	$(BUILD)/bin/gladstone gallery -o out/gallery --device $(DEVICE)
	@[ -z "$(DOCS)" ] || cp out/gallery/gallery.png docs/gallery.png

studies: build  ## the shipped studies into out/studies; some: STUDIES='f_number z_d'; a GPU: DEVICE=cuda; docs' figures: DOCS=1
	@for study in $(STUDIES); do run=out/studies/$$study; \
		$(BUILD)/bin/gladstone sweep plan studies/cases/study_$$study.toml -o $$run --device $(DEVICE) && \
		$(BUILD)/bin/gladstone sweep run $$run --quiet && $(BUILD)/bin/gladstone sweep collect $$run --quiet || exit; \
		[ -z "$(DOCS)" ] || for figure in $$(grep -o "$$study/[a-z0-9_]*[.]png" docs/studies/$$study.md); do \
			mkdir -p docs/studies/$$study && cp $$run/figures/$${figure##*/} docs/studies/$$figure || exit; done; \
	done

bench: configure  ## measure rays/s, steps/s and vectors/s; options: BENCH='--benchmark_filter=...'
	cmake --build $(BUILD) --parallel $(JOBS) --target gladstone_bench
	$(BUILD)/bin/gladstone_bench $(BENCH)

fuzz:  ## give every reader made-up files, under sanitizers, into out/fuzz; longer: FUZZ_SECONDS=3600
	@$(MAKE) --no-print-directory PRESET=dev configure
	cmake --build build/dev --parallel $(JOBS) --target fuzz_targets
	ctest --test-dir build/dev --output-on-failure --label-regex '^fuzz$$'
	tests/fuzz/fuzz.sh build/dev out/fuzz $(FUZZ_SECONDS)

soak: build  ## kill, starve and confuse the program, and check what is left: SOAK_RUNS=300, SOAK_SEED=1
	python3 -B tests/soak/soak.py --program $(BUILD)/bin/gladstone --seed $(SOAK_SEED) --runs $(SOAK_RUNS)

check-long: build  ## simulate ten recommended designs with eight fresh seeds each: SETS=10 SEEDS=8; some minutes each
	python3 -B tests/long/designs.py --program $(BUILD)/bin/gladstone --sets $(or $(SETS),10) --seeds $(or $(SEEDS),8)

lint: PACKAGES += $(LINT_PACKAGES)
lint: configure  ## check the format (clang-format) and the code (clang-tidy)
	@clang-format --dry-run -Werror $(SOURCES)
	@[ -x $(BUILD)/lint/bin/clang-tidy ] || { python3 -m venv $(BUILD)/lint && $(BUILD)/lint/bin/pip install -q $(CLANG_TIDY); } || \
		echo 'lint: $(CLANG_TIDY) cannot be installed from PyPI: only the format was checked' >&2
	@[ ! -x $(BUILD)/lint/bin/clang-tidy ] || $(TIDY_SOURCES) | xargs -P $(JOBS) -n 1 $(BUILD)/lint/bin/clang-tidy -p $(BUILD) --quiet

format:  ## rewrite the sources in the project's format
	@cmake/install_packages.sh clang-format
	clang-format -i $(SOURCES)

install: configure  ## programs, libraries, headers, cases and CMake package; where: PREFIX=/usr/local
	cmake --build $(BUILD) --parallel $(JOBS)
	cmake --install $(BUILD) --prefix $(PREFIX)

clean:  ## remove what was built
	rm -rf $(BUILD)

packages:
	@cmake/install_packages.sh $(PACKAGES)
	$(if $(OPTIONAL_PACKAGES),@cmake/install_packages.sh --optional $(OPTIONAL_PACKAGES))

configure: packages
	@cmake --preset $(PRESET) -DGLADSTONE_WARNINGS_AS_ERRORS=$(WARNINGS_AS_ERRORS) $(CMAKE_OPTIONS)

help:  ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "make %-10s %s\n", $$1, $$2}' Makefile
	@echo 'PRESET=default|cuda|dev picks the build (build, build/cuda, build/dev); JOBS=N its parallel jobs;'
	@echo 'CMAKE_OPTIONS="-D..." goes to CMake.'
