#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "render/scene/cross_check.h"
#include "render/scene/read_setup.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {
namespace {

void read_bos_z_d(Setup& setup, SetupTable geometry) {
  setup.z_d = geometry.quantity("z_d_mm", setup.z_d, unit::millimetre, Range::positive(1e9));
}

/// Reads table [sequence]; nullopt if it is absent.
std::optional<SequenceSetup> read_field_sequence(SetupTable table, FieldSetup const& field) {
  if (!table.present()) return std::nullopt;
  SequenceSetup setup;
  auto const first = static_cast<long long>(bos_experiment.first_pair());
  setup.pair = static_cast<std::size_t>(table.integer("pair", first, first, max_sequence_frames));
  // The files were replaced by the one of the pair if the case was selected by select_pair().
  if (!table.has("files") && !table.has("pair")) {
    table.problem("files", "is missing (density files, one for each frame); add it, files = [\"rho_*.h5\"]",
                  ErrorCode::missing_key);
  }
  table.path_list("files", 1);
  for (char const* const key : {"frames", "dt_us"}) {
    table.refuse(key, "applies to PIV only (a BOS sequence has one frame for each of sequence.files); remove it");
  }
  if (field.kind != FieldKind::file) {
    table.problem("files",
                  "requires [medium.field] with kind = \"file\", whose other keys apply to every file; add it");
  }
  return setup;
}

void read_bos(Setup& setup, SetupTable root) {
  setup.sequence = read_field_sequence(root.table("sequence"), setup.medium.field);
  setup.target = read_target_setup(root.table("target"));
  root.refuse("calibration", "does not apply to BOS (it requires experiment = \"calibration\"); remove it");
  refuse_piv_tables(setup, root);
}

/// Reports views and targets that extend farther off the axis than a lens can image: no chief rays are found from
/// there.
void cross_check_extents(Setup const& setup, Vec2d view, SetupTable target, SetupTable root) {
  double const widest = 2 * setup.max_off_axis_distance(), mm = unit::millimetre;
  if (std::max(view.x, view.y) > widest) {
    camera_table(root).problem(
        "pixel_pitch_um",
        fmt::format("makes a field of view of {:.4g} x {:.4g} mm (at most {:.4g} mm, 168 degrees, are supported); "
                    "pitches are in um; use a longer focal length or fewer or smaller pixels",
                    view.x / mm, view.y / mm, widest / mm));
  } else if (setup.target.extent_m && std::max(setup.target.extent_m->x, setup.target.extent_m->y) > widest) {
    target.problem("extent_mm",
                   fmt::format("exceeds the largest supported field of view, 168 degrees ({:.4g} mm, ten times the "
                               "distance to the lens on each side); use the view or a little more",
                               widest / mm));
  }
}

/// Checks the target's size and the size and polarity of its dots.
void cross_check_target(Setup const& setup, SetupTable root) {
  double const mm = unit::millimetre;
  SetupTable target = root.table("target");
  double const px = setup.pixel_size();
  Vec2d view{setup.camera.columns * px, setup.camera.rows * px}, needed = view + setup.target_view_margin();
  if (setup.has_oblique_view()) needed = view = posed_view(setup);
  if (setup.target.extent_m && (setup.target.extent_m->x < needed.x || setup.target.extent_m->y < needed.y)) {
    target.problem("extent_mm", fmt::format("the field of view, {:.4g} x {:.4g} mm at the dots, is larger than the "
                                            "target or partly outside of it ({:.4g} x {:.4g} mm about its centre would "
                                            "contain the whole view); enlarge the target or leave extent_mm out",
                                            view.x / mm, view.y / mm, needed.x / mm, needed.y / mm));
  }
  cross_check_extents(setup, view, target, root);
  if (setup.target.kind != TargetKind::image) {
    double const diameter_px = setup.geometric_dot_px();
    cross_check_spot(setup, root);
    if (setup.target.polarity == Polarity::dark && diameter_px == 0) {
      target.problem("polarity", "dark dots of zero size cannot be seen; give dot_diameter_px");
    }
    if (setup.target.polarity == Polarity::dark && setup.divides_light()) {
      target.problem("polarity",
                     "dark dots on white paper cannot be rendered through lenslets (the light of the paper through "
                     "each of them is unknown); use bright dots");
    }
  }
}

/// Checks the number of random or regular dots.
void cross_check_dot_count(Setup const& setup, SetupTable target) {
  double const mm = unit::millimetre;
  double const count = setup.dot_count();
  double const diameter = setup.dot_diameter();
  Vec2d const extent = setup.target_extent();
  double const coverage = count * pi / 4 * diameter * diameter / (extent.x * extent.y);
  if (!(count >= 1)) {
    target.problem("dots_per_32px_window", "gives no dot at all on this target; increase it");
  } else if (count > 4e9) {
    target.problem(
        "dots_per_32px_window",
        fmt::format("gives {:.3g} dots on {:.4g} x {:.4g} mm (4e9 at most; they alone would need {:.3g} GB of memory); "
                    "decrease it, camera.pixels or target.extent_mm",
                    count, extent.x / mm, extent.y / mm, count * 200 / 1e9));
  } else if (setup.target.arrangement == DotArrangement::random && coverage > 0.5) {
    target.problem(
        "dots_per_32px_window",
        fmt::format("dots would cover {:.0f} % of the target (random discs without overlap reach about 50 %); use "
                    "fewer or smaller dots, or arrangement = \"regular\"",
                    100 * coverage));
  }
}

void cross_check_bos(Setup const& setup, SetupTable root, Warnings& warnings) {
  cross_check_medium(setup, root, warnings);
  cross_check_target(setup, root);
  if (setup.target.kind == TargetKind::dots) cross_check_dot_count(setup, root.table("target"));
}

}  // namespace

constinit Experiment const bos_experiment{.name = "bos",
                                          .sources = dot_sources,
                                          .focus_word = "target",
                                          .measures_density = true,
                                          .correlated = true,
                                          .medium_in_first_frame = false,
                                          .consecutive_frames = false,
                                          .reason_for_rays = "",
                                          .read_z_d = read_bos_z_d,
                                          .read = read_bos,
                                          .cross_check = cross_check_bos};

}  // namespace gladstone::inline scene
