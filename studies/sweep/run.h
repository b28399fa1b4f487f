#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "studies/sweep/case_runner.h"

namespace gladstone {

/// Which cases of a study a runner is to see to, and how.
struct RunSelection {
  std::optional<std::string> only;    ///< these cases alone, as parse_case_list reads them; else all
  std::size_t shard = 0, shards = 1;  ///< the shard-th of that many equal pieces of them
  bool retry_failed = false;          ///< all failed cases are tried again, not only those that lacked memory
  bool keep_images = false;           ///< leave the whole CASE in RUN/cases/INDEX/
};

/// The cases of a selection of a study of so many, in the manifest's order. @throws DataError where it selects what is
/// not there
std::vector<std::size_t> selected_cases(std::size_t count, RunSelection const& selection);

/// How a selection stands.
struct RunState {
  std::size_t ok = 0;
  std::vector<CaseResult> failed;    ///< without their measures
  std::vector<std::size_t> missing;  ///< without a whole result
  std::vector<std::size_t> running;  ///< those of them that a runner has claimed
  bool complete() const { return failed.empty() && missing.empty(); }
};

/// Reads results and claims; computes nothing. @throws OutputError where the claims cannot be looked at
RunState state_of(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected);

/// Whether the next run computes a case with this result anew.
bool is_due(CaseResult const& result, RunSelection const& selection);

/// The CASE that a run with keep_images leaves of a case: RUN/cases/INDEX.
std::string images_folder(std::string const& run, std::size_t index);

/// Whether images are wanted of a finished case and not there: it is computed again for them.
bool lacks_images(std::string const& run, CaseResult const& result, RunSelection const& selection);

/// Takes the failures away that a run is to try again, before it begins: they are missing then, and computed once,
/// whatever number of workers it has. What another runner has claimed is left to it.
/// @return how the selection stands then; cases that lack images count as missing
/// @throws OutputError
RunState forget_failures(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected,
                         RunSelection const& selection);

/// Records that a case could not be computed, unless another runner has computed it or does so now.
/// @return whether it was recorded
/// @throws OutputError
bool record_failure(std::string const& run, Manifest const& cases, std::size_t index, std::string const& error,
                    bool again);

enum class CaseEvent { begun, finished };

/// Computes what is missing of a selection, or lacks its images, one case after the other. Each case is claimed while
/// it is computed, and its result looked for again once it is; what another runner has claimed is waited for, and
/// computed here should that runner die.
/// @param first    position in `selected` to begin at, so that runners side by side meet late
/// @param tell     called before and after every case that is computed here
/// @throws as CaseRunner::run; what is finished stays
void run_cases(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected,
               RunSelection const& selection, CaseRunner& runner, std::size_t first,
               std::function<void(std::size_t index, CaseEvent event)> const& tell);

}  // namespace gladstone
