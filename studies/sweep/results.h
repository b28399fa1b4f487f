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
  bool again = false;                                    ///< it failed for lack of memory: the next run tries again
  std::vector<std::pair<std::string, double>> measures;  ///< errors.json flattened with dots, and more; NaN: unknown
  std::vector<VectorErrors> vectors;                     ///< by vector_error_names(); what repeats are compared by
  std::vector<std::string> warnings;
  double seconds_render = 0, seconds_correlate = 0, seconds_compare = 0;
  std::string device;
  std::string build;  ///< build_text() of the gladstone that computed it; empty: unknown
};

/// What is recorded of a case that this gladstone could not compute.
CaseResult failed_case(std::size_t index, std::string line_hash, std::string device, std::string error, bool again);

/// RUN/cases/INDEX.json
std::string result_path(std::string const& run, std::size_t index);

/// A result's whole file: a JSON object whose first member is the content_hash() of all that follows it.
std::string result_text(CaseResult const& result);

/// How much of a result is wanted: what became of the case, or its numbers too, which take long to read.
enum class ResultPart { head, all };

/// Nothing where the text is not a whole result: cut short or damaged.
/// @param path for messages
/// @param part of it that is parsed; that it is whole is checked for all of it
/// @throws DataError where it is a whole one of another version, which is no reason to compute anew unasked
std::optional<CaseResult> parse_result(std::string const& text, std::string const& path,
                                       ResultPart part = ResultPart::all);

/// The result of a case; nothing where there is none, or none that can be read, is whole and belongs to this very line.
/// @param line_hash of the case's line in the manifest
/// @throws DataError where it is of another version, or a folder stands in its place
std::optional<CaseResult> read_result(std::string const& run, std::size_t index, std::string const& line_hash,
                                      ResultPart part = ResultPart::all);

/// Whether a file stands where the result of a case belongs, whole or not.
bool has_result(std::string const& run, std::size_t index);

/// Removes a case's result. @pre the caller holds the case's claim @throws OutputError
void remove_result(std::string const& run, std::size_t index);

/// Puts a result in its place in one move. @pre the caller holds the case's claim, so that nobody else writes it
/// @throws OutputError (full disk, ...), with nothing left behind
void write_result(std::string const& run, CaseResult const& result);

/// Removes the partial files of writers that were killed.
void remove_left_partials(std::string const& run);

}  // namespace gladstone
