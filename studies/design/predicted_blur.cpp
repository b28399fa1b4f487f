#include "studies/design/predicted_blur.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/base/parallel.h"
#include "render/planning.h"
#include "render/scene/field_map.h"
#include "render/scene/scene.h"

namespace gladstone::inline design {
namespace {

constexpr int spacing_px = 2;  ///< spacing of the lattice's nodes, of which a window averages over many [px]

/// Displaced sampling point with its weight.
struct Offset {
  Vec2d px;
  double weight;
};

/// Samples slice, position in the cone and position in the dot by an additive recurrence in five dimensions (Roberts
/// 2018; the root of x^6 = x + 1). Every point is paired with its opposite, so that a uniform gradient is averaged
/// exactly.
std::vector<Offset> blur_offsets(DesignPoint<double> const& bench) {
  constexpr int points = 256;
  constexpr double root = 1.1347241384015194;
  double const pixel = bench.pixel_at_medium(), dot = bench.dot_diameter * bench.z_a / bench.z_b() / pixel;
  std::array<double, 5> u;
  std::vector<Offset> offsets;
  auto const in_disc = [](double radius, double turn) {
    return std::sqrt(radius) / 2 * Vec2d{std::cos(2 * pi * turn), std::sin(2 * pi * turn)};
  };
  for (int i = 1; i <= points; ++i) {
    for (std::size_t k = 0; k < u.size(); ++k) {
      double const step = i * std::pow(root, -1.0 - static_cast<double>(k));
      u[k] = step - std::floor(step);
    }
    double const s = bench.z_d + bench.given->thickness * (u[0] - 0.5);
    double const cone = bench.pupil() * s / bench.z_b() / pixel;
    Vec2d const place = cone * in_disc(u[1], u[2]) + dot * in_disc(u[3], u[4]);
    double const weight = s / bench.z_d / (2 * points);
    offsets.push_back({place, weight});
    offsets.push_back({-1.0 * place, weight});
  }
  double sum = 0;
  for (Offset const& offset : offsets) sum += offset.weight;
  for (Offset& offset : offsets) offset.weight /= sum;
  return offsets;
}

/// Displacements on a lattice, with bilinear interpolation between nodes and constant extrapolation.
class Lattice {
 public:
  explicit Lattice(Image<Vec2d> values) : values_(std::move(values)) {}
  Image<Vec2d> const& values() const { return values_; }

  Vec2d at(Vec2d pixel) const {
    double const x = std::clamp((pixel.x + 0.5) / spacing_px - 0.5, 0.0, values_.columns() - 1.0);
    double const y = std::clamp((pixel.y + 0.5) / spacing_px - 0.5, 0.0, values_.rows() - 1.0);
    int const i = std::min(static_cast<int>(x), values_.columns() - 2);
    int const j = std::min(static_cast<int>(y), values_.rows() - 2);
    double const a = x - i, b = y - j;
    return (1 - b) * ((1 - a) * values_(i, j) + a * values_(i + 1, j)) +
           b * ((1 - a) * values_(i, j + 1) + a * values_(i + 1, j + 1));
  }

 private:
  Image<Vec2d> values_;
};

Lattice blurred(Lattice const& sharp, std::vector<Offset> const& offsets) {
  int const columns = sharp.values().columns(), rows = sharp.values().rows();
  Image<Vec2d> values(columns, rows);
  parallel_for(static_cast<std::size_t>(rows), [&](std::size_t row) {
    for (int column = 0; column < columns; ++column) {
      Vec2d const node{spacing_px * (column + 0.5) - 0.5, spacing_px * (static_cast<double>(row) + 0.5) - 0.5};
      Vec2d sum{};
      for (Offset const& offset : offsets) sum += offset.weight * sharp.at(node + offset.px);
      values(column, static_cast<int>(row)) = sum;
    }
  });
  return Lattice(std::move(values));
}

/// Averages over the pixels of an interrogation window centred at `place`, with its weights.
Vec2d in_window(Lattice const& lattice, WindowTransfer const& window, Vec2d place) {
  std::vector<double> const& side = window.side();
  Vec2d sum{};
  for (std::size_t j = 0; j < side.size(); ++j) {
    double const dy = static_cast<double>(j) + 0.5;
    for (std::size_t i = 0; i < side.size(); ++i) {
      double const dx = static_cast<double>(i) + 0.5, weight = side[i] * side[j] / 4;
      sum += weight * (lattice.at(place + Vec2d{dx, dy}) + lattice.at(place + Vec2d{-dx, dy}) +
                       lattice.at(place + Vec2d{dx, -dy}) + lattice.at(place + Vec2d{-dx, -dy}));
    }
  }
  return sum;
}

}  // namespace

PredictedBlur predicted_blur(Setup const& setup, DesignPoint<double> const& bench,
                             std::vector<Vec2d> const& places_px) {
  std::vector<Offset> const offsets = blur_offsets(bench);
  double reach = static_cast<double>(bench.given->window.side().size());
  double farthest = 0;
  for (Offset const& offset : offsets) farthest = std::max(farthest, length(offset.px));
  int const margin = 2 * spacing_px + static_cast<int>(std::ceil(reach + farthest));
  Setup wider = setup;
  wider.camera.columns += 2 * margin;
  wider.camera.rows += 2 * margin;
  Scene const scene = build_scene(wider);
  Lattice const sharp(map_field(scene, plan_step(scene).step, spacing_px).eq9_px);
  Lattice const cone = blurred(sharp, offsets);
  PredictedBlur blur;
  blur.cone_px.resize(places_px.size());
  blur.whole_px.resize(places_px.size());
  parallel_for(places_px.size(), [&](std::size_t i) {
    Vec2d const place = places_px[i] + Vec2d{double(margin), double(margin)};
    Vec2d const eq9 = sharp.at(place);
    blur.cone_px[i] = cone.at(place) - eq9;
    blur.whole_px[i] = in_window(cone, bench.given->window, place) - eq9;
  });
  return blur;
}

}  // namespace gladstone::inline design
