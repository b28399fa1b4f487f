#include "studies/case/case_summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "render/method.h"
#include "render/scene/ray_losses.h"
#include "studies/case/json_text.h"
#include "studies/case/particle_case.h"

namespace gladstone {
namespace {

/// Minimum, median and maximum.
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

nlohmann::json table_error_json(RayBudget const& error) {
  return {{"fineness", error.fineness},
          {"truth_px", resolved(error.truth_error_px, error.truth_resolution_px)},
          {"image_levels", resolved(error.image_error_levels, error.image_resolution_levels)},
          {"truth_resolution_px", number_or_null(error.truth_resolution_px)},
          {"image_resolution_levels", number_or_null(error.image_resolution_levels)},
          {"bits", error.bits}};
}

nlohmann::json side_faces_json(SideFaceErrors const& there, int bits) {
  return {{"dots", there.dots},
          {"rays", there.rays},
          {"truth_error_px", number_or_null(there.truth_error_px)},
          {"image_error_levels", number_or_null(there.image_error_levels)},
          {"bits", bits},
          {"rays_wanted", number_or_null(there.rays_wanted)}};
}

nlohmann::json plan_json(RayBudget const& plan, std::size_t sources) {
  return {{"truth_error_px", resolved(plan.truth_error_px, plan.truth_resolution_px)},
          {"image_error_levels", resolved(plan.image_error_levels, plan.image_resolution_levels)},
          {"truth_resolution_px", number_or_null(plan.truth_resolution_px)},
          {"image_resolution_levels", number_or_null(plan.image_resolution_levels)},
          {"bits", plan.bits},
          {"extrapolated", plan.extrapolated},
          {"truth_asked_px", truth_tolerance_px},
          {"image_asked_levels", image_tolerance_levels},
          {"rays_wanted", number_or_null(plan.rays_wanted)},
          {"processor_seconds", number_or_null(plan.seconds)},
          {"processor_seconds_allowed", source_budget_s * static_cast<double>(sources)}};
}

}  // namespace

nlohmann::json case_summary(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                            RecordedFrames const& frames, CaseOutcome const& outcome) {
  Scene const& scene = prepared.scene;
  Rendering const& rendering = *rendered.rendering;
  TruthAccuracy const& accuracy = outcome.accuracy;
  RayBudget const& plan = prepared.rays;
  bool const piv = scene.setup.piv.has_value(), formula = rendering.method == RenderMethod::formula;
  nlohmann::json summary{
      {"magnification", scene.imaging.magnification},
      {"step_mm", prepared.step.step_mm},
      {"step", {{"change_px", prepared.step.change_px}, {"limiting_dot", prepared.step.limiting_dot}}},
      {"rays_per_dot", formula ? nlohmann::json(nullptr) : nlohmann::json(plan.rays)},
      {"rays_planned", spread_of(traced_only(rendering.truth.rays_planned))},
      {"exposure", rendered.exposure_e},
      {"gladstone_dale", scene.setup.medium.gladstone_dale},
      {"spot",
       {{"model", loaded.document.root().table("lens").text("psf", "gaussian")},
        {"first_zero_diameter_px", scene.setup.spot_diameter_px()},
        {"sigma_px", scene.spot_sigma_px() > 0 ? nlohmann::json(scene.spot_sigma_px()) : nlohmann::json(nullptr)}}},
      {"experiment", piv ? "piv" : "bos"},
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
        {"side_faces", plan.side_faces ? side_faces_json(*plan.side_faces, plan.bits) : nlohmann::json(nullptr)}}},
      {"method", to_string(rendering.method)},
      {"device", outcome.device},
      {"precision", "double"},
      {"rays",
       {{"traced", rendering.rays},
        {"reference", status_counts(rendering.statuses, 0)},
        {"flow", status_counts(rendering.statuses, 1)}}},
      {"rays_lost_by_surface", formula ? nlohmann::json(nullptr) : losses_json(sample_ray_losses(scene))},
      {"pupil_margin_mm", rendered.rendering->pupil_margin / unit::millimetre},
      {"caustic_fraction", prepared.strain.caustic_fraction},
      {"saturated", {{"reference", frames.saturated_reference}, {"flow", frames.saturated_flow}}},
      {"reference_sha256", outcome.reference_sha256},
      {"flow_sha256", outcome.flow_sha256},
      {"photons_fully_lit", rendered.exposure_e / scene.setup.camera.noise.quantum_efficiency},
      {"warnings", outcome.warnings},
      {"seconds_render", rendered.seconds},
  };
  if (piv) summary.update(particle_summary(scene, rendering.truth, rendered.exposure_e));
  if (!scene.setup.render.rays_per_dot && !formula) summary["rays_plan"] = plan_json(plan, rendering.truth.size());
  return summary;
}

}  // namespace gladstone
