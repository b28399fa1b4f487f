#include "render/focused_dots/light_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "render/base/gauss_legendre.h"
#include "render/base/units.h"
#include "render/optics/ray_bundle.h"

namespace gladstone {

namespace {

/// Place along a curve that keeps neighbours in the unit disc together (Morton 1966): what is looked up one after the
/// other, or side by side on a device, then lies together in memory.
unsigned z_order(Vec2d p) {
  auto const x = static_cast<unsigned>(128 * (p.x + 1)), y = static_cast<unsigned>(128 * (p.y + 1));
  unsigned order = 0;
  for (unsigned bit = 0; bit < 8; ++bit) order |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
  return order;
}

/// Rings at Gauss-Legendre radii, fewer directions on the inner ones; enough of both for waves of three of the field's
/// finest lengths.
/// @param radius of the cone, in those lengths @param times as many rings and directions
void make_cone_rule(double radius, int times, std::vector<ConePoint>& points, std::vector<Vec2d>& directions) {
  int const rings = std::min(40, times * (static_cast<int>(std::ceil(0.35 * radius)) + 4));
  int const count = std::min(ConeRule::most_directions, times * 4 * static_cast<int>(std::ceil(0.45 * radius + 3)));
  for (int k = 0; k < count; ++k) directions.push_back({std::cos(2 * pi * k / count), std::sin(2 * pi * k / count)});
  GaussLegendre const nodes(rings);
  for (std::size_t ring = 0; ring < nodes.node.size(); ++ring) {
    double const r = 0.5 * (1 + nodes.node[ring]);
    int const stride = r > 0.5 ? 1 : (r > 0.25 ? 2 : 4);
    for (int k = 0; k < count; k += stride) points.push_back({r, nodes.weight[ring] * r * stride / count, k});
  }
  std::vector<Vec2d> const& at = directions;
  std::stable_sort(points.begin(), points.end(), [&at](ConePoint const& a, ConePoint const& b) {
    return z_order(a.radius * at[static_cast<std::size_t>(a.direction)]) <
           z_order(b.radius * at[static_cast<std::size_t>(b.direction)]);
  });
}

/// A sunflower's points, those that lie together side by side.
std::vector<Vec2d> scattered_points(int count) {
  std::vector<Vec2d> points;
  for (int k = 0; k < count; ++k) points.push_back(sunflower(k, count));
  std::stable_sort(points.begin(), points.end(), [](Vec2d a, Vec2d b) { return z_order(a) < z_order(b); });
  return points;
}

/// The places: exact for polynomials of degree 5, so that the least-squares quadratic is that of the whole source.
PlaceRule make_place_rule(bool extended, SourceShape shape) {
  PlaceRule rule{};
  SourceCubature const places = !extended                    ? SourceCubature{{{0, 0}}, {1.0}}
                                : shape == SourceShape::disc ? SourceCubature::radon()
                                                             : SourceCubature::square(3);
  rule.count = static_cast<int>(places.points.size());
  int const terms = extended ? PlaceRule::terms : 1;
  Eigen::MatrixXd basis(rule.count, terms);
  Eigen::VectorXd weight(rule.count);
  for (int i = 0; i < rule.count; ++i) {
    rule.places[i] = places.points[static_cast<std::size_t>(i)];
    weight(i) = rule.weights[i] = places.weights[static_cast<std::size_t>(i)];
    double value[PlaceRule::terms];
    PlaceRule::basis(rule.places[i], value);
    for (int term = 0; term < terms; ++term) basis(i, term) = value[term];
  }
  Eigen::MatrixXd const weighted = basis.transpose() * weight.asDiagonal();
  Eigen::MatrixXd const fit = (weighted * basis).ldlt().solve(weighted);
  for (int term = 0; term < terms; ++term) {
    for (int i = 0; i < rule.count; ++i) rule.fit[term][i] = fit(term, i);
  }
  return rule;
}

CubatureView view_of(SourceCubature const& rule) {
  return {rule.points.data(), rule.weights.data(), static_cast<int>(rule.points.size())};
}

}  // namespace

OwnedLightModel::OwnedLightModel(FocusedDots const& dots, DotPattern const& sources, SpotView const* spot,
                                 DeflectionTable const& table, MomentImagesBy by)
    : pupil{{{{0, 0}}, {1.0}},
            SourceCubature::disc(1, 3, 3),
            SourceCubature::radon(),
            SourceCubature::disc(3, 9, 9),
            SourceCubature::disc(5, 15, 15)} {
  Scene const& scene = dots.scene();
  CameraSetup const& camera = scene.setup.camera;
  bool const has_stop = !scene.chief_rays_only();
  double const stop_radius = scene.imaging.entrance_pupil / 2;
  TargetImage& image = model.image;
  image.axis_px = scene.to_pixel({});
  image.px_per_metre = scene.imaging.magnification / camera.pixel_pitch;
  image.source_half = sources.half_size;
  image.has_stop = has_stop;
  if (has_stop) {
    image.stop = dots.aperture_stop();
    image.stop_radius = stop_radius;
  }
  double const share = has_stop ? stop_radius / scene.pupil_radius() : 1.0;
  model.expected_weight = static_cast<double>(scene.rays_per_dot) * share * share;
  model.mean_pupil2 = 0.5 * stop_radius * stop_radius;
  model.distance = scene.setup.z_a + scene.setup.z_d;
  model.sent_radius = scene.pupil_radius();
  model.scramblings = 1 << scrambling_bits(scene.rays_per_dot);
  model.table = table;
  if (table.way > 0) {
    // a closed form's finest length is no cell but the whole of a wave's slope; and many rays leave time for a rule
    // that leaves as little as they do
    bool const fine = scene.medium.grid.nodes[0] <= 1 || scene.rays_per_dot >= 4096;
    make_cone_rule(table.way * stop_radius / scene.medium.finest, fine ? 2 : 1, cone_points, cone_directions);
    int const scattered = std::max(1024, 2 * static_cast<int>(cone_points.size()));
    cone_scattered = scattered_points(scattered);
    model.cone = {cone_points.data(),
                  cone_directions.data(),
                  static_cast<int>(cone_points.size()),
                  static_cast<int>(cone_directions.size()),
                  fine,
                  cone_scattered.data(),
                  scattered,
                  Scene::stop_edge(scattered)};
    model.places = make_place_rule(sources.half_size > 0, sources.shape);
  }
  if (!spot) return;
  model.spot = *spot;
  model.controlled = spot->model != SpotModel::none && scene.setup.lens.focus == Focus::target;
  double const spot_px =
      spot->model == SpotModel::airy ? SpotSize{scene.spot_scale_px()}.matched_sigma() : spot->gaussian.sigma;
  source = SourceCubature::make(sources.shape, image.half_size_px(), spot_px);
  model.source = view_of(source);
  for (int rule = 0; rule < pupil_rules; ++rule) model.pupil[rule] = view_of(pupil[rule]);
  if (table.way > 0 && model.by_moments()) {
    MomentImages& images = model.moment_images;
    images = MomentImages::plan(image.half_size_px(), spot->gaussian, model.most_box_side(),
                                sources.half_size > 0 ? PlaceRule::terms : 1);
    if (by == MomentImagesBy::host && images.exist()) {
      moment_images = make_moment_images(images, source.points, source.weights, image.half_size_px(), spot->gaussian);
      images.values = moment_images.data();
    }
  }
}

}  // namespace gladstone
