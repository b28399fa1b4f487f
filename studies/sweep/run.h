#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "studies/sweep/case_runner.h"

namespace gladstone::inline sweep {

/// Selection of the cases that a run computes, and options of their computation.
struct RunSelection {
  std::optional<std::string> only;    ///< list of cases in the format of parse_case_list(); nullopt: all
  std::size_t shard = 0, shards = 1;  ///< index of this run's part of the selection, and number of (equal) parts
  /// Repeat all failed cases, not only those that failed because of insufficient memory.
  bool retry_failed = false;
  bool keep_images = false;  ///< write all files of a case to RUN/cases/INDEX/
  bool pairs_only = false;   ///< compute only the images of a case, which are kept; implies keep_images
};

/// Returns the selected cases of a study with `count` cases, in the manifest's order.
/// @throws DataError if the selection contains a case that does not exist
std::vector<std::size_t> selected_cases(std::size_t count, RunSelection const& selection);

/// State of the selected cases.
struct RunState {
  std::size_t ok = 0;
  std::vector<CaseResult> failed;       ///< results of the failed cases, without measures
  std::vector<std::size_t> missing;     ///< cases without an intact result
  std::vector<std::size_t> running;     ///< subset of `missing` that a process has claimed
  std::vector<std::size_t> pairs_only;  ///< finished cases of which only the images were computed
  bool complete() const { return failed.empty() && missing.empty(); }
};

/// Determines the state from results and claims without computing anything. @throws OutputError if the claims cannot be
/// read
RunState determine_run_state(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected);

/// Returns true if the next run recomputes a case with this result.
bool needs_recomputation(CaseResult const& result, RunSelection const& selection);

/// Returns the folder in which a run with keep_images stores the files of a case: RUN/cases/INDEX.
std::string images_folder(std::string const& run, std::size_t index);

/// Returns true if the case is finished without parts that are requested, so that it must be recomputed: images that do
/// not exist, or vectors and errors of a case of which only the images were computed.
bool is_missing_parts(std::string const& run, CaseResult const& result, RunSelection const& selection);

/// Removes the results of the failed cases that a run will repeat. They are removed before the workers start, so that
/// each is recomputed once, regardless of the number of workers. Cases claimed by other processes are skipped.
/// @return state afterwards; cases without requested parts count as missing
/// @throws OutputError
RunState remove_failed_results(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected,
                               RunSelection const& selection);

/// Records that a case could not be computed, unless it has a result or another process has claimed it.
/// @return true if the failure was recorded
/// @throws OutputError
bool record_failure(std::string const& run, Manifest const& cases, std::size_t index, std::string const& error,
                    bool again);

enum class CaseEvent { begun, finished };

/// Computes a case, as CaseRunner::run.
/// @param keep  folder for the files of the case; empty: none
using CaseComputation = std::function<CaseResult(ManifestCase const& one, std::string const& keep, CaseParts parts)>;
inline CaseComputation computation_by(CaseRunner& runner) {
  return [&runner](ManifestCase const& one, std::string const& keep, CaseParts parts) {
    return runner.run(one, keep, {}, parts);
  };
}

/// Computes the cases of a selection that have no result or lack requested parts, one after the other. Each case is
/// claimed during its computation, and its result is checked again after claiming. Cases claimed by other processes are
/// waited for, and computed here if the other process dies.
/// @param first  position in `selected` at which to start, so that concurrent processes start at different cases
/// @param tell   called before and after every case that is computed here
/// @throws as `compute`; finished results remain
void run_cases(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected,
               RunSelection const& selection, CaseComputation const& compute, std::size_t first,
               std::function<void(std::size_t index, CaseEvent event)> const& tell);

}  // namespace gladstone::inline sweep
