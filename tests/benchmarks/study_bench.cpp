#include <benchmark/benchmark.h>

#include <cstdio>
#include <filesystem>

#include "studies/drawing/temporary_directory.h"
#include "studies/sweep/vector_errors.h"
#include "tests/support/study_without_work.h"

namespace gladstone::bench {
namespace {

/// Number of cases from which a study is run only if the filter names it, since it requires minutes and gigabytes.
constexpr std::size_t on_request = 100000;
/// Space on the disk for the result of a case: errors of 1024 vectors against three references, to compare repeats, are
/// 41 kB of text; the rest are 98 measures [bytes].
constexpr double bytes_per_case = 50e3;

/// Returns true if the disk has the space that a study needs, which is printed.
bool has_space(std::string const& folder, std::size_t cases) {
  double const needed = bytes_per_case * static_cast<double>(cases);
  double const available = static_cast<double>(std::filesystem::space(folder).available);
  std::fprintf(stderr, "study_without_work: %zu cases need %.1f GB in %s (TMPDIR), %.1f GB are free\n", cases,
               1e-9 * needed, folder.c_str(), 1e-9 * available);
  return available > needed;
}

/// Plans, runs, resumes and collects a study whose cases do no work but write a result of the usual size: 98 measures
/// and the errors of 1024 vectors. The time per case must not depend on their number, nor the memory on the results.
void study_without_work(benchmark::State& state) {
  auto const cases = static_cast<std::size_t>(state.range(0));
  if (cases >= on_request && benchmark::GetBenchmarkFilter().find(std::to_string(cases)) == std::string::npos) {
    state.SkipWithError("takes minutes; select it by --benchmark_filter=study_without_work/cases:100000");
    return;
  }
  for (auto _ : state) {
    TemporaryDirectory const folder;
    if (!has_space(folder.path(), cases)) {
      state.SkipWithError("the disk is too small");
      return;
    }
    test::StudyWithoutWork const study(folder.path(), cases, most_kept_vectors);
    auto const measure = [&](char const* stage, std::function<void()> const& work) {
      test::WorkCost const cost = test::run_in_process(work);
      if (cost.status != 0) state.SkipWithError(stage);
      state.counters[std::string(stage) + "_ms"] = 1e3 * cost.seconds / static_cast<double>(cases);
      state.counters[std::string(stage) + "_MB"] = 1e-6 * cost.bytes;
    };
    measure("plan", [&] { study.plan(); });
    measure("run", [&] { study.run(); });
    measure("resume", [&] { study.run(); });  // all cases are complete
    measure("collect", [&] { study.collect(); });
    if (!study.complete()) state.SkipWithError("the study is incomplete");
  }
}
BENCHMARK(study_without_work)
    ->ArgName("cases")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(on_request)
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace gladstone::bench
