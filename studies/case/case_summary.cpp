#include "studies/case/case_summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "render/method.h"
#include "render/scene/ray_losses.h"
#include "studies/case/case_kind.h"
#include "studies/case/json_text.h"
#include "studies/case/lens_glasses.h"
#include "studies/case/warning_json.h"
#include "studies/case/write_case.h"

namespace gladstone::inline cases {
namespace {

/// Returns minimum, median and maximum.
nlohmann::json spread_of(std::vector<std::int64_t> numbers) {
  if (numbers.empty()) return nullptr;
  std::sort(numbers.begin(), numbers.end());
  return {{"least", numbers.front()}, {"median", numbers[numbers.size() / 2]}, {"most", numbers.back()}};
}

/// Removes the zero ray numbers of particles that were not traced.
std::vector<std::int64_t> traced_only(std::vector<std::int64_t> rays) {
  std::erase(rays, 0);
  return rays;
}

nlohmann::json status_counts(StatusCounts const& counts, std::size_t frame) {
  nlohmann::json json;
  for (std::size_t status = 0; status < ray_status_count; ++status) {
    json[to_string(static_cast<RayStatus>(status))] = counts[frame][status];
  }
  return json;
}

/// Returns the fractions of a sample of rays lost in each frame, by surface and cause.
nlohmann::json losses_json(RayLosses const& losses) {
  nlohmann::json json{{"sample", {{"sources", losses.sources}, {"rays_of_each", losses.rays}}},
                      {"reference", nlohmann::json::object()},
                      {"flow", nlohmann::json::object()}};
  for (ElementRayLoss const& lost : losses.lost) {
    for (std::size_t frame = 0; frame < frame_count; ++frame) {
      if (lost.share[frame] > 0) {
        json[frame == 0 ? "reference" : "flow"][lost.place][to_string(lost.cause)] = lost.share[frame];
      }
    }
  }
  return json;
}

/// Returns an error; null if it is below its resolution or was not measured.
nlohmann::json resolved(double error, double resolution) {
  return error < resolution ? nlohmann::json(nullptr) : number_or_null(error);
}

nlohmann::json table_error_json(TableError const& error) {
  return {{"fineness", error.fineness},
          {"truth_px", resolved(error.truth_px, error.truth_resolution_px)},
          {"image_levels", resolved(error.image_levels, error.image_resolution_levels)},
          {"truth_resolution_px", number_or_null(error.truth_resolution_px)},
          {"image_resolution_levels", number_or_null(error.image_resolution_levels)},
          {"bits", error.bits}};
}

nlohmann::json side_faces_json(SideFaceAccuracy const& there) {
  return {{"dots", there.dots}, {"rays", there.most_rays}, {"truth_error_px", number_or_null(there.truth_error_px)}};
}

/// Returns the number of rays of every source; if it is adaptive, the largest.
nlohmann::json rays_per_source(PreparedCase const& prepared, Rendering const& rendering) {
  if (rendering.plan.method == RenderMethod::formula) return nullptr;
  std::vector<std::int64_t> const& rays = rendering.truth.rays_planned;
  bool const adaptive = rendering.plan.method == RenderMethod::rays && prepared.plan.adaptive_criteria && !rays.empty();
  return adaptive ? nlohmann::json(*std::max_element(rays.begin(), rays.end())) : nlohmann::json(prepared.plan.rays);
}

/// Returns the glasses of a prescription; empty for an ideal lens.
nlohmann::json glasses_of_setup(LensSetup const& setup) {
  if (!setup.prescription) return nlohmann::json::array();
  GlassCatalogue glasses = GlassCatalogue::shipped();
  for (std::string const& file : setup.glasses) glasses.add_file(file);
  return lens_glasses_json(list_lens_glasses(*setup.prescription, glasses));
}

}  // namespace

nlohmann::json case_summary(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                            RecordedFrames const& frames, CaseOutcome const& outcome) {
  Scene const& scene = prepared.scene;
  Rendering const& rendering = *rendered.rendering;
  TruthAccuracy const& accuracy = outcome.accuracy;
  bool const formula = rendering.plan.method == RenderMethod::formula;
  nlohmann::json summary{
      {"magnification", scene.imaging.magnification},
      {"step_mm", prepared.plan.step_estimate.step_mm},
      {"step",
       {{"change_px", prepared.plan.step_estimate.change_px},
        {"limiting_dot", prepared.plan.step_estimate.limiting_dot}}},
      {"rays_per_dot", rays_per_source(prepared, rendering)},
      {"rays_planned", spread_of(traced_only(rendering.truth.rays_planned))},
      {"exposure", rendered.exposure_e},
      {"gladstone_dale", scene.setup.medium.gladstone_dale},
      {"spot",
       {{"model", loaded.document.root().table("lens").text("psf", "gaussian")},
        {"first_zero_diameter_px", scene.setup.spot_diameter_px()},
        {"sigma_px", scene.spot_sigma_px() > 0 ? nlohmann::json(scene.spot_sigma_px()) : nlohmann::json(nullptr)}}},
      {"experiment", scene.setup.experiment().name},
      {"dots", rendering.truth.size()},
      {"dots_unseen", outcome.unseen},
      {"truth_error_px",
       {{"rms", number_or_null(accuracy.rms_px)},
        {"largest", std::isnan(accuracy.rms_px) ? nlohmann::json(nullptr) : nlohmann::json(accuracy.largest_px)},
        {"largest_dot", accuracy.worst},
        {"dots_above_1e-3", accuracy.above},
        {"dots_unknown", accuracy.unknown}}},
      {"estimator",
       {{"dots_by_table", accuracy.by_table},
        {"dots_by_rays", formula ? 0 : rendering.truth.size() - accuracy.by_table},
        {"dots_by_formula", formula ? rendering.truth.size() : 0},
        {"no_table_since", to_string(rendering.table)},
        {"table_error", outcome.table_error ? table_error_json(*outcome.table_error) : nlohmann::json(nullptr)},
        {"side_faces", outcome.side_faces ? side_faces_json(*outcome.side_faces) : nlohmann::json(nullptr)}}},
      {"image_error",
       {{"levels", number_or_null(outcome.image_error_levels)}, {"bits", error_bit_depth(scene.setup.camera)}}},
      {"method", to_string(rendering.plan.method)},
      {"device", outcome.device},
      {"precision", "double"},
      {"rays",
       {{"traced", rendering.rays},
        {"reference", status_counts(rendering.statuses, 0)},
        {"flow", status_counts(rendering.statuses, 1)}}},
      {"rays_lost_by_surface",
       formula ? nlohmann::json(nullptr) : losses_json(sample_ray_losses(scene, prepared.plan))},
      {"lens_glasses", glasses_of_setup(scene.setup.lens)},
      {"pupil_margin_mm", rendered.rendering->pupil_margin / unit::millimetre},
      {"caustic_fraction", prepared.strain.caustic_fraction},
      {"saturated", {{"reference", frames.saturated_reference}, {"flow", frames.saturated_flow}}},
      {"reference_sha256", outcome.reference_sha256},
      {"flow_sha256", outcome.flow_sha256},
      {"photons_fully_lit", rendered.exposure_e / scene.setup.camera.noise.quantum_efficiency},
      {"warnings", to_strings(outcome.warnings)},
      {"warning_records", outcome.warnings},
      {"seconds_render", rendered.seconds},
  };
  summary.update(case_kind(scene.setup).own_summary(scene, rendering.truth, rendered.exposure_e));
  return summary;
}

}  // namespace gladstone::inline cases
