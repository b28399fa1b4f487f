#pragma once

#include <vector>

#include "render/focused_dots/dot_model.h"
#include "render/focused_dots/focused_dots.h"
#include "render/scene/source_cubature.h"

namespace gladstone::inline focused_dots {

/// Device on which the moment images are computed: the host, or another one, for which only MomentImages::plan() is
/// called.
enum class MomentImagesBy { host, device };

/// Imaging model of a scene's dots together with the cubature rules that it refers to.
struct OwnedDotModel {
  DotModel model;
  SourceCubature source;
  std::vector<double> moment_images;
  std::vector<ConePoint> cone_points;
  std::vector<Vec2d> cone_directions, cone_scattered;

  /// @param sources  dots to be rendered: the scene's, or others
  /// @param table  deflection table of the scene; must outlive the model
  /// @param with_images  false: moment images are not computed
  OwnedDotModel(FocusedDots const& dots, DotPattern const& sources, DeflectionTable const& table, bool with_images,
                MomentImagesBy by = MomentImagesBy::host);
  OwnedDotModel(OwnedDotModel const&) = delete;  // the model points into the rules
  OwnedDotModel& operator=(OwnedDotModel const&) = delete;
};

}  // namespace gladstone::inline focused_dots
