#include "render/scene/spot.h"

#include "render/scene/scene.h"

namespace gladstone::inline scene {

SpotView make_spot(Scene const& scene, std::optional<AiryTable>& airy) {
  SpotView spot;
  spot.model = scene.chief_rays_only() ? SpotModel::none : scene.setup.lens.spot;
  if (spot.model == SpotModel::airy) spot.airy = airy.emplace(scene.spot_scale_px()).view();
  spot.gaussian.sigma = scene.spot_sigma_px();
  return spot;
}

}  // namespace gladstone::inline scene
