#include "studies/compare/displacement_truth.h"

#include <utility>
#include <vector>

#include "render/base/contracts.h"
#include "studies/compare/comparison_kind.h"
#include "studies/compare/map_refinement.h"

namespace gladstone::inline compare {
namespace {

/// Twice the largest distance between pixels from which the displacement may be interpolated [px].
constexpr int coarsest_spacing_px = 8;

/// Returns the spacing of the coarsest lattice, in units of the distance between nodes.
int first_spacing(int spacing_px) {
  int spacing = 1;
  while (2 * spacing * spacing_px <= coarsest_spacing_px) spacing *= 2;
  return spacing;
}

}  // namespace

Image<Vec2d> displacement_truth(Scene const& scene, RenderPlan const& plan, Renderer& renderer, TruthAt at,
                                int spacing_px, TracedPixels traced) {
  GLADSTONE_EXPECTS(spacing_px >= 1);
  CameraSetup const& camera = scene.setup.camera;
  ComparisonKind const& kind = comparison_kind(scene.setup);
  int const columns = (camera.columns + spacing_px - 1) / spacing_px,
            rows = (camera.rows + spacing_px - 1) / spacing_px;
  auto const sample = [&](std::vector<MapNode> const& nodes) -> MapSamples {
    std::vector<Vec2d> places;
    places.reserve(nodes.size());
    for (MapNode const& node : nodes)
      places.push_back({static_cast<double>(node.column) * spacing_px, static_cast<double>(node.row) * spacing_px});
    if (places.empty()) return {};
    GroundTruth truth = kind.displacements(scene, plan, renderer, places, at);
    return {std::move(truth.displacement_px), std::move(truth.displacement_error_px)};
  };
  bool const all = traced == TracedPixels::all || kind.without_rays(scene);
  return refine_map(columns, rows, all ? 1 : first_spacing(spacing_px), sample);
}

}  // namespace gladstone::inline compare
