#include "render/scene/dot_exposure.h"

#include <cmath>
#include <limits>

#include "render/base/gauss_legendre.h"
#include "render/base/units.h"

namespace gladstone {

SpotView make_spot(Scene const& scene, std::optional<AiryTable>& airy) {
  SpotView spot;
  spot.model = scene.chief_rays_only() ? SpotModel::none : scene.setup.lens.spot;
  if (spot.model == SpotModel::airy) spot.airy = airy.emplace(scene.spot_scale_px()).view();
  spot.gaussian.sigma = scene.spot_sigma_px();
  return spot;
}

LightPatch::LightPatch(SpotView const& spot)
    : spot_(spot),
      half_(spot.half_width()),
      side_(2 * half_ + 33),
      light_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0.0),
      column_shares_(static_cast<std::size_t>(2 * half_ + 1)),
      row_shares_(static_cast<std::size_t>(2 * half_ + 1)) {}

void LightPatch::deposit(Vec2d p, double weight, LightImage* image, double light_per_weight) {
  double const middle_x = std::floor(p.x + 0.5), middle_y = std::floor(p.y + 0.5);
  if (!(std::abs(middle_x) < 1e8 && std::abs(middle_y) < 1e8)) return;
  int const width = 2 * half_ + 1;
  int const column = static_cast<int>(middle_x) - half_, row = static_cast<int>(middle_y) - half_;
  bool const untouched = high_column_ == low_column_;
  if (untouched || column < left_ || row < top_ || column + width > left_ + side_ || row + width > top_ + side_) {
    if (!untouched) flush(image, light_per_weight);
    left_ = column - (side_ - width) / 2;
    top_ = row - (side_ - width) / 2;
    low_column_ = low_row_ = side_;
    high_column_ = high_row_ = 0;
  }
  int const c0 = column - left_, r0 = row - top_;
  low_column_ = std::min(low_column_, c0);
  high_column_ = std::max(high_column_, c0 + width);
  low_row_ = std::min(low_row_, r0);
  high_row_ = std::max(high_row_, r0 + width);
  double* const corner = light_.data() + r0 * side_ + c0;

  switch (spot_.model) {
    case SpotModel::none:
      *corner += weight;
      break;
    case SpotModel::airy:
      for (int j = 0; j < width; ++j) {
        for (int i = 0; i < width; ++i) {
          corner[j * side_ + i] += weight * spot_.airy.share(p.x - middle_x, p.y - middle_y, j, i);
        }
      }
      break;
    default: {
      spot_.gaussian.shares(p.x, column, width, column_shares_.data());
      spot_.gaussian.shares(p.y, row, width, row_shares_.data());
      for (int j = 0; j < width; ++j) {
        double const line = weight * row_shares_[static_cast<std::size_t>(j)];
        for (int i = 0; i < width; ++i) corner[j * side_ + i] += line * column_shares_[static_cast<std::size_t>(i)];
      }
    }
  }
}

void LightPatch::flush(LightImage* image, double light_per_weight) {
  for (int row = low_row_; row < high_row_; ++row) {
    double* const line = light_.data() + row * side_;
    for (int column = low_column_; column < high_column_; ++column) {
      if (image && line[column] != 0) image->add(column + left_, row + top_, line[column] * light_per_weight);
      line[column] = 0;
    }
  }
  low_column_ = high_column_ = low_row_ = high_row_ = 0;
}

SourceCubature SourceCubature::disc(int radial, int innermost, int outermost) {
  SourceCubature cubature;
  GaussLegendre const nodes(radial);
  for (int i = 0; i < radial; ++i) {
    double const r = std::sqrt(0.5 * (1 + nodes.node[static_cast<std::size_t>(i)]));
    int const angular = static_cast<int>(std::ceil(innermost + (outermost - innermost) * r));
    for (int k = 0; k < angular; ++k) {
      double const angle = 2 * pi * (k + 0.5 * (i % 2)) / angular;
      cubature.points.push_back({r * std::cos(angle), r * std::sin(angle)});
      cubature.weights.push_back(0.5 * nodes.weight[static_cast<std::size_t>(i)] / angular);
    }
  }
  return cubature;
}

SourceCubature SourceCubature::radon() {
  SourceCubature cubature{{{0, 0}}, {0.25}};
  for (int k = 0; k < 6; ++k) {
    double const angle = pi * k / 3;
    cubature.points.push_back({std::sqrt(2.0 / 3.0) * std::cos(angle), std::sqrt(2.0 / 3.0) * std::sin(angle)});
    cubature.weights.push_back(0.125);
  }
  return cubature;
}

SourceCubature SourceCubature::make(SourceShape shape, double half_size_px, double spot_px) {
  if (half_size_px == 0) return {{{0, 0}}, {1.0}};
  // the finest thing that the source's outline is blurred by is the spot
  double const fineness = half_size_px / std::clamp(spot_px, 0.05, 2.0);
  if (shape == SourceShape::disc) {
    return disc(std::clamp(static_cast<int>(std::ceil(fineness)) + 2, 3, 64), 6,
                std::clamp(static_cast<int>(std::ceil(4 * fineness)) + 6, 9, 256));
  }
  int const radial = std::clamp(static_cast<int>(std::ceil(1.5 * fineness)) + 3, 4, 64);
  SourceCubature cubature;
  GaussLegendre const nodes(2 * radial);
  for (std::size_t i = 0; i < nodes.node.size(); ++i) {
    for (std::size_t k = 0; k < nodes.node.size(); ++k) {
      cubature.points.push_back({nodes.node[i], nodes.node[k]});
      cubature.weights.push_back(0.25 * nodes.weight[i] * nodes.weight[k]);
    }
  }
  return cubature;
}

namespace {

CubatureView view_of(SourceCubature const& rule) {
  return {rule.points.data(), rule.weights.data(), static_cast<int>(rule.points.size())};
}

}  // namespace

OwnedLightModel::OwnedLightModel(Scene const& scene, DotPattern const& sources, SpotView const* spot)
    : pupil{{{{0, 0}}, {1.0}},
            SourceCubature::disc(1, 3, 3),
            SourceCubature::radon(),
            SourceCubature::disc(3, 9, 9),
            SourceCubature::disc(5, 15, 15)} {
  CameraSetup const& camera = scene.setup.camera;
  bool const has_stop = !scene.chief_rays_only();
  double const stop_radius = scene.imaging.entrance_pupil / 2;
  TargetImage& image = model.image;
  image.axis_px = scene.to_pixel({});
  image.px_per_metre = scene.imaging.magnification / camera.pixel_pitch;
  image.source_half = sources.half_size;
  image.has_stop = has_stop;
  if (has_stop) {
    image.stop = scene.aperture_stop();
    image.stop_radius = stop_radius;
  }
  double const share = has_stop ? stop_radius / scene.pupil_radius() : 1.0;
  model.expected_weight = static_cast<double>(scene.rays_per_dot) * share * share;
  model.mean_pupil2 = 0.5 * stop_radius * stop_radius;
  model.distance = scene.setup.z_a + scene.setup.z_d;
  if (!spot) return;
  model.spot = *spot;
  model.controlled = spot->model != SpotModel::none && scene.setup.lens.focus == Focus::target;
  double const spot_px =
      spot->model == SpotModel::airy ? SpotSize{scene.spot_scale_px()}.matched_sigma() : spot->gaussian.sigma;
  source = SourceCubature::make(sources.shape, image.half_size_px(), spot_px);
  model.source = view_of(source);
  for (int rule = 0; rule < pupil_rules; ++rule) model.pupil[rule] = view_of(pupil[rule]);
}

DotExposure::DotExposure(LightModel const& model, bool with_images) : model_(model), with_images_(with_images) {
  if (with_images) patches_.assign(frame_count, LightPatch(model.spot));
}

void DotExposure::begin(Vec2d centre, double radiance, LightImage* const (&images)[frame_count],
                        double light_per_weight) {
  centre_ = centre;
  plan_ = DotPlan::make(model_, centre, radiance);
  light_per_weight_ = light_per_weight;
  for (int frame = 0; frame < frame_count; ++frame) {
    images_[frame] = images[frame];
    sums_[frame] = {};
  }
  moved_ = false;
  rays_.clear();
}

void DotExposure::deposit(Frame frame, Deposit const& light) {
  if (light.weight == 0) return;
  auto const f = static_cast<std::size_t>(frame);
  patches_[f].deposit(light.at, light.weight, images_[f], light_per_weight_);
}

void DotExposure::record(EmittedRay<double> const& emitted, RayHit<double> const& reference,
                         RayHit<double> const& flow) {
  ++statuses_[0][static_cast<std::size_t>(reference.status)];
  ++statuses_[1][static_cast<std::size_t>(flow.status)];
  if (flow.status <= RayStatus::vignetted) {
    Vec2d const bend = flow.at_lens - emitted.pupil;
    largest_bend2_ = std::max(largest_bend2_, dot(bend, bend));
  }
  RayRecord<double> const ray = make_record(model_.image, centre_, plan_.origin, emitted, reference, flow);
  sums_[0].add(ray.reference, ray.reference_weight, ray.reference_counts);
  sums_[1].add(ray.flow, ray.flow_weight, ray.flow_counts);
  moved_ |= ray.moved();
  if (!with_images_) return;
  if (model_.controlled) {
    rays_.push_back(ray);
  } else {
    deposit(Frame::reference, {plan_.origin + ray.reference, ray.reference_weight});
    deposit(Frame::flow, {plan_.origin + ray.flow, ray.flow_weight});
  }
}

FlowFit DotExposure::fit_flow() const {
  FlowFit fit;
  fit.prepare(rays_.size(), model_.image.stop_radius, model_.image.source_half > 0);
  double sums[FlowFit::most_sums] = {};
  int const factors = fit.factor_count(), terms = factors - FlowFit::targets;
  for (RayRecord<double> const& ray : rays_) {
    if (!(ray.flow_weight > 0)) continue;
    double factor[FlowFit::most_factors];
    fit.factors(ray, flow_displacement(model_, ray), factor);
    double* sum = sums;
    for (int row = 0; row < factors; ++row) {
      double const weighted = ray.flow_weight * factor[row];
      for (int column = 0; column <= std::min(row, terms - 1); ++column) *sum++ += weighted * factor[column];
    }
  }
  if (!(sums[0] > 0)) return fit;
  int const first_target = terms * (terms + 1) / 2;
  Vec2d const mean = Vec2d{sums[first_target], sums[first_target + terms]} / sums[0];
  fit.solve(sums, 0, 1, [] {});
  double unexplained = 0, square = 0;
  for (RayRecord<double> const& ray : rays_) {
    if (!(ray.flow_weight > 0)) continue;
    Vec2d const hit = flow_displacement(model_, ray), rest = hit - fit.displacement(ray.place, ray.pupil);
    square += ray.flow_weight * dot(hit - mean, hit - mean);
    unexplained += ray.flow_weight * dot(rest, rest);
  }
  fit.settle(mean, unexplained, square);
  return fit;
}

void DotExposure::deposit_controlled() {
  if (!moved_) {
    for (Frame const frame : {Frame::reference, Frame::flow}) {
      for (int i = 0; i < model_.source.count; ++i) deposit(frame, reference_light(model_, plan_, i));
    }
    return;
  }
  FlowFit const fit = fit_flow();
  CubatureView const& pupil = model_.pupil[pupil_rule(fit.pupil_spread())];
  for (int i = 0; i < model_.source.count; ++i) {
    deposit(Frame::reference, reference_light(model_, plan_, i));
    for (int k = 0; k < pupil.count; ++k) deposit(Frame::flow, expected_light(model_, plan_, fit, pupil, i, k));
  }
  for (RayRecord<double> const& ray : rays_) {
    Remainder const rest = remaining_light(model_, plan_, fit, ray);
    deposit(Frame::flow, rest.landed);
    deposit(Frame::flow, rest.expected);
  }
}

void DotExposure::finish(GroundTruth& truth, std::size_t dot) {
  if (with_images_) {
    finish_light();
    for (int frame = 0; frame < frame_count; ++frame) {
      patches_[static_cast<std::size_t>(frame)].flush(images_[frame], light_per_weight_);
    }
  }
  truth.set_hits(dot, plan_.origin, sums_[0], sums_[1], light_per_weight_);
}

}  // namespace gladstone
