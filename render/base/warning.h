#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gladstone::inline base {

/// Kind of a warning. `code` in the JSON of --json and of the Python warnings is its name; docs/reference/errors.md
/// lists them.
enum class WarningCode {
  assumed,       ///< a unit, order or value that an input does not state, and that was assumed
  ignored,       ///< a part of an input, or a setting, that has no effect
  approximated,  ///< an effect that is neglected or approximated
  inconsistent,  ///< inputs that contradict each other, of which one is used
  implausible,   ///< a value outside the usual range, or data that suggest another unit, quantity, axis or sign
  incomplete,    ///< an input that is cut short, damaged or lacks data; the rest is used
  excluded,      ///< pixels, dots or vectors that are excluded from the result
  low_accuracy,  ///< an error or standard error that exceeds its goal
  out_of_view,   ///< dots or particles that are not imaged
  exposure,      ///< images with saturated pixels, or with too little light
  unsuitable,    ///< a set-up or setting with which the measurement becomes inaccurate, such as small dot images
  unreliable,    ///< a result that is probably wrong, such as vectors of frames that do not correlate
  failed,        ///< a part of the work that failed, such as a pair, a figure or a worker; the other parts are complete
  obsolete,      ///< a key or value that is still accepted but has no effect
  other,         ///< a warning of a file by an earlier version, which has no code
};

/// A warning is a record of code, place and text; programs inspect the code and the place, never the text.
struct Warning {
  WarningCode code;
  std::string place;  ///< file, "file:line", key path of a setup, or name of another input or output; may be empty
  std::string text;

  bool operator==(Warning const&) const = default;
};

using Warnings = std::vector<Warning>;

/// Returns the name of a code: "low_accuracy".
std::string_view warning_code_name(WarningCode code);

/// Returns the code of a name; `other` if there is none.
WarningCode find_warning_code(std::string_view name);

/// Returns "PLACE: TEXT".
std::string to_string(Warning const& warning);

/// Returns "PLACE: TEXT" of each warning.
std::vector<std::string> to_strings(Warnings const& warnings);

/// Returns a warning with another place, which precedes the previous one: "OUTER: PLACE".
Warning at_place(std::string const& outer, Warning warning);

}  // namespace gladstone::inline base
