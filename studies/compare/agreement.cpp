#include "studies/compare/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/base/contracts.h"
#include "render/files/fields/field_file.h"
#include "render/planning.h"
#include "render/render.h"

namespace gladstone::inline compare {
namespace {

constexpr int pieces_across = 4;  // number of jackknife pieces along each side of the plane
// side length of the plane in dots; at 512 nodes, the dot spacing is half the size of the turbulent structures
constexpr int dots_across = 96;

using Pieces = std::array<AgreementSums, pieces_across * pieces_across>;

/// Computes jackknife standard errors from the values without one piece each (Efron & Stein, Ann. Stat. 9 (1981) 586).
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

/// Builds a scene with a square lattice of dots in place of those of its setup.
/// @param side   number of dots along each side
/// @param pitch  distance of the dots [m]
Scene build_lattice_scene(Setup const& setup, int side, double pitch) {
  Scene scene = build_scene(setup);
  scene.dots.centre.clear();
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i)
      scene.dots.centre.push_back({pitch * (i - 0.5 * (side - 1)), pitch * (j - 0.5 * (side - 1))});
  }
  return scene;
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
  int const views = plane_nodes / nodes, dots = dots_across / views;
  GLADSTONE_EXPECTS(dots * views == dots_across);
  field.spacing = Vec3d{spacing, spacing, spacing};
  double const pitch = nodes * spacing / dots * setup.z_b() / setup.z_a;  // dot spacing on the target [m]
  Pieces pieces;
  for (int row = 0; row < views; ++row) {
    for (int column = 0; column < views; ++column) {
      field.center = {-column * nodes * spacing, -row * nodes * spacing, 0};
      Scene const scene = build_lattice_scene(setup, dots, pitch);
      RenderPlan plan = plan_step(scene);
      plan.rays = *setup.render.rays_per_dot;
      GroundTruth const truth = render(scene, plan, renderer, RenderImages::no, RenderTheory::yes).truth;
      for (int j = 0; j < dots; ++j) {
        for (int i = 0; i < dots; ++i) {
          int const piece_row = (row * dots + j) * pieces_across / dots_across;
          int const piece_column = (column * dots + i) * pieces_across / dots_across;
          pieces[static_cast<std::size_t>(piece_row * pieces_across + piece_column)].add(
              truth, static_cast<std::size_t>(j * dots + i));
        }
      }
    }
  }
  PlaneAgreement result;
  for (AgreementSums const& piece : pieces) result.sums += piece;
  result.error = jackknife(result.sums, pieces);
  return result;
}

}  // namespace gladstone::inline compare
