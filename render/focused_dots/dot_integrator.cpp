#include "render/focused_dots/dot_integrator.h"

#include <cmath>

namespace gladstone {

DotIntegrator::DotIntegrator(DotModel const& model) : model_(model) {
  SpotView spot;
  spot.model = SpotModel::gaussian;
  spot.gaussian = model.spot;
  patches_.assign(frame_count, DotPatch(spot, model.moment_images));
}

CorrectedCone DotIntegrator::cone() const {
  DeflectionTable const nothing;
  return {seen_.kind == DotKind::still ? nothing : model_.table,
          model_.stop_radius,
          model_.distance(),
          seen_.centre,
          seen_.aim.pupil,
          seen_.check};
}

void DotIntegrator::enter(int ray, SentRay const& sent, Deflection const& found) {
  CheckedRay const checked = check_ray(model_, seen_.aim.pupil, sent, found);
  for (std::size_t frame = 0; frame < frame_count; ++frame) {
    ++statuses_[frame][static_cast<std::size_t>(checked.status[frame])];
    seen_.truth.hits[frame].count += reaches_sensor_plane(checked.status[frame]);
  }
  if (found.status != RayStatus::alive) seen_.kind = DotKind::left;
  of_scramblings_[ray % model_.scramblings()].add(checked.at, found, checked.expected);
}

bool DotIntegrator::settle() {
  seen_.check = {};
  for (int i = 0; i < model_.scramblings(); ++i) seen_.check += of_scramblings_[i];
  seen_.errors = check_errors(of_scramblings_, model_.scramblings(), seen_.check);
  return model_.enough(seen_.errors, seen_.rays);
}

void DotIntegrator::integrate() {
  CorrectedCone const cone = this->cone();
  PlaceRule const& rule = model_.places;
  auto const directions = static_cast<std::size_t>(model_.cone.direction_count);
  rims_.clear();
  for (int i = 0; i < rule.count; ++i) {
    Vec2d const offset = model_.offset(rule.places[i]);
    for (std::size_t k = 0; k < directions; ++k) rims_.push_back(cone.rim(offset, model_.cone.directions[k]));
  }
  if (std::any_of(rims_.begin(), rims_.end(), [](double rim) { return std::isnan(rim); })) rims_.clear();
  bool const simple = !rims_.empty();
  bool narrow = true;
  points_.clear();
  for (int i = 0; i < rule.count; ++i) {
    Vec2d const offset = model_.offset(rule.places[i]);
    double const* const rims = simple ? rims_.data() + static_cast<std::size_t>(i) * directions : nullptr;
    for (int k = 0; k < model_.cone.points_of(simple); ++k) {
      ConeLight const light = cone_light(cone, model_.cone, k, offset, rims);
      seen_.without_medium[i] += light.without_medium;
      seen_.whole[i].add(light.weight, light.displacement);
      if (light.weight != 0) seen_.extent.include(light.displacement);
      points_.push_back(light);
    }
    cone.finish(seen_.whole[i], seen_.without_medium[i]);
    if (!std::isfinite(seen_.whole[i].square())) seen_.kind = DotKind::left;
    narrow = narrow && model_.narrow(seen_.whole[i]);
  }
  if (seen_.kind == DotKind::narrow) {
    seen_.kind = wide_or_narrow(model_, narrow, seen_.truth.origin + cone.origin(), seen_.extent);
  }
  sum_cone(model_, seen_.light, cone.origin(), seen_.whole, seen_.without_medium, seen_.truth);
  if (seen_.kind != DotKind::still) {
    Vec2d const square = model_.error2(seen_.errors, simple);
    seen_.truth.error = {std::sqrt(square.x), std::sqrt(square.y)};
  }
  if (seen_.kind == DotKind::still) seen_.truth.hits[1] = seen_.truth.hits[0];
  seen_.truth.path = TruthPath::table;
}

void DotIntegrator::lay_down(LightImage* const (&images)[frame_count]) {
  deposit_source(Frame::reference, images[0]);
  switch (seen_.kind) {
    case DotKind::still:
      deposit_source(Frame::flow, images[1]);
      break;
    case DotKind::narrow:
      deposit_narrow(images[1]);
      break;
    case DotKind::wide:
      deposit_wide(images[1]);
      break;
    case DotKind::left:
      break;
  }
  for (int frame = 0; frame < frame_count; ++frame) patches_[static_cast<std::size_t>(frame)].flush(images[frame], 1);
}

void DotIntegrator::deposit_source(Frame frame, LightImage* image) {
  for (int i = 0; i < model_.source.count; ++i) {
    Deposit const light = reference_light(model_, seen_.truth.origin, seen_.light, i);
    patches_[static_cast<std::size_t>(frame)].deposit(light.at, light.weight, image, 1);
  }
}

void DotIntegrator::deposit_narrow(LightImage* image) {
  MomentField const field = MomentField::fit(model_.places, seen_.whole);
  Vec2d const origin = seen_.truth.origin + cone().origin();
  for (int i = 0; i < model_.source.count; ++i) {
    Deposit const light = reference_light(model_, origin, seen_.light, i);
    if (!patches_[1].make_series(light.at.x, column_) || !patches_[1].make_series(light.at.y, row_)) continue;
    patches_[1].deposit(column_, row_, light.weight, field.at(model_.source.points[i]), image, 1);
  }
}

void DotIntegrator::deposit_wide(LightImage* image) {
  int const places = model_.places.count;
  CorrectedCone const cone = this->cone();
  SpannedBoxes const spanned(model_.moment_images.lattice, seen_.truth.origin + cone.origin(), seen_.extent);
  auto const& [boxes, range, few] = spanned;
  parts_.assign(static_cast<std::size_t>(range.count() * places), {});
  for (std::size_t i = 0; i < points_.size(); ++i) {
    ConeLight const& light = points_[i];
    if (light.weight == 0) continue;
    Vec2<int> const box = boxes.box_of(light.displacement);
    std::size_t const place = i * static_cast<std::size_t>(places) / points_.size();
    parts_[static_cast<std::size_t>(range.index(box) * places) + place].add(light.weight,
                                                                            boxes.from_middle(light.displacement, box));
  }
  for (int index = 0; index < range.count(); ++index) {
    DisplacementMoments* const part = parts_.data() + index * places;
    if (std::all_of(part, part + places, [](DisplacementMoments const& m) { return m.of[0] == 0; })) continue;
    for (int i = 0; i < places; ++i) cone.finish(part[i], seen_.without_medium[i]);
    patches_[1].deposit(boxes.square(range.box(index)), seen_.light, MomentField::fit(model_.places, part), image, 1);
  }
}

}  // namespace gladstone
