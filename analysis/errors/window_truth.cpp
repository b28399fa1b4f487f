#include "analysis/errors/window_truth.h"

#include <atomic>
#include <cmath>
#include <limits>

#include "analysis/errors/point_cells.h"
#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone {

WindowWeight gaussian_window(double sigma_px, double half_width_px) {
  GLADSTONE_EXPECTS(sigma_px > 0.0 && half_width_px > 0.0);
  double const factor = -0.5 / (sigma_px * sigma_px);
  return {[factor](double dx, double dy) { return std::exp(factor * (dx * dx + dy * dy)); }, half_width_px};
}

WindowWeight top_hat_window(double window_px) {
  GLADSTONE_EXPECTS(window_px > 0.0);
  return {[](double, double) { return 1.0; }, 0.5 * window_px};
}

namespace {

/// A dot of a window: a W^2, its place from the window's centre, its displacement.
struct WindowDot {
  double weight;
  Vec2d offset_px, displacement_px;
};

Vec2d mean_displacement(std::vector<WindowDot> const& dots) {
  Vec2d sum{};
  double total = 0.0;
  for (WindowDot const& dot : dots) {
    sum += dot.weight * dot.displacement_px;
    total += dot.weight;
  }
  return sum / total;
}

/// The plane of least squares, at the window's centre.
Vec2d plane_at_centre(std::vector<WindowDot> const& dots) {
  constexpr double least_width = 1e-3;  // of dots that are not in line, in parts of their length
  Vec2d place{}, mean = mean_displacement(dots);
  double total = 0.0;
  for (WindowDot const& dot : dots) {
    place += dot.weight * dot.offset_px;
    total += dot.weight;
  }
  place = place / total;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  Vec2d by_x{}, by_y{};
  for (WindowDot const& dot : dots) {
    Vec2d const r = dot.offset_px - place, d = dot.weight * (dot.displacement_px - mean);
    xx += dot.weight * r.x * r.x;
    xy += dot.weight * r.x * r.y;
    yy += dot.weight * r.y * r.y;
    by_x += r.x * d;
    by_y += r.y * d;
  }
  // width^2 and length^2 are the eigenvalues of the second moments; their product over their sum's square is close to
  // (width/length)^2 where dots are nearly in line
  double const determinant = xx * yy - xy * xy, trace = xx + yy;
  if (!(determinant > least_width * least_width * trace * trace)) return mean;
  Vec2d const along_x = (yy * by_x - xy * by_y) / determinant, along_y = (xx * by_y - xy * by_x) / determinant;
  return mean - place.x * along_x - place.y * along_y;
}

WindowTruth truth_by(Vec2d (*value)(std::vector<WindowDot> const&), std::span<Vec2d const> reference_px,
                     std::span<Vec2d const> displacement_px, std::span<double const> flux,
                     std::span<Vec2d const> centres_px, WindowWeight const& weight, TruthAt at) {
  GLADSTONE_EXPECTS(reference_px.size() == displacement_px.size());
  GLADSTONE_EXPECTS(flux.empty() || flux.size() == reference_px.size());
  GLADSTONE_EXPECTS(weight.half_width_px > 0.0);

  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec2d> position(reference_px.size());
  for (std::size_t i = 0; i < position.size(); ++i) {
    Vec2d const d = displacement_px[i];
    bool const usable = std::isfinite(d.x) && std::isfinite(d.y);
    Vec2d const shift = at == TruthAt::mid_position ? 0.5 * d : Vec2d{};
    position[i] = usable ? reference_px[i] + shift : Vec2d{nan, nan};
  }
  PointCells const cells(position, weight.half_width_px);

  WindowTruth truth;
  truth.displacement_px.resize(centres_px.size());
  std::atomic<std::size_t> left_out{0};
  parallel_chunks(centres_px.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<WindowDot> dots;
    for (std::size_t i = begin; i < end; ++i) {
      dots.clear();
      cells.for_near(centres_px[i], weight.half_width_px, [&](std::size_t dot) {
        Vec2d const offset = position[dot] - centres_px[i];
        if (std::abs(offset.x) > weight.half_width_px || std::abs(offset.y) > weight.half_width_px) return;
        double const w = weight.value(offset.x, offset.y) * (flux.empty() ? 1.0 : flux[dot]);
        if (w > 0.0) dots.push_back({w * w, offset, displacement_px[dot]});
      });
      bool const enough = dots.size() >= 3;
      truth.displacement_px[i] = enough ? value(dots) : Vec2d{nan, nan};
      if (!enough) ++left_out;
    }
  });
  truth.left_out = left_out;
  return truth;
}

}  // namespace

WindowTruth window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                         std::span<double const> flux, std::span<Vec2d const> centres_px, WindowWeight const& weight,
                         TruthAt at) {
  return truth_by(mean_displacement, reference_px, displacement_px, flux, centres_px, weight, at);
}

WindowTruth deformed_window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                                  std::span<double const> flux, std::span<Vec2d const> centres_px,
                                  WindowWeight const& weight, TruthAt at) {
  return truth_by(plane_at_centre, reference_px, displacement_px, flux, centres_px, weight, at);
}

}  // namespace gladstone
