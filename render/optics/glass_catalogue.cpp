#include "render/optics/glass_catalogue.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/base/text_encoding.h"
#include "render/base/text_file.h"
#include "render/base/units.h"
#include "render/optics/shipped_glasses.h"

namespace gladstone {
namespace {

constexpr std::size_t most_coefficients = 10;
constexpr double same_index = 1e-4;  // [1]; glasses of one name with a smaller difference are considered identical

/// Manufacturers in order of precedence, if several have a glass of the name and the lens file does not prefer any.
constexpr std::array makers{"SCHOTT", "OHARA", "HOYA", "HIKARI", "NIKON", "CDGM", "SUMITA", "CORNING"};

bool is_index(double n) { return n > 0.99 && n < 7; }  // plausible range, from air relative to air to infrared crystals

/// Returns the form in which names are compared: upper case, without hyphens. NBK7 equals N-BK7.
std::string compared(std::string_view name) {
  std::string key;
  for (char const c : name) {
    if (c != '-') key.push_back(static_cast<char>(std::toupper(static_cast<unsigned char>(c))));
  }
  return key;
}

/// Returns true if a catalogue has the given name or is an edition of it, such as SCHOTT_2017 or SCHOTT-NEW.
bool is_catalogue(std::string_view catalogue, std::string_view asked) {
  if (!catalogue.starts_with(asked)) return false;
  return catalogue.size() == asked.size() || std::isalpha(static_cast<unsigned char>(catalogue[asked.size()])) == 0;
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

/// Error in a line or a glass.
struct AgfFault {
  int line;
  std::string text;
};

/// Reader of one AGF catalogue. An error invalidates the glass that contains it, not the catalogue.
class AgfReader {
 public:
  struct LeftOut {
    std::string name;
    AgfFault fault;
  };

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
  void finish() {
    finish_record();
    finish_glass();
  }

  std::vector<Glass> glasses;
  std::vector<LeftOut> left_out;
  std::vector<AgfFault> passed_over;  ///< skipped lines of glasses that are used without them

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
      left_out.push_back({glass_->name, fault});
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
                       fmt::format("dispersion formula {} is not known (1 to {} are)", words[2], dispersion_formulas)};
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
      passed_over.push_back({record.line, fmt::format("internal transmission of {}", glass_->name)});
    }
  }

  void finish_glass() {
    if (!glass_) return;
    Glass glass = std::move(*glass_);
    glass_.reset();
    std::string const fault = fault_of(glass);
    if (!fault.empty()) {
      left_out.push_back({glass.name, {begun_.line, fault}});
      return;
    }
    std::sort(glass.transmission.begin(), glass.transmission.end(),
              [](auto const& a, auto const& b) { return a.wavelength < b.wavelength; });
    glasses.push_back(std::move(glass));
  }

  /// Returns the reason why a glass is unusable, or an empty string. The index must be plausible at one end or in the
  /// middle of the range only, as some formulas have a pole at an end.
  static std::string fault_of(Glass const& glass) {
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
  AgfRecord record_;
  std::optional<Glass> glass_;
  AgfFault begun_{};
};

/// Returns "A (line 3: reason), B (...) and 7 more".
std::string list_left_out(std::vector<AgfReader::LeftOut> const& left_out) {
  constexpr std::size_t most = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(left_out.size(), most); ++i) {
    text += fmt::format("{}{} (line {}: {})", i > 0 ? ", " : "", left_out[i].name, left_out[i].fault.line,
                        left_out[i].fault.text);
  }
  if (left_out.size() > most) text += fmt::format(" and {} more", left_out.size() - most);
  return text;
}

}  // namespace

void GlassCatalogue::add(std::string_view text, std::string const& catalogue, std::string const& file) {
  AgfReader reader(catalogue);
  int number = 0;
  while (!text.empty()) {
    std::size_t const end = std::min(text.find('\n'), text.size());
    reader.read_line(text.substr(0, end), ++number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  reader.finish();
  std::vector<AgfReader::LeftOut> const& out = reader.left_out;
  if (reader.glasses.empty() && !out.empty()) {
    throw DataError(fmt::format("{}:{}", file, out[0].fault.line),
                    fmt::format("the catalogue has no usable glass: {}", list_left_out(out)));
  }
  if (reader.glasses.empty()) {
    throw DataError(file, "holds no glass (a catalogue in the AGF format has lines NM, CD and LD)");
  }
  if (!out.empty()) {
    warnings_.push_back(fmt::format("{}:{}: {} of {} glasses cannot be used and {} left out: {}", file,
                                    out[0].fault.line, out.size(), out.size() + reader.glasses.size(),
                                    out.size() == 1 ? "is" : "are", list_left_out(out)));
  }
  if (!reader.passed_over.empty()) {
    warnings_.push_back(fmt::format(
        "{}:{}: {} lines IT are no share of light and a positive thickness, and are passed over (the first: {})", file,
        reader.passed_over[0].line, reader.passed_over.size(), reader.passed_over[0].text));
  }
  for (Glass& glass : reader.glasses) glass.where = fmt::format("{}:{}", file, glass.where);
  for (AgfReader::LeftOut const& one : out) {
    left_out_.push_back({one.name, fmt::format("{}:{}: {}", file, one.fault.line, one.fault.text)});
  }
  glasses_.insert(glasses_.end(), std::make_move_iterator(reader.glasses.begin()),
                  std::make_move_iterator(reader.glasses.end()));
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
  constexpr std::size_t most = 5, half = 2;  // names are short, so that half of the letters may differ
  std::string const key = compared(name);
  std::vector<std::string> keys;
  // a discontinued glass with lead, "SF6", often has a lead-free successor, "N-SF6"
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
    if (compared(glass.name) == key && (owner.empty() || is_catalogue(glass.catalogue, owner))) found.push_back(&glass);
  }
  return found;
}

std::vector<Glass const*> GlassCatalogue::candidates(std::string_view name) const {
  std::vector<Glass const*> found = named(name, "");  // complete name first: in F_SILICA, "SILICA" is not a catalogue
  if (!found.empty()) return found;
  if (auto const colon = name.find(':'); colon != std::string_view::npos) {
    return named(name.substr(colon + 1), name.substr(0, colon));
  }
  if (auto const bar = name.rfind('_'); bar != std::string_view::npos) {
    return named(name.substr(0, bar), name.substr(bar + 1));
  }
  return {};
}

void GlassCatalogue::refuse_unknown(std::string_view name, std::string const& where) const {
  auto const out = std::find_if(left_out_.begin(), left_out_.end(),
                                [&](LeftOut const& one) { return compared(one.name) == compared(name); });
  if (out != left_out_.end()) {
    throw DataError(
        where, fmt::format("glass \"{}\" cannot be used ({}); correct the catalogue, or give a lens its index", name,
                           out->reason));
  }
  std::string_view const own = name.substr(std::min(name.find(':') + 1, name.size()));
  throw DataError(where, fmt::format("glass \"{}\" is in no catalogue ({} glasses are known){}; add its catalogue "
                                     "(AGF) to the setup's lens.glasses = [\"FILE.agf\"] (of info lens: --glass), or "
                                     "give a lens its index",
                                     name, glasses_.size(), glasses_like(own.substr(0, own.rfind('_')))));
}

GlassMatch GlassCatalogue::match(std::string_view name, double wavelength, std::string const& where,
                                 std::vector<std::string> const& preferred) const {
  GlassMatch result{nullptr, {}};
  std::vector<Glass const*> found = candidates(name);
  if (found.empty()) {
    found = candidates("N-" + std::string(name));
    if (found.empty()) refuse_unknown(name, where);
    result.notes.push_back(fmt::format("{}: glass \"{}\" is in no catalogue; {}, which followed it, is taken", where,
                                       name, found.front()->name));
  }
  auto const covers = [wavelength](Glass const* glass) {
    return wavelength >= glass->shortest && wavelength <= glass->longest && is_index(glass->index(wavelength));
  };
  if (std::none_of(found.begin(), found.end(), covers)) {
    Glass const& glass = *found.front();
    throw DataError(where,
                    fmt::format("glass {} is described from {:.4g} to {:.4g} nm, not at {:.4g} nm; choose another "
                                "wavelength or glass",
                                glass.name, glass.shortest / unit::nanometre, glass.longest / unit::nanometre,
                                wavelength / unit::nanometre));
  }
  std::erase_if(found, [&](Glass const* glass) { return !covers(glass); });
  // preferred catalogues first, then manufacturers in order
  std::vector<std::string> order;
  for (std::string const& catalogue : preferred) order.push_back(compared(catalogue));
  order.insert(order.end(), makers.begin(), makers.end());
  auto const rank = [&order](Glass const* glass) {
    return std::find_if(order.begin(), order.end(),
                        [&](std::string const& one) { return is_catalogue(glass->catalogue, one); }) -
           order.begin();
  };
  std::stable_sort(found.begin(), found.end(), [&](auto const* a, auto const* b) { return rank(a) < rank(b); });
  Glass const& glass = *found.front();
  result.glass = &glass;
  bool const decided = rank(&glass) < static_cast<std::ptrdiff_t>(preferred.size());
  bool const differ = std::any_of(found.begin(), found.end(), [&](Glass const* other) {
    return std::abs(other->index(wavelength) - glass.index(wavelength)) > same_index;
  });
  if (differ && !decided) {
    std::vector<std::string> names;
    for (Glass const* other : found) {
      names.push_back(fmt::format("{}:{} ({})", other->catalogue, other->name, other->where));
    }
    result.notes.push_back(fmt::format("{}: glass \"{}\" may be {}, of different index; {} is taken", where, name,
                                       fmt::join(names, ", "), names.front()));
  }
  constexpr double d = spectral_line::d;
  bool const printed = glass.printed_nd > 1 && d >= glass.shortest && d <= glass.longest;  // 0, 1: none
  if (printed && std::abs(glass.nd() - glass.printed_nd) > same_index) {
    result.notes.push_back(
        fmt::format("{}: glass {}:{}: its formula gives nd = {:.6f}, its catalogue prints {:.6f}; the formula is taken",
                    where, glass.catalogue, glass.name, glass.nd(), glass.printed_nd));
  }
  return result;
}

}  // namespace gladstone
