#pragma once

#include <gmock/gmock.h>

#include <ostream>
#include <string>

#include "render/base/warning.h"

/// Matchers of warnings by code and place, so that the wording of texts is free:
/// EXPECT_THAT(lens.warnings, ElementsAre(Warns("assumed at open.zmx:14")));
namespace gladstone {

inline void PrintTo(Warning const& warning, std::ostream* out) {
  *out << warning_code_name(warning.code) << " at \"" << warning.place << "\": " << warning.text;
}

/// Returns "CODE at PLACE" with the name of the file without its folders; "CODE" without a place.
inline std::string code_and_place(Warning const& warning) {
  std::string const place = warning.place.substr(warning.place.rfind('/') + 1);
  return std::string(warning_code_name(warning.code)) + (place.empty() ? "" : " at " + place);
}

/// Matches a warning by its code_and_place().
inline auto Warns(std::string const& code_at_place) {
  return testing::ResultOf([](Warning const& warning) { return code_and_place(warning); }, code_at_place);
}

/// Matches a warning whose text also matches: where the test is about a number or a name.
template <class Text>
auto Warns(std::string const& code_at_place, Text const& text) {
  return testing::AllOf(Warns(code_at_place), testing::Field("text", &Warning::text, text));
}

}  // namespace gladstone
