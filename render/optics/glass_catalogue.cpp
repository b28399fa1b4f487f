#include "render/optics/glass_catalogue.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <utility>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/base/units.h"
#include "render/files/text_encoding.h"
#include "render/files/text_file.h"
#include "render/optics/agf.h"
#include "render/optics/glass_name.h"
#include "render/optics/shipped_catalogue.h"

namespace gladstone::inline optics {
namespace {

constexpr double same_index = 1e-4;  // [1]; glasses of one name with a smaller difference are considered identical

/// Returns "A (line 3: reason), B (...) and 7 more".
std::string list_left_out(std::vector<AgfContent::LeftOut> const& left_out) {
  constexpr std::size_t most = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(left_out.size(), most); ++i) {
    text += fmt::format("{}{} (line {}: {})", i > 0 ? ", " : "", left_out[i].name, left_out[i].fault.line,
                        left_out[i].fault.text);
  }
  if (left_out.size() > most) text += fmt::format(" and {} more", left_out.size() - most);
  return text;
}

bool covers(Glass const& glass, double wavelength) {
  return wavelength >= glass.shortest && wavelength <= glass.longest && is_index(glass.index(wavelength));
}

/// Throws DataError unless at least one of the glasses covers the wavelength.
void require_range(std::vector<Glass const*> const& found, double wavelength, std::string const& where) {
  if (std::any_of(found.begin(), found.end(), [=](Glass const* glass) { return covers(*glass, wavelength); })) return;
  Glass const& glass = *found.front();
  throw DataError(ErrorCode::out_of_range, where,
                  fmt::format("glass {} is described from {:.4g} to {:.4g} nm, not at {:.4g} nm; choose another "
                              "wavelength or glass",
                              glass.name, glass.shortest / unit::nanometre, glass.longest / unit::nanometre,
                              wavelength / unit::nanometre));
}

/// Choice among the glasses that a name can refer to.
struct Choice {
  std::vector<Glass const*> found;  ///< glasses to choose from, in order
  Glass const* glass = nullptr;     ///< chosen glass
  bool in_no_catalogue = false;     ///< true: no catalogue contains the name
  bool followed = false;            ///< true: the glasses are successors of the named glass
  bool listed = false;              ///< the catalogue of the glass is in the lens file's list, or the file has no list
  bool added = false;               ///< true: the user added the catalogue of the glass
  bool ambiguous = false;           ///< true: another glass comes first in order, or has a different index

  /// Describes the assumptions made: "may be A, B, with different indices; A is taken"; empty if none was made.
  std::string text(std::vector<std::string> const& list, std::optional<double> stated_nd) const {
    std::vector<std::string> reasons;
    if (followed) {
      reasons.emplace_back(in_no_catalogue ? "is in no catalogue" : "is in no catalogue that the lens file lists");
    } else if (!listed && !added) {
      reasons.push_back(fmt::format("is not in the catalogues that the lens file lists ({})", fmt::join(list, ", ")));
    }
    if (ambiguous) {
      std::vector<std::string> names;
      for (Glass const* other : found) names.push_back(place_of(*other));
      reasons.push_back(fmt::format("may be {}, with different indices", fmt::join(names, ", ")));
    }
    if (reasons.empty()) return {};
    std::string taken = place_of(*glass);
    if (followed) taken += ", which followed it,";
    if (glass != found.front())
      taken += fmt::format(", which has the nd = {:.6g} stated in the lens file,", stated_nd.value_or(0));
    taken += " is taken";
    if (followed && !listed) taken += fmt::format(", although the lens file lists only {}", fmt::join(list, ", "));
    return fmt::format("{}; {}", fmt::join(reasons, " and "), taken);
  }
};

}  // namespace

bool agrees_with_nd(Glass const& glass, double stated_nd) {
  constexpr double rounding = 1e-3;  // [1]
  constexpr double d = spectral_line::d;
  return d < glass.shortest || d > glass.longest || std::abs(glass.nd() - stated_nd) <= rounding;
}

std::string place_of(Glass const& glass) { return fmt::format("{}:{} ({})", glass.catalogue, glass.name, glass.where); }

void GlassCatalogue::add(std::string_view text, std::string const& catalogue, std::string const& file) {
  AgfContent content = read_agf(text, catalogue);
  std::vector<AgfContent::LeftOut> const& out = content.left_out;
  if (content.glasses.empty() && !out.empty()) {
    throw DataError(ErrorCode::missing_content, fmt::format("{}:{}", file, out[0].fault.line),
                    fmt::format("the catalogue has no usable glass: {}", list_left_out(out)));
  }
  if (content.glasses.empty()) {
    throw DataError(ErrorCode::missing_content, file,
                    "contains no glass (a catalogue in the AGF format has lines NM, CD and LD)");
  }
  if (!out.empty()) {
    warnings_.push_back({WarningCode::ignored, fmt::format("{}:{}", file, out[0].fault.line),
                         fmt::format("{} of {} glasses are invalid and are ignored: {}", out.size(),
                                     out.size() + content.glasses.size(), list_left_out(out))});
  }
  if (!content.skipped_lines.empty()) {
    warnings_.push_back(
        {WarningCode::ignored, fmt::format("{}:{}", file, content.skipped_lines[0].line),
         fmt::format(
             "{} lines IT do not consist of a transmittance and a positive thickness, and are ignored (the first: {})",
             content.skipped_lines.size(), content.skipped_lines[0].text)});
  }
  for (Glass& glass : content.glasses) glass.where = fmt::format("{}:{}", file, glass.where);
  for (AgfContent::LeftOut const& one : out) {
    left_out_.push_back({one.name, fmt::format("{}:{}: {}", file, one.fault.line, one.fault.text)});
  }
  glasses_.insert(glasses_.end(), std::make_move_iterator(content.glasses.begin()),
                  std::make_move_iterator(content.glasses.end()));
}

void GlassCatalogue::add_file(std::string const& path) {
  add(decoded_text(read_text_file(path), path), glass_key(std::filesystem::path(path).stem().string()), path);
}

GlassCatalogue const& GlassCatalogue::shipped() {
  static GlassCatalogue const catalogue = [] {
    GlassCatalogue all;
    all.has_shipped_ = true;
    return all;
  }();
  return catalogue;
}

std::vector<Glass const*> GlassCatalogue::glasses() const {
  std::vector<Glass const*> all;
  for (Glass const& glass : glasses_) all.push_back(&glass);
  if (has_shipped_) {
    ShippedCatalogue const& shipped = ShippedCatalogue::instance();
    for (std::size_t i = 0; i < shipped.entries().size(); ++i) all.push_back(&shipped.glass(i));
  }
  return all;
}

std::vector<GlassCatalogue::FullName> GlassCatalogue::names() const {
  std::vector<FullName> all;
  for (Glass const& glass : glasses_) all.push_back({glass_key(glass.name), glass.catalogue, glass.name});
  if (has_shipped_) {
    ShippedCatalogue const& shipped = ShippedCatalogue::instance();
    for (auto const& entry : shipped.entries()) {
      all.push_back({entry.key, shipped.catalogue(entry), std::string(entry.name)});
    }
  }
  return all;
}

std::string GlassCatalogue::suggest_glasses(std::string_view name) const {
  constexpr std::size_t most = 5, half = 2;  // names are short, so that half of the letters may differ
  std::string const key = glass_key(name);
  std::vector<FullName> const all = names();
  std::vector<std::string> keys, known;
  for (FullName const& one : all) known.push_back(one.key);
  // a discontinued glass with lead, "SF6", often has a lead-free successor, "N-SF6"
  for (std::string const& other : known) {
    if (other == "N" + key || "N" + other == key) keys.push_back(other);
  }
  for (std::string const& near : nearest_names(key, known, most, half)) keys.push_back(near);
  std::vector<std::string> like;
  for (std::string const& near : keys) {
    for (FullName const& one : all) {
      std::string const full = fmt::format("{}:{}", one.catalogue, one.name);
      bool const listed = std::find(like.begin(), like.end(), full) != like.end();
      if (like.size() < most && one.key == near && !listed) like.push_back(full);
    }
  }
  return like.empty() ? "" : "; did you mean " + quoted_list(like) + '?';
}

std::vector<Glass const*> GlassCatalogue::named(std::string_view name, std::string_view catalogue) const {
  std::string const key = glass_key(name), owner = glass_key(catalogue);
  auto const wanted = [&owner](std::string_view of) { return owner.empty() || is_catalogue(of, owner); };
  std::vector<Glass const*> found;
  for (Glass const& glass : glasses_) {
    if (glass_key(glass.name) == key && wanted(glass.catalogue)) found.push_back(&glass);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](Glass const* a, Glass const* b) { return maker_rank(a->catalogue) < maker_rank(b->catalogue); });
  if (has_shipped_) {
    ShippedCatalogue const& shipped = ShippedCatalogue::instance();
    for (std::size_t i = 0; i < shipped.entries().size(); ++i) {
      ShippedCatalogue::Entry const& entry = shipped.entries()[i];
      if (entry.key == key && wanted(shipped.catalogue(entry))) found.push_back(&shipped.glass(i));
    }
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
                                [&](LeftOut const& one) { return glass_key(one.name) == glass_key(name); });
  if (out != left_out_.end()) {
    throw DataError(ErrorCode::invalid_value, where,
                    fmt::format("glass \"{}\" cannot be used ({}); correct the catalogue, or give the lens an index",
                                name, out->reason));
  }
  std::string_view const own = name.substr(std::min(name.find(':') + 1, name.size()));
  throw DataError(
      ErrorCode::unknown_choice, where,
      fmt::format("glass \"{}\" is in no catalogue ({} glasses are known){}; add its catalogue (AGF) to the "
                  "setup's lens.glasses = [\"FILE.agf\"] (for info lens: --glass), or give the lens an index",
                  name, names().size(), suggest_glasses(own.substr(0, own.rfind('_')))));
}

std::vector<Glass const*> GlassCatalogue::successors(std::string_view name) const {
  std::size_t const own = name.find(':') == std::string_view::npos ? 0 : name.find(':') + 1;
  return candidates(fmt::format("{}N-{}", name.substr(0, own), name.substr(own)));
}

GlassMatch GlassCatalogue::match(std::string_view name, double wavelength, std::string const& where,
                                 std::vector<std::string> const& preferred, std::optional<double> stated_nd) const {
  auto const rank = [&preferred](Glass const* glass) {
    return std::find_if(preferred.begin(), preferred.end(),
                        [glass](std::string const& one) { return is_catalogue(glass->catalogue, glass_key(one)); }) -
           preferred.begin();
  };
  auto const is_preferred = [&](Glass const* glass) {
    return rank(glass) < static_cast<std::ptrdiff_t>(preferred.size());
  };
  auto const is_added = [this](Glass const* glass) {
    return std::any_of(glasses_.begin(), glasses_.end(), [glass](Glass const& one) { return &one == glass; });
  };
  auto const disagrees = [&](Glass const* glass) { return stated_nd && !agrees_with_nd(*glass, *stated_nd); };

  // Find the glasses of the name, or their successors.
  std::vector<Glass const*> found = candidates(name);
  Choice choice;
  choice.in_no_catalogue = found.empty();
  if (std::none_of(found.begin(), found.end(), is_preferred)) {
    std::vector<Glass const*> successor = successors(name);
    if (!found.empty()) std::erase_if(successor, [&](Glass const* glass) { return !is_preferred(glass); });
    if (found.empty() && successor.empty()) refuse_unknown(name, where);
    bool const found_agrees = !std::all_of(found.begin(), found.end(), disagrees);
    bool const successor_agrees = !std::all_of(successor.begin(), successor.end(), disagrees);
    choice.followed = !successor.empty() && (successor_agrees || !found_agrees);
    if (choice.followed) found = std::move(successor);
  }
  require_range(found, wavelength, where);
  std::erase_if(found, [&](Glass const* glass) { return !covers(*glass, wavelength); });
  std::stable_sort(found.begin(), found.end(), [&](auto const* a, auto const* b) { return rank(a) < rank(b); });

  // The stated nd decides among glasses of catalogues that are neither listed nor added.
  choice.found = found;
  bool const chosen = is_preferred(found.front()) || is_added(found.front());
  if (!chosen && !std::all_of(found.begin(), found.end(), disagrees)) std::erase_if(found, disagrees);
  Glass const& glass = *found.front();
  choice.glass = &glass;
  choice.listed = preferred.empty() || is_preferred(&glass);
  choice.added = is_added(&glass);
  bool const differ = std::any_of(found.begin(), found.end(), [&](Glass const* other) {
    return std::abs(other->index(wavelength) - glass.index(wavelength)) > same_index;
  });
  choice.ambiguous = &glass != choice.found.front() || (differ && !is_preferred(&glass));

  GlassMatch result{&glass, {}, choice.followed || (!is_preferred(&glass) && !choice.added)};
  if (std::string const text = choice.text(preferred, stated_nd); !text.empty()) {
    result.notes.push_back({WarningCode::assumed, where, fmt::format("glass \"{}\" {}", name, text)});
  }
  constexpr double d = spectral_line::d;
  // values of 0 and 1 are placeholders
  bool const printed = glass.printed_nd > 1 && d >= glass.shortest && d <= glass.longest;
  if (printed && std::abs(glass.nd() - glass.printed_nd) > same_index) {
    result.notes.push_back(
        {WarningCode::inconsistent, where,
         fmt::format("glass {}:{}: its formula gives nd = {:.6f}, its catalogue prints {:.6f}; the formula is used",
                     glass.catalogue, glass.name, glass.nd(), glass.printed_nd)});
  }
  return result;
}

}  // namespace gladstone::inline optics
