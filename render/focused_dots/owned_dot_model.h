#pragma once

#include <vector>

#include "render/focused_dots/dot_model.h"
#include "render/focused_dots/focused_dots.h"
#include "render/scene/source_cubature.h"

namespace gladstone {

/// Who works out the images of moments: here, or a device, which has only their plan.
enum class MomentImagesBy { host, device };

/// A scene's model with the rules that it integrates by.
struct OwnedDotModel {
  DotModel model;
  SourceCubature source;
  std::vector<double> moment_images;
  std::vector<ConePoint> cone_points;
  std::vector<Vec2d> cone_directions, cone_scattered;

  /// @param sources its dots, or others @param table of the scene, kept by the caller @param with_images false: no
  /// images of moments are worked out
  OwnedDotModel(FocusedDots const& dots, DotPattern const& sources, DeflectionTable const& table, bool with_images,
                MomentImagesBy by = MomentImagesBy::host);
  OwnedDotModel(OwnedDotModel const&) = delete;  // the model points into the rules
  OwnedDotModel& operator=(OwnedDotModel const&) = delete;
};

}  // namespace gladstone
