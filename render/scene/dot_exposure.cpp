#include "render/scene/dot_exposure.h"

#include <Eigen/Dense>
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
    case SpotModel::airy: {
      AiryTable::View const& table = spot_.airy;
      double const u = (p.x - middle_x + 0.5) * table.subdivisions, v = (p.y - middle_y + 0.5) * table.subdivisions;
      int const iu = std::min(static_cast<int>(u), table.subdivisions - 1);
      int const iv = std::min(static_cast<int>(v), table.subdivisions - 1);
      double const fu = u - iu, fv = v - iv;
      std::ptrdiff_t const footprint = static_cast<std::ptrdiff_t>(width) * width;
      double const* const lower =
          table.shares + (static_cast<std::ptrdiff_t>(iv) * (table.subdivisions + 1) + iu) * footprint;
      double const* const upper = lower + (table.subdivisions + 1) * footprint;
      for (int j = 0; j < width; ++j) {
        for (int i = 0; i < width; ++i) {
          std::ptrdiff_t const at = static_cast<std::ptrdiff_t>(j) * width + i;
          double const low = lower[at] + fu * (lower[at + footprint] - lower[at]);
          double const high = upper[at] + fu * (upper[at + footprint] - upper[at]);
          corner[j * side_ + i] += weight * (low + fv * (high - low));
        }
      }
      break;
    }
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

SourceCubature make_cubature(Scene const& scene, DotPattern const& sources, SpotView const& spot) {
  double const half_size_px = sources.half_size * scene.imaging.magnification / scene.setup.camera.pixel_pitch;
  double const spot_px =
      spot.model == SpotModel::airy ? SpotSize{scene.spot_scale_px()}.matched_sigma() : spot.gaussian.sigma;
  return SourceCubature::make(sources.shape, half_size_px, spot_px);
}

DotPlan plan_dot(Scene const& scene, SpotView const* spot, SceneView<double> const& view, std::uint64_t dot) {
  Vec2d const centre = view.sources.centre[dot];
  DotPlan plan;
  plan.origin = scene.to_pixel(centre);
  plan.control = spot != nullptr && spot->model != SpotModel::none && scene.setup.lens.focus == Focus::target;
  // the mean of cos^4 over the stop, whose points are |P|^2 = R^2/2 from the axis in the mean
  double const stop = scene.imaging.entrance_pupil / 2;
  double const share = view.bundle.pupil_radius > 0 ? stop / view.bundle.pupil_radius : 1.0;
  double const distance = view.bundle.lens_z - view.sources.plane_z;
  double const spread = 1 + (gladstone::dot(centre, centre) + 0.5 * stop * stop) / (distance * distance);
  double const radiance = view.sources.radiance ? view.sources.radiance[dot] : 1.0;
  plan.expected_weight = static_cast<double>(scene.rays_per_dot) * share * share * radiance / (spread * spread);
  return plan;
}

namespace {

/// Weighted least squares of two right-hand sides: coefficients of `terms` basis functions, zero where undetermined.
template <int MostTerms, class Basis>
void least_squares(std::vector<RayRecord> const& rays, int terms, Basis&& basis, Vec2d RayRecord::*target, Vec2d* out) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, MostTerms, MostTerms>;
  using Right = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, MostTerms, 2>;
  Matrix normal = Matrix::Zero(terms, terms);
  Right right = Right::Zero(terms, 2);
  for (RayRecord const& ray : rays) {
    if (!(ray.flow_weight > 0)) continue;
    double value[MostTerms];
    basis(ray, value);
    for (int row = 0; row < terms; ++row) {
      double const scaled = ray.flow_weight * value[row];
      for (int column = 0; column <= row; ++column) normal(row, column) += scaled * value[column];
      right(row, 0) += scaled * (ray.*target).x;
      right(row, 1) += scaled * (ray.*target).y;
    }
  }
  Right const solution = normal.template selfadjointView<Eigen::Lower>().ldlt().solve(right);
  bool const sound = solution.allFinite();
  for (int term = 0; term < terms; ++term) out[term] = sound ? Vec2d{solution(term, 0), solution(term, 1)} : Vec2d{};
}

}  // namespace

int FlowFit::basis(Vec2d x, Vec2d p, std::size_t rays, bool extended, double* value) {
  int n = 0;
  value[n++] = 1;
  if (rays < 32) return n;
  value[n++] = p.x;
  value[n++] = p.y;
  if (extended) {
    value[n++] = x.x;
    value[n++] = x.y;
  }
  if (rays < 96) return n;
  value[n++] = p.x * p.x;
  value[n++] = p.x * p.y;
  value[n++] = p.y * p.y;
  if (!extended) return n;
  for (double const place : {x.x, x.y}) {
    value[n++] = place * p.x;
    value[n++] = place * p.y;
  }
  value[n++] = x.x * x.x;
  value[n++] = x.x * x.y;
  value[n++] = x.y * x.y;
  value[n++] = x.x * x.x * x.x;
  value[n++] = x.x * x.x * x.y;
  value[n++] = x.x * x.y * x.y;
  value[n++] = x.y * x.y * x.y;
  return n;
}

void FlowFit::fit(std::vector<RayRecord> const& rays, double stop_radius, bool extended) {
  stop_radius_ = stop_radius;
  rays_ = rays.size();
  extended_ = extended;
  double value[displacement_terms];
  terms_ = basis({}, {}, rays_, extended_, value);
  least_squares<displacement_terms>(
      rays, terms_,
      [this](RayRecord const& ray, double* out) { basis(ray.place, ray.pupil / stop_radius_, rays_, extended_, out); },
      &RayRecord::displacement, displacement_);
  int const bends = rays_ < 32 ? 1 : (extended ? bend_terms : 3);
  std::fill(std::begin(bend_), std::end(bend_), Vec2d{});
  least_squares<bend_terms>(
      rays, bends,
      [this](RayRecord const& ray, double* out) {
        out[0] = 1;
        out[1] = ray.pupil.x / stop_radius_;
        out[2] = ray.pupil.y / stop_radius_;
        out[3] = ray.place.x;
        out[4] = ray.place.y;
      },
      &RayRecord::bend, bend_);

  // where the field is finer than a polynomial can follow, the mean serves as well and is cheaper to integrate
  double weight = 0, unexplained = 0, square = 0;
  Vec2d mean{};
  for (RayRecord const& ray : rays) {
    Vec2d const rest = ray.displacement - displacement(ray.place, ray.pupil);
    weight += ray.flow_weight;
    mean += ray.flow_weight * ray.displacement;
    square += ray.flow_weight * dot(ray.displacement, ray.displacement);
    unexplained += ray.flow_weight * dot(rest, rest);
  }
  if (!(weight > 0)) return;
  mean = mean / weight;
  if (unexplained > 0.1 * (square - weight * dot(mean, mean))) {
    terms_ = 1;
    displacement_[0] = mean;
  }
}

Vec2d FlowFit::displacement(Vec2d place, Vec2d pupil) const {
  if (terms_ == 1) return displacement_[0];
  double value[displacement_terms];
  basis(place, pupil / stop_radius_, rays_, extended_, value);
  Vec2d sum{};
  for (int term = 0; term < terms_; ++term) sum += value[term] * displacement_[term];
  return sum;
}

Vec2d FlowFit::arrival(Vec2d pupil, Vec2d place) const {
  return pupil + bend_[0] + (pupil.x / stop_radius_) * bend_[1] + (pupil.y / stop_radius_) * bend_[2] +
         place.x * bend_[3] + place.y * bend_[4];
}

FlowFit::Jacobian FlowFit::arrival_by_pupil() const {
  return {1 + bend_[1].x / stop_radius_, bend_[2].x / stop_radius_, bend_[1].y / stop_radius_,
          1 + bend_[2].y / stop_radius_};
}

Vec2d FlowFit::pupil_of(Vec2d arrival, Vec2d place) const {
  Vec2d const q = arrival - bend_[0] - place.x * bend_[3] - place.y * bend_[4];
  Jacobian const j = arrival_by_pupil();
  double const scale = 1 / j.determinant();
  return {scale * (j.d * q.x - j.b * q.y), scale * (j.a * q.y - j.c * q.x)};
}

double FlowFit::area_ratio() const { return 1 / arrival_by_pupil().determinant(); }

double FlowFit::pupil_spread() const {
  Vec2d const centre = displacement({}, {});
  double spread = 0;
  for (Vec2d const rim : {Vec2d{1, 0}, Vec2d{0, 1}, Vec2d{-1, 0}, Vec2d{0, -1}}) {
    spread = std::max(spread, length(displacement({}, stop_radius_ * rim) - centre));
  }
  return spread;
}

DotExposure::DotExposure(Scene const& scene, DotPattern const& sources, SpotView const* spot,
                         SourceCubature const& cubature)
    : scene_(scene),
      cubature_(cubature),
      with_image_(spot != nullptr),
      stop_(scene.aperture_stop()),
      stop_radius_(scene.chief_rays_only() ? 1.0 : stop_.radius),
      half_size_px_(sources.half_size * scene.imaging.magnification / scene.setup.camera.pixel_pitch) {
  if (spot) patches_.assign(frame_count, LightPatch(*spot));
}

void DotExposure::begin(DotPlan const& plan, LightImage* const (&images)[frame_count], double light_per_weight) {
  plan_ = plan;
  light_per_weight_ = light_per_weight;
  for (int frame = 0; frame < frame_count; ++frame) {
    images_[frame] = images[frame];
    sums_[frame] = {};
  }
  rays_.clear();
}

void DotExposure::deposit(Frame frame, Vec2d p, double weight) {
  auto const f = static_cast<std::size_t>(frame);
  patches_[f].deposit(p, weight, images_[f], light_per_weight_);
}

void DotExposure::record(EmittedRay<double> const& emitted, RayHit<double> const& reference,
                         RayHit<double> const& flow) {
  ++statuses_[0][static_cast<std::size_t>(reference.status)];
  ++statuses_[1][static_cast<std::size_t>(flow.status)];
  if (flow.status <= RayStatus::vignetted) {
    Vec2d const bend = flow.at_lens - emitted.pupil;
    largest_bend2_ = std::max(largest_bend2_, dot(bend, bend));
  }
  RayHit<double> const* const hits[frame_count] = {&reference, &flow};
  for (std::size_t f = 0; f < frame_count; ++f) {
    if (hits[f]->weight == 0) continue;
    sums_[f].add(hits[f]->pixel - plan_.origin, hits[f]->weight, reaches_sensor_plane(hits[f]->status));
    if (with_image_ && !plan_.control) deposit(static_cast<Frame>(f), hits[f]->pixel, hits[f]->weight);
  }
  if (with_image_ && plan_.control) {
    Vec2d const geometric = scene_.to_pixel({emitted.ray.position.x, emitted.ray.position.y}) - plan_.origin;
    // from frame to frame, so that what the medium leaves alone is exactly zero
    bool const both = flow.weight != 0 && reference.weight != 0;
    Vec2d const displacement =
        both ? flow.pixel - reference.pixel : (flow.weight != 0 ? flow.pixel - plan_.origin - geometric : Vec2d{});
    rays_.push_back({half_size_px_ > 0 ? geometric / half_size_px_ : Vec2d{}, reference.at_lens, displacement,
                     flow.at_lens - reference.at_lens, emitted.weight, flow.weight});
  }
}

namespace {

/// Points of the pupil over which a displacement that varies by `spread_px` across it is averaged.
SourceCubature const& pupil_cubature(double spread_px) {
  static SourceCubature const rules[] = {{{{0, 0}}, {1.0}},
                                         SourceCubature::disc(1, 3, 3),
                                         SourceCubature::disc(2, 6, 6),
                                         SourceCubature::disc(3, 9, 9),
                                         SourceCubature::disc(5, 15, 15)};
  return rules[spread_px == 0 ? 0 : (spread_px < 0.01 ? 1 : (spread_px < 0.05 ? 2 : (spread_px < 0.2 ? 3 : 4)))];
}

}  // namespace

void DotExposure::deposit_controlled() {
  FlowFit fit;
  fit.fit(rays_, stop_radius_, half_size_px_ > 0);
  SourceCubature const& pupil = pupil_cubature(fit.pupil_spread());
  double const flow_share = fit.area_ratio();
  for (std::size_t i = 0; i < cubature_.points.size(); ++i) {
    Vec2d const place = cubature_.points[i];
    Vec2d const p = plan_.origin + half_size_px_ * place;
    double const weight = plan_.expected_weight * cubature_.weights[i];
    deposit(Frame::reference, p, weight);
    for (std::size_t k = 0; k < pupil.points.size(); ++k) {
      Vec2d const moved = fit.displacement(place, fit.pupil_of(stop_radius_ * pupil.points[k], place));
      deposit(Frame::flow, p + moved, weight * flow_share * pupil.weights[k]);
    }
  }
  for (RayRecord const& ray : rays_) {
    Vec2d const p = plan_.origin + half_size_px_ * ray.place;
    Vec2d const arrival = fit.arrival(ray.pupil, ray.place);
    double const expected = ray.weight * (scene_.chief_rays_only() ? 1.0 : stop_.transmission(arrival.x, arrival.y));
    Vec2d const moved = fit.displacement(ray.place, ray.pupil);
    if (moved == ray.displacement && expected == ray.flow_weight) continue;
    if (ray.flow_weight != 0) deposit(Frame::flow, p + ray.displacement, ray.flow_weight);
    if (expected != 0) deposit(Frame::flow, p + moved, -expected);
  }
}

void DotExposure::finish(GroundTruth& truth, std::size_t dot) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (with_image_) {
    finish_light();
    for (int frame = 0; frame < frame_count; ++frame) {
      patches_[static_cast<std::size_t>(frame)].flush(images_[frame], light_per_weight_);
    }
  }
  bool const seen[2] = {sums_[0].weight > 0, sums_[1].weight > 0};
  Vec2d const none{nan, nan};
  truth.reference_px[dot] = seen[0] ? plan_.origin + sums_[0].mean() : none;
  truth.displacement_px[dot] = seen[0] && seen[1] ? sums_[1].mean() - sums_[0].mean() : none;
  truth.displacement_std_px[dot] = seen[1] ? sums_[1].deviation() : none;
  truth.flux[dot] = {sums_[0].weight * light_per_weight_, sums_[1].weight * light_per_weight_};
  truth.rays[dot] = {sums_[0].count, sums_[1].count};
}

}  // namespace gladstone
