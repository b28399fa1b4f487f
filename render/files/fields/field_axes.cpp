#include "render/files/fields/field_axes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/error.h"

namespace gladstone::inline files {
namespace {

/// Formats axes as a list: "z, y, x".
std::string listed(std::string_view axes) {
  std::string text;
  for (char const axis : axes) text += (text.empty() ? "" : ", ") + std::string(1, axis);
  return text;
}

}  // namespace

std::string AxisAssignment::text() const {
  std::string text = fmt::format("[{}] is read as {} ({})", fmt::join(shape, ", "), listed(axes), by);
  if (!turned_round.empty()) {
    text += fmt::format("; {} {} in the file and {} reversed", listed(turned_round),
                        turned_round.size() == 1 ? "descends" : "descend", turned_round.size() == 1 ? "is" : "are");
  }
  return text;
}

bool is_axis_order(std::string_view axes) {
  if (axes.size() != 2 && axes.size() != 3) return false;
  return std::all_of(axes.begin(), axes.end(), [&](char axis) {
    return std::string_view("xyz").find(axis) != std::string_view::npos &&
           std::count(axes.begin(), axes.end(), axis) == 1;
  });
}

void name_axes(StoredAxes& stored, std::string const& axes, std::size_t rank, std::string const& path) {
  if (axes.empty()) return;
  if (!is_axis_order(axes)) {
    throw DataError(ErrorCode::invalid_value, path,
                    fmt::format("axes = \"{}\" is not an order of axes; list the axes of the file, slowest "
                                "first, such as \"zyx\", or \"yx\" for a plane",
                                axes));
  }
  if (axes.size() != rank) {
    throw DataError(
        ErrorCode::inconsistent, path,
        fmt::format("axes = \"{}\" names {} axes of an array that has {}; name each of them", axes, axes.size(), rank));
  }
  std::string rest = "xyz";
  for (std::size_t i = 0; i < rank; ++i) {
    stored[rank - 1 - i].world = axes[i];
    std::erase(rest, axes[i]);
  }
  if (rank == 2) stored[2].world = rest.front();
}

StoredAxis axis_from_coordinates(std::vector<double> x, std::string const& path, std::string const& what) {
  auto const refuse = [&](std::string const& why) {
    throw DataError(ErrorCode::invalid_value, path, what + ": " + why);
  };
  if (!std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); })) {
    refuse("coordinates are not finite; correct them");
  }
  StoredAxis axis;
  axis.first = x.front();
  if (x.size() == 1) return axis;
  double const step = (x.back() - x.front()) / static_cast<double>(x.size() - 1);
  double const largest = std::max(std::abs(x.front()), std::abs(x.back()));
  for (std::size_t i = 1; i < x.size(); ++i) {
    if ((x[i] - x[i - 1]) * step > 0) continue;
    refuse(
        fmt::format("coordinates neither ascend nor descend throughout ({:.9g} at node {} is followed by {:.9g}); "
                    "sort the nodes",
                    x[i - 1], i - 1, x[i]));
  }
  axis.step = step;
  axis.stated = true;
  // Coordinates are stored as float or rounded to decimals: two units in the last place of the largest one.
  double const tolerance = 1e-4 * std::abs(step) + 2.0 * std::numeric_limits<float>::epsilon() * largest;
  bool uniform = true;
  for (std::size_t i = 0; i < x.size() && uniform; ++i) {
    uniform = std::abs(x[i] - (x.front() + static_cast<double>(i) * step)) <= tolerance;
  }
  if (!uniform) axis.coordinates = std::move(x);
  return axis;
}

}  // namespace gladstone::inline files
