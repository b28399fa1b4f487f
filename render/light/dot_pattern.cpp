#include "render/light/dot_pattern.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/units.h"
#include "render/files/image_file.h"
#include "render/light/number_table.h"

namespace gladstone::inline light {
namespace {

/// Grid of cells for finding overlapping discs. Cells are at least one diameter wide, so that a disc overlaps discs of
/// the same or adjacent cells only. There are about as many cells as discs, so that the memory is proportional to the
/// number of discs.
class OccupiedCells {
 public:
  OccupiedCells(Vec2d extent, double diameter, std::size_t count)
      : extent_(extent),
        diameter_(diameter),
        side_(std::max(diameter, std::sqrt(extent.x / static_cast<double>(count) * extent.y))),
        columns_(1 + static_cast<std::ptrdiff_t>(std::min(extent.x / side_, static_cast<double>(count)))),
        rows_(1 + static_cast<std::ptrdiff_t>(std::min(extent.y / side_, static_cast<double>(count)))),
        latest_(static_cast<std::size_t>(columns_ * rows_), none) {
    earlier_.reserve(count);
  }

  /// Adds a disc at p, to be stored as centres[centres.size()], and returns true, unless it overlaps an existing disc.
  bool add(Vec2d p, std::vector<Vec2d> const& centres) {
    std::ptrdiff_t const column = cell(p.x + extent_.x / 2, columns_), row = cell(p.y + extent_.y / 2, rows_);
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, row - 1); j <= std::min(rows_ - 1, row + 1); ++j) {
      for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, column - 1); i <= std::min(columns_ - 1, column + 1); ++i) {
        for (std::uint32_t other = latest_[static_cast<std::size_t>(j * columns_ + i)]; other != none;
             other = earlier_[other]) {
          if (length(centres[other] - p) < diameter_) return false;
        }
      }
    }
    std::uint32_t& latest = latest_[static_cast<std::size_t>(row * columns_ + column)];
    earlier_.push_back(latest);
    latest = static_cast<std::uint32_t>(centres.size());
    return true;
  }

 private:
  std::ptrdiff_t cell(double from_edge, std::ptrdiff_t count) const {
    return std::min(count - 1, static_cast<std::ptrdiff_t>(from_edge / side_));
  }

  static constexpr std::uint32_t none = 0xffffffffu;
  Vec2d extent_;
  double diameter_;
  double side_;
  std::ptrdiff_t columns_;
  std::ptrdiff_t rows_;
  std::vector<std::uint32_t> latest_;   // most recently added disc of each cell
  std::vector<std::uint32_t> earlier_;  // previous disc in the same cell, for each disc
};

}  // namespace

std::vector<Vec2d> random_dots(Vec2d extent, std::size_t count, double diameter, std::uint64_t seed) {
  double const coverage = static_cast<double>(count) * pi / 4 * diameter * diameter / (extent.x * extent.y);
  if (coverage > 0.5) {
    throw DataError(ErrorCode::invalid_value, KeyPath{"target"},
                    fmt::format("{} dots of {:.4g} mm would cover {:.0f} % of the target (random discs without "
                                "overlap reach about 50 %); use fewer or smaller dots, or arrangement = \"regular\"",
                                count, diameter / unit::millimetre, 100 * coverage));
  }
  KeyedEngine engine(seed, RandomStream::target, 0);
  auto const draw = [&] {
    double const x = (to_unit(engine()) - 0.5) * extent.x;
    return Vec2d{x, (to_unit(engine()) - 0.5) * extent.y};
  };
  std::vector<Vec2d> centres;
  centres.reserve(count);
  if (diameter == 0) {
    while (centres.size() < count) centres.push_back(draw());
    return centres;
  }
  OccupiedCells cells(extent, diameter, count);
  std::size_t misses = 0;
  while (centres.size() < count) {
    Vec2d const p = draw();
    if (cells.add(p, centres)) {
      centres.push_back(p);
      misses = 0;
    } else if (++misses > 100000) {
      throw DataError(
          ErrorCode::invalid_value, KeyPath{"target"},
          fmt::format("only {} of {} dots of {:.4g} mm could be placed without overlap; use fewer or smaller dots",
                      centres.size(), count, diameter / unit::millimetre));
    }
    if ((misses & 1023u) == 1023u) throw_if_interrupted();
  }
  return centres;
}

std::vector<Vec2d> regular_dots(Vec2d extent, double per_area, double diameter) {
  double const pitch = 1 / std::sqrt(per_area);
  if (pitch < diameter) {
    throw DataError(ErrorCode::invalid_value, KeyPath{"target"},
                    fmt::format("dots of {:.4g} mm overlap on a lattice of {:.4g} mm; use fewer or smaller dots",
                                diameter / unit::millimetre, pitch / unit::millimetre));
  }
  auto const columns = std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(std::floor(extent.x / pitch + 1e-9)));
  auto const rows = std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(std::floor(extent.y / pitch + 1e-9)));
  std::vector<Vec2d> centres;
  centres.reserve(static_cast<std::size_t>(columns * rows));
  for (std::ptrdiff_t j = 0; j < rows; ++j) {
    for (std::ptrdiff_t i = 0; i < columns; ++i) {
      centres.push_back({(static_cast<double>(i) - 0.5 * static_cast<double>(columns - 1)) * pitch,
                         (static_cast<double>(j) - 0.5 * static_cast<double>(rows - 1)) * pitch});
    }
  }
  return centres;
}

namespace {

/// Rejects dots that coincide to the nanometre: the camera would see one dot where two are traced.
/// @param lines  line number in the file of every centre
void refuse_coincident(std::string const& path, std::vector<Vec2d> const& centres,
                       std::vector<std::size_t> const& lines) {
  auto const nanometres = [](double metres) { return std::round(metres * 1e9); };
  std::vector<std::tuple<double, double, std::size_t>> sorted;
  sorted.reserve(centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    sorted.emplace_back(nanometres(centres[i].x), nanometres(centres[i].y), i);
  }
  std::sort(sorted.begin(), sorted.end());
  std::size_t repeated = 0, first = centres.size(), second = first;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    auto const& [x, y, dot] = sorted[i];
    auto const& [x_before, y_before, before] = sorted[i - 1];
    if (x != x_before || y != y_before) continue;
    ++repeated;
    if (dot < second) first = before, second = dot;
  }
  if (repeated == 0) return;
  throw DataError(ErrorCode::invalid_value, fmt::format("{}:{}", path, lines[second]),
                  fmt::format("the dot at {:.6g}, {:.6g} mm repeats line {} ({} of {} dots coincide with an earlier "
                              "one and would be counted twice in light and truth); remove the repeated lines",
                              centres[second].x / unit::millimetre, centres[second].y / unit::millimetre, lines[first],
                              repeated, centres.size()));
}

}  // namespace

std::vector<Vec2d> dots_from_csv(std::string const& path, double farthest) {
  NumberTable file(path, "a table of points", {"x_mm", "y_mm"});
  std::vector<Vec2d> centres;
  std::vector<std::size_t> lines;
  while (auto const row = file.next()) {
    Vec2d const centre{(*row)[0] * unit::millimetre, (*row)[1] * unit::millimetre};
    if (std::max(std::abs(centre.x), std::abs(centre.y)) > farthest) {
      throw DataError(ErrorCode::out_of_range, file.place(),
                      fmt::format("the dot at {:.6g}, {:.6g} mm is too far from the axis to be imaged ({:.6g} mm at "
                                  "most, ten times the distance to the lens); positions are in mm",
                                  (*row)[0], (*row)[1], farthest / unit::millimetre));
    }
    require_room(centres, path, "dots");
    centres.push_back(centre);
    lines.push_back(file.number());
  }
  if (centres.empty())
    throw DataError(ErrorCode::missing_content, path, "contains no dots (one line x_mm,y_mm is needed for each)");
  refuse_coincident(path, centres, lines);
  return centres;
}

DotPattern image_target(std::string const& path, Vec2d extent) {
  Image<double> const picture = read_image(path);
  if (std::size_t const bad = count_not_finite(picture); bad > 0) {
    throw DataError(ErrorCode::invalid_value, path,
                    fmt::format("{} of {} pixels are nan or infinite (grey values are the radiance); correct them", bad,
                                picture.size()));
  }
  double const white = picture.empty() ? 0.0 : *std::max_element(picture.begin(), picture.end());
  if (!(white > 0)) throw DataError(ErrorCode::invalid_value, path, "is entirely black (no pixel emits light)");
  double const side = extent.x / picture.columns();
  if (std::abs(side * picture.rows() - extent.y) > 0.5 * side) {
    throw DataError(
        ErrorCode::inconsistent, path,
        fmt::format("is {} x {} pixels but the target is {:.4g} x {:.4g} mm (pixels must be square); give "
                    "target.extent_mm the aspect ratio of the image",
                    picture.columns(), picture.rows(), extent.x / unit::millimetre, extent.y / unit::millimetre));
  }
  DotPattern pattern;
  pattern.shape = SourceShape::square;
  pattern.half_size = side / 2;
  for (int row = 0; row < picture.rows(); ++row) {
    for (int column = 0; column < picture.columns(); ++column) {
      if (!(picture(column, row) > 0)) continue;
      pattern.centre.push_back(
          {(column - 0.5 * (picture.columns() - 1)) * side, (0.5 * (picture.rows() - 1) - row) * side});
      pattern.radiance.push_back(picture(column, row) / white);
    }
  }
  return pattern;
}

}  // namespace gladstone::inline light
