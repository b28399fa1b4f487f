#include "studies/compare/displacement_truth.h"

#include <algorithm>
#include <vector>

#include "render/base/contracts.h"
#include "studies/compare/compare.h"
#include "studies/compare/particle_points.h"

namespace gladstone {

Image<Vec2d> displacement_truth(Scene const& scene, Renderer& renderer, TruthAt at, int spacing_px) {
  GLADSTONE_EXPECTS(spacing_px >= 1);
  CameraSetup const& camera = scene.setup.camera;
  Image<Vec2d> map((camera.columns + spacing_px - 1) / spacing_px, (camera.rows + spacing_px - 1) / spacing_px);
  std::vector<Vec2d> places;
  places.reserve(map.size());
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      places.push_back({static_cast<double>(column) * spacing_px, static_cast<double>(row) * spacing_px});
    }
  }
  std::vector<Vec2d> const displacements =
      scene.setup.piv ? particle_displacements(scene, renderer, places, at)
                      : truth_at_points(scene, renderer, places, at, RenderTheory::no).displacement_px;
  std::copy(displacements.begin(), displacements.end(), map.begin());
  return map;
}

}  // namespace gladstone
