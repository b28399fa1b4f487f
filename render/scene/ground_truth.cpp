#include "render/scene/ground_truth.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::inline scene {

void GroundTruth::resize(std::size_t count) {
  std::vector<Vec2d>* const columns[] = {
      &reference_px, &displacement_px, &displacement_error_px, &displacement_std_px, &flux, &eq9_px,
      &chief_px,     &eq9_cone_px};
  auto const resize_some = [&](std::size_t i) {
    if (i > 0) return columns[i - 1]->resize(count);
    position_m.resize(count);
    rays.resize(count);
    rays_planned.resize(count);
    path.resize(count);
  };
  constexpr std::size_t worth_waking_threads = 1 << 15;
  if (count >= worth_waking_threads) return parallel_for(1 + std::size(columns), resize_some);
  for (std::size_t i = 0; i <= std::size(columns); ++i) resize_some(i);
}

void GroundTruth::copy(GroundTruth const& other, std::size_t from, std::size_t to) {
  position_m[to] = other.position_m[from];
  for (auto column : {&GroundTruth::reference_px, &GroundTruth::displacement_px, &GroundTruth::displacement_error_px,
                      &GroundTruth::displacement_std_px, &GroundTruth::flux, &GroundTruth::eq9_px,
                      &GroundTruth::chief_px, &GroundTruth::eq9_cone_px}) {
    (this->*column)[to] = (other.*column)[from];
  }
  rays[to] = other.rays[from];
  rays_planned[to] = other.rays_planned[from];
  path[to] = other.path[from];
}

void GroundTruth::set_hits(std::size_t dot, DotTruth const& found, double light_per_weight) {
  Vec2d const none{not_a_number, not_a_number};
  CentroidSum<double> const &reference = found.hits[0], &flow = found.hits[1];
  bool const seen[2] = {reference.weight > 0, flow.weight > 0};
  reference_px[dot] = seen[0] ? found.origin + reference.mean() : none;
  displacement_px[dot] = seen[0] && seen[1] ? flow.mean() - reference.mean() : none;
  displacement_error_px[dot] = seen[0] && seen[1] ? found.error : none;
  displacement_std_px[dot] = seen[1] ? flow.deviation() : none;
  flux[dot] = {reference.weight * light_per_weight, flow.weight * light_per_weight};
  rays[dot] = {reference.count, flow.count};
  path[dot] = found.path;
}

TruthAccuracy truth_accuracy(GroundTruth const& truth, double limit_px) {
  TruthAccuracy accuracy;
  double squares = 0;
  std::size_t known = 0;
  for (std::size_t dot = 0; dot < truth.size(); ++dot) {
    bool const by_table = truth.path[dot] == TruthPath::table;
    accuracy.by_table += by_table ? 1 : 0;
    if (std::isnan(truth.displacement_px[dot].x)) continue;
    Vec2d const error = truth.displacement_error_px[dot];
    double const larger = std::max(error.x, error.y);
    if (!std::isfinite(larger)) {
      ++accuracy.unknown;
      continue;
    }
    ++known;
    squares += error.x * error.x + error.y * error.y;
    if (larger > accuracy.largest_px) {
      accuracy.largest_px = larger;
      accuracy.worst = dot;
    }
    if (larger > limit_px) {
      ++accuracy.above;
      accuracy.above_by_rays += by_table ? 0 : 1;
    }
  }
  accuracy.rms_px = std::sqrt(squares / (2.0 * static_cast<double>(known)));
  return accuracy;
}

}  // namespace gladstone::inline scene
