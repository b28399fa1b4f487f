#!/bin/sh
# fuzz.sh BUILD OUT SECONDS: runs the fuzz targets of a build for SECONDS in all, from their corpus and the inputs that earlier
# runs found. OUT/TARGET/found receives inputs that reach new code, OUT/TARGET/fault-* an input that fails: give that file
# to the target to reproduce the fault. Exits with 1 after the first fault.
set -eu
build=$1 out=$2 seconds=$3
source=$(dirname "$0")
# Damaged HDF5 files make HDF5 1.10 itself read beyond its buffers and use gigabytes of memory: its bytes are tested on the
# corpus only, by ctest, and its contents by hdf5_datasets.
targets=$(find "$build/bin" -name 'fuzz_*' ! -name fuzz_hdf5_bytes -type f -executable | sort)
[ -n "$targets" ] || { echo "fuzz.sh: no targets in $build/bin" >&2 && exit 2; }
each=$((seconds / $(echo "$targets" | wc -l)))
# A library that asks for more memory than there can be is refused, as it is without a sanitizer. HDF5 leaks memory on
# damaged files.
export ASAN_OPTIONS="allocator_may_return_null=1:detect_leaks=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
for target in $targets; do
  name=${target##*/fuzz_}
  mkdir -p "$out/$name/found"
  # Faults are crashes, reports of a sanitizer, more than 60 s for an input (a ray along a slab takes a million steps, 7 s),
  # and more than 1 GiB of memory, or 256 MiB at once.
  "$target" -seed=1 -max_total_time=$((each > 0 ? each : 1)) -timeout=60 -rss_limit_mb=1024 -malloc_limit_mb=256 \
    -max_len=8192 -detect_leaks=0 -print_final_stats=1 -artifact_prefix="$out/$name/fault-" \
    "$out/$name/found" "$source/corpus/$name" "$build/tests/fuzz/corpus/$name" >"$out/$name/log" 2>&1 || {
    tail -n 40 "$out/$name/log"
    echo "fuzz.sh: $name fails on the input above; again: $target $out/$name/fault-..." >&2
    exit 1
  }
  echo "$name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$name/log") inputs," \
    "$(sed -n 's/^#.*DONE *cov: \([0-9]*\) .*/\1/p' "$out/$name/log") branches reached"
done
