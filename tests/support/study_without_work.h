#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "studies/sweep/collect.h"
#include "studies/sweep/plan.h"
#include "studies/sweep/run.h"

namespace gladstone::test {

/// Processor time and additional memory of a piece of work.
struct WorkCost {
  double seconds = 0;
  double bytes = 0;  ///< growth of the resident memory from the start of the work to its maximum
  int status = 0;    ///< status of the process, as returned by waitpid(); 0: the work was completed
};

/// Runs work on one thread of a new process, so that memory used before does not count.
inline WorkCost run_in_process(std::function<void()> const& work) {
  int ends[2];
  if (::pipe(ends) != 0) return {.status = -1};
  pid_t const child = ::fork();
  if (child == 0) {
    set_thread_count(1);
    Progress::enable(false);
    long pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    int code = 1;
    try {
      work();
      code = 0;
    } catch (std::exception const& error) {
      std::fprintf(stderr, "%s\n", error.what());
    }
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    WorkCost const cost{static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec),
                        1024.0 * static_cast<double>(usage.ru_maxrss) -
                            static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE))};
    bool const told = ::write(ends[1], &cost, sizeof cost) == sizeof cost;
    ::_exit(told ? code : 1);
  }
  ::close(ends[1]);
  WorkCost cost;
  bool const told = ::read(ends[0], &cost, sizeof cost) == sizeof cost;
  ::close(ends[0]);
  ::waitpid(child, &cost.status, 0);
  if (!told && cost.status == 0) cost.status = -1;
  return cost;
}

/// Study whose cases take no time: planned, run and collected by the functions of `gladstone sweep`, with results that
/// depend on the case only. A result has as many measures as that of a BOS case with its error budget.
class StudyWithoutWork {
 public:
  static constexpr std::size_t measures = 98;

  /// @param folder   existing folder for study.toml, base.toml and run/
  /// @param cases    a multiple of 100
  /// @param vectors  vectors in each result; a case stores at most most_kept_vectors
  StudyWithoutWork(std::string const& folder, std::size_t cases, std::size_t vectors)
      : folder_(folder), vectors_(vectors) {
    std::ofstream(folder_ / "base.toml") << "schema = 1\n";
    std::ofstream(folder_ / "study.toml") << "base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [8, 16, "
                                          << cases / 100 << "] }\n\"geometry.z_d_mm\" = { linear = [100, 300, 100] }\n";
  }

  std::string run_folder() const { return (folder_ / "run").string(); }

  void plan() const { write_plan(run_folder(), plan_study(read_study((folder_ / "study.toml").string()), "cpu")); }

  /// Computes the missing cases, as a worker of `gladstone sweep run` does.
  /// @param start     fraction of the cases at which to start
  /// @param computing  called when a case has been claimed, before its result exists
  /// @param computed  called when its result has been written, while it is still claimed
  void run(double start = 0, std::function<void(std::size_t index)> const& computing = {},
           std::function<void(std::size_t index)> const& computed = {}) const {
    Manifest const cases = read_manifest(run_folder());
    std::vector<std::size_t> const selected = selected_cases(cases.size(), {});
    auto const compute = [&](ManifestCase const& one, std::string const&, CaseParts) {
      if (computing) computing(one.index);
      return result_of(one);
    };
    auto const tell = [&](std::size_t index, CaseEvent event) {
      if (computed && event == CaseEvent::finished) computed(index);
    };
    auto const first = static_cast<std::size_t>(start * static_cast<double>(selected.size()));
    run_cases(run_folder(), cases, selected, {}, compute, first, tell);
  }

  /// Returns true if all cases have intact results.
  bool complete() const {
    Manifest const cases = read_manifest(run_folder());
    return determine_run_state(run_folder(), cases, selected_cases(cases.size(), {})).complete();
  }

  /// Writes the tables. @return number of rows
  std::size_t collect() const { return collect_study(run_folder()).rows.size(); }

 private:
  CaseResult result_of(ManifestCase const& one) const {
    CaseResult result;
    result.index = one.index;
    result.line_hash = one.line_hash;
    result.device = one.device;
    double const number = static_cast<double>(one.index) / 7;
    for (std::size_t i = 0; i < measures; ++i) {
      result.measures.emplace_back(std::string("budget.terms.term_").append(std::to_string(i)).append(".rms_px"),
                                   number + static_cast<double>(i));
    }
    for (std::string const& name : vector_error_names()) {
      result.vectors.push_back({name, std::vector<Vec2d>(vectors_, {0.012345, -0.054321})});
    }
    return result;
  }

  std::filesystem::path folder_;
  std::size_t vectors_;
};

}  // namespace gladstone::test
