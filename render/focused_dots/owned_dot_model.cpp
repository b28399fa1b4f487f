#include "render/focused_dots/owned_dot_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "render/base/gauss_legendre.h"
#include "render/base/units.h"
#include "render/optics/ray_bundle.h"

namespace gladstone::inline focused_dots {

namespace {

constexpr std::uint64_t most_given_rays = std::uint64_t{1} << 24;  ///< maximum number of check rays: more do not reduce
                                                                   ///< the table's error
constexpr std::uint64_t most_chosen_rays = 256;                    ///< maximum number of rays per dot for "auto"

/// Returns the position along a space-filling curve (Morton 1966) that keeps neighbouring points of the unit disc
/// together, so that consecutive or parallel look-ups access adjacent memory.
unsigned z_order(Vec2d p) {
  auto const x = static_cast<unsigned>(128 * (p.x + 1)), y = static_cast<unsigned>(128 * (p.y + 1));
  unsigned order = 0;
  for (unsigned bit = 0; bit < 8; ++bit) order |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
  return order;
}

/// Creates a rule with rings at Gauss-Legendre radii and fewer directions on the inner ones. Resolves waves of three
/// times the field's finest length.
/// @param radius  radius of the cone in units of the finest length
/// @param fineness  refinement factor of the rule
/// @param times  further refinement factor of rings and directions
void make_cone_rule(double radius, int fineness, int times, std::vector<ConePoint>& points,
                    std::vector<Vec2d>& directions) {
  times *= fineness;
  int const rings = std::min(40 * fineness, times * (static_cast<int>(std::ceil(0.35 * radius)) + 4));
  int const count = std::min(std::min(128 * fineness, ConeRule::most_directions),
                             times * 4 * static_cast<int>(std::ceil(0.45 * radius + 4)));
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

/// Returns the points of a sunflower spiral, sorted such that neighbours are adjacent in memory.
std::vector<Vec2d> scattered_points(int count) {
  std::vector<Vec2d> points;
  for (int k = 0; k < count; ++k) points.push_back(sunflower(k, count));
  std::stable_sort(points.begin(), points.end(), [](Vec2d a, Vec2d b) { return z_order(a) < z_order(b); });
  return points;
}

/// Creates the rule over a source. It is exact for polynomials of degree 5, so that the least-squares quadratic over
/// its points equals that over the whole source.
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

/// Returns the light of a white dot on the axis [fully lit px]; a point has the light of a disc of one pixel's area.
double light_of_dot(double half_size_px, SourceShape shape) {
  if (half_size_px == 0) return 1;
  return (shape == SourceShape::disc ? pi : 4) * half_size_px * half_size_px;
}

}  // namespace

OwnedDotModel::OwnedDotModel(FocusedDots const& dots, DotPattern const& sources, DeflectionTable const& table,
                             bool with_images, MomentImagesBy by) {
  Scene const& scene = dots.scene();
  RenderPlan const& plan = dots.plan();
  model.axis_px = scene.camera.sensor.axis_pixel();
  model.columns = scene.setup.camera.columns;
  model.rows = scene.setup.camera.rows;
  model.source_half = sources.half_size;
  model.stop_radius = scene.imaging.entrance_pupil / 2;
  model.bench = dots.bench();
  model.spot.sigma = scene.spot_sigma_px();
  double const half_px = model.half_size_px();
  model.dot_light = light_of_dot(half_px, sources.shape);
  model.table = table;
  // The finest length of a closed form is not a grid cell but the length of a wave's whole slope.
  bool const closed_form = scene.medium.grid.nodes[0] <= 1;
  model.cone.fine = closed_form || plan.fineness > 1;
  double const radius =
      scene.medium.finest > 0 ? table.mid_plane_fraction * model.stop_radius / scene.medium.finest : 0;
  make_cone_rule(radius, plan.fineness, closed_form ? 2 : 1, cone_points, cone_directions);
  model.cone.points = cone_points.data();
  model.cone.directions = cone_directions.data();
  model.cone.count = static_cast<int>(cone_points.size());
  model.cone.direction_count = static_cast<int>(cone_directions.size());
  model.cone.scattered_count = std::max(1024, 2 * model.cone.count);
  cone_scattered = scattered_points(model.cone.scattered_count);
  model.cone.scattered = cone_scattered.data();
  model.cone.smoothing = Scene::stop_edge(model.cone.scattered_count);
  model.places = make_place_rule(sources.half_size > 0, sources.shape);

  bool const given = plan.given_rays.has_value();
  std::uint64_t const asked = std::min(plan.rays, most_given_rays);
  // round up to whole warps
  std::uint64_t const wanted = given ? asked : (std::max<std::uint64_t>(asked, 1) + 31) / 32 * 32;
  model.choice.seed = plan.seed;
  model.choice.scrambling_bits = scrambling_bits(wanted);
  model.shape = sources.shape;
  model.fewest_rays = static_cast<int>(wanted);
  model.most_rays = static_cast<int>(given ? wanted : std::max(wanted, most_chosen_rays));

  source = SourceCubature::make(sources.shape, half_px, model.spot.sigma);
  model.source = {source.points.data(), source.weights.data(), static_cast<int>(source.points.size())};
  MomentImages& images = model.moment_images;
  images =
      MomentImages::plan(half_px, model.spot, model.most_square_side(), sources.half_size > 0 ? PlaceRule::terms : 1);
  if (with_images && table.exists() && by == MomentImagesBy::host && images.exist()) {
    moment_images = make_moment_images(images, model.source, half_px, model.spot);
    images.values = moment_images.data();
  }
}

}  // namespace gladstone::inline focused_dots
