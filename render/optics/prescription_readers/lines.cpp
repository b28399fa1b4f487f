#include "render/optics/prescription_readers/lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/glass.h"

namespace gladstone::inline optics {

namespace {

std::optional<double> finite_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  bool const whole = error == std::errc() && end == word.data() + word.size() && !word.empty();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

bool are_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

double PrescriptionLine::number(std::size_t i) const {
  if (i >= words.size())
    throw DataError(ErrorCode::syntax, where, fmt::format("{} needs {} values; the line is cut short", words[0], i));
  if (auto const value = finite_number(words[i])) return *value;
  throw DataError(ErrorCode::syntax, where,
                  fmt::format("{}: \"{}\" is not a finite number", words[0], words[i].substr(0, 40)));
}

double PrescriptionLine::number_or_infinity(std::size_t i) const {
  if (i < words.size()) {
    std::string const word = upper_case(words[i]);
    bool const sign = word.starts_with('-') || word.starts_with('+');
    std::string_view const size = std::string_view(word).substr(sign ? 1 : 0);
    if (size == "INF" || size == "INFINITY") return word.starts_with('-') ? -HUGE_VAL : HUGE_VAL;
  }
  return number(i);
}

std::optional<double> PrescriptionLine::optional_number(std::size_t i) const {
  return i < words.size() ? finite_number(words[i]) : std::nullopt;
}

bool PrescriptionLine::has_nonzero_number() const {
  return std::any_of(words.begin() + 1, words.end(),
                     [](std::string const& word) { return finite_number(word).value_or(0) != 0; });
}

std::string describe_wavelength_fault(double value, double unit, std::string_view unit_name) {
  double const shortest = 100 * unit::nanometre / unit, longest = 20 * unit::micrometre / unit;
  auto const is_plausible = [&](double wavelength) { return wavelength >= shortest && wavelength <= longest; };
  if (is_plausible(value)) return "";
  std::string remedy = "correct it";
  for (double const factor : {1e3, 1e-3, 1e6, 1e9}) {
    if (!is_plausible(factor * value)) continue;
    remedy = fmt::format("is {:.6g} {} meant?", factor * value, unit_name);
    break;
  }
  return fmt::format("is outside the range of wavelengths, {:.6g} to {:.6g} {}; {}", shortest, longest, unit_name,
                     remedy);
}

void set_primary_wavelength(Prescription& lens, ListedWavelength const* primary, double unit,
                            std::string_view unit_name, std::string const& where, char const* commands) {
  if (primary && primary->value != 0) {
    std::string const fault = describe_wavelength_fault(primary->value, unit, unit_name);
    if (!fault.empty()) {
      throw DataError(ErrorCode::out_of_range, primary->where,
                      fmt::format("a wavelength of {:.6g} {} {}", primary->value, unit_name, fault));
    }
    lens.primary_wavelength = primary->value * unit;
    return;
  }
  lens.warnings.push_back({WarningCode::assumed, primary ? primary->where : where,
                           fmt::format("the file gives no primary wavelength ({}); {:.7g} nm (the d line) is used "
                                       "unless another wavelength is chosen",
                                       commands, spectral_line::d / unit::nanometre)});
}

std::string replace_decimal_commas(std::vector<std::string>& words) {
  std::string first;
  for (std::size_t i = 1; i < words.size(); ++i) {
    std::size_t const comma = words[i].find(',');
    if (comma == std::string::npos || words[i].find('.') != std::string::npos) continue;
    std::string with_point = words[i];
    with_point[comma] = '.';
    if (!are_digits(std::string_view(with_point).substr(comma + 1, 1)) || !finite_number(with_point)) continue;
    if (first.empty()) first = words[i];
    words[i] = with_point;
  }
  return first;
}

bool is_index_relative_to_air(double n) { return n >= 0.9996 && n < 5; }

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::optional<PrescribedMedium> read_glass_code(std::string_view word) {
  auto const described = [](std::optional<double> nd, std::optional<double> vd) -> std::optional<PrescribedMedium> {
    if (!nd || !vd) return std::nullopt;
    if (*vd == 0 || *nd <= 1) return PrescribedMedium{PrescribedMedium::Index{*nd}};
    return PrescribedMedium{PrescribedMedium::Described{*nd, *vd}};
  };
  if (auto const colon = word.find(':'); colon != std::string_view::npos) {
    return described(finite_number(word.substr(0, colon)), finite_number(word.substr(colon + 1)));
  }
  auto const point = word.find('.');
  bool const pointed = point != std::string_view::npos;
  std::string_view const index = word.substr(0, pointed ? point : word.size() / 2);
  std::string_view const abbe = word.substr(pointed ? point + 1 : word.size() / 2);
  if (!are_digits(index) || !are_digits(abbe) || index.size() < 3 || abbe.size() < 2) return std::nullopt;
  return described(finite_number(fmt::format("1.{}", index)),
                   finite_number(fmt::format("{}.{}0", abbe.substr(0, 2), abbe.substr(2))));
}

int PrescriptionLine::integer(std::size_t i) const {
  double const value = number(i);
  if (value != std::floor(value) || std::abs(value) > 1e6) {
    throw DataError(ErrorCode::syntax, where, fmt::format("{}: \"{}\" is not a whole number", words[0], words[i]));
  }
  return static_cast<int>(value);
}

std::vector<std::string> quoted_words(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos;
       at = line.find_first_not_of(" \t", at)) {
    bool const quoted = line[at] == '"' || line[at] == '\'';
    std::size_t const begin = quoted ? at + 1 : at;
    std::size_t end = quoted ? line.find(line[at], begin) : line.find_first_of(" \t", begin);
    if (end == std::string_view::npos) end = line.size();
    words.emplace_back(line.substr(begin, end - begin));
    at = std::min(quoted ? end + 1 : end, line.size());
  }
  return words;
}

}  // namespace gladstone::inline optics
