#include "studies/case/lens_glasses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <variant>

#include "render/optics/glass_name.h"
#include "render/optics/lens_media.h"

namespace gladstone::inline cases {
namespace {

std::string full_name(Glass const& glass) { return fmt::format("{}:{}", glass.catalogue, glass.name); }

/// Returns the other glasses of the same name.
std::vector<std::string> namesakes(Glass const& taken, std::vector<Glass const*> const& all) {
  std::vector<std::string> names;
  for (Glass const* other : all) {
    bool const same = glass_key(other->name) == glass_key(taken.name);
    if (same && other->where != taken.where) names.push_back(full_name(*other));
  }
  return names;
}

/// Returns the glass behind a surface, and its name in the lens file; nullopt for air, mirrors and plain indices.
std::optional<std::pair<std::string, Glass>> glass_behind(PrescribedSurface const& surface, LensMedia& media) {
  auto const& medium = surface.after;
  if (auto const* const named = std::get_if<PrescribedMedium::Named>(&medium.is))
    return std::pair(named->glass, media.named_glass(*named, surface.where));
  if (auto const* const own = std::get_if<PrescribedMedium::Private>(&medium.is))
    return std::pair(own->glass.name, own->glass);
  if (auto const* const described = std::get_if<PrescribedMedium::Described>(&medium.is)) {
    Glass glass = Glass::from_nd_vd(described->nd, described->vd);
    return std::pair(glass.name, std::move(glass));
  }
  return std::nullopt;
}

}  // namespace

std::vector<LensGlass> list_lens_glasses(Lens const& lens, GlassCatalogue const& catalogue) {
  LensMedia media(lens.prescription, catalogue, lens.wavelength, false);
  std::vector<Glass const*> const all = catalogue.glasses();
  std::vector<LensGlass> list;
  for (std::size_t i = 0; i < lens.prescription.surfaces.size(); ++i) {
    auto const found = glass_behind(lens.prescription.surfaces[i], media);
    if (!found) continue;
    auto const& [name, glass] = *found;
    bool const of_catalogue = !glass.where.empty();
    std::string const full = of_catalogue ? full_name(glass) : "";
    auto const known = std::find_if(list.begin(), list.end(), [&, &own = name](LensGlass const& one) {
      return one.name == own && one.catalogue == full;
    });
    if (known != list.end()) {
      known->surfaces.push_back(i + 1);
      continue;
    }
    list.push_back({name, full, glass.where, glass.index(lens.wavelength), {i + 1}});
    if (of_catalogue) list.back().also_in = namesakes(glass, all);
  }
  return list;
}

nlohmann::json lens_glasses_json(std::vector<LensGlass> const& glasses) {
  nlohmann::json list = nlohmann::json::array();
  for (LensGlass const& glass : glasses) {
    bool const own = glass.catalogue.empty();
    list.push_back({{"name", glass.name},
                    {"catalogue", own ? nlohmann::json(nullptr) : nlohmann::json(glass.catalogue)},
                    {"place", own ? nlohmann::json(nullptr) : nlohmann::json(glass.place)},
                    {"index", glass.index},
                    {"surfaces", glass.surfaces},
                    {"also_in", glass.also_in}});
  }
  return list;
}

std::string lens_glasses_text(std::vector<LensGlass> const& glasses) {
  std::string text;
  for (LensGlass const& glass : glasses) {
    text += fmt::format(
        "  glass {} behind surface {}: {}, n = {:.6f}{}\n", glass.name, fmt::join(glass.surfaces, ", "),
        glass.catalogue.empty() ? "described by the lens file" : fmt::format("{} ({})", glass.catalogue, glass.place),
        glass.index, glass.also_in.empty() ? "" : fmt::format("; also in {}", fmt::join(glass.also_in, ", ")));
  }
  return text;
}

}  // namespace gladstone::inline cases
