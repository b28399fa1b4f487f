#include "render/optics/glass_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/base/text_encoding.h"
#include "render/base/text_file.h"
#include "render/base/units.h"
#include "render/optics/shipped_glasses.h"

namespace gladstone {
namespace {

constexpr std::size_t most_coefficients = 10;
constexpr double same_index = 1e-4;  // [1]; glasses of one name that differ by less are the same for a ray

/// Names are compared in capitals and without hyphens: NBK7 is N-BK7.
std::string compared(std::string_view name) {
  std::string key;
  for (char const c : name) {
    if (c != '-') key.push_back(static_cast<char>(std::toupper(static_cast<unsigned char>(c))));
  }
  return key;
}

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

/// Reads the lines of one catalogue.
class AgfReader {
 public:
  AgfReader(std::string const& catalogue, std::string const& file) : catalogue_(catalogue), file_(file) {}

  void read_line(std::string_view line, int number) {
    number_ = number;
    std::vector<std::string_view> const words = words_of(line);
    if (words.empty()) return;
    if (words[0] == "NM") {
      finish();
      need(words, 3, "a name and the number of a dispersion formula");
      double const formula = number_in(words[2]);
      if (!(formula >= 1 && formula <= dispersion_formulas && formula == std::floor(formula))) {
        fail(fmt::format("dispersion formula {} is not known (1 to {} are)", words[2], dispersion_formulas));
      }
      open_ = true;
      named_at_ = number;
      glass_ = {};
      glass_.name = words[1];
      glass_.catalogue = catalogue_;
      glass_.formula = static_cast<DispersionFormula>(static_cast<int>(formula));
      return;
    }
    if (!open_) return;
    if (words[0] == "CD") {
      for (std::size_t i = 1; i < std::min(words.size(), most_coefficients + 1); ++i) {
        glass_.coefficients.push_back(number_in(words[i]));
      }
    } else if (words[0] == "LD") {
      need(words, 3, "the shortest and longest wavelength");
      glass_.shortest = number_in(words[1]) * unit::micrometre;
      glass_.longest = number_in(words[2]) * unit::micrometre;
    } else if (words[0] == "IT" && words.size() >= 4) {  // some catalogues leave the share out where they have none
      Glass::Transmission const t{number_in(words[1]) * unit::micrometre, number_in(words[2]),
                                  number_in(words[3]) * unit::millimetre};
      if (!(t.thickness > 0) || !(t.transmission >= 0 && t.transmission <= 1)) {
        fail("an internal transmission is not a share of light and a positive thickness");
      }
      glass_.transmission.push_back(t);
    }
  }

  std::vector<Glass> finished() {
    finish();
    return std::move(glasses_);
  }

 private:
  void finish() {
    if (!open_) return;
    open_ = false;
    number_ = named_at_;
    if (glass_.coefficients.empty()) fail(fmt::format("glass {} has no coefficients (a line CD)", glass_.name));
    if (!(glass_.shortest > 0 && glass_.longest > glass_.shortest)) {
      fail(fmt::format("glass {} has no range of wavelengths (a line LD)", glass_.name));
    }
    for (double const wavelength : {glass_.shortest, 0.5 * (glass_.shortest + glass_.longest), glass_.longest}) {
      double const index = glass_.index(wavelength);
      if (index > 1 && index < 5) continue;
      fail(
          fmt::format("glass {} has index {:.4g} at {:.4g} nm, which no glass has (are its coefficients those of "
                      "formula {}?)",
                      glass_.name, index, wavelength / unit::nanometre, static_cast<int>(glass_.formula)));
    }
    std::sort(glass_.transmission.begin(), glass_.transmission.end(),
              [](auto const& a, auto const& b) { return a.wavelength < b.wavelength; });
    glasses_.push_back(std::move(glass_));
  }

  void need(std::vector<std::string_view> const& words, std::size_t count, char const* what) const {
    if (words.size() < count) fail(fmt::format("a line {} needs {}", words[0], what));
  }
  double number_in(std::string_view word) const {
    double value = 0;
    std::string_view const digits = word.starts_with('+') ? word.substr(1) : word;
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      fail(fmt::format("\"{}\" is not a finite number", word.substr(0, 40)));
    }
    return value;
  }
  [[noreturn]] void fail(std::string const& message) const {
    throw DataError(fmt::format("{}:{}", file_, number_), message);
  }

  std::string catalogue_, file_;
  std::vector<Glass> glasses_;
  Glass glass_;
  bool open_ = false;
  int number_ = 0, named_at_ = 0;
};

}  // namespace

void GlassCatalogue::add(std::string_view text, std::string const& catalogue, std::string const& file) {
  AgfReader reader(catalogue, file);
  int number = 0;
  while (!text.empty()) {
    std::size_t const end = std::min(text.find('\n'), text.size());
    reader.read_line(text.substr(0, end), ++number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  std::vector<Glass> added = reader.finished();
  if (added.empty()) throw DataError(file, "holds no glass (a catalogue in the AGF format has lines NM, CD and LD)");
  glasses_.insert(glasses_.end(), std::make_move_iterator(added.begin()), std::make_move_iterator(added.end()));
}

void GlassCatalogue::add_file(std::string const& path) {
  add(decoded_text(read_text_file(path), path), compared(std::filesystem::path(path).stem().string()), path);
}

GlassCatalogue const& GlassCatalogue::shipped() {
  static GlassCatalogue const catalogue = [] {
    GlassCatalogue all;
    for (auto const& [name, text] : shipped_glasses()) all.add(text, compared(name), "data/glasses/" + name + ".agf");
    return all;
  }();
  return catalogue;
}

std::string GlassCatalogue::glasses_like(std::string_view name) const {
  constexpr std::size_t most = 5, half = 2;  // names are short: half of one may differ
  std::string const key = compared(name);
  std::vector<std::string> keys;
  // an older glass of lead, "SF6", often lives on without it, "N-SF6"
  for (Glass const& glass : glasses_) {
    std::string const other = compared(glass.name);
    if (other == std::string("N").append(key) || std::string("N").append(other) == key) keys.push_back(other);
  }
  std::vector<std::string> all;
  for (Glass const& glass : glasses_) all.push_back(compared(glass.name));
  for (std::string const& near : nearest_names(key, all, most, half)) keys.push_back(near);
  std::vector<std::string> names;
  for (std::string const& near : keys) {
    for (Glass const& glass : glasses_) {
      std::string const full = fmt::format("{}:{}", glass.catalogue, glass.name);
      bool const known = std::find(names.begin(), names.end(), full) != names.end();
      if (names.size() < most && compared(glass.name) == near && !known) names.push_back(full);
    }
  }
  return names.empty() ? "" : "; did you mean " + quoted_list(names) + '?';
}

std::vector<Glass const*> GlassCatalogue::named(std::string_view name, std::string_view catalogue) const {
  std::string const key = compared(name), owner = compared(catalogue);
  std::vector<Glass const*> found;
  for (Glass const& glass : glasses_) {
    if (compared(glass.name) == key && (owner.empty() || glass.catalogue == owner)) found.push_back(&glass);
  }
  return found;
}

Glass const& GlassCatalogue::find(std::string_view name, double wavelength, std::string const& where) const {
  std::string_view own = name;
  std::vector<Glass const*> found = named(name, "");  // the whole name first: F_SILICA names no catalogue
  if (auto const colon = name.find(':'); found.empty() && colon != std::string_view::npos) {
    own = name.substr(colon + 1);
    found = named(own, name.substr(0, colon));
  } else if (auto const bar = name.rfind('_'); found.empty() && bar != std::string_view::npos) {
    own = name.substr(0, bar);
    found = named(own, name.substr(bar + 1));
  }
  if (found.empty()) {
    throw DataError(where, fmt::format("glass \"{}\" is in no catalogue ({} glasses are known){}; add its catalogue "
                                       "(AGF) to the setup's lens.glasses = [\"FILE.agf\"] (of info lens: --glass), or "
                                       "give a lens its index",
                                       name, glasses_.size(), glasses_like(own)));
  }
  for (Glass const* glass : found) {
    if (wavelength >= glass->shortest && wavelength <= glass->longest) continue;
    throw DataError(where,
                    fmt::format("glass {} is described from {:.4g} to {:.4g} nm, not at {:.4g} nm; choose another "
                                "wavelength or glass",
                                glass->name, glass->shortest / unit::nanometre, glass->longest / unit::nanometre,
                                wavelength / unit::nanometre));
  }
  std::string candidates;
  for (Glass const* glass : found)
    candidates += fmt::format("{}{}:{}", candidates.empty() ? "" : ", ", glass->catalogue, glass->name);
  for (Glass const* glass : found) {
    if (std::abs(glass->index(wavelength) - found.front()->index(wavelength)) <= same_index) continue;
    throw DataError(where, fmt::format("glass \"{}\" is ambiguous (it may be {}, of different index); name one of them",
                                       name, candidates));
  }
  return *found.front();
}

}  // namespace gladstone
