#include "render/rays/source_tracer.h"

namespace gladstone::inline rays {

RayLight::RayLight(SpotView const& spot) : spot_(spot), patch_(spot) {}

void RayLight::begin(LightImage* image, double light_per_weight, std::uint64_t rays) {
  image_ = image;
  light_per_weight_ = light_per_weight;
  bool const gaussian = spot_.model != SpotModel::none && spot_.model != SpotModel::airy;
  by_grid_ = gaussian && HitGrid::is_faster_than_psfs(spot_.gaussian.sigma, rays);
  if (by_grid_ && !grid_) grid_.emplace(spot_.gaussian);
}

void RayLight::deposit(Vec2d p, double weight) {
  by_grid_ ? grid_->deposit(p, weight, image_, light_per_weight_)
           : patch_.deposit(p, weight, image_, light_per_weight_);
}

void RayLight::finish() {
  by_grid_ ? grid_->flush(image_, light_per_weight_) : patch_.flush(image_, light_per_weight_);
}

}  // namespace gladstone::inline rays
