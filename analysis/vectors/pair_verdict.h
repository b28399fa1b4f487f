#pragma once

#include <string>
#include <string_view>

namespace gladstone::inline vectors {

/// Result of the assessment of an image pair, see assess_pair(). Programs inspect the kind, never the text.
struct PairVerdict {
  enum class Kind {
    not_tested,        ///< vectors of other programs, or of a method without an assessment
    correlates,        ///< at least one vector is valid or replaced
    uncorrelated,      ///< no vector with a signal correlates better than unrelated frames
    identical_frames,  ///< not judged: both frames are bitwise identical
    masked,            ///< not judged: all windows are masked
    no_signal,         ///< not judged: no window has a signal
    optical_flow,      ///< not judged: the method has no correlation
    few_windows,       ///< not judged: too few windows for the median test
    no_median_test,    ///< not judged: the median test is off
    periodic,          ///< not judged: the pattern is periodic
    no_valid_vector,   ///< not judged: no vector passed its tests
  };
  Kind kind = Kind::not_tested;
  double number = 0.0;  ///< few_windows: required number of windows [1]; periodic: period of the pattern [px]; else 0

  bool operator==(PairVerdict const&) const = default;
};

/// Returns the name of a kind, which files store: "uncorrelated"; empty for not_tested.
std::string_view verdict_code(PairVerdict::Kind kind);

/// Returns the kind of a name; not_tested if there is none.
PairVerdict::Kind find_verdict_kind(std::string_view code);

/// Returns the verdict of a text of verdict_text(), with the digits that the text shows of its number; not_tested for
/// any other text.
PairVerdict find_verdict(std::string_view text);

/// Words a verdict: "correlates", "does not correlate" or "not judged: REASON"; empty for not_tested.
std::string verdict_text(PairVerdict const& verdict);

}  // namespace gladstone::inline vectors
