#include "cuda/device_medium.h"

namespace gladstone::cuda {
namespace {

/// Volumes up to this many nodes are held in double: 128 MiB [nodes].
constexpr std::size_t most_wide_nodes = std::size_t{1} << 24;

template <class Grid>
std::size_t coefficient_count(Grid const& grid) {
  return static_cast<std::size_t>(grid.plane) *
         static_cast<std::size_t>(Grid::dimensions == 2 ? 1 : grid.nodes[2] + 2 * Grid::padding);
}

/// @throws OutOfDeviceMemory before anything is allocated
void require_room(char const* what_for, std::size_t bytes) {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
  if (bytes > free) throw OutOfDeviceMemory(what_for, bytes);
}

}  // namespace

MirroredMedium::MirroredMedium(Medium<double> const& medium, bool wide) : host_(medium) {
  std::visit(
      [&](auto const& grid) {
        if constexpr (requires { grid.coefficients; }) {
          using Grid = std::remove_cvref_t<decltype(grid)>;
          using Stored = std::remove_cvref_t<decltype(*grid.coefficients)>;
          std::size_t const count = coefficient_count(grid);
          bool const widen = wide && std::is_same_v<Grid, SplineVolume<double>> && count <= most_wide_nodes;
          char const* const name = "the field's refractivity";
          require_room(name, count * (widen ? sizeof(double) : sizeof(Stored)));
          if (widen) {
            std::vector<double> const widened(grid.coefficients, grid.coefficients + count);
            doubles_ = DeviceArray<double>(widened.data(), count, name);
          } else if constexpr (std::is_same_v<Stored, float>) {
            floats_ = DeviceArray<float>(grid.coefficients, count, name);
          } else {
            doubles_ = DeviceArray<double>(grid.coefficients, count, name);
          }
        }
      },
      medium);
}

}  // namespace gladstone::cuda
