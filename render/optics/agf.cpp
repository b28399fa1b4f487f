#include "render/optics/agf.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "render/base/units.h"

namespace gladstone::inline optics {
namespace {

constexpr std::size_t most_coefficients = 10;

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0;;) {
    at = line.find_first_not_of(" \t", at);
    if (at == std::string_view::npos) return words;
    std::size_t const end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

/// Record of a catalogue: a line and its continuation lines.
struct AgfRecord {
  int line = 0;
  std::vector<std::string_view> words;
};

std::optional<double> number_in(std::string_view word) {
  double value = 0;
  std::string_view const digits = word.starts_with('+') ? word.substr(1) : word;
  auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  bool const whole = error == std::errc() && end == digits.data() + digits.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Reader of one AGF catalogue, line by line.
class AgfReader {
 public:
  explicit AgfReader(std::string const& catalogue) : catalogue_(catalogue) {}

  void read_line(std::string_view line, int number) {
    std::vector<std::string_view> const words = words_of(line);
    if (words.empty()) return;
    bool const goes_on = continues_record() && std::all_of(words.begin(), words.end(), number_in);
    if (goes_on) {
      record_.words.insert(record_.words.end(), words.begin(), words.end());
    } else {
      finish_record();
      record_ = {number, words};
    }
  }
  AgfContent finish() {
    finish_record();
    finish_glass();
    return std::move(content_);
  }

 private:
  /// Returns true if the current record consists of numbers, so that it may be continued on the next line.
  bool continues_record() const {
    if (record_.words.empty()) return false;
    static constexpr std::array numeric{"CD", "TD", "OD", "LD", "ED", "IT"};
    return std::find(numeric.begin(), numeric.end(), record_.words[0]) != numeric.end();
  }

  void finish_record() {
    AgfRecord const record = std::exchange(record_, {});
    if (record.words.empty()) return;
    if (record.words[0] == "NM") {
      finish_glass();
      begun_ = {record.line, ""};
      glass_.emplace();
      glass_->catalogue = catalogue_;
      glass_->where = std::to_string(record.line);
    }
    if (!glass_) return;
    try {
      read_record(record);
    } catch (AgfFault const& fault) {
      content_.left_out.push_back({glass_->name, fault});
      glass_.reset();
    }
  }

  void read_record(AgfRecord const& record) {
    std::vector<std::string_view> const& words = record.words;
    auto const number = [&](std::size_t i) {
      if (auto const value = number_in(words[i])) return *value;
      throw AgfFault{record.line, fmt::format("\"{}\" is not a finite number", words[i].substr(0, 40))};
    };
    auto const need = [&](std::size_t count, char const* what) {
      if (words.size() < count) throw AgfFault{record.line, fmt::format("a line {} needs {}", words[0], what)};
    };
    if (words[0] == "NM") {
      if (words.size() > 1) glass_->name = words[1];
      need(3, "a name and the number of a dispersion formula");
      double const formula = number(2);
      if (!(formula >= 1 && formula <= dispersion_formulas && formula == std::floor(formula))) {
        throw AgfFault{record.line,
                       fmt::format("unknown dispersion formula {} (known are 1 to {})", words[2], dispersion_formulas)};
      }
      glass_->formula = static_cast<DispersionFormula>(static_cast<int>(formula));
      if (words.size() > 4) glass_->printed_nd = number_in(words[4]).value_or(0);
    } else if (words[0] == "CD") {
      for (std::size_t i = 1; i < std::min(words.size(), most_coefficients + 1); ++i) {
        glass_->coefficients.push_back(number(i));
      }
    } else if (words[0] == "LD") {
      need(3, "the shortest and longest wavelength");
      glass_->shortest = number(1) * unit::micrometre;
      glass_->longest = number(2) * unit::micrometre;
    } else if (words[0] == "IT" && words.size() >= 4) {  // some catalogues omit the transmittance if it is unknown
      read_transmission(record);
    }
  }

  /// Reads a line IT. An invalid line is skipped, since it does not affect the path of rays.
  void read_transmission(AgfRecord const& record) {
    auto const at = number_in(record.words[1]), share = number_in(record.words[2]), thick = number_in(record.words[3]);
    if (at && share && thick && *at > 0 && *share >= 0 && *share <= 1 && *thick > 0) {
      glass_->transmission.push_back({*at * unit::micrometre, *share, *thick * unit::millimetre});
    } else {
      content_.skipped_lines.push_back({record.line, fmt::format("internal transmission of {}", glass_->name)});
    }
  }

  void finish_glass() {
    if (!glass_) return;
    Glass glass = std::move(*glass_);
    glass_.reset();
    std::string const fault = find_fault(glass);
    if (!fault.empty()) {
      content_.left_out.push_back({glass.name, {begun_.line, fault}});
      return;
    }
    std::sort(glass.transmission.begin(), glass.transmission.end(),
              [](auto const& a, auto const& b) { return a.wavelength < b.wavelength; });
    content_.glasses.push_back(std::move(glass));
  }

  /// Returns the reason why a glass is unusable, or an empty string. The index must be plausible at one end or in the
  /// middle of the range only, as some formulas have a pole at an end.
  static std::string find_fault(Glass const& glass) {
    if (glass.coefficients.empty()) return "it has no coefficients (a line CD)";
    if (!(glass.shortest > 0 && glass.longest > glass.shortest)) return "it has no range of wavelengths (a line LD)";
    double const middle = 0.5 * (glass.shortest + glass.longest);
    for (double const wavelength : {glass.shortest, middle, glass.longest}) {
      if (is_index(glass.index(wavelength))) return "";
    }
    return fmt::format(
        "its index is {:.4g} at {:.4g} nm, which no glass has (are its coefficients those of formula {}?)",
        glass.index(middle), middle / unit::nanometre, static_cast<int>(glass.formula));
  }

  std::string catalogue_;
  AgfContent content_;
  AgfRecord record_;
  std::optional<Glass> glass_;
  AgfFault begun_{};
};

}  // namespace

AgfContent read_agf(std::string_view text, std::string const& catalogue, int first_line) {
  AgfReader reader(catalogue);
  for (int number = first_line; !text.empty(); ++number) {
    std::size_t const end = std::min(text.find('\n'), text.size());
    reader.read_line(text.substr(0, end), number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return reader.finish();
}

}  // namespace gladstone::inline optics
