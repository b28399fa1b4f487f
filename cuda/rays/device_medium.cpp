#include "cuda/rays/device_medium.h"

namespace gladstone::cuda {
namespace {

template <class Grid>
std::size_t coefficient_count(Grid const& grid) {
  int const ghosts = 2 * Grid::padding + (grid.periodic[2] ? 1 : 0);
  return static_cast<std::size_t>(grid.plane) *
         static_cast<std::size_t>(Grid::dimensions == 2 ? 1 : grid.nodes[2] + ghosts);
}

/// @throws OutOfDeviceMemory before anything is allocated
void require_room(char const* what_for, std::size_t bytes) {
  if (bytes > device_room().free) throw OutOfDeviceMemory(what_for, bytes);
}

/// Returns a volume's polynomials; empty if they would need more than a quarter of the device's total memory. The limit
/// does not refer to free memory, so that results do not depend on other programs on the device.
template <class T, class Grid>
DeviceArray<T> make_polynomials(Grid const& grid) {
  using Cells = CellPolynomials<T, typename Grid::Interpolant, true>;
  std::size_t const cell_count = Cells(grid, nullptr).cell_count(), count = cell_count * Cells::size;
  if (cell_count > Cells::most_cells || count * sizeof(T) > device_room().total / 4) return {};
  DeviceArray<T> cells(count, "the field's polynomials");
  fill_cells(grid, cells.data());
  return cells;
}

}  // namespace

MirroredMedium::MirroredMedium(Medium<double> const& medium, bool wide) : host_(medium) {
  std::visit(
      [&](auto const& grid) {
        if constexpr (requires { grid.coefficients; }) {
          using Grid = std::remove_cvref_t<decltype(grid)>;
          using Stored = std::remove_cvref_t<decltype(*grid.coefficients)>;
          std::size_t const count = coefficient_count(grid);
          char const* const name = "the field's refractivity";
          require_room(name, count * sizeof(Stored));
          if constexpr (std::is_same_v<Stored, float>) {
            floats_ = DeviceArray<float>(grid.coefficients, count, name);
          } else {
            doubles_ = DeviceArray<double>(grid.coefficients, count, name);
          }
          if constexpr (Grid::dimensions == 3) {
            Grid on_device = grid;
            on_device.coefficients = floats_.data();
            if (!wide) {
              single_polynomials_ =
                  make_polynomials<float>(on_device);  // theory, in double precision, still reads the grid
            } else {
              polynomials_ = make_polynomials<double>(on_device);
              if (polynomials_.size() > 0) floats_ = {};
            }
          }
        }
      },
      medium);
}

}  // namespace gladstone::cuda
