#include "render/accuracy.h"

#include "render/focused_dots/table_error.h"
#include "render/method.h"
#include "render/rays/sample_images.h"
#include "render/scene/side_faces.h"
#include "render/scene/source_sample.h"

namespace gladstone {
namespace {

/// Measures the standard error of the images of a general rendering if the number of rays was adaptive.
double error_of_adaptive_rays(Scene const& scene, RenderPlan const& plan, double level) {
  bool const one_path = plan.rays == 1;
  return plan.adaptive_criteria && !one_path ? measure_image_error(scene, plan, level, all_sources(scene))
                                             : not_measured;
}

/// Measures the standard error of the images of the dots at side faces, which are rendered ray by ray.
double error_at_side_faces(Scene const& scene, RenderPlan plan, double level) {
  std::vector<std::size_t> const at_faces = sources_at_side_faces(scene, plan, scene.dots);
  if (at_faces.empty()) return not_measured;
  plan.rays = plan.given_rays.value_or(max_rays_per_source(scene, plan));
  return measure_image_error(scene, plan, level, at_faces);
}

}  // namespace

RenderingAccuracy measure_accuracy(Scene const& scene, RenderPlan const& plan, GroundTruth const& truth,
                                   double exposure_e) {
  double const level = light_per_level(scene.setup.camera, exposure_e);
  RenderingAccuracy accuracy;
  accuracy.truth = truth_accuracy(truth, truth_tolerance_px);
  if (plan.method == RenderMethod::rays) accuracy.image_levels = error_of_adaptive_rays(scene, plan, level);
  if (plan.method == RenderMethod::focused_dots) {
    accuracy.image_levels = error_at_side_faces(scene, plan, level);
    accuracy.table = plan.table_error ? *plan.table_error : measure_table_error(require_focused_dots(scene, plan));
  }
  return accuracy;
}

}  // namespace gladstone
