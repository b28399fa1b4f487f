#include <fmt/format.h>

#include "render/base/error.h"
#include "studies/case/warning_log.h"
#include "studies/compare/sequence.h"

namespace gladstone::inline compare {

void report_sequence(SequenceResult const& result, std::string const& folder) {
  constexpr std::size_t most_named = 20;
  std::size_t failed = 0;
  for (PairRecord const& record : result.pairs) {
    if (record.error.empty() || ++failed > most_named) continue;
    log_warning({WarningCode::failed, record.pair.vectors, record.error});
  }
  if (failed > most_named)
    log_warning({WarningCode::failed, "",
                 fmt::format("{} further pairs failed; sequence.json lists them", failed - most_named)});
  if (result.count(PairState::done) == 0)
    throw DataError(ErrorCode::undetermined, folder,
                    fmt::format("all {} pairs failed; the first: {}", result.pairs.size(), result.pairs.front().error));
  log_warnings(result.warnings);
}

}  // namespace gladstone::inline compare
