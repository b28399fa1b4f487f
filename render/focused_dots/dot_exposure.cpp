#include "render/focused_dots/dot_exposure.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gladstone {

DotExposure::DotExposure(LightModel const& model, bool with_images) : model_(model), with_images_(with_images) {
  if (with_images) patches_.assign(frame_count, DotPatch(model.spot, model.moment_images));
}

void DotExposure::begin(Vec2d centre, double radiance, LightImage* const (&images)[frame_count],
                        double light_per_weight) {
  centre_ = centre;
  plan_ = DotPlan::make(model_, centre, radiance);
  light_per_weight_ = light_per_weight;
  std::copy_n(images, frame_count, images_);
  std::fill_n(of_scramblings_, most_scramblings, DotSums{});
  recorded_ = 0;
  moved_ = false;
  tabled_ = model_.tabled(centre);
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
  DotSums& sums = of_scramblings_[recorded_++ % static_cast<std::uint64_t>(model_.scramblings)];
  sums.hits[0].add(ray.reference, ray.reference_weight, ray.reference_counts);
  sums.hits[1].add(ray.flow, ray.flow_weight, ray.flow_counts);
  moved_ |= ray.moved;
  if (tabled_) sums.check.add(model_.table, centre_ + model_.offset(ray.place), flow_displacement(model_, ray), ray);
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
  FlowScatter scatter;
  for (RayRecord<double> const& ray : rays_) {
    if (ray.flow_weight > 0) scatter += fit.scatter(ray, flow_displacement(model_, ray), mean);
  }
  fit.settle(mean, scatter);
  return fit;
}

void DotExposure::deposit_source(Frame frame) {
  for (int i = 0; i < model_.source.count; ++i) deposit(frame, reference_light(model_, model_.source, plan_, i));
}

void DotExposure::deposit_rays() {
  FlowFit const fit = fit_flow();
  CubatureView const& pupil = model_.pupil[pupil_rule(fit.pupil_spread())];
  for (int i = 0; i < model_.source.count; ++i) {
    for (int k = 0; k < pupil.count; ++k) deposit(Frame::flow, expected_light(model_, plan_, fit, pupil, i, k));
  }
  for (RayRecord<double> const& ray : rays_) {
    Remainder const rest = remaining_light(model_, plan_, fit, ray);
    deposit(Frame::flow, rest.landed);
    deposit(Frame::flow, rest.expected);
  }
}

std::optional<DotExposure::ConeIntegral> DotExposure::integrate_cone(DotErrors const& errors) {
  if (!model_.correctable(check_, plan_.expected_weight)) return {};
  ConeIntegral integral{model_.corrected(centre_, check_), {}};
  CorrectedCone const& cone = integral.cone;
  PlaceRule const& rule = model_.places;
  ConeRule const& cross_section = model_.cone;
  int const directions = cross_section.direction_count;
  std::vector<double> rims(static_cast<std::size_t>(rule.count * directions));
  bool simple = true;
  for (int i = 0; simple && i < rule.count; ++i) {
    for (int k = 0; simple && k < directions; ++k) {
      double const rim = cone.rim(model_.offset(rule.places[i]), cross_section.directions[k]);
      rims[static_cast<std::size_t>(i * directions + k)] = rim;
      simple = !std::isnan(rim);
    }
  }
  if (model_.rays_are_better(errors, check_, simple)) return {};
  int const points = model_.cone_points(simple);
  cone_points_.clear();
  for (int i = 0; i < rule.count; ++i) {
    Vec2d const offset = model_.offset(rule.places[i]);
    DisplacementMoments& moments = integral.whole[i];
    for (int k = 0; k < points; ++k) {
      ConeLight const light = simple ? cone_light(cone, cross_section, k, offset, rims.data() + i * directions)
                                     : smoothed_light(cone, cross_section, k, offset);
      integral.without_medium[i] += light.without_medium;
      moments.add(light.weight, light.displacement);
      cone_points_.push_back(light);
    }
    cone.finish(moments, integral.without_medium[i]);
    if (!std::isfinite(moments.square())) return {};
    integral.narrow = integral.narrow && model_.narrow(moments);
  }
  sum_cone(model_, plan_, cone.origin(), integral.whole, integral.without_medium, truth_.hits);
  truth_.path = TruthPath::table;
  truth_.error = model_.error(errors, true, simple);
  return integral;
}

bool DotExposure::deposit_wide(ConeIntegral const& integral) {
  int const places = model_.places.count;
  std::size_t const points = cone_points_.size() / static_cast<std::size_t>(places);
  BoxLattice const& lattice = model_.moment_images.lattice;
  Vec2d const origin = plan_.origin + integral.cone.origin();
  auto const span_of = [&](DotBoxes const& boxes) {
    BoxRange span;
    for (ConeLight const& light : cone_points_) {
      if (light.weight != 0) span.include(boxes.box_of(light.displacement));
    }
    return span;
  };
  DotBoxes boxes(lattice, origin, 1);
  BoxRange range = span_of(boxes);
  while (!range.few() && boxes.step < DotBoxes::most_step) {
    boxes = DotBoxes(lattice, origin, 2 * boxes.step);
    range = span_of(boxes);
  }
  if (!range.few()) return false;
  parts_.assign(static_cast<std::size_t>(range.count() * places), {});
  for (std::size_t i = 0; i < cone_points_.size(); ++i) {
    ConeLight const& light = cone_points_[i];
    if (light.weight == 0) continue;
    Vec2<int> const box = boxes.box_of(light.displacement);
    parts_[static_cast<std::size_t>(range.index(box) * places) + i / points].add(
        light.weight, boxes.from_middle(light.displacement, box));
  }
  for (int index = 0; index < range.count(); ++index) {
    DisplacementMoments* const part = parts_.data() + index * places;
    if (std::all_of(part, part + places, [](DisplacementMoments const& m) { return m.of[0] == 0; })) continue;
    for (int i = 0; i < places; ++i) integral.cone.finish(part[i], integral.without_medium[i]);
    patches_[1].deposit(boxes.square(range.box(index)), plan_.expected_weight, MomentField::fit(model_.places, part),
                        images_[1], light_per_weight_);
  }
  return true;
}

void DotExposure::deposit_narrow(ConeIntegral const& integral) {
  MomentField const field = MomentField::fit(model_.places, integral.whole);
  for (int i = 0; i < model_.source.count; ++i) {
    Deposit const light = reference_light(model_, model_.source, plan_, i);
    Vec2d const at = light.at + integral.cone.origin();
    if (!patches_[1].make_series(at.x, column_) || !patches_[1].make_series(at.y, row_)) continue;
    patches_[1].deposit(column_, row_, light.weight, field.at(model_.source.points[i]), images_[1], light_per_weight_);
  }
}

void DotExposure::finish_light() {
  DotSums all;
  for (int i = 0; i < model_.scramblings; ++i) all += of_scramblings_[i];
  check_ = all.check;
  DotErrors const errors = dot_errors(of_scramblings_, model_.scramblings, all);
  truth_ = {plan_.origin, {all.hits[0], all.hits[1]}, model_.error(errors, false, false), TruthPath::rays};
  std::optional<ConeIntegral> const integral = moved_ && tabled_ ? integrate_cone(errors) : std::nullopt;
  if (!with_images_ || !model_.controlled) return;  // else every ray's light was laid down as it came
  deposit_source(Frame::reference);
  switch (model_.kind(moved_, integral.has_value(), integral && integral->narrow)) {
    case DotKind::still:
      deposit_source(Frame::flow);
      break;
    case DotKind::narrow:
      deposit_narrow(*integral);
      break;
    case DotKind::wide:
      if (!deposit_wide(*integral)) deposit_rays();
      break;
    case DotKind::rays:
      deposit_rays();
  }
}

void DotExposure::finish(GroundTruth& truth, std::size_t dot) {
  finish_light();
  if (with_images_) {
    for (int frame = 0; frame < frame_count; ++frame) {
      patches_[static_cast<std::size_t>(frame)].flush(images_[frame], light_per_weight_);
    }
  }
  truth.set_hits(dot, truth_, light_per_weight_);
}

}  // namespace gladstone
