#pragma once

#include <utility>

#include "render/rays/ray_planning.h"
#include "render/scene/ray_budget.h"
#include "render/scene/scene.h"

namespace gladstone {

/// A scene with the plan by which a test renders it.
struct PlannedScene : Scene {
  PlannedScene() = default;
  explicit PlannedScene(Scene scene) : Scene(std::move(scene)) {}

  RenderPlan plan;
};

/// Plans the step of a scene and takes over what its setup gives; the other parts of its plan are retained.
inline IntegrationStep plan_step(PlannedScene& scene) {
  RenderPlan const found = with_step(scene, determine_step_by_tracing(scene));
  scene.plan.step = found.step;
  scene.plan.pupil_margin = found.pupil_margin;
  scene.plan.given_rays = found.given_rays;
  scene.plan.seed = found.seed;
  scene.plan.polarity = found.polarity;
  return scene.plan.step_estimate = found.step_estimate;
}

}  // namespace gladstone
