#include "render/files/fields/field_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "render/base/text.h"
#include "render/base/units.h"

namespace gladstone::inline files {
namespace {

/// Name of a unit, its size in SI units and its dimension.
struct UnitName {
  std::string_view name;
  double size;
  Dimension dimension;
};

constexpr Dimension mass{1, 0, 0}, time_span{0, 0, 1}, volume{0, 3, 0};

constexpr std::array unit_names{
    UnitName{"km", 1e3, dimension_of_length},
    UnitName{"kilometre", 1e3, dimension_of_length},
    UnitName{"kilometer", 1e3, dimension_of_length},
    UnitName{"m", unit::metre, dimension_of_length},
    UnitName{"metre", unit::metre, dimension_of_length},
    UnitName{"meter", unit::metre, dimension_of_length},
    UnitName{"dm", 1e-1, dimension_of_length},
    UnitName{"cm", 1e-2, dimension_of_length},
    UnitName{"centimetre", 1e-2, dimension_of_length},
    UnitName{"centimeter", 1e-2, dimension_of_length},
    UnitName{"mm", unit::millimetre, dimension_of_length},
    UnitName{"millimetre", unit::millimetre, dimension_of_length},
    UnitName{"millimeter", unit::millimetre, dimension_of_length},
    UnitName{"um", unit::micrometre, dimension_of_length},
    UnitName{"\u00b5m", unit::micrometre, dimension_of_length},  // U+00B5, micro sign
    UnitName{"\u03bcm", unit::micrometre, dimension_of_length},  // U+03BC, Greek letter mu
    UnitName{"micrometre", unit::micrometre, dimension_of_length},
    UnitName{"micrometer", unit::micrometre, dimension_of_length},
    UnitName{"micron", unit::micrometre, dimension_of_length},
    UnitName{"nm", unit::nanometre, dimension_of_length},
    UnitName{"nanometre", unit::nanometre, dimension_of_length},
    UnitName{"nanometer", unit::nanometre, dimension_of_length},
    UnitName{"in", 0.0254, dimension_of_length},
    UnitName{"inch", 0.0254, dimension_of_length},
    UnitName{"inches", 0.0254, dimension_of_length},
    UnitName{"ft", 0.3048, dimension_of_length},
    UnitName{"foot", 0.3048, dimension_of_length},
    UnitName{"feet", 0.3048, dimension_of_length},
    UnitName{"kg", 1, mass},
    UnitName{"kilogram", 1, mass},
    UnitName{"g", 1e-3, mass},
    UnitName{"gram", 1e-3, mass},
    UnitName{"mg", 1e-6, mass},
    UnitName{"lb", 0.45359237, mass},
    UnitName{"lbm", 0.45359237, mass},
    UnitName{"slug", 14.59390294, mass},
    UnitName{"l", 1e-3, volume},
    UnitName{"litre", 1e-3, volume},
    UnitName{"liter", 1e-3, volume},
    UnitName{"ml", 1e-6, volume},
    UnitName{"cc", 1e-6, volume},
    UnitName{"s", 1, time_span},
    UnitName{"sec", 1, time_span},
    UnitName{"second", 1, time_span},
    UnitName{"ms", 1e-3, time_span},
    UnitName{"us", 1e-6, time_span},
    UnitName{"min", 60, time_span},
    UnitName{"h", 3600, time_span},
    UnitName{"ppm", 1e-6, dimension_of_numbers},
};

/// Finds a unit by its name in the singular or plural.
std::optional<UnitName> find_unit(std::string const& written) {
  if (written == "Mg") return UnitName{"Mg", 1e3, mass};  // a milligram is "mg"
  std::string word = lower_case(written);
  for (bool const plural : {false, true}) {
    if (plural && word.size() > 3 && word.ends_with('s')) word.pop_back();
    auto const* const known =
        std::find_if(unit_names.begin(), unit_names.end(), [&word](UnitName const& one) { return one.name == word; });
    if (known != unit_names.end()) return *known;
  }
  return std::nullopt;
}

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    bool const found = text.substr(at).starts_with(from);
    result += found ? to : text.substr(at, 1);
    at += found ? from.size() : 1;
  }
  return result;
}

/// Removes brackets around a unit and writes its superscripts and products in ASCII.
std::string plain_unit(std::string_view written) {
  std::string text = trimmed(written);
  bool const bracketed =
      text.size() > 2 && ((text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')'));
  if (bracketed) text = trimmed(std::string_view(text).substr(1, text.size() - 2));
  text = replaced(text, "\u00b9", "1");
  text = replaced(text, "\u00b2", "2");
  text = replaced(text, "\u00b3", "3");
  text = replaced(text, "\u207b", "-");
  text = replaced(text, "\u00b7", " ");
  text = replaced(text, "**", "^");
  return text;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (static_cast<unsigned char>(c) > 127);
}

/// Parses a product of numbers and names with exponents; each "/" inverts the factor that follows it.
std::optional<UnitName> parse_unit(std::string_view written) {
  std::string const text = plain_unit(written);
  UnitName product{"", 1, {}};
  int sign = 1;
  bool any = false;
  for (std::size_t at = 0; at < text.size();) {
    char const c = text[at];
    if (c == '/') sign = -1;
    if (c == '/' || c == ' ' || c == '*' || c == '.' || c == '-') {
      ++at;
      continue;
    }
    char const* const end = text.data() + text.size();
    any = true;
    if (is_digit(c)) {
      double number = 0;
      auto const parsed = std::from_chars(text.data() + at, end, number);
      if (parsed.ec != std::errc() || number == 0) return std::nullopt;
      product.size *= sign > 0 ? number : 1 / number;
      at = static_cast<std::size_t>(parsed.ptr - text.data());
      sign = 1;
      continue;
    }
    std::size_t last = at;
    while (last < text.size() && is_letter(text[last])) ++last;
    if (last == at) return std::nullopt;
    auto const factor = find_unit(text.substr(at, last - at));
    if (!factor) return std::nullopt;
    int exponent = 1;
    std::size_t digits = last;
    if (digits < text.size() && text[digits] == '^') ++digits;
    if (digits < text.size() && text[digits] == '+') ++digits;
    auto const parsed = std::from_chars(text.data() + digits, end, exponent);
    bool const powered = parsed.ec == std::errc();
    if (!powered && digits > last) return std::nullopt;
    at = powered ? static_cast<std::size_t>(parsed.ptr - text.data()) : last;
    if (std::abs(exponent) > 9) return std::nullopt;
    exponent *= sign;
    sign = 1;
    product.size *= std::pow(factor->size, exponent);
    product.dimension.mass += exponent * factor->dimension.mass;
    product.dimension.length += exponent * factor->dimension.length;
    product.dimension.time += exponent * factor->dimension.time;
  }
  if (!any) return std::nullopt;
  return product;
}

std::string unknown_length(std::string const& of, std::string const& unit) {
  return fmt::format("lengths{} are in \"{}\", which is not a known unit of length", of, unit);
}

}  // namespace

UnitSuffix unit_suffix(std::string_view name) {
  constexpr std::array suffixes{UnitSuffix{"_kg_m3", "kg/m^3"}, UnitSuffix{"_g_cm3", "g/cm^3"},
                                UnitSuffix{"_g_m3", "g/m^3"},   UnitSuffix{"_mm_s", "mm/s"},
                                UnitSuffix{"_cm_s", "cm/s"},    UnitSuffix{"_m_s", "m/s"}};
  std::string const lower = lower_case(name);
  auto const* const found = std::find_if(suffixes.begin(), suffixes.end(), [&](UnitSuffix const& one) {
    return lower.size() > one.ending.size() && lower.ends_with(one.ending);
  });
  return found == suffixes.end() ? UnitSuffix{} : *found;
}

bool states_unit(std::string_view text) {
  constexpr std::array<std::string_view, 8> absent{
      "", "1", "-", "none", "dimensionless", "unitless", "nondimensional", "n/a"};
  std::string const word = lower_case(trimmed(text));
  return std::find(absent.begin(), absent.end(), word) == absent.end();
}

std::optional<double> unit_size(std::string_view text, Dimension const& dimension) {
  auto const unit = parse_unit(text);
  if (!unit || !(unit->dimension == dimension)) return std::nullopt;
  return unit->size;
}

double length_unit(std::string_view name) { return unit_size(name, dimension_of_length).value_or(0.0); }

double FieldUnits::metres() const {
  double const size = length_unit(length);
  return size > 0.0 ? size : unit::millimetre;
}

std::string FieldUnits::assumed() const {
  if (!spaced) return "the file gives no coordinates that are known here, and nodes are taken 1 mm apart";
  return states_unit(length) ? "" : "lengths have no unit in the file and are taken as mm";
}

std::string FieldUnits::undefined() const {
  if (!unknown.empty()) return unknown;
  return spaced && states_unit(length) && length_unit(length) == 0.0 ? unknown_length("", length) : "";
}

ValueFactor FieldUnits::value_factor(Dimension const& dimension) const {
  if (!states_unit(values)) return {};
  if (auto const size = unit_size(values, dimension)) return {*size, ""};
  std::string const wanted = dimension == dimension_of_density    ? "of density, and are taken as kg/m^3"
                             : dimension == dimension_of_velocity ? "of velocity, and are taken as m/s"
                                                                  : "of pure numbers, and are taken as such";
  return {1, fmt::format("values are in \"{}\", which is not a known unit {}", values, wanted)};
}

void convert_lengths(StoredAxes& axes, std::array<std::optional<std::string>, 3> const& unit_of, FieldUnits& units,
                     Warnings& notes) {
  for (auto const& unit : unit_of) {
    if (unit && states_unit(*unit) && units.length.empty()) units.length = *unit;
  }
  double const common = length_unit(units.length);
  if (!(common > 0)) return;
  std::string without;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!unit_of[i]) continue;
    if (!states_unit(*unit_of[i])) {
      without += (without.empty() ? "" : ", ") + std::string(1, axes[i].world);
      continue;
    }
    double const size = length_unit(*unit_of[i]);
    if (!(size > 0)) {
      if (units.unknown.empty()) units.unknown = unknown_length(fmt::format(" along {}", axes[i].world), *unit_of[i]);
      continue;
    }
    double const ratio = *unit_of[i] == units.length ? 1 : size / common;
    axes[i].first *= ratio;
    axes[i].step *= ratio;
    for (double& place : axes[i].coordinates) place *= ratio;
  }
  if (!without.empty()) {
    notes.push_back(
        {WarningCode::assumed, "",
         fmt::format("lengths along {} name no unit and are taken to be in {}, as the others", without, units.length)});
  }
}

}  // namespace gladstone::inline files
