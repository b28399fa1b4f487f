#include "studies/case/kinds/shared_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "render/base/integer_frames.h"
#include "render/planning.h"
#include "studies/case/case_warnings.h"
#include "studies/case/truth_file.h"
#include "studies/case/write_case.h"

namespace gladstone::inline cases {

void cross_check_windows(CaseSetup& loaded) {
  CameraSetup const& camera = loaded.setup.camera;
  for (int window : loaded.correlate.window_px) {
    if (window <= std::min(camera.columns, camera.rows)) continue;
    loaded.document.root()
        .table("correlate")
        .problem("window_px",
                 fmt::format("a window of {} px is larger than the image of {} x {} px; use smaller windows", window,
                             camera.columns, camera.rows));
  }
}

CaseWriter render_pair(CaseSetup& loaded, Renderer& renderer, ReusableParts const& known,
                       SharedParts::OfCamera const& shared, RenderedCamera& entry, BuiltMedium& medium) {
  if (shared.exposure_e) loaded.setup.camera.exposure_e = shared.exposure_e;
  loaded.setup.shared_particles = shared.particles;
  auto const finished = std::make_shared<RecordedCase>(render_case_in_memory(loaded, renderer, known));
  if (!shared.reference.empty()) {
    FramePair<std::uint16_t> levels = finished->frames.levels->integers();
    levels.reference = shared.reference;
    finished->frames.levels = std::make_shared<IntegerFrames const>(std::move(levels));
  }
  Rendering const& rendering = *finished->rendered.rendering;
  entry.sources = rendering.truth.size();
  entry.name_of_sources = loaded.setup.experiment().sources.many;
  std::vector<std::int64_t> planned = rendering.truth.rays_planned;
  std::erase(planned, 0);  // remove particles out of view
  if (!planned.empty()) {
    auto const [least, most] = std::minmax_element(planned.begin(), planned.end());
    entry.rays = static_cast<std::uint64_t>(*least);
    entry.most_rays = static_cast<std::uint64_t>(*most);
  }
  entry.step_mm = finished->prepared.plan.step_estimate.step_mm;
  entry.magnification = finished->prepared.scene.imaging.magnification;
  entry.exposure_e = finished->rendered.exposure_e;
  entry.seconds = finished->rendered.seconds;
  entry.device = rendering.device;
  medium = finished->prepared.scene.medium;
  return [&loaded, finished](std::string const& folder) {
    auto const& [prepared, rendered, frames] = *finished;
    return write_case(loaded, prepared, rendered, frames, judge_case(loaded, prepared, rendered, frames), folder);
  };
}

ImageDiameters images_of_dots(Setup const& setup) {
  return {setup.geometric_dot_px(), setup.spot_e2_diameter_px(), setup.defocus_diameter_px(), setup.z_b()};
}

double number_of_dots(Scene const& scene) { return static_cast<double>(scene.dots.centre.size()); }

void warn_of_dots_out_of_view(Scene const& scene, Warnings& warnings) {
  auto const in_view = [&scene](Vec2d centre) { return scene.in_view(centre); };
  if (std::none_of(scene.dots.centre.begin(), scene.dots.centre.end(), in_view)) {
    warn(warnings,
         {WarningCode::out_of_view, "target",
          fmt::format("all {} dots lie outside the view of {:.4g} x {:.4g} mm about the axis: the images will be "
                      "empty; check the target's file (positions are in mm) or increase target.dots_per_32px_window",
                      scene.dots.centre.size(),
                      scene.setup.camera.columns * scene.setup.camera.pixel_pitch / scene.imaging.magnification * 1e3,
                      scene.setup.camera.rows * scene.setup.camera.pixel_pitch / scene.imaging.magnification * 1e3)});
  }
}

void write_dot_truth(std::string const& path, Scene const& scene, Rendering const& rendering,
                     CaseOutcome const& outcome, FileOrigin const& origin) {
  write_truth(path, scene, rendering, field_in_view(scene, rendering.plan, truth_map_spacing_px),
              outcome.table_error ? &*outcome.table_error : nullptr, origin);
}

nlohmann::json no_own_summary(Scene const& /*scene*/, GroundTruth const& /*truth*/, double /*exposure_e*/) {
  return nlohmann::json::object();
}

}  // namespace gladstone::inline cases
