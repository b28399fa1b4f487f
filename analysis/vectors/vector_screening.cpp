#include "analysis/vectors/vector_screening.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "analysis/vectors/vector_file.h"

namespace gladstone::inline vectors {
namespace {

bool inside(double coordinate, int size) {
  return coordinate >= -outside_margin_px && coordinate <= size - 1 + outside_margin_px;
}

/// Bounding box of positions.
struct Extent {
  Vec2d low{}, high{};
  bool any = false;

  void add(Vec2d p) {
    low = any ? Vec2d{std::min(low.x, p.x), std::min(low.y, p.y)} : p;
    high = any ? Vec2d{std::max(high.x, p.x), std::max(high.y, p.y)} : p;
    any = true;
  }
  std::string text() const {
    return fmt::format("x from {:.6g} to {:.6g}, y from {:.6g} to {:.6g}", low.x, high.x, low.y, high.y);
  }
};

Extent find_extent(DisplacementField const& screened) {
  Extent extent;
  for (Vec2d const& p : screened.position_px) extent.add(p);
  return extent;
}

/// Number of vectors whose position (within 0.01 px) another vector already has, and the first such position.
struct RepeatedPlaces {
  std::size_t count = 0;
  Vec2d first{};
};

RepeatedPlaces find_repeated_places(DisplacementField const& screened) {
  constexpr double same_px = 0.01;
  std::vector<std::pair<long long, long long>> cells;
  cells.reserve(screened.size());
  for (Vec2d const& p : screened.position_px)
    cells.emplace_back(std::llround(p.y / same_px), std::llround(p.x / same_px));
  std::sort(cells.begin(), cells.end());
  RepeatedPlaces repeated;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    if (cells[i] != cells[i - 1]) continue;
    if (repeated.count++ == 0)
      repeated.first = {same_px * static_cast<double>(cells[i].second), same_px * static_cast<double>(cells[i].first)};
  }
  return repeated;
}

}  // namespace

std::string RejectedVectors::text() const {
  std::string list;
  auto const add = [&list](std::size_t count, std::string const& reason) {
    if (count > 0) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, reason);
  };
  add(place_not_finite, "with a position that is nan or infinite");
  add(outside_image, fmt::format("outside the image (by more than {} px)", outside_margin_px));
  add(displacement_not_finite, "with a displacement that is nan or infinite");
  add(displacement_beyond_image, "with a displacement larger than the image");
  return list;
}

RejectedVectors screen_vectors(DisplacementField& field, double offset_px, int image_columns, int image_rows) {
  RejectedVectors left_out;
  field.status.resize(field.size(), VectorStatus::valid);
  std::vector<std::size_t> kept;
  Extent extent;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d const place = field.position_px[i] + Vec2d{offset_px, offset_px};
    if (!is_finite(place)) {
      ++left_out.place_not_finite;
      continue;
    }
    extent.add(field.position_px[i]);
    if (!inside(place.x, image_columns) || !inside(place.y, image_rows)) {
      ++left_out.outside_image;
    } else {
      kept.push_back(i);
    }
  }
  left_out.low_px = extent.low;
  left_out.high_px = extent.high;
  if (kept.size() < field.size()) take_vectors(field, kept);
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d& d = field.displacement_px[i];
    bool const known = is_finite(d);
    if (known && std::abs(d.x) <= image_columns && std::abs(d.y) <= image_rows) continue;
    if (field.status[i] != VectorStatus::masked) {
      ++(known ? left_out.displacement_beyond_image : left_out.displacement_not_finite);
      field.status[i] = VectorStatus::invalid;
    }
    d = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  }
  return left_out;
}

std::string reason_to_reject_positions(DisplacementField const& screened, RejectedVectors const& left_out,
                                       int image_columns, int image_rows) {
  std::string const image = fmt::format("the image of {} x {} px", image_columns, image_rows);
  if (screened.size() == 0) {
    std::string const where =
        left_out.outside_image > 0 ? " (" + Extent{left_out.low_px, left_out.high_px}.text() + ")" : "";
    return fmt::format(
        "all {} vectors lie outside {}{}: {}; positions must be in px from the centre of the first pixel: export them "
        "so, or give the offset to be added with --conventions offset=NUMBER",
        left_out.all(), image, where, left_out.text());
  }
  if (left_out.outside_image > screened.size()) {
    return fmt::format(
        "{} of {} vectors lie outside {} ({}), as if positions had another origin; positions must be in px from the "
        "centre of the first pixel: export them so, or give the offset to be added with --conventions offset=NUMBER",
        left_out.outside_image, left_out.outside_image + screened.size(), image,
        Extent{left_out.low_px, left_out.high_px}.text());
  }
  Extent const extent = find_extent(screened);
  Vec2d const size = extent.high - extent.low;
  if (static_cast<double>(screened.size()) > 2.0 * (size.x + 1.0) * (size.y + 1.0)) {
    return fmt::format("{} vectors are closer together than pixels ({}); export positions in px, not in mm",
                       screened.size(), extent.text());
  }
  if (RepeatedPlaces const repeated = find_repeated_places(screened); repeated.count > 0) {
    return fmt::format(
        "{} of {} vectors have the position of another one, the first at ({:.6g}, {:.6g}) px; remove the repeated rows",
        repeated.count, screened.size(), repeated.first.x, repeated.first.y);
  }
  return {};
}

std::string describe_suspect_positions(DisplacementField const& screened, int image_columns, int image_rows) {
  constexpr std::size_t fewest = 16;  // minimum number of vectors for which the extent of a grid is judged
  Extent const extent = find_extent(screened);
  Vec2d const size = extent.high - extent.low;
  double const share = size.x * size.y / (static_cast<double>(image_columns) * image_rows);
  if (screened.size() < fewest || share >= 0.05) return {};
  return fmt::format(
      "the vectors cover only {:.2g} % of the image ({}); if this is not intended, export positions in px",
      100.0 * share, extent.text());
}

}  // namespace gladstone::inline vectors
