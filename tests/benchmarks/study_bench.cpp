#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "render/base/progress.h"
#include "studies/figures/temporary_directory.h"
#include "studies/sweep/case_locks.h"
#include "studies/sweep/collect.h"
#include "studies/sweep/plan.h"
#include "studies/sweep/run.h"
#include "studies/sweep/vector_errors.h"

namespace gladstone::bench {
namespace {

/// Largest memory of this process so far [MB].
double peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Plans, runs, resumes and collects a study whose cases do no work but write a result of the usual size: 98 measures
/// and the errors of 1024 vectors. The time per case must not depend on their number, nor the memory on the results.
void study_without_work(benchmark::State& state) {
  Progress::enable(false);
  auto const count = static_cast<std::size_t>(state.range(0));
  for (auto _ : state) {
    TemporaryDirectory const folder;
    auto const in = [&folder](char const* name) { return (std::filesystem::path(folder.path()) / name).string(); };
    std::ofstream(in("base.toml")) << "schema = 1\n";
    std::ofstream(in("study.toml")) << "base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [8, 16, "
                                    << count / 100 << "] }\n\"geometry.z_d_mm\" = { linear = [100, 300, 100] }\n";
    CaseResult result;
    for (int i = 0; i < 98; ++i) {
      result.measures.emplace_back("budget.terms.refraction.rms_px" + std::to_string(i), 1e-3 / 7);
    }
    for (std::string const& name : vector_error_names()) {
      result.vectors.push_back({name, std::vector<Vec2d>(most_kept_vectors, {0.012345, -0.054321})});
    }
    double const start = processor_seconds();
    write_plan(in("run"), plan_study(read_study(in("study.toml")), "cpu"));
    double const planned = processor_seconds();
    Manifest const cases = read_manifest(in("run"));
    {
      CaseLocks claims(in("run"), CaseLocks::Use::take);
      for (std::size_t index = 0; index < cases.size(); ++index) {
        ManifestCase const one = cases[index];
        if (read_result(in("run"), index, one.line_hash) || !claims.take(index)) state.SkipWithError("case not free");
        result.index = index;
        result.line_hash = one.line_hash;
        write_result(in("run"), result);
        claims.release(index);
      }
    }
    double const ran = processor_seconds(), memory_of_run = peak_memory();
    // Resume: nothing is left to compute.
    RunState const left = determine_run_state(in("run"), cases, selected_cases(cases.size(), {}));
    double const resumed = processor_seconds();
    if (!left.complete()) state.SkipWithError("the study is incomplete");
    if (collect_study(in("run")).rows.size() != count) state.SkipWithError("rows are missing");
    double const collected = processor_seconds(), each = 1e3 / static_cast<double>(count);
    state.counters["plan_ms"] = (planned - start) * each;
    state.counters["run_ms"] = (ran - planned) * each;
    state.counters["resume_ms"] = (resumed - ran) * each;
    state.counters["collect_ms"] = (collected - resumed) * each;
    state.counters["run_MB"] = memory_of_run;
    state.counters["collect_MB"] = peak_memory();
  }
}
BENCHMARK(study_without_work)
    ->ArgName("cases")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace gladstone::bench
