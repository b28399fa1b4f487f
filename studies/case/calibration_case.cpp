#include "studies/case/calibration_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/random.h"
#include "render/base/units.h"
#include "render/files/image_file.h"
#include "render/files/output_file.h"
#include "render/method.h"
#include "render/planning.h"
#include "render/render.h"
#include "render/scene/calibration_planes.h"
#include "studies/case/calibration_truth.h"
#include "studies/case/case_warnings.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_json.h"

namespace gladstone::inline cases {
namespace {

constexpr std::size_t dots_traced_again = 64;
constexpr int dots_for_a_fit = 12;  // minimum number of dots per plane for a homography and its check

/// Selects up to `dots_traced_again` dots, evenly distributed over the pattern.
DotPattern some_dots(Scene const& scene) {
  DotPattern some = scene.dots;
  some.centre.clear();
  std::size_t const count = scene.dots.centre.size(), taken = std::min(count, dots_traced_again);
  for (std::size_t k = 0; k < taken; ++k) some.centre.push_back(scene.dots.centre[k * count / taken]);
  return some;
}

DotPositionError place_error(Scene const& scene, RenderPlan const& plan, Renderer& renderer) {
  DotPositionError error;
  if (scene.chief_rays_only()) return error;
  DotPattern const some = some_dots(scene);
  auto const places = [&](std::uint64_t repeat) {
    RenderPlan other = plan;
    other.seed = repeat_seed(plan.seed, repeat);
    return renderer.render(scene, other, some, RenderImages::yes, RenderTheory::no).truth.reference_px;
  };
  std::vector<Vec2d> const one = places(1), two = places(2);
  double squares = 0;
  for (std::size_t k = 0; k < one.size(); ++k) {
    Vec2d const apart = (one[k] - two[k]) / std::sqrt(2.0);
    if (!std::isfinite(apart.x)) continue;
    ++error.dots;
    squares += dot(apart, apart);
    error.largest_px = std::max({error.largest_px, std::abs(apart.x), std::abs(apart.y)});
  }
  error.rms_px = std::sqrt(squares / (2.0 * static_cast<double>(error.dots)));
  return error;
}

/// Warns if the position error of a plane exceeds the tolerance.
void warn_of_place_errors(RenderedCalibration& rendered) {
  double worst = 0, at = 0;
  for (RenderedPlane const& plane : rendered.planes) {
    if (!(plane.place_error.rms_px > worst)) continue;
    worst = plane.place_error.rms_px;
    at = plane.z;
  }
  if (worst <= truth_tolerance_px) return;
  warn(rendered.warnings,
       {WarningCode::low_accuracy, "render.rays_per_dot",
        fmt::format("{} rays per dot cause errors of {:.2g} px rms in the positions of the dots on Z = {:.6g} mm (more "
                    "than {:g} px); increase render.rays_per_dot, or use a larger f-number",
                    rendered.rays, worst, at / unit::millimetre, truth_tolerance_px)});
}

/// Returns the camera with an independent noise seed for each frame.
CameraSetup camera_of_frame(CameraSetup camera, std::size_t frame) {
  camera.noise.seed = repeat_seed(camera.noise.seed, frame);
  return camera;
}

}  // namespace

RenderedCalibration render_planes(CaseSetup& loaded, Renderer& renderer) {
  auto const start = std::chrono::steady_clock::now();
  Setup const& setup = loaded.setup;
  RenderedCalibration rendered;
  warn(rendered.warnings, loaded.warnings);
  double brightest = 0;
  for (double const z : setup.planes) {
    RenderedPlane plane;
    plane.z = z;
    plane.scene = build_scene(plane_setup(setup, z));
    RenderPlan const plan = plan_rendering(plane.scene);
    auto const in_view = std::count_if(plane.scene.dots.centre.begin(), plane.scene.dots.centre.end(),
                                       [&](Vec2d centre) { return plane.scene.in_view(centre); });
    if (in_view < dots_for_a_fit) {
      warn(rendered.warnings, {WarningCode::out_of_view, "calibration",
                               fmt::format("only {} dots of the plane Z = {:.6g} mm are in view ({} are required); "
                                           "change the position of the camera, or calibration.spacing_mm and extent_mm",
                                           in_view, z / unit::millimetre, dots_for_a_fit)});
    }
    Rendering traced = render(plane.scene, plan, renderer, RenderImages::yes, RenderTheory::no);
    warn_of_unseen(rendered.warnings, plane.scene, traced,
                   fmt::format(" of the plane Z = {:.6g} mm", z / unit::millimetre));
    plane.light = std::move(traced.light.reference);
    plane.truth = std::move(traced.truth);
    for (std::int64_t const rays : plane.truth.rays_planned) {
      plane.rays = std::max(plane.rays, static_cast<std::uint64_t>(rays));
    }
    rendered.rays = std::max(rendered.rays, plane.rays);
    plane.statuses = traced.statuses;
    plane.place_error = place_error(plane.scene, plan, renderer);
    rendered.device = traced.device;
    brightest = std::max(brightest, *std::max_element(plane.light.begin(), plane.light.end()));
    rendered.planes.push_back(std::move(plane));
  }
  warn_of_place_errors(rendered);
  CameraSetup const& camera = setup.camera;
  rendered.exposure_e = camera.exposure_e ? *camera.exposure_e : Detector::auto_exposure(camera, brightest);
  SetupTable root = loaded.document.root();
  root.table("render").resolve("method", std::string(to_string(RenderMethod::rays)));
  if (setup.render.rays_per_dot || camera.exposure_e) {
    root.table("camera").resolve("exposure", rendered.exposure_e);
  } else {  // If the rays are chosen again, they are chosen for the same exposure, so "auto" remains.
    root.table("camera").resolve("exposure", std::string("auto"));
  }
  if (!setup.render.rays_per_dot) root.table("render").resolve("rays_per_dot", std::string("auto"));
  rendered.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return rendered;
}

namespace {

nlohmann::json place_error_json(DotPositionError const& error) {
  return {{"rms", number_or_null(error.rms_px)}, {"largest", error.largest_px}, {"dots", error.dots}};
}

}  // namespace

Recording record_plane(CameraSetup const& camera, RenderedCalibration const& rendered, std::size_t plane) {
  Detector const detector(camera_of_frame(camera, plane), rendered.exposure_e);
  return detector.record(rendered.planes[plane].light, RandomStream::noise_reference);
}

nlohmann::json write_calibration(CaseSetup& loaded, RenderedCalibration const& rendered, std::string const& folder) {
  CameraSetup const& camera = loaded.setup.camera;
  std::string const resolved = loaded.document.resolved();
  auto const place = [&folder](std::string const& name) { return (std::filesystem::path(folder) / name).string(); };
  FileOrigin origin{"gladstone calibration truth", 1, resolved, loaded.setup.render.seed, rendered.device};
  Warnings warnings = rendered.warnings;
  nlohmann::json planes = nlohmann::json::array();
  std::size_t dots = 0, all_saturated = 0;
  for (std::size_t i = 0; i < rendered.planes.size(); ++i) {
    RenderedPlane const& plane = rendered.planes[i];
    Recording const frame = record_plane(camera, rendered, i);
    std::string const name = case_file::plane(i);
    write_tiff(place(name), frame.image, {camera.bit_depth, camera.pixel_pitch, resolved});
    origin.sources.add_known(name.substr(0, name.find('.')), pixel_sha256(frame.image));
    auto const unseen = std::count_if(plane.truth.reference_px.begin(), plane.truth.reference_px.end(),
                                      [](Vec2d p) { return std::isnan(p.x); });
    dots += plane.truth.size();
    all_saturated += frame.saturated;
    planes.push_back({{"file", name},
                      {"z_mm", plane.z / unit::millimetre},
                      {"dots", plane.truth.size()},
                      {"dots_unseen", unseen},
                      {"saturated", frame.saturated},
                      {"rays_planned", plane.rays},
                      {"place_error_px", place_error_json(plane.place_error)},
                      {"magnification", plane.scene.imaging.magnification},
                      {"sha256", pixel_sha256(frame.image)}});
  }
  if (all_saturated > 0) {
    warn(warnings,
         {WarningCode::exposure, "camera.exposure",
          fmt::format("{} pixels are saturated, which shifts the centroids of their dots; reduce camera.exposure",
                      all_saturated)});
  }
  for (auto const& [path, hash] : loaded.input_hashes) origin.sources.add("", path, SourceFiles::Holds::bytes, hash);
  origin.sources.add_known("inputs", nlohmann::json(loaded.input_hashes).dump());
  write_calibration_truth(place(case_file::truth), rendered, origin);
  OutputFile::write_text(place(case_file::setup), insert_uncertain_inputs(resolved, loaded.uncertain));
  nlohmann::json summary{{"experiment", "calibration"},
                         {"planes", planes},
                         {"dots", dots},
                         {"rays_per_dot", rendered.rays},
                         {"exposure", rendered.exposure_e},
                         {"method", to_string(RenderMethod::rays)},
                         {"device", rendered.device},
                         {"warnings", to_strings(warnings)},
                         {"warning_records", warnings},
                         {"seconds_render", rendered.seconds}};
  OutputFile::write_text(place(case_file::summary), json_text(summary) + "\n");
  return summary;
}

}  // namespace gladstone::inline cases
