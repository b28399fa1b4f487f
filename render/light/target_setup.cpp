#include "render/light/target_setup.h"

#include <filesystem>
#include <limits>

#include "render/base/units.h"

namespace gladstone::inline light {

TargetSetup read_target_setup(SetupTable table) {
  TargetSetup setup;
  std::string const kind = table.kind_word("kind", "dots", {"dots", "grid", "points", "image"});
  if (kind == "points") setup.kind = TargetKind::points;
  if (kind == "image") setup.kind = TargetKind::image;
  if (setup.kind == TargetKind::dots) {
    setup.dots_per_32px_window =
        table.number("dots_per_32px_window", setup.dots_per_32px_window, Range::positive(1024.0));
    if (kind == "grid") {
      setup.arrangement = DotArrangement::regular;
    } else {
      setup.arrangement = table.choice("arrangement", setup.arrangement,
                                       {{"random", DotArrangement::random}, {"regular", DotArrangement::regular}});
    }
  } else {
    setup.file = table.required_path("file");
    if (std::error_code error; !setup.file.empty() && !std::filesystem::exists(setup.file, error)) {
      table.problem("file",
                    "file not found: " + setup.file + "; relative names are resolved against the setup file's folder",
                    ErrorCode::missing_file);
    }
  }
  if (setup.kind != TargetKind::image) {
    if (table.has("dot_diameter_mm")) {
      if (table.has("dot_diameter_px")) {
        table.problem("dot_diameter_mm", "conflicts with dot_diameter_px (both set the dot size); remove one of them");
        table.number("dot_diameter_px", *setup.dot_diameter_px);
      }
      setup.dot_diameter_m = table.number("dot_diameter_mm", 0.0, Range::at_least(0.0)) * unit::millimetre;
      setup.dot_diameter_px.reset();
    } else {
      setup.dot_diameter_px = table.number("dot_diameter_px", *setup.dot_diameter_px, Range::at_least(0.0, 1e4));
    }
  }
  if (setup.kind == TargetKind::image) {
    table.refuse("polarity", "does not apply to an image (its grey values are the radiance); remove it");
  } else {
    setup.polarity = table.choice("polarity", setup.polarity, {{"bright", Polarity::bright}, {"dark", Polarity::dark}});
  }
  if (table.has("extent_mm") && setup.kind != TargetKind::points) {
    auto const extent = table.numbers("extent_mm", {}, 2, Range::positive());
    if (extent.size() == 2) setup.extent_m = Vec2d{extent[0] * unit::millimetre, extent[1] * unit::millimetre};
  }
  if (table.has("center_mm") && setup.kind != TargetKind::points) {
    auto const centre = table.numbers("center_mm", {}, 2, {-1e9, 1e9});
    if (centre.size() == 2) setup.centre_m = Vec2d{centre[0] * unit::millimetre, centre[1] * unit::millimetre};
  }
  setup.seed = static_cast<std::uint64_t>(
      table.integer("seed", static_cast<long long>(setup.seed), 0, std::numeric_limits<long long>::max()));
  return setup;
}

}  // namespace gladstone::inline light
