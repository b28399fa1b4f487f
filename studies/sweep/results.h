#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/base/warning.h"
#include "studies/sweep/manifest.h"
#include "studies/sweep/vector_errors.h"

namespace gladstone::inline sweep {

/// Status of a case.
enum class CaseStatus { ok, failed, missing };
char const* to_string(CaseStatus status);

/// Result of one case, stored in RUN/cases/INDEX.json.
struct CaseResult {
  std::size_t index = 0;
  std::string line_hash;               ///< hash of the manifest line of the case
  CaseStatus status = CaseStatus::ok;  ///< ok or failed
  std::string error;                   ///< error message of a failed case
  /// true: the case failed because of insufficient memory, and the next run repeats it
  bool again = false;
  /// true: only the images were computed (CaseParts::images), no vectors and no measures of errors
  bool pairs_only = false;
  /// Measures by name: the numbers of errors.json by dotted path, and others; NaN: unknown.
  std::vector<std::pair<std::string, double>> measures;
  /// Errors of each kind at individual vectors, in the order of vector_error_names(); used to compare repeats.
  std::vector<VectorErrors> vectors;
  Warnings warnings;
  double seconds_render = 0, seconds_correlate = 0, seconds_compare = 0;
  std::string device;
  std::string build;  ///< build_text() of the gladstone build that computed it; empty: unknown
};

/// Creates the result of a case that could not be computed.
CaseResult failed_case(std::size_t index, std::string line_hash, std::string device, std::string error, bool again);

/// Returns RUN/cases/INDEX.json.
std::string result_path(std::string const& run, std::size_t index);

/// Formats a result file: a JSON object whose first member is the content_hash() of everything after it.
std::string result_text(CaseResult const& result);

/// Part of a result to be parsed: the head (status and messages), or everything including the numbers, which takes
/// longer.
enum class ResultPart { head, all };

/// Parses a result file; returns nullopt if it is truncated or damaged. The hash always covers the whole file.
/// @param path  for messages
/// @throws DataError if it is an intact result of another version, which is not recomputed without the user's request
std::optional<CaseResult> parse_result(std::string const& text, std::string const& path,
                                       ResultPart part = ResultPart::all);

/// Reads the result of a case. Returns nullopt if there is none, or if it is unreadable, damaged or belongs to another
/// manifest line.
/// @param line_hash  hash of the case's manifest line
/// @throws DataError if the result is of another version, or the path is not a regular file
std::optional<CaseResult> read_result(std::string const& run, std::size_t index, std::string const& line_hash,
                                      ResultPart part = ResultPart::all);

/// Returns true if a result file of the case exists, whether intact or not.
bool has_result(std::string const& run, std::size_t index);

/// Removes the result of a case. @pre the caller has claimed the case @throws OutputError
void remove_result(std::string const& run, std::size_t index);

/// Writes a result atomically, by renaming a temporary file. @pre the caller has claimed the case, so that no other
/// process writes it
/// @throws OutputError (full disk, ...); no partial file remains
void write_result(std::string const& run, CaseResult const& result);

/// Removes the temporary files of processes that were killed while writing results.
void remove_abandoned_results(std::string const& run);

}  // namespace gladstone::inline sweep
