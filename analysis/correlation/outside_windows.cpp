#include "analysis/correlation/outside_windows.h"

#include <algorithm>
#include <cmath>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/vector_validation.h"
#include "render/base/contracts.h"

namespace gladstone::inline correlation {
namespace {

enum class Place { known, unknown, outside };

Place place_of(Image<double> const& frame, Vec2d at) {
  long const i = std::lround(at.x), j = std::lround(at.y);
  if (i < 0 || j < 0 || i >= frame.columns() || j >= frame.rows()) return Place::outside;
  return std::isfinite(frame(static_cast<int>(i), static_cast<int>(j))) ? Place::known : Place::unknown;
}

/// Returns whether more pixels of a window are outside the frames than are unknown inside the frames.
bool is_outside(Image<double> const& reference, Image<double> const& flow, Vec2d centre, int window_px,
                Vec2d displacement) {
  int outside = 0, unknown = 0;
  for (int j = 0; j < window_px; ++j)
    for (int i = 0; i < window_px; ++i) {
      Vec2d const at = centre + Vec2d{i - 0.5 * (window_px - 1), j - 0.5 * (window_px - 1)};
      Place const first = place_of(reference, at - 0.5 * displacement),
                  second = place_of(flow, at + 0.5 * displacement);
      if (first == Place::outside || second == Place::outside)
        ++outside;
      else
        unknown += first == Place::unknown || second == Place::unknown;
    }
  return outside > unknown;
}

}  // namespace

void mark_windows_outside(DisplacementField& field, StoredFrames const& frames, CorrelationSettings const& settings) {
  if (std::find(field.reason.begin(), field.reason.end(), VectorReason::masked) == field.reason.end()) return;
  Image<double> const &reference = frames.reference(), &flow = frames.flow();
  auto const is_gap = [](double level) { return !std::isfinite(level); };
  bool const gaps =
      std::any_of(reference.begin(), reference.end(), is_gap) || std::any_of(flow.begin(), flow.end(), is_gap);
  std::vector<Vec2d> around;
  if (gaps) {
    GLADSTONE_EXPECTS(field.columns > 0);
    std::vector<GridVector> vectors(field.size());
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      vectors[i].displacement = field.displacement_px[i];
      vectors[i].status = field.status[i];
    }
    around = filled_displacement(vectors, field.columns);
  }
  int const window_px = settings.window_px.back();
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.reason[i] != VectorReason::masked) continue;
    if (gaps && !is_outside(reference, flow, field.position_px[i], window_px, around[i])) continue;
    field.status[i] = VectorStatus::invalid;
    field.reason[i] = VectorReason::outside;
  }
}

}  // namespace gladstone::inline correlation
