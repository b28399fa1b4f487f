#include "cuda/device_medium.h"

#include <fmt/format.h>

namespace gladstone::cuda {
namespace {

/// Volumes up to this many nodes are held in double: 128 MiB [nodes].
constexpr std::size_t most_wide_nodes = std::size_t{1} << 24;

template <class Grid>
std::size_t coefficient_count(Grid const& grid) {
  return static_cast<std::size_t>(grid.plane) *
         static_cast<std::size_t>(Grid::dimensions == 2 ? 1 : grid.nodes[2] + 2 * Grid::padding);
}

/// @throws DeviceError before anything is allocated
void require_room(std::size_t bytes) {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
  if (bytes <= free) return;
  throw DeviceError(fmt::format(
      "the field's refractivity needs {:.2f} GiB of device memory, {:.2f} of {:.2f} GiB are free; use a "
      "smaller field or --device cpu",
      static_cast<double>(bytes) / 0x1p30, static_cast<double>(free) / 0x1p30, static_cast<double>(total) / 0x1p30));
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
          require_room(count * (widen ? sizeof(double) : sizeof(Stored)));
          char const* const name = "the field's refractivity";
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
