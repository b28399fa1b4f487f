#pragma once

#include <vector>

#include "render/focused_dots/dot_light.h"
#include "render/focused_dots/focused_dots.h"
#include "render/scene/source_cubature.h"

namespace gladstone {

/// Who works out the images of moments: here, or a device, which has only their plan.
enum class MomentImagesBy { host, device };

/// A scene's light model with the rules that it integrates by; the spot's Airy table is the caller's.
struct OwnedLightModel {
  LightModel model;
  SourceCubature source;
  std::vector<double> moment_images;
  SourceCubature pupil[pupil_rules];
  std::vector<ConePoint> cone_points;
  std::vector<Vec2d> cone_directions, cone_scattered;

  /// @param sources its dots, or others @param spot null: no images @param table of the scene, kept by the caller; or
  /// one that does not exist
  OwnedLightModel(FocusedDots const& dots, DotPattern const& sources, SpotView const* spot,
                  DeflectionTable const& table, MomentImagesBy by = MomentImagesBy::host);
  OwnedLightModel(OwnedLightModel const&) = delete;  // the model points into the rules
  OwnedLightModel& operator=(OwnedLightModel const&) = delete;
};

}  // namespace gladstone
