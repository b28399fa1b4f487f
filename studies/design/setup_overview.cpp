#include "studies/design/setup_overview.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "render/base/parallel.h"
#include "render/base/text.h"
#include "render/base/units.h"
#include "render/method.h"
#include "render/scene/build_camera.h"
#include "render/scene/calibration_planes.h"
#include "studies/case/json_text.h"
#include "studies/design/bos_sheet.h"
#include "studies/design/piv_sheet.h"
#include "studies/design/sheet_text.h"

namespace gladstone::inline design {
namespace {

using unit::mm;

/// Keys of the rows of the BOS design sheet that an overview contains.
constexpr std::array bos_keys{"magnification",     "gladstone_dale_m3_kg",     "magnification_at_medium",
                              "field_of_view_mm",  "field_of_view_height_mm",  "field_of_view_at_dots_mm",
                              "cone_diameter_mm",  "diffraction_diameter_px",  "dot_diameter_px",
                              "depth_of_field_mm", "sensitivity_px_per_kg_m4", "displacement_px",
                              "resolution_mm",     "dots_per_window",          "peak_electrons",
                              "random_error_px",   "gradient_min_kg_m4"};
/// Keys of the rows that depend on a number of dots per window, which only targets of kind "dots" have.
constexpr std::array pattern_keys{"dots_per_window", "random_error_px", "gradient_min_kg_m4"};
/// Keys of the rows about the image of a dot, which an image target does not have.
constexpr std::array dot_keys{"dot_diameter_px", "peak_electrons"};
/// Keys of the rows that add_camera_rows() replaces for a camera to which the design sheet does not apply.
constexpr std::array thin_lens_keys{"magnification",           "magnification_at_medium",  "field_of_view_mm",
                                    "field_of_view_height_mm", "field_of_view_at_dots_mm", "diffraction_diameter_px",
                                    "dot_diameter_px",         "depth_of_field_mm"};
/// Keys of the rows of the PIV design sheet that depend on the flow.
constexpr std::array flow_keys{"displacement_px", "in_plane_max_m_s", "out_of_plane_max_m_s"};

template <class Keys>
bool holds(Keys const& keys, std::string const& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

/// Adds paraxial values of any camera, for the plane of the dots or particles.
void add_camera_rows(std::vector<ResultRow>& rows, Setup const& setup) {
  double const pixel = setup.pixel_size();
  rows.push_back(plain_row("magnification", "magnification", setup.imaging().magnification, "", "near the axis"));
  rows.push_back(plain_row("field_of_view_mm", "field of view in the plane of the dots, width",
                           setup.camera.columns * pixel / mm, "mm", "by the scale at the centre"));
  rows.push_back(plain_row("field_of_view_height_mm", "field of view in the plane of the dots, height",
                           setup.camera.rows * pixel / mm, "mm"));
  rows.push_back(plain_row("entrance_pupil_mm", "diameter of the entrance pupil", setup.imaging().entrance_pupil / mm,
                           "mm", setup.imaging().entrance_pupil == 0 ? "chief rays only" : ""));
  rows.push_back(
      plain_row("spot_diameter_px", "point spread function, e^-2 diameter", setup.spot_e2_diameter_px(), "px"));
}

/// Adds the size of the dots in the image.
void add_dot_image(std::vector<ResultRow>& rows, Setup const& setup) {
  rows.push_back(plain_row("geometric_dot_px", "geometric image of a dot, diameter", setup.geometric_dot_px(), "px"));
  rows.push_back(plain_row("defocus_diameter_px", "circle of confusion of the dots", setup.defocus_diameter_px(), "px",
                           "0 in focus"));
}

void add_lenslets(std::vector<ResultRow>& rows, Setup const& setup) {
  auto const* const lenslets = setup.element<LensletSetup>();
  if (!lenslets) return;
  double const pixels = lenslets->pitch / setup.camera.pixel_pitch;
  rows.push_back(
      plain_row("pixels_per_lenslet", "pixels across a lenslet", pixels, "px", "views along each direction"));
  rows.push_back(plain_row("lenslets_across", "lenslets across the sensor", setup.camera.columns / pixels, ""));
}

/// Returns the number of dots that the sensor sees; NaN if their chief rays would meet more than two million
/// surfaces (about a second).
double count_dots_in_view(Setup const& setup, DotPattern const& dots) {
  constexpr std::size_t max_intersections = 2'000'000;
  Scene scene;
  scene.setup = setup;
  scene.imaging = setup.imaging();
  scene.camera = build_camera(setup);
  if (dots.centre.size() * scene.camera.elements.size() > max_intersections) return NAN;
  return static_cast<double>(
      std::count_if(dots.centre.begin(), dots.centre.end(), [&scene](Vec2d centre) { return scene.in_view(centre); }));
}

void add_dot_numbers(std::vector<ResultRow>& rows, Setup const& setup) {
  bool const image = setup.target.kind == TargetKind::image;
  DotPattern const dots = build_target(setup);
  rows.push_back(plain_row("dots", image ? "lit pixels of the target's image" : "dots on the target",
                           static_cast<double>(dots.centre.size()), ""));
  if (double const seen = count_dots_in_view(setup, dots); std::isfinite(seen)) {
    rows.push_back(plain_row("dots_in_view", image ? "those in view" : "dots in view", seen, ""));
  }
}

bool has_sheet(Setup const& setup) {
  return std::isfinite(setup.lens.f_number) && std::isfinite(setup.lens.focal_length) && !setup.divides_light();
}

void add_bos(SetupOverview& overview, CaseSetup& loaded) {
  Setup& setup = loaded.setup;
  bool const thin = setup.has_closed_form_layout(), dots = setup.target.kind == TargetKind::dots;
  bool const image = setup.target.kind == TargetKind::image, sheet = has_sheet(setup);
  if (!closed_form_gradient(setup)) {
    setup.medium.field.kind = FieldKind::none;
    overview.notes.emplace_back("the density field is not read: the displacement is that of a usual gradient");
  }
  if (!thin || !sheet) {
    add_camera_rows(overview.rows, setup);
    if (!image) add_dot_image(overview.rows, setup);
  }
  if (sheet) {
    FixedDesignParameters const given = collect_fixed_parameters(loaded);
    for (ResultRow const& row : bos_sheet(setup, make_design_point(setup, given)).rows) {
      bool const wanted = holds(bos_keys, row.key) && (dots || !holds(pattern_keys, row.key)) &&
                          (!image || !holds(dot_keys, row.key)) && (thin || !holds(thin_lens_keys, row.key));
      if (wanted) overview.rows.push_back(row);
    }
  } else {
    overview.notes.emplace_back(
        "sensitivity and blur by the aperture are not given: the design sheet requires a stop, a finite focal length "
        "and no lenslets");
  }
  add_dot_numbers(overview.rows, setup);
}

void add_piv(SetupOverview& overview, CaseSetup& loaded) {
  Setup const& setup = loaded.setup;
  if (!std::isfinite(setup.lens.f_number)) {
    add_camera_rows(overview.rows, setup);
    overview.notes.emplace_back("particle images are not given: the camera has no aperture stop");
    return;
  }
  bool const flow_read = !setup.piv->flow.file;
  if (!flow_read) overview.notes.emplace_back("the velocity file is not read: displacements are not given");
  for (ResultRow const& row : piv_sheet(loaded).rows) {
    if (flow_read || !holds(flow_keys, row.key)) overview.rows.push_back(row);
  }
  if (std::isfinite(overview.cost.sources)) {
    overview.rows.push_back(
        plain_row("particles_in_view", "particles in view", overview.cost.sources, "", "within the laser sheet"));
  } else {
    overview.notes.emplace_back("the file of particles is not read: their number is not given");
  }
}

void add_calibration(SetupOverview& overview, CaseSetup& loaded) {
  Setup const& setup = loaded.setup;
  auto& rows = overview.rows;
  add_camera_rows(rows, setup);
  auto const [first, last] = std::minmax_element(setup.planes.begin(), setup.planes.end());
  rows.push_back(plain_row("planes", "planes", static_cast<double>(setup.planes.size()), ""));
  for (auto const& [z, key, blur_key] : {std::tuple{*first, "first_plane_mm", "first_plane_defocus_px"},
                                         std::tuple{*last, "last_plane_mm", "last_plane_defocus_px"}}) {
    Setup const there = plane_setup(setup, z);
    rows.push_back(
        plain_row(key, "plane at Z", z / mm, "mm", fmt::format("magnification {:.5g}", there.imaging().magnification)));
    rows.push_back(plain_row(blur_key, "circle of confusion of its dots", there.defocus_diameter_px(), "px"));
  }
  rows.push_back(plain_row("geometric_dot_px", "geometric image of a dot, diameter", setup.geometric_dot_px(), "px"));
  rows.push_back(plain_row("dot_spacing_px", "distance between dots in the image",
                           setup.target.spacing / setup.pixel_size(), "px"));
  add_dot_numbers(rows, plane_setup(setup, 0));
}

/// Rounds a time to two significant digits, without an exponent from 10 s on.
std::string time_text(double seconds) {
  if (seconds < 10) return fmt::format("{:.2g}", seconds);
  double const step = std::pow(10.0, std::floor(std::log10(seconds)) - 1);
  return fmt::format("{:.0f}", std::round(seconds / step) * step);
}

std::string cost_text(RenderCost const& cost) {
  std::string memory;
  for (MemoryRequirement const& part : cost.memory) {
    if (part.bytes > 0)
      memory += fmt::format("{}{} {:.3g} MB", memory.empty() ? "" : ", ", part.what, part.bytes / 1e6);
  }
  std::string text = "render\n";
  std::string const rays =
      cost.method == RenderMethod::formula ? "no rays"
      : cost.expected_rays < cost.rays_per_source
          ? fmt::format("about {:.6g} rays per source, up to {:.6g}", cost.expected_rays, cost.rays_per_source)
          : fmt::format("{}{:.6g} rays per source", cost.rays_are_largest ? "up to " : "", cost.rays_per_source);
  text += fmt::format("  {:<50}{}, {}\n", "method", to_string(cost.method), rays);
  if (std::isfinite(cost.processor_seconds)) {
    std::string const threads = count_text(static_cast<std::size_t>(thread_count()), "thread");
    bool const expected = cost.expected_rays < cost.rays_per_source;
    text += fmt::format("  {:<50}{}{} s{} on {} of a CPU\n", "time",
                        cost.rays_are_largest && !expected ? "up to " : "about ", time_text(cost.seconds()),
                        expected ? ", up to " + time_text(cost.longest_seconds()) + " s" : "", threads);
  } else {
    text += fmt::format("  {:<50}unknown\n", "time");
  }
  return text + fmt::format("  {:<50}{:.3g} MB ({})\n", "memory", cost.bytes() / 1e6, memory);
}

nlohmann::ordered_json cost_json(RenderCost const& cost) {
  nlohmann::ordered_json memory = nlohmann::ordered_json::object();
  for (MemoryRequirement const& part : cost.memory) memory[part.what] = part.bytes;
  return {{"method", to_string(cost.method)},
          {"sources", number_or_null(cost.sources)},
          {"rays_per_source", cost.rays_per_source},
          {"rays_are_largest", cost.rays_are_largest},
          {"expected_rays", cost.expected_rays},
          {"processor_seconds", number_or_null(cost.expected_seconds)},
          {"threads", thread_count()},
          {"seconds", number_or_null(cost.seconds())},
          {"longest_seconds", number_or_null(cost.longest_seconds())},
          {"memory_bytes", cost.bytes()},
          {"memory", memory}};
}

/// Experiment, and the function that adds its rows to an overview.
struct OverviewKind {
  Experiment const& experiment;
  void (*add)(SetupOverview& overview, CaseSetup& loaded);
};
constexpr std::array overview_kinds{OverviewKind{bos_experiment, add_bos}, OverviewKind{piv_experiment, add_piv},
                                    OverviewKind{calibration_experiment, add_calibration}};

}  // namespace

SetupOverview make_setup_overview(CaseSetup loaded) {
  SetupOverview overview;
  overview.cost = estimate_render_cost(loaded.setup);
  overview.experiment = loaded.setup.experiment().name;
  if (OverviewKind const* const kind = find_kind(overview_kinds, loaded.setup.experiment())) {
    kind->add(overview, loaded);
  }
  add_lenslets(overview.rows, loaded.setup);
  return overview;
}

std::string overview_text(SetupOverview const& overview) {
  std::string text = rows_text(overview.rows);
  text += cost_text(overview.cost);
  for (std::string const& note : overview.notes) text += "  note: " + note + '\n';
  return text;
}

nlohmann::ordered_json overview_json(SetupOverview const& overview) {
  nlohmann::ordered_json json{{"experiment", overview.experiment}};
  json.update(sheet_values(overview.rows));
  json["notes"] = overview.notes;
  json["render"] = cost_json(overview.cost);
  return json;
}

}  // namespace gladstone::inline design
