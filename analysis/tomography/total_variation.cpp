#include "analysis/tomography/total_variation.h"

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone::tomography {
namespace {

/// Largest stable step of the dual iteration: 1 / |gradient|^2, which is at most 4 along each of the three axes.
constexpr double dual_step = 1.0 / 12.0;

}  // namespace

TotalVariation::TotalVariation(RegularGrid const& grid) : nodes_(grid.nodes), dual_(grid.size()) {
  double const shortest = std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  ratio_ = {shortest / grid.spacing.x, shortest / grid.spacing.y, shortest / grid.spacing.z};
}

template <class Body>
void TotalVariation::for_each_node(Body const& body) const {
  auto const row = static_cast<std::size_t>(nodes_[0]), plane = row * static_cast<std::size_t>(nodes_[1]);
  parallel_for(static_cast<std::size_t>(nodes_[2]), [&](std::size_t k) {
    for (int j = 0; j < nodes_[1]; ++j)
      for (int i = 0; i < nodes_[0]; ++i)
        body(k * plane + static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i), i, j, static_cast<int>(k));
  });
}

Vec3d TotalVariation::differentiate(std::vector<double> const& volume, std::size_t node, int i, int j, int k) const {
  auto const row = static_cast<std::size_t>(nodes_[0]), plane = row * static_cast<std::size_t>(nodes_[1]);
  double const here = volume[node];
  return {i + 1 < nodes_[0] ? ratio_.x * (volume[node + 1] - here) : 0.0,
          j + 1 < nodes_[1] ? ratio_.y * (volume[node + row] - here) : 0.0,
          k + 1 < nodes_[2] ? ratio_.z * (volume[node + plane] - here) : 0.0};
}

/// Divergence of the dual variable, the negative adjoint of differentiate().
double TotalVariation::diverge(std::size_t node, int i, int j, int k) const {
  auto const row = static_cast<std::size_t>(nodes_[0]), plane = row * static_cast<std::size_t>(nodes_[1]);
  Vec3d const here = dual_[node];
  double sum = 0.0;
  if (i + 1 < nodes_[0]) sum += ratio_.x * here.x;
  if (i > 0) sum -= ratio_.x * dual_[node - 1].x;
  if (j + 1 < nodes_[1]) sum += ratio_.y * here.y;
  if (j > 0) sum -= ratio_.y * dual_[node - row].y;
  if (k + 1 < nodes_[2]) sum += ratio_.z * here.z;
  if (k > 0) sum -= ratio_.z * dual_[node - plane].z;
  return sum;
}

void TotalVariation::denoise(std::vector<double>& volume, double lambda, int iterations) {
  GLADSTONE_EXPECTS(volume.size() == dual_.size());
  if (!(lambda > 0.0)) return;
  std::vector<double> denoised(volume.size());
  auto const apply = [&] {
    for_each_node([&](std::size_t node, int i, int j, int k) {
      denoised[node] = volume[node] + lambda * diverge(node, i, j, k);
    });
  };
  for (int iteration = 0; iteration < iterations; ++iteration) {
    apply();
    for_each_node([&](std::size_t node, int i, int j, int k) {
      Vec3d const p = dual_[node] + (dual_step / lambda) * differentiate(denoised, node, i, j, k);
      dual_[node] = p / std::max(1.0, length(p));
    });
  }
  apply();
  volume.swap(denoised);
}

double TotalVariation::compute(std::vector<double> const& volume) const {
  std::vector<double> of_plane(static_cast<std::size_t>(nodes_[2]), 0.0);
  for_each_node([&](std::size_t node, int i, int j, int k) {
    of_plane[static_cast<std::size_t>(k)] += length(differentiate(volume, node, i, j, k));
  });
  double sum = 0.0;
  for (double const one : of_plane) sum += one;
  return sum;
}

}  // namespace gladstone::tomography
