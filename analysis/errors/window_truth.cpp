#include "analysis/errors/window_truth.h"

#include <atomic>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/base/point_cells.h"

namespace gladstone::inline errors {

WindowWeight correlation_window(WindowWeighting weighting, double window_px) {
  GLADSTONE_EXPECTS(window_px > 0.0);
  return {[=](double dx, double dy) {
            return axis_weight(weighting, dx, window_px) * axis_weight(weighting, dy, window_px);
          },
          window_half_support(weighting, window_px)};
}

WindowTruth window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                         std::span<double const> flux, std::span<Vec2d const> centres_px, WindowWeight const& weight,
                         TruthAt at) {
  GLADSTONE_EXPECTS(reference_px.size() == displacement_px.size());
  GLADSTONE_EXPECTS(flux.empty() || flux.size() == reference_px.size());
  GLADSTONE_EXPECTS(weight.half_width_px > 0.0);

  std::vector<Vec2d> position(reference_px.size());
  for (std::size_t i = 0; i < position.size(); ++i) {
    Vec2d const d = displacement_px[i];
    Vec2d const shift = at == TruthAt::mid_position ? 0.5 * d : Vec2d{};
    position[i] = is_finite(d) ? reference_px[i] + shift : Vec2d{not_a_number, not_a_number};
  }
  PointCells const cells(position, weight.half_width_px);

  WindowTruth truth;
  truth.displacement_px.resize(centres_px.size());
  std::atomic<std::size_t> left_out{0};
  parallel_chunks(centres_px.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec2d sum{};
      double total = 0.0;
      int dots = 0;
      cells.for_near(centres_px[i], weight.half_width_px, [&](std::size_t dot) {
        Vec2d const offset = position[dot] - centres_px[i];
        if (std::abs(offset.x) > weight.half_width_px || std::abs(offset.y) > weight.half_width_px) return;
        double const w = weight.value(offset.x, offset.y) * (flux.empty() ? 1.0 : flux[dot]);
        if (!(w > 0.0)) return;
        sum += (w * w) * displacement_px[dot];
        total += w * w;
        ++dots;
      });
      bool const enough = dots >= 3;
      truth.displacement_px[i] = enough ? sum / total : Vec2d{not_a_number, not_a_number};
      if (!enough) ++left_out;
    }
  });
  truth.left_out = left_out;
  return truth;
}

}  // namespace gladstone::inline errors
