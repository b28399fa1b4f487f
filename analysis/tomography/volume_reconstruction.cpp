#include "analysis/tomography/volume_reconstruction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/base/available_memory.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/not_a_number.h"
#include "render/base/progress.h"

namespace gladstone::inline tomography {
namespace {

// Memory per node: volume before and after a sweep, denoised volume, number of views, sums and dual variable.
constexpr double bytes_per_node = 8.0 + 8.0 + 8.0 + 8.0 + 16.0 + 24.0;

void check_settings(RegularGrid const& grid, SartSettings const& settings) {
  std::vector<SetupProblem> problems;
  auto const require = [&](bool holds, char const* name, std::string const& expected) {
    if (!holds) problems.push_back({name, "expected " + expected});
  };
  for (int axis = 0; axis < 3; ++axis) {
    int const nodes = grid.nodes[static_cast<std::size_t>(axis)];
    require(nodes >= 2 && nodes <= 100'000, "grid", fmt::format("2 to 100000 nodes along each axis, got {}", nodes));
    require(grid.spacing[axis] > 0.0 && std::isfinite(grid.spacing[axis]) && std::isfinite(grid.origin[axis]), "grid",
            "a positive spacing and finite bounds");
  }
  require(settings.iterations >= 1, "iterations", "1 or more");
  require(settings.relaxation > 0.0 && settings.relaxation < 2.0, "relaxation", "a number above 0 and below 2");
  double const tv_weight = settings.tv_weight.value_or(0.0);
  require(tv_weight >= 0.0 && std::isfinite(tv_weight), "tv-weight", "a number of 0 or more");
  require(settings.tolerance >= 0.0, "tolerance", "a number of 0 or more");
  require(settings.tv_iterations >= 1, "tv-iterations", "1 or more");
  require(settings.lowest <= 0.0 && settings.highest >= 0.0, "bounds", "an interval that contains the reference");
  if (!problems.empty()) throw SetupError(std::move(problems));
  GLADSTONE_EXPECTS(settings.support.empty() || settings.support.size() == grid.size());
}

void check_views(std::vector<ProjectedView> const& views) {
  if (views.size() < least_views)
    throw DataError(ErrorCode::undetermined, "tomography",
                    fmt::format("{} views do not determine a volume; give at least {}", views.size(), least_views));
  for (ProjectedView const& view : views) {
    if (view.lines.size() != view.value.size())
      throw DataError(ErrorCode::wrong_shape, view.name,
                      fmt::format("has {} lines of sight but {} line integrals; give one value per line",
                                  view.lines.size(), view.value.size()));
    if (std::none_of(view.value.begin(), view.value.end(), [](double value) { return std::isfinite(value); }))
      throw DataError(ErrorCode::no_valid_vector, view.name,
                      "has no line integral; check its vectors and its reference");
  }
}

/// Returns the order in which the views are used: their indices, sorted by the fractional part of index times golden
/// ratio, so that the directions of consecutive views differ strongly.
std::vector<std::size_t> order_views(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  auto const key = [](std::size_t i) { return std::fmod(0.6180339887498949 * static_cast<double>(i), 1.0); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return order;
}

/// Prepares a view for the iteration. Lines that cross less than one cell are ignored, since the division by their
/// small sum of weights would amplify noise.
SartView prepare_view(ProjectedView const& view, RegularGrid const& grid, double& outside, double& total) {
  SartView prepared{LineProjector(grid, view.lines), view.value};
  double const least = std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  for (std::size_t i = 0; i < view.value.size(); ++i) {
    double const row_sum = prepared.projector.row_sums()[i];
    if (!std::isfinite(view.value[i])) continue;
    total += view.value[i] * view.value[i];
    if (row_sum == 0.0) outside += view.value[i] * view.value[i];
    if (row_sum < least) prepared.value[i] = not_a_number;
  }
  return prepared;
}

void require_common_part(VolumeReconstruction const& result) {
  auto const most = *std::max_element(result.views.begin(), result.views.end());
  if (most >= static_cast<std::int64_t>(least_views)) return;
  throw DataError(ErrorCode::undetermined, "tomography",
                  fmt::format("no part of the volume is seen by more than {} views; check the cameras, "
                              "--angles and --bounds",
                              most));
}

/// Counts the nodes that at least one view sees and whose value may differ from zero.
std::size_t count_changed_nodes(VolumeReconstruction const& result, SartSettings const& settings) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < result.views.size(); ++i)
    if (result.views[i] > 0 && (settings.support.empty() || settings.support[i] != 0)) ++count;
  return count;
}

/// Returns the ratio of each view's rms residual to the rms of all line integrals, in the order in which the views are
/// given.
std::vector<double> compute_view_residual(SweepSums const& sums, std::vector<SartView> const& prepared,
                                          std::vector<std::size_t> const& order) {
  std::vector<double> result(order.size());
  double lines = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    auto const& values = prepared[i].value;
    auto const used =
        static_cast<double>(std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); }));
    lines += used;
    result[order[i]] = used > 0.0 ? std::sqrt(sums.residual[i] / used) : 0.0;
  }
  double const total = std::accumulate(sums.value.begin(), sums.value.end(), 0.0);
  for (double& one : result) one = total > 0.0 ? one / std::sqrt(total / lines) : 0.0;
  return result;
}

}  // namespace

double choose_tv_strength(double change, std::size_t nodes, double previous) {
  constexpr double slowest = 0.9;
  double const rms = nodes > 0 ? std::sqrt(change / static_cast<double>(nodes)) : 0.0;
  return std::max(rms, slowest * previous);
}

VolumeReconstruction reconstruct_volume(std::vector<ProjectedView> const& views, RegularGrid const& grid,
                                        SartSettings const& settings, SartVolumeMaker const& make_volume) {
  check_settings(grid, settings);
  check_views(views);
  require_memory("tomography",
                 fmt::format("a volume of {} x {} x {} nodes", grid.nodes[0], grid.nodes[1], grid.nodes[2]),
                 bytes_per_node * static_cast<double>(grid.size()));
  VolumeReconstruction result;
  result.grid = grid;
  std::vector<SartView> prepared;
  double outside = 0.0, total = 0.0;
  std::vector<std::size_t> const order = order_views(views.size());
  for (std::size_t const i : order) prepared.push_back(prepare_view(views[i], grid, outside, total));
  result.outside = total > 0.0 ? outside / total : 0.0;

  std::unique_ptr<SartVolume> const volume =
      make_volume({grid, prepared, settings.relaxation, settings.lowest, settings.highest, settings.support});
  result.device = volume->device();
  std::size_t changed_nodes = 0;
  double lambda = 0.0;
  SweepSums sums;
  Progress progress("reconstructing", static_cast<std::size_t>(settings.iterations) * views.size());
  for (int sweep = 0; sweep < settings.iterations; ++sweep) {
    for (std::size_t view = 0; view < prepared.size(); ++view) {
      throw_if_interrupted();
      volume->correct(view, sweep == 0);
      progress.advance();
    }
    if (sweep == 0) {
      volume->download(result.value, result.views);
      require_common_part(result);
      changed_nodes = count_changed_nodes(result, settings);
    }
    sums = volume->sum_sweep();
    lambda = settings.tv_weight ? *settings.tv_weight * sums.largest
                                : choose_tv_strength(sums.change, changed_nodes, lambda);
    SweepNorms const norms = volume->regularize(lambda, settings.tv_iterations);
    double const residual = std::accumulate(sums.residual.begin(), sums.residual.end(), 0.0);
    double const value = std::accumulate(sums.value.begin(), sums.value.end(), 0.0);
    result.residual.push_back(value > 0.0 ? std::sqrt(residual / value) : 0.0);
    result.tv_weight = sums.largest > 0.0 ? lambda / sums.largest : 0.0;
    if (std::sqrt(norms.change) <= settings.tolerance * std::sqrt(norms.volume)) break;
  }
  volume->download(result.value, result.views);
  result.view_residual = compute_view_residual(sums, prepared, order);
  return result;
}

std::vector<ContradictingView> find_contradicting_views(std::vector<double> const& view_residual) {
  constexpr double least_ratio = 1.4, least_residual = 0.1, part_of_largest = 0.7;
  double const largest = *std::max_element(view_residual.begin(), view_residual.end());
  std::vector<ContradictingView> found;
  for (std::size_t i = 0; i < view_residual.size(); ++i) {
    std::vector<double> others = view_residual;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    std::sort(others.begin(), others.end());
    double const usual = others[(others.size() - 1) / 2];
    if (view_residual[i] >= std::max({least_residual, least_ratio * usual, part_of_largest * largest}))
      found.push_back({i, view_residual[i] / usual});
  }
  return found;
}

double compute_relative_error(std::vector<double> const& value, std::vector<double> const& truth) {
  GLADSTONE_EXPECTS(value.size() == truth.size());
  double squares = 0.0, norm = 0.0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    squares += (value[i] - truth[i]) * (value[i] - truth[i]);
    norm += truth[i] * truth[i];
  }
  return std::sqrt(squares / norm);
}

}  // namespace gladstone::inline tomography
