#include "analysis/tomography/total_variation.h"

#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone::inline tomography {

TotalVariation::TotalVariation(RegularGrid const& grid)
    : stencil_(TotalVariationStencil::of(grid)), dual_(grid.size()) {}

template <class Body>
void TotalVariation::for_each_node(Body const& body) const {
  parallel_for(static_cast<std::size_t>(stencil_.nodes[2]), [&](std::size_t plane) {
    int const k = static_cast<int>(plane);
    for (int j = 0; j < stencil_.nodes[1]; ++j)
      for (int i = 0; i < stencil_.nodes[0]; ++i) body(static_cast<std::size_t>(stencil_.index(i, j, k)), i, j, k);
  });
}

void TotalVariation::denoise(std::vector<double>& volume, double lambda, int iterations) {
  GLADSTONE_EXPECTS(volume.size() == dual_.size());
  if (!(lambda > 0.0)) return;
  std::vector<double> denoised(volume.size());
  auto const apply = [&] {
    for_each_node([&](std::size_t node, int i, int j, int k) {
      denoised[node] = stencil_.denoise(volume.data(), dual_.data(), lambda, i, j, k);
    });
  };
  for (int iteration = 0; iteration < iterations; ++iteration) {
    apply();
    for_each_node([&](std::size_t node, int i, int j, int k) {
      dual_[node] = stencil_.project(denoised.data(), dual_.data(), lambda, i, j, k);
    });
  }
  apply();
  volume.swap(denoised);
}

double TotalVariation::compute(std::vector<double> const& volume) const {
  std::vector<double> of_plane(static_cast<std::size_t>(stencil_.nodes[2]), 0.0);
  for_each_node([&](std::size_t, int i, int j, int k) {
    of_plane[static_cast<std::size_t>(k)] += length(stencil_.differentiate(volume.data(), i, j, k));
  });
  double sum = 0.0;
  for (double const one : of_plane) sum += one;
  return sum;
}

}  // namespace gladstone::inline tomography
