#include "studies/compare/compare.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/standard_correlator.h"
#include "analysis/errors/deformed_window_truth.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/files/stop_point.h"
#include "render/method.h"
#include "render/rays/rays_renderer.h"
#include "render/scene/build_camera.h"
#include "render/sensor/detector.h"
#include "studies/case/truth_file.h"
#include "studies/case/warning_log.h"
#include "studies/case/write_case.h"
#include "studies/compare/budget_stages.h"
#include "studies/compare/compared_vectors.h"
#include "studies/compare/comparison_kind.h"
#include "studies/compare/comparison_warnings.h"
#include "studies/compare/correlate.h"
#include "studies/compare/stored_comparison.h"
#include "studies/compare/thinned_vectors.h"
#include "studies/compare/tracked_dots.h"

namespace gladstone::inline compare {
namespace {

/// Returns the weight of each dot in the correlation: the geometric mean of its light in both frames. The weight of a
/// pair of images is proportional to the product of their light.
std::vector<double> correlation_flux(GroundTruth const& truth) {
  std::vector<double> flux;
  flux.reserve(truth.size());
  for (Vec2d const& both : truth.flux) flux.push_back(std::sqrt(std::max(0.0, both.x * both.y)));
  return flux;
}

/// Initializes a comparison from its vectors.
Comparison comparison_of(MeasuredVectors& vectors, Setup const& setup) {
  Comparison comparison;
  comparison.measured = std::move(vectors.field);
  comparison.report = vectors.report;
  comparison.foreign = vectors.foreign;
  comparison.left_out = vectors.left_out;
  comparison.detected = vectors.detected;
  comparison.complete = vectors.complete;
  comparison.chain = comparison_kind(setup).chain;
  return comparison;
}

/// Computes mask and budgets of a comparison with a complete chain.
/// @param name  name of the vectors, for messages
/// @throws DataError if no vector can be compared
void judge_chain(Comparison& comparison, std::string const& name) {
  DisplacementField const& measured = comparison.measured;
  std::vector<std::span<Vec2d const>> references{comparison.point.displacement_px, comparison.window.displacement_px};
  for (ReferenceDisplacement const& one : comparison_kind(comparison).references)
    references.emplace_back(one.of(comparison));
  for (std::vector<Vec2d> const* optional : {&comparison.thin_lens, &comparison.noise_free})
    if (!optional->empty()) references.emplace_back(*optional);
  comparison.mask = common_mask(measured, references);
  if (std::none_of(comparison.mask.begin(), comparison.mask.end(), [](auto counts) { return counts != 0; })) {
    throw DataError(ErrorCode::undetermined, name,
                    "has no vector that can be compared: no vector is valid, in view and has three dots with a truth "
                    "in its window; check the vectors and --conventions");
  }
  comparison.budget = error_budget(budget_stages(comparison, comparison.window), comparison.mask, comparison.chain);
  if (comparison.frames_deformed) {
    comparison.budget_after_passes =
        error_budget(budget_stages(comparison, comparison.deformed_window), comparison.mask, comparison.chain);
  }
}

}  // namespace

void name_sources(Comparison& comparison, ComparedFiles files) {
  comparison.verified = files.unverified.empty();
  comparison.sources = std::move(files.sources);
}

GroundTruth truth_at_points(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                            std::vector<Vec2d> const& centres_px, TruthAt at, RenderTheory theory) {
  DotPattern virtual_dots;
  virtual_dots.shape = scene.dots.shape;
  virtual_dots.centre.resize(centres_px.size());
  parallel_for(centres_px.size(), [&](std::size_t i) { virtual_dots.centre[i] = scene.to_target(centres_px[i]); });
  auto const correct = [&](GroundTruth const& truth) {
    parallel_for(centres_px.size(), [&](std::size_t i) {
      Vec2d const shift = at == TruthAt::mid_position ? 0.5 * truth.displacement_px[i] : Vec2d{};
      Vec2d const miss = centres_px[i] - (truth.reference_px[i] + shift);
      if (!std::isfinite(miss.x) || !std::isfinite(miss.y)) return;
      Vec2d const seen = truth.reference_px[i];
      virtual_dots.centre[i] = virtual_dots.centre[i] + (scene.to_target(seen + miss) - scene.to_target(seen));
    });
  };
  // Both corrections use few rays, the first with point dots, the second with dots of the target's size.
  RenderPlan few = plan;
  few.given_rays = few.rays = std::min<std::uint64_t>(plan.rays, 128);
  for (double const half_size : {0.0, scene.dots.half_size}) {
    virtual_dots.half_size = half_size;
    correct(renderer.render(scene, few, virtual_dots, RenderImages::no, RenderTheory::no).truth);
  }
  return renderer.render(scene, plan, virtual_dots, RenderImages::no, theory).truth;
}

std::vector<Vec2d> ideal_lens_truth(Scene scene, RenderPlan plan, Renderer& renderer, GroundTruth const& point) {
  if (plan.method == RenderMethod::focused_dots && scene.setup.lens.focus == Focus::target)
    return point.displacement_px;
  DotPattern virtual_dots;
  virtual_dots.half_size = scene.dots.half_size;
  virtual_dots.shape = scene.dots.shape;
  for (Vec3d const& p : point.position_m) virtual_dots.centre.push_back({p.x, p.y});
  // On the optical axis, the ideal lens can be rendered by the fast renderer, unless rays are requested.
  bool const focusable = scene.setup.has_closed_form_layout() && !scene.chief_rays_only();
  bool const by_rays = scene.setup.render.method == RenderMethod::rays || plan.method != resolve_render_method(scene);
  if (!focusable || by_rays) return ideal_displacements(scene, plan, virtual_dots);
  plan.method = RenderMethod::automatic;
  // Retain the sensor's position, and so the magnification; change the focal length to focus on the target.
  scene.setup.lens.focal_length = 1 / (1 / scene.imaging.image_distance + 1 / scene.setup.z_b());
  scene.setup.lens.focus = Focus::target;
  scene.setup.lens.f_number = scene.setup.lens.focal_length / scene.imaging.entrance_pupil;
  scene.camera = build_camera(scene.setup);
  return renderer.render(scene, plan, virtual_dots, RenderImages::no, RenderTheory::no).truth.displacement_px;
}

PointTruth truth_of_vectors(PreparedCase const& prepared, Renderer& renderer, std::vector<Vec2d> const& position_px,
                            TruthAt at) {
  return comparison_kind(prepared.scene.setup).truth(prepared.scene, prepared.plan, renderer, position_px, at);
}

Comparison compare_case(std::string const& folder, Backend const& device, CompareOptions const& options,
                        CaseSetup const* known) {
  ComparedFiles files = compared_files(folder, options.vectors);
  if (!files.unverified.empty()) {
    log_warning(
        {WarningCode::assumed, files.unverified,
         fmt::format("contains no SHA-256 of its frames, so that it is unknown whether {} was measured on this case",
                     files.vectors)});
  }
  CaseSetup loaded = known ? known->copy() : load_case_setup(files.setup, {});
  GroundTruth const dots = read_truth(files.truth);
  MeasuredVectors vectors = load_vectors(files.vectors, loaded, &dots, options);
  stop_point("comparing");
  Warnings given;  // warnings already logged
  auto const setup = std::make_shared<CaseSetup const>(loaded.copy());
  std::string fingerprint = comparison_fingerprint(files.sources, options);
  Comparison comparison = comparison_of(vectors, loaded.setup);
  if (options.reuse && read_chain(folder, fingerprint, comparison)) {
    spdlog::info("reused the comparison of {}, which was made from the same files", in_case(folder, case_file::errors));
    judge_chain(comparison, vectors.name);
  } else {
    vectors.field = std::move(comparison.measured);
    PreparedCase const prepared = prepare_case(loaded);
    given = prepared.warnings;
    std::optional<RenderedCase> rendered;
    bool const again = !vectors.foreign && !vectors.settings.gives_scattered_vectors();
    if (again) rendered = render_case(prepared, *device.renderer, RenderTheory::no);
    PointTruth point = truth_of_vectors(prepared, *device.renderer, vectors.field.position_px, options.truth_at);
    comparison = compare_vectors(prepared, dots, rendered ? &*rendered : nullptr, std::move(vectors), std::move(point),
                                 device, options.truth_at);
  }
  name_sources(comparison, std::move(files));
  comparison.setup = setup;
  comparison.fingerprint = std::move(fingerprint);
  comparison.warnings = comparison_warnings(comparison, loaded.setup);
  for (Warning const& warning : comparison.warnings) {
    if (std::find(given.begin(), given.end(), warning) == given.end()) log_warning(warning);
  }
  return comparison;
}

Comparison compare_vectors(PreparedCase const& prepared, GroundTruth const& dots, RenderedCase const* rendered,
                           MeasuredVectors vectors, PointTruth truth, Backend const& device, TruthAt at) {
  Comparison comparison = comparison_of(vectors, prepared.scene.setup);
  comparison.point = std::move(truth.point);
  comparison.thin_lens = std::move(truth.thin_lens);
  comparison.flow_px = std::move(truth.flow_px);
  comparison.ambient_px = std::move(truth.ambient_px);
  DisplacementField const& measured = comparison.measured;

  CorrelationSettings const& settings = vectors.settings;
  CameraSetup const& camera = prepared.scene.setup.camera;
  std::vector<double> const flux = correlation_flux(dots);
  bool const tracked = correlation_method(settings.method).tracks_dots;
  if (tracked) {
    comparison.window =
        tracked_truth(dots, flux, camera, comparison.point.displacement_px, measured.position_px, settings, at);
    comparison.deformed_window = comparison.window;
  } else {
    comparison.window = window_truth(dots.reference_px, dots.displacement_px, flux, measured.position_px,
                                     correlation_window(window_weighting(settings), settings.window_px.back()), at);
    comparison.deformed_window = deformed_window_truth(dots.reference_px, dots.displacement_px, flux,
                                                       measured.position_px, settings, camera.columns, camera.rows, at);
  }
  comparison.frames_deformed = !tracked && (settings.window_px.size() > 1 || settings.final_passes > 1);
  if (rendered && !settings.gives_scattered_vectors()) {  // scattered vectors are excluded, since other dots may be
                                                          // found in noise-free images
    Detector const detector(prepared.scene.setup.camera, rendered->exposure_e);
    DisplacementField again =
        every_nth(correlate_frames(*rendered->rendering->in_place->ideal(detector),
                                   with_known_dots(settings, prepared.scene.setup, dots.reference_px), device)
                      .field,
                  vectors.every);
    if (again.size() == measured.size()) comparison.noise_free = std::move(again.displacement_px);
  }

  judge_chain(comparison, vectors.name);
  return comparison;
}

}  // namespace gladstone::inline compare
