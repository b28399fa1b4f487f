#include "cuda/device/cuda_error.h"
#include "cuda/rays/device_medium.h"

namespace gladstone::cuda::inline rays {
namespace {

constexpr int threads = 128;

template <class Basis>
__global__ void fill_cells_kernel(GriddedIndex<double, float, Basis, 3> const grid,
                                  CellPolynomials<Basis, true> const cells, double* const out) {
  std::size_t const cell = static_cast<std::size_t>(blockIdx.x) * threads + threadIdx.x;
  if (cell >= cells.cell_count()) return;
  std::size_t const columns = cells.cells[0], rows = cells.cells[1];
  fill_cell(grid, static_cast<int>(cell % columns), static_cast<int>(cell / columns % rows),
            static_cast<int>(cell / columns / rows), out + cell * CellPolynomials<Basis, true>::size);
}

}  // namespace

template <class Basis>
void fill_cells(GriddedIndex<double, float, Basis, 3> const& grid, double* out) {
  CellPolynomials<Basis, true> const cells(grid, out);
  auto const blocks = static_cast<unsigned>((cells.cell_count() + threads - 1) / threads);
  fill_cells_kernel<<<blocks, threads>>>(grid, cells, out);
  check_launch("fill_cells");
}

template void fill_cells(SplineVolume<double> const&, double*);
template void fill_cells(LinearVolume<double> const&, double*);

}  // namespace gladstone::cuda::inline rays
