#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/sweep/manifest.h"
#include "studies/sweep/vector_errors.h"

namespace gladstone {

/// What became of a case.
enum class CaseStatus { ok, failed, missing };
char const* to_string(CaseStatus status);

/// The result of one case: RUN/cases/INDEX.json.
struct CaseResult {
  std::size_t index = 0;
  std::string line_hash;                                 ///< of the manifest line that it belongs to
  CaseStatus status = CaseStatus::ok;                    ///< ok or failed
  std::string error;                                     ///< of a failed case
  std::vector<std::pair<std::string, double>> measures;  ///< errors.json flattened with dots, and more; NaN: unknown
  std::vector<VectorErrors> vectors;                     ///< by vector_error_names(); what repeats are compared by
  std::vector<std::string> warnings;
  double seconds_render = 0, seconds_correlate = 0, seconds_compare = 0;
  std::string device;
};

/// RUN/cases/INDEX.json
std::string result_path(std::string const& run, std::size_t index);

/// A result's whole file: a JSON object whose first member is the content_hash() of all that follows it.
std::string result_text(CaseResult const& result);

/// Nothing where the text is not a whole result: cut short or damaged.
/// @param path for messages
/// @throws DataError where it is a whole one of another version, which is no reason to compute anew unasked
std::optional<CaseResult> parse_result(std::string const& text, std::string const& path);

/// The result of a case; nothing where there is none, or none that is whole and belongs to this very line.
/// @throws DataError where it is of another version
std::optional<CaseResult> read_result(std::string const& run, ManifestCase const& one);

/// Puts a result in its place in one move. @pre the caller holds the case's claim, so that nobody else writes it
/// @throws OutputError (full disk, ...), with nothing left behind
void write_result(std::string const& run, CaseResult const& result);

}  // namespace gladstone
