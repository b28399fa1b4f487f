#include "render/focused_dots/dot_integrator.h"

#include "render/focused_dots/narrow_light.h"

namespace gladstone::inline focused_dots {

DotIntegrator::DotIntegrator(DotModel const& model) : model_(model) {
  SpotView spot;
  spot.model = SpotModel::gaussian;
  spot.gaussian = model.spot;
  patches_.assign(frame_count, DotPatch(spot, model.moment_images));
  lane_.scramblings = model.scramblings();
  points_.resize(static_cast<std::size_t>(model.most_points()));
  order_.resize(points_.size());
  rims_.resize(static_cast<std::size_t>(model.rim_count()));
  whole_.rims = rims_.data();
}

void DotIntegrator::integrate() {
  CorrectedCone const cone = this->cone();
  integrate_cone(OneLane{}, model_, cone, whole_, points_.data());
  conclude(OneLane{}, model_, cone.origin(), whole_, seen_, seen_);
}

void DotIntegrator::accumulate_light(LightImage* const (&images)[frame_count]) {
  constexpr int orders = DisplacementMoments::order + 1;
  for (std::size_t frame = 0; frame < frame_count; ++frame) patches_[frame].begin(images[frame]);
  accumulate_light_by_points<1>(0, {});
  if (seen_.kind == DotKind::still) accumulate_light_by_points<1>(1, {});
  if (seen_.kind == DotKind::narrow) accumulate_light_by_points<orders>(1, seen_.origin);
  if (seen_.kind == DotKind::wide) {
    accumulate_light_by_squares<MomentImages::pad>(
        OneLane{}, model_, seen_, cone(), whole_, {points_.data(), order_.data(), model_.cone.points_of(whole_.simple)},
        squares_, patches_[1]);
  }
  for (std::size_t frame = 0; frame < frame_count; ++frame) patches_[frame].flush(images[frame], 1);
}

template <int orders>
void DotIntegrator::accumulate_light_by_points(std::size_t frame, Vec2d moved) {
  with_lanes(2 * model_.spot.half_width() + 1, [&]<int lanes>() {
    double room[point_numbers(orders, lanes)];
    gladstone::accumulate_light_by_points<orders, lanes>(OneLane{}, model_, seen_.truth.origin + moved, seen_.light,
                                                         &seen_.field, patches_[frame], room, 1);
  });
}

}  // namespace gladstone::inline focused_dots
