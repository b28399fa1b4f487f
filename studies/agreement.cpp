#include "studies/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "render/base/contracts.h"
#include "render/medium/density_field.h"
#include "render/scene/ray_plan.h"

namespace gladstone {
namespace {

constexpr int pieces_across = 4;  // of the plane, for the jackknife

/// Which piece of a periodic plane of `plane_nodes` a place on the medium's mid-plane belongs to.
std::size_t piece_at(Vec2d place, FieldSetup const& field, int plane_nodes) {
  auto const index = [&](double along, double centre, double spacing) {
    double const node = (along - centre) / spacing + 0.5 * (plane_nodes - 1);
    double const share = node / plane_nodes - std::floor(node / plane_nodes);
    return std::min(static_cast<int>(share * pieces_across), pieces_across - 1);
  };
  int const column = index(place.x, field.center.x, field.spacing->x);
  int const row = index(place.y, field.center.y, field.spacing->y);
  return static_cast<std::size_t>(row * pieces_across + column);
}

using Pieces = std::array<AgreementSums, pieces_across * pieces_across>;

/// Standard errors from the values without one piece each (Efron & Stein, Ann. Stat. 9 (1981) 586).
Agreement jackknife(AgreementSums const& whole, Pieces const& pieces) {
  constexpr double count = std::tuple_size_v<Pieces>;
  Agreement mean{}, square{};
  for (AgreementSums const& piece : pieces) {
    Agreement const without = (whole - piece).agreement();
    mean.correlation += without.correlation / count;
    mean.rms_ratio += without.rms_ratio / count;
    square.correlation += without.correlation * without.correlation / count;
    square.rms_ratio += without.rms_ratio * without.rms_ratio / count;
  }
  auto const error = [](double mean_square, double mean_value) {
    return std::sqrt((count - 1) * std::max(0.0, mean_square - mean_value * mean_value));
  };
  return {error(square.correlation, mean.correlation), error(square.rms_ratio, mean.rms_ratio)};
}

}  // namespace

void AgreementSums::add(GroundTruth const& truth, std::size_t i) {
  Vec2d const e = truth.eq9_px[i], c = truth.eq9_cone_px[i], r = truth.displacement_px[i];
  if (!std::isfinite(r.x) || !std::isfinite(r.y)) return;
  eq9 += dot(e, e);
  cone += dot(c, c);
  rays += dot(r, r);
  eq9_rays += dot(e, r);
  ++dots;
}

AgreementSums& AgreementSums::operator+=(AgreementSums const& other) {
  eq9 += other.eq9;
  cone += other.cone;
  rays += other.rays;
  eq9_rays += other.eq9_rays;
  dots += other.dots;
  return *this;
}

AgreementSums AgreementSums::operator-(AgreementSums const& part) const {
  return {eq9 - part.eq9, cone - part.cone, rays - part.rays, eq9_rays - part.eq9_rays, dots - part.dots};
}

double AgreementSums::eq9_px() const { return std::sqrt(eq9 / (2 * static_cast<double>(dots))); }
double AgreementSums::cone_px() const { return std::sqrt(cone / (2 * static_cast<double>(dots))); }
double AgreementSums::rays_px() const { return std::sqrt(rays / (2 * static_cast<double>(dots))); }
Agreement AgreementSums::agreement() const { return {eq9_rays / std::sqrt(eq9 * rays), std::sqrt(rays / eq9)}; }

AgreementSums agreement_in_view(Scene const& scene, GroundTruth const& truth) {
  AgreementSums sums;
  auto const sensor = scene.view().sensor;
  for (std::size_t dot = 0; dot < truth.size(); ++dot) {
    if (sensor.covers(truth.reference_px[dot])) sums.add(truth, dot);
  }
  return sums;
}

Image<double> field_plane(FieldSetup const& field) {
  auto const source = open_field(field.file, field.dataset);
  RegularGrid const& grid = source->grid();
  GLADSTONE_EXPECTS(grid.nodes[2] == 1);
  Image<double> plane(grid.nodes[0], grid.nodes[1]);
  source->read_planes(0, 1, {plane.data(), plane.size()});
  return plane;
}

PlaneAgreement agreement_over_plane(Setup setup, int nodes, double spacing, Renderer& renderer) {
  FieldSetup& field = setup.medium.field;
  int const plane_nodes = open_field(field.file, field.dataset)->grid().nodes[0];
  GLADSTONE_EXPECTS(nodes > 0 && plane_nodes % nodes == 0 && setup.render.rays_per_dot);
  int const views = plane_nodes / nodes;
  field.spacing = Vec3d{spacing, spacing, spacing};
  setup.target.dots_per_32px_window /= views * views;
  setup.view_margin_px = 0;
  std::uint64_t const seed = setup.target.seed;
  Pieces pieces;
  for (int row = 0; row < views; ++row) {
    for (int column = 0; column < views; ++column) {
      field.center = {column * nodes * spacing, row * nodes * spacing, 0};
      setup.target.seed = seed + static_cast<std::uint64_t>(row * views + column);
      Scene scene = build_scene(setup);
      plan_step(scene);
      scene.rays_per_dot = *setup.render.rays_per_dot;
      GroundTruth const truth = renderer.render(scene, scene.dots, RenderImages::no, RenderTheory::yes).truth;
      for (std::size_t dot = 0; dot < truth.size(); ++dot) {
        Vec2d const on_medium = scene.dots.centre[dot] * (setup.z_a / setup.z_b());
        pieces[piece_at(on_medium, field, plane_nodes)].add(truth, dot);
      }
    }
  }
  PlaneAgreement result;
  for (AgreementSums const& piece : pieces) result.sums += piece;
  result.error = jackknife(result.sums, pieces);
  return result;
}

}  // namespace gladstone
