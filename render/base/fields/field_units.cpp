#include "render/base/fields/field_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "render/base/units.h"

namespace gladstone {
namespace {

struct LengthName {
  std::string_view name;
  double metres;
};

constexpr std::array lengths{
    LengthName{"m", unit::metre},
    LengthName{"metre", unit::metre},
    LengthName{"meter", unit::metre},
    LengthName{"cm", 1e-2},
    LengthName{"centimetre", 1e-2},
    LengthName{"centimeter", 1e-2},
    LengthName{"mm", unit::millimetre},
    LengthName{"millimetre", unit::millimetre},
    LengthName{"millimeter", unit::millimetre},
    LengthName{"um", unit::micrometre},
    LengthName{"\u00b5m", unit::micrometre},  // U+00B5, micro sign
    LengthName{"\u03bcm", unit::micrometre},  // U+03BC, Greek letter mu
    LengthName{"micrometre", unit::micrometre},
    LengthName{"micrometer", unit::micrometre},
    LengthName{"micron", unit::micrometre},
    LengthName{"nm", unit::nanometre},
    LengthName{"nanometre", unit::nanometre},
    LengthName{"nanometer", unit::nanometre},
    LengthName{"in", 0.0254},
    LengthName{"inch", 0.0254},
    LengthName{"inches", 0.0254},
};

}  // namespace

std::string trimmed(std::string_view text) {
  constexpr std::string_view blanks(" \t\r\n\v\f\0", 7);
  std::size_t const first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

std::optional<double> unit_ratio(std::string_view from, std::string_view to) {
  if (from == to) return 1.0;
  double const size = length_unit(from), other = length_unit(to);
  if (!(size > 0 && other > 0)) return std::nullopt;
  return size / other;
}

double length_unit(std::string_view name) {
  std::string word = trimmed(name);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (bool const plural : {false, true}) {
    if (plural && word.size() > 3 && word.ends_with('s')) word.pop_back();
    auto const* const known =
        std::find_if(lengths.begin(), lengths.end(), [&word](LengthName const& one) { return one.name == word; });
    if (known != lengths.end()) return known->metres;
  }
  return 0.0;
}

double FieldUnits::metres() const {
  double const size = length_unit(length);
  return size > 0.0 ? size : unit::millimetre;
}

std::string FieldUnits::assumed() const {
  if (!spaced) return "the file gives no coordinates, and nodes are taken 1 mm apart";
  if (length.empty()) return "lengths name no unit and are taken as mm";
  if (length_unit(length) > 0.0) return {};
  return fmt::format("lengths are in \"{}\", which is no unit known here, and are taken as mm", length);
}

}  // namespace gladstone
