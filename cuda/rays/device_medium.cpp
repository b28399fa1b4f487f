#include "cuda/rays/device_medium.h"

#include <type_traits>

namespace gladstone::cuda::inline rays {
namespace {

template <class Grid>
std::size_t coefficient_count(Grid const& grid) {
  int const ghosts = 2 * Grid::padding + (grid.periodic[2] ? 1 : 0);
  return static_cast<std::size_t>(grid.plane) *
         static_cast<std::size_t>(Grid::dimensions == 2 ? 1 : grid.nodes[2] + ghosts);
}

/// @throws OutOfDeviceMemory  if free memory is insufficient, before anything is allocated
void require_room(char const* what_for, std::size_t bytes) {
  if (bytes > query_device_memory().free) throw OutOfDeviceMemory(what_for, bytes);
}

/// Returns a volume's polynomials; empty if they would need more than a quarter of the device's total memory. The limit
/// does not refer to free memory, so that results do not depend on other programs on the device.
template <class Grid>
DeviceArray<double> make_polynomials(Grid const& grid) {
  using Cells = CellPolynomials<typename Grid::Interpolant, true>;
  std::size_t const cell_count = Cells(grid, nullptr).cell_count(), count = cell_count * Cells::size;
  if (cell_count > Cells::most_cells || count * sizeof(double) > query_device_memory().total / 4) return {};
  DeviceArray<double> cells(count, "the field's polynomials");
  fill_cells(grid, cells.data());
  return cells;
}

}  // namespace

/// Uploads a grid's coefficients. @return its view on the device
template <class Grid>
DeviceMedium MirroredMedium::upload(Grid grid) {
  using Stored = std::remove_cvref_t<decltype(*grid.coefficients)>;
  std::size_t const count = coefficient_count(grid);
  char const* const name = "the field's refractivity";
  require_room(name, count * sizeof(Stored));
  if constexpr (Grid::dimensions == 2) {
    doubles_ = DeviceArray<double>(grid.coefficients, count, name);
    grid.coefficients = doubles_.data();
  } else {
    floats_ = DeviceArray<float>(grid.coefficients, count, name);
    grid.coefficients = floats_.data();
    polynomials_ = make_polynomials(grid);
    if (polynomials_.size() > 0) {
      floats_ = {};
      double const* const cells = polynomials_.data();
      if (grid.periodic[0] || grid.periodic[1] || grid.periodic[2]) {
        return CellPolynomials<typename Grid::Interpolant, true>(grid, cells);
      }
      return CellPolynomials<typename Grid::Interpolant, false>(grid, cells);
    }
  }
  return grid;
}

MirroredMedium::MirroredMedium(Medium<double> const& medium) {
  view_ = std::visit(
      [this](auto const& held) -> DeviceMedium {
        if constexpr (requires { held.coefficients; }) {
          return upload(held);
        } else {
          return held;
        }
      },
      medium);
}

}  // namespace gladstone::cuda::inline rays
