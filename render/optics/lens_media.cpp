#include "render/optics/lens_media.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "render/base/units.h"

namespace gladstone::inline optics {

LensMedium LensMedia::find(PrescribedMedium const& medium, std::string const& surface_where) {
  std::string const& where = medium.where.empty() ? surface_where : medium.where;
  auto const of_glass = [&](Glass const& glass) {
    return LensMedium{glass.index(wavelength_), absorption_ ? glass.absorption(wavelength_) : 0};
  };
  try {
    if (auto const* const named = std::get_if<PrescribedMedium::Named>(&medium.is)) {
      return of_glass(named_glass(*named, where));
    }
    if (auto const* const own = std::get_if<PrescribedMedium::Private>(&medium.is)) {
      if (wavelength_ < own->glass.shortest || wavelength_ > own->glass.longest) {
        throw DataError(ErrorCode::out_of_range, where,
                        fmt::format("glass {} is given from {:.4g} to {:.4g} nm, not at {:.4g} nm; choose "
                                    "another wavelength",
                                    own->glass.name, own->glass.shortest / unit::nanometre,
                                    own->glass.longest / unit::nanometre, wavelength_ / unit::nanometre));
      }
      return of_glass(own->glass);
    }
  } catch (DataError const& error) {
    not_found_.push_back({error.place(), error.message(), "", error.code()});
    return {};
  }
  if (auto const* const index = std::get_if<PrescribedMedium::Index>(&medium.is)) return {index->n, 0};
  if (auto const* const described = std::get_if<PrescribedMedium::Described>(&medium.is)) {
    Glass const glass = Glass::from_nd_vd(described->nd, described->vd);
    auto const known = std::find_if(described_.begin(), described_.end(),
                                    [&](DescribedGlass const& other) { return other.name == glass.name; });
    if (known == described_.end()) described_.push_back({glass.name, where});
    return {glass.index(wavelength_), 0};
  }
  return {};
}

Warnings LensMedia::finish() {
  refuse_glasses();
  note_described_glasses();
  return std::move(warnings_);
}

Glass LensMedia::named_glass(PrescribedMedium::Named const& named, std::string const& where) {
  std::string const& name = named.glass;
  std::vector<std::string> const& listed = prescription_.catalogues;
  if (!named.otherwise) return found_glass(catalogue_.match(name, wavelength_, where, listed), name);
  double const nd = named.otherwise->nd, vd = named.otherwise->vd;
  std::string const line_taken = fmt::format(
      "nd = {:.6g} and Vd = {:.4g} of its line are used for n = A + B/lambda^2 (add its catalogue for better "
      "accuracy)",
      nd, vd);
  std::string const key = fmt::format("{} {:.6g} {:.4g}", name, nd, vd);
  if (!catalogue_.has(name)) {
    note_once(key, {WarningCode::assumed, where, fmt::format("glass \"{}\" is in no catalogue; {}", name, line_taken)});
    return Glass::from_nd_vd(nd, vd);
  }
  GlassMatch const match = catalogue_.match(name, wavelength_, where, listed, nd);
  Glass const& glass = *match.glass;
  if (agrees_with_nd(glass, nd)) return found_glass(match, name);
  std::string const contradiction = fmt::format("glass \"{}\": {} has nd = {:.6g}", name, place_of(glass), glass.nd());
  if (match.assumed) {
    note_once(key, {WarningCode::inconsistent, where, fmt::format("{}; {}", contradiction, line_taken)});
    return Glass::from_nd_vd(nd, vd);
  }
  note_once(key, {WarningCode::inconsistent, where,
                  fmt::format("{}, but its line says nd = {:.6g}; the catalogue's glass is used (if the line is right, "
                              "list the catalogue of its glass first in GCAT)",
                              contradiction, nd)});
  return glass;
}

Glass LensMedia::found_glass(GlassMatch const& match, std::string const& name) {
  for (Warning const& note : match.notes)
    note_once(name + place_of(*match.glass) + std::string(warning_code_name(note.code)), note);
  return *match.glass;
}

void LensMedia::note_once(std::string const& key, Warning const& warning) {
  if (noted_.insert(key).second) warnings_.push_back(warning);
}

void LensMedia::refuse_glasses() const {
  if (not_found_.empty()) return;
  SetupProblem const& first = not_found_.front();
  if (not_found_.size() == 1) throw DataError(first.code, first.where, first.message);
  throw SetupError(not_found_);
}

std::string_view LensMedia::line_in_file(std::string_view where) const {
  std::string const& file = prescription_.file;
  bool const has_line = where.starts_with(file) && where.size() > file.size() + 1;
  return has_line ? where.substr(file.size() + 1) : where;
}

void LensMedia::note_described_glasses() {
  if (described_.empty()) return;
  bool const one = described_.size() == 1;
  std::vector<std::string> names;
  for (DescribedGlass const& glass : described_) {
    names.push_back(one ? glass.name : fmt::format("{} (line {})", glass.name, line_in_file(glass.where)));
  }
  warnings_.push_back({WarningCode::approximated, described_.front().where,
                       fmt::format("{} {} approximated by n = A + B/lambda^2, accurate to about 1e-3 away from 587.6 "
                                   "nm; name {} of a catalogue for better accuracy",
                                   one ? "glass " + names.front()
                                       : fmt::format("{} glasses ({})", names.size(), fmt::join(names, "; ")),
                                   one ? "is" : "are", one ? "a glass" : "glasses")});
}

}  // namespace gladstone::inline optics
