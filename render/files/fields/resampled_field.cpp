#include "render/files/fields/resampled_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/available_memory.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"

namespace gladstone::inline files {
namespace {

/// Computes the weights of the values at nodes `x` in their interpolation polynomial at `place` (Lagrange).
std::vector<double> lagrange_weights(std::span<double const> x, double place) {
  std::vector<double> weights(x.size(), 1.0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < x.size(); ++j) {
      if (i != j) weights[i] *= (place - x[j]) / (x[i] - x[j]);
    }
  }
  return weights;
}

/// Value of a resampled node, as a weighted sum of consecutive nodes of the file.
struct Sum {
  std::size_t first;  ///< index of the first node in the sum
  std::vector<double> weights;
};

/// Computes the interpolation sums of uniform nodes: the cubic through the four nearest nodes of the file, or the
/// polynomial through all nodes if there are fewer than four.
/// @param x      coordinates of the nodes in the file, ascending
/// @param nodes  number of uniform nodes, `step` apart, from the first to the last coordinate
std::vector<Sum> interpolate_to(std::vector<double> const& x, std::size_t nodes, double step) {
  std::vector<Sum> sums;
  std::size_t const support = std::min<std::size_t>(4, x.size());
  std::size_t cell = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    double const place = i + 1 == nodes ? x.back() : x.front() + static_cast<double>(i) * step;
    while (cell + 2 < x.size() && x[cell + 1] <= place) ++cell;
    std::size_t const first = std::min(cell > 0 ? cell - 1 : 0, x.size() - support);
    sums.push_back({first, lagrange_weights(std::span(x).subspan(first, support), place)});
  }
  return sums;
}

double finest_spacing(std::vector<double> const& x) {
  double finest = HUGE_VAL;
  for (std::size_t i = 1; i < x.size(); ++i) finest = std::min(finest, x[i] - x[i - 1]);
  return finest;
}

double coarsest_spacing(std::vector<double> const& x) {
  double coarsest = 0;
  for (std::size_t i = 1; i < x.size(); ++i) coarsest = std::max(coarsest, x[i] - x[i - 1]);
  return coarsest;
}

/// Memory layout of lines along one axis: `outer` blocks of `nodes` layers of `inner` numbers.
struct Lines {
  std::size_t outer, nodes, inner;
};

/// Returns the largest difference between a node's value and its prediction from two nodes on either side (one node if
/// the axis has fewer than five).
double largest_misprediction(std::vector<double> const& values, Lines const& lines, std::vector<double> const& x) {
  std::size_t const reach = x.size() >= 5 ? 2 : 1;
  double largest = 0;
  for (std::size_t i = reach; i + reach < x.size(); ++i) {
    std::vector<std::size_t> neighbours;
    std::vector<double> places;
    for (std::size_t j = i - reach; j <= i + reach; ++j) {
      if (j == i) continue;
      neighbours.push_back(j);
      places.push_back(x[j]);
    }
    auto const weights = lagrange_weights(places, x[i]);
    for (std::size_t outer = 0; outer < lines.outer; ++outer) {
      double const* const block = values.data() + outer * lines.nodes * lines.inner;
      for (std::size_t inner = 0; inner < lines.inner; ++inner) {
        double sum = 0;
        for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * block[neighbours[k] * lines.inner + inner];
        largest = std::max(largest, std::abs(sum - block[i * lines.inner + inner]));
      }
    }
  }
  return largest;
}

/// Resamples all lines of a field along one axis, one sum per resampled node.
std::vector<double> resampled(std::vector<double> const& values, Lines const& lines, std::vector<Sum> const& sums) {
  std::vector<double> result(lines.outer * sums.size() * lines.inner);
  for (std::size_t outer = 0; outer < lines.outer; ++outer) {
    throw_if_interrupted();
    double const* const from = values.data() + outer * lines.nodes * lines.inner;
    double* to = result.data() + outer * sums.size() * lines.inner;
    for (auto const& [first, weights] : sums) {
      for (std::size_t k = 0; k < weights.size(); ++k) {
        double const* const layer = from + (first + k) * lines.inner;
        for (std::size_t inner = 0; inner < lines.inner; ++inner) to[inner] += weights[k] * layer[inner];
      }
      to += lines.inner;
    }
  }
  return result;
}

}  // namespace

ResampledField::ResampledField(std::unique_ptr<OrientedField> source)
    : FieldSource(source->values()), source_(std::move(source)), grid_(source_->grid()) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto const& x = source_->coordinates(axis);
    if (x.empty()) continue;
    double const span = x.back() - x.front(), cells = std::ceil(span / finest_spacing(x) * (1 - 1e-6));
    if (!(cells < std::numeric_limits<int>::max())) {
      throw DataError(
          ErrorCode::unsupported, source_->path(),
          fmt::format("\"{}\": the smallest distance of nodes along {} is {:.3g} of the field's extent, so that a "
                      "uniform grid of this distance has too many nodes; write the field on a coarser, "
                      "uniform grid",
                      name(), "xyz"[axis], finest_spacing(x) / span));
    }
    grid_.nodes[axis] = static_cast<int>(cells) + 1;
    grid_.spacing[static_cast<int>(axis)] = span / cells;
    grid_.origin[static_cast<int>(axis)] = x.front();
  }
}

void ResampledField::load() {
  if (!values_.empty()) return;
  RegularGrid const& stored = source_->grid();
  double const needed = 2.0 * sizeof(double) * values() * grid_.nodes[0] * grid_.nodes[1] * grid_.nodes[2];
  require_memory(source_->path(), "resampling \"" + name() + "\" to a uniform grid of its finest spacing", needed);
  std::vector<double> all(static_cast<std::size_t>(values()) * stored.size());
  source_->read_planes(0, stored.nodes[2], all);
  auto const [least, most] = std::minmax_element(all.begin(), all.end());
  range_ = *most - *least;
  std::array<std::size_t, 3> nodes{};
  for (std::size_t axis = 0; axis < 3; ++axis) nodes[axis] = static_cast<std::size_t>(stored.nodes[axis]);
  std::size_t inner = static_cast<std::size_t>(values());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto const& x = source_->coordinates(axis);
    if (!x.empty()) {
      Lines const lines{all.size() / (inner * nodes[axis]), nodes[axis], inner};
      error_ = std::max(error_, largest_misprediction(all, lines, x));
      nodes[axis] = static_cast<std::size_t>(grid_.nodes[axis]);
      all = resampled(all, lines, interpolate_to(x, nodes[axis], grid_.spacing[static_cast<int>(axis)]));
    }
    inner *= nodes[axis];
  }
  values_ = std::move(all);
}

double ResampledField::error_bound() {
  load();
  return error_;
}

Warnings ResampledField::notes() {
  double const error = error_bound();
  Warnings notes = source_->notes();
  std::string axes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto const& x = source_->coordinates(axis);
    if (x.empty()) continue;
    axes += fmt::format("{}{} (spacings from {:.4g} to {:.4g}) to {} nodes {:.6g} apart", axes.empty() ? "" : ", ",
                        "xyz"[axis], finest_spacing(x), coarsest_spacing(x), grid_.nodes[axis],
                        grid_.spacing[static_cast<int>(axis)]);
  }
  notes.push_back({WarningCode::approximated, "",
                   fmt::format("the file's nodes are not equidistant and were interpolated to a uniform grid: {}; the "
                               "error of the interpolation is at most {:.2g} ({:.2g} % of the range of values)",
                               axes, error, range_ > 0 ? 100 * error / range_ : 0.0)});
  return notes;
}

void ResampledField::read_planes(int first_plane, int count, std::span<double> out) {
  GLADSTONE_EXPECTS(first_plane >= 0 && count >= 0 && count <= grid_.nodes[2] - first_plane);
  load();
  std::size_t const plane = values_.size() / static_cast<std::size_t>(grid_.nodes[2]);
  GLADSTONE_EXPECTS(out.size() == plane * static_cast<std::size_t>(count));
  std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(plane * static_cast<std::size_t>(first_plane)), out.size(),
              out.begin());
}

void ResampledField::read_rows(int plane, int first_row, int count, std::span<double> out) {
  GLADSTONE_EXPECTS(plane >= 0 && plane < grid_.nodes[2]);
  GLADSTONE_EXPECTS(first_row >= 0 && count >= 0 && count <= grid_.nodes[1] - first_row);
  load();
  std::size_t const row = static_cast<std::size_t>(values()) * static_cast<std::size_t>(grid_.nodes[0]);
  std::size_t const first = row * (static_cast<std::size_t>(plane) * static_cast<std::size_t>(grid_.nodes[1]) +
                                   static_cast<std::size_t>(first_row));
  GLADSTONE_EXPECTS(out.size() == row * static_cast<std::size_t>(count));
  std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(first), out.size(), out.begin());
}

}  // namespace gladstone::inline files
