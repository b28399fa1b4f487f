#include "render/focused_dots/dot_integrator.h"

#include "render/focused_dots/narrow_light.h"

namespace gladstone {

DotIntegrator::DotIntegrator(DotModel const& model) : model_(model) {
  SpotView spot;
  spot.model = SpotModel::gaussian;
  spot.gaussian = model.spot;
  patches_.assign(frame_count, DotPatch(spot, model.moment_images));
  lane_.scramblings = model.scramblings();
  points_.resize(static_cast<std::size_t>(model.most_points()));
  order_.resize(points_.size());
}

void DotIntegrator::integrate() {
  CorrectedCone const cone = this->cone();
  integrate_cone(OneLane{}, model_, cone, whole_, points_.data());
  conclude(OneLane{}, model_, cone.origin(), whole_, seen_, seen_);
}

void DotIntegrator::lay_down(LightImage* const (&images)[frame_count]) {
  patches_[1].begin(images[1]);
  deposit_source(Frame::reference, images[0]);
  if (seen_.kind == DotKind::still) deposit_source(Frame::flow, images[1]);
  if (seen_.kind == DotKind::narrow) deposit_narrow();
  if (seen_.kind == DotKind::wide) deposit_wide();
  for (int frame = 0; frame < frame_count; ++frame) patches_[static_cast<std::size_t>(frame)].flush(images[frame], 1);
}

void DotIntegrator::deposit_source(Frame frame, LightImage* image) {
  for (int i = 0; i < model_.source.count; ++i) {
    Deposit const light = reference_light(model_, seen_.truth.origin, seen_.light, i);
    patches_[static_cast<std::size_t>(frame)].deposit(light.at, light.weight, image, 1);
  }
}

void DotIntegrator::deposit_narrow() {
  constexpr int orders = DisplacementMoments::order + 1;
  auto const lay_down = [&]<int pixels>() {
    double room[spot_numbers(orders, pixels)];
    lay_down_points<orders, pixels>(OneLane{}, model_, seen_.truth.origin + seen_.origin, seen_.light, &seen_.field,
                                    patches_[1], room, 1);
  };
  int const width = 2 * model_.spot.half_width() + 1;
  if (width <= 8) return lay_down.operator()<8>();
  if (width <= 12) return lay_down.operator()<12>();
  lay_down.operator()<48>();  // focused_dots() takes no wider ones
}

void DotIntegrator::deposit_wide() {
  lay_down_squares<MomentImages::pad>(OneLane{}, model_, seen_, cone(), whole_,
                                      {points_.data(), order_.data(), model_.cone.points_of(whole_.simple)}, squares_,
                                      patches_[1]);
}

}  // namespace gladstone
