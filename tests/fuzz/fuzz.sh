#!/bin/sh
# fuzz.sh BUILD OUT SECONDS: runs the fuzz targets of a build for SECONDS in all, from their corpus and what earlier runs
# have found. OUT/TARGET/found gets what reaches new code, OUT/TARGET/fault-* what fails: give that file to the target
# to see it again. Ends with 1 after the first fault.
set -eu
build=$1 out=$2 seconds=$3
source=$(dirname "$0")
targets=$(find "$build/bin" -name 'fuzz_*' -type f -executable | sort)
[ -n "$targets" ] || { echo "fuzz.sh: no targets in $build/bin" >&2 && exit 2; }
each=$((seconds / $(echo "$targets" | wc -l)))
# A library that asks for more memory than there can be is refused, as it is without a sanitizer; what HDF5 leaks of
# damaged files is no fault of ours.
export ASAN_OPTIONS="allocator_may_return_null=1:detect_leaks=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
for target in $targets; do
  name=${target##*/fuzz_}
  mkdir -p "$out/$name/found"
  # A crash, a sanitizer's report, a minute without an answer (a ray along a slab takes a million steps, 7 s), 1 GiB, or 256 MiB at once. What damaged files make HDF5 ask
  # for is its own affair: it is told that there is none, and only memory that it uses counts.
  at_once=256
  [ "$name" != hdf5_bytes ] || at_once=2000000
  "$target" -seed=1 -max_total_time=$((each > 0 ? each : 1)) -timeout=60 -rss_limit_mb=1024 -malloc_limit_mb=$at_once \
    -max_len=8192 -detect_leaks=0 -print_final_stats=1 -artifact_prefix="$out/$name/fault-" \
    "$out/$name/found" "$source/corpus/$name" "$build/tests/fuzz/corpus/$name" >"$out/$name/log" 2>&1 || {
    tail -n 40 "$out/$name/log"
    echo "fuzz.sh: $name fails on the input above; again: $target $out/$name/fault-..." >&2
    exit 1
  }
  echo "$name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$name/log") inputs," \
    "$(sed -n 's/^#.*DONE *cov: \([0-9]*\) .*/\1/p' "$out/$name/log") branches reached"
done
