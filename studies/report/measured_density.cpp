#include "studies/report/measured_density.h"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/files/output_file.h"

namespace gladstone {
namespace {

constexpr double unknown_weight = 1e-6;  ///< weight of an unknown difference, relative to a known one

/// Normal equations for the differences between nodes.
class Differences {
 public:
  explicit Differences(int nodes) : right_(Eigen::VectorXd::Zero(nodes)) {
    for (int i = 0; i < nodes; ++i) entries_.emplace_back(i, i, 1e-12);  // regularizes the undetermined constant
  }
  void add(int from, int to, double difference) {
    bool const known = std::isfinite(difference);
    double const weight = known ? 1 : unknown_weight;
    entries_.emplace_back(from, from, weight);
    entries_.emplace_back(to, to, weight);
    entries_.emplace_back(from, to, -weight);
    entries_.emplace_back(to, from, -weight);
    if (!known) return;
    right_[to] += difference;
    right_[from] -= difference;
  }
  Eigen::VectorXd solve() const {
    Eigen::SparseMatrix<double> matrix(right_.size(), right_.size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right_);
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

double border_mean(Image<double> const& image) {
  double sum = 0;
  int count = 0;
  for (int row = 0; row < image.rows(); ++row) {
    for (int column = 0; column < image.columns(); ++column) {
      bool const border = row == 0 || column == 0 || row == image.rows() - 1 || column == image.columns() - 1;
      if (!border) continue;
      sum += image(column, row);
      ++count;
    }
  }
  return sum / count;
}

/// Returns the value at a node; beyond the border, linear extrapolation of the last two nodes.
double continued(Image<double> const& image, int column, int row) {
  int const i = std::clamp(column, 0, image.columns() - 1), j = std::clamp(row, 0, image.rows() - 1);
  double value = image(i, j);
  if (column != i)
    value += (column < 0 ? image(0, j) - image(1, j) : image(i, j) - image(i - 1, j)) * std::abs(column - i);
  if (row != j) value += (row < 0 ? image(i, 0) - image(i, 1) : image(i, j) - image(i, j - 1)) * std::abs(row - j);
  return value;
}

}  // namespace

Image<double> integrated_density(std::vector<Vec2d> const& gradient, int columns, int rows, double spacing) {
  GLADSTONE_EXPECTS(columns >= 2 && rows >= 2 && gradient.size() == static_cast<std::size_t>(columns) * rows);
  Differences differences(columns * rows);
  auto const at = [columns](int column, int row) { return row * columns + column; };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      int const here = at(column, row);
      if (column + 1 < columns) {
        int const next = at(column + 1, row);
        differences.add(here, next, spacing * (gradient[here].x + gradient[next].x) / 2);
      }
      if (row + 1 < rows) {  // downwards, opposite to Y
        int const next = at(column, row + 1);
        differences.add(here, next, -spacing * (gradient[here].y + gradient[next].y) / 2);
      }
    }
  }
  Eigen::VectorXd const solution = differences.solve();
  Image<double> density(columns, rows);
  for (int i = 0; i < columns * rows; ++i) density(i % columns, i / columns) = solution[i];
  double const level = border_mean(density);
  for (double& value : density) value -= level;
  return density;
}

void write_density_plane(std::string const& path, Image<double> const& density, int margin, double ambient) {
  int const columns = density.columns() + 2 * margin, rows = density.rows() + 2 * margin;
  std::string text = fmt::format(
      "NRRD0004\ntype: double\ndimension: 3\nsizes: {} {} 1\nencoding: raw\nendian: little\n\n", columns, rows);
  for (int row = rows - 1; row >= 0; --row) {  // y upwards
    for (int column = 0; column < columns; ++column) {
      double const value = ambient + continued(density, column - margin, row - margin);
      text.append(reinterpret_cast<char const*>(&value), sizeof value);
    }
  }
  OutputFile::write_text(path, text);
}

}  // namespace gladstone
