#include "render/focused_dots/dot_patch.h"

#include <algorithm>
#include <cmath>

namespace gladstone {
namespace {

/// Adds a series of spots to a patch: the sum over a + b <= order of moment (a, b) times the a-th shares of the columns
/// times the b-th shares of the rows. Numbers of lanes that the compiler knows keep every loop in vector registers.
/// @param lanes width or more @param shares [order + 1][width]
template <int lanes>
void add_series(double* corner, int side, int width, double weight, DisplacementMoments const& moments,
                double const* column_shares, double const* row_shares) {
  constexpr int order = DisplacementMoments::order;
  double columns[order + 1][lanes] = {}, rows[order + 1][lanes] = {}, of_row[order + 1][lanes] = {};
  for (int a = 0; a <= order; ++a) {
    std::copy_n(column_shares + a * width, width, columns[a]);
    std::copy_n(row_shares + a * width, width, rows[a]);
  }
  for (int a = 0; a <= order; ++a) {
    for (int b = 0; a + b <= order; ++b) {
      double const moment = weight * moments.of[DisplacementMoments::at(a, b)];
      for (int j = 0; j < lanes; ++j) of_row[a][j] += moment * rows[b][j];
    }
  }
  for (int j = 0; j < width; ++j) {
    double line[lanes] = {};
    for (int a = 0; a <= order; ++a) {
      for (int i = 0; i < lanes; ++i) line[i] += of_row[a][j] * columns[a][i];
    }
    for (int i = 0; i < width; ++i) corner[j * side + i] += line[i];
  }
}

}  // namespace

DotPatch::DotPatch(SpotView const& spot, MomentImages const& images)
    : LightPatch(spot, images.half), images_(images), of_square_(static_cast<std::size_t>(images.stride)) {}

bool DotPatch::make_series(double p, Series& series) const {
  if (!(std::abs(p) < 1e8)) return false;
  int const width = 2 * half() + 1;
  series.first = static_cast<int>(std::floor(p + 0.5)) - half();
  series.shares.resize(static_cast<std::size_t>((DisplacementMoments::order + 1) * width));
  spot().gaussian.taylor_shares(p, series.first, width, DisplacementMoments::order, series.shares.data());
  return true;
}

void DotPatch::deposit(Series const& column, Series const& row, double weight, DisplacementMoments const& moments,
                       LightImage* image, double light_per_weight) {
  int const width = 2 * half() + 1;
  double* const corner = reach({column.first, row.first, width}, image, light_per_weight);
  auto const add = [&]<int lanes>() {
    add_series<lanes>(corner, side(), width, weight, moments, column.shares.data(), row.shares.data());
  };
  if (width <= 8) {
    add.operator()<8>();
  } else if (width <= 12) {
    add.operator()<12>();
  } else {
    add.operator()<48>();  // light_model's by_moments() takes no wider ones
  }
}

void DotPatch::deposit(Vec2<int> square, double weight, MomentField const& field, LightImage* image,
                       double light_per_weight) {
  BoxLattice const& lattice = images_.lattice;
  int const width = images_.width();
  double const* const images = images_.of_phase(lattice.phase(square.y) * lattice.per_pixel + lattice.phase(square.x));
  for (int first = 0; first < images_.stride; first += MomentImages::pad) {
    double sum[MomentImages::pad] = {};
    double const* here = images + first;
    for (int moment = 0; moment < DisplacementMoments::count; ++moment) {
      for (int term = 0; term < images_.terms; ++term, here += images_.stride) {
        double const share = weight * field.coefficient[moment][term];
        for (int i = 0; i < MomentImages::pad; ++i) sum[i] += share * here[i];
      }
    }
    std::copy_n(sum, MomentImages::pad, of_square_.data() + first);
  }
  double* const corner = reach({lattice.pixel(square.x) - images_.half, lattice.pixel(square.y) - images_.half, width},
                               image, light_per_weight);
  for (int row = 0; row < width; ++row) {
    for (int column = 0; column < width; ++column) {
      corner[row * side() + column] += of_square_[static_cast<std::size_t>(row * width + column)];
    }
  }
}

}  // namespace gladstone
