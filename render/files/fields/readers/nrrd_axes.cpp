#include "render/files/fields/readers/nrrd_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "render/base/text.h"

namespace gladstone::inline files {
namespace {

/// Reads the axes of a header and selects the spatial ones.
class NrrdAxes {
 public:
  NrrdAxes(NrrdFields const& fields, NrrdHeader header) : fields_(fields), header_(std::move(header)) {}

  NrrdHeader read(int values) && {
    header_.values = values;
    read_sizes();
    if (fields_.has("space directions")) {
      directions_ = fields_.vectors("space directions");
      if (directions_.size() != sizes_.size())
        fields_.refuse(ErrorCode::wrong_shape, "space directions", "must be one vector for each axis");
    }
    choose(values);
    for (std::size_t i = 0; i < kept_.size(); ++i) header_.sizes[i] = static_cast<int>(sizes_[kept_[i]]);
    header_.dimension = kept_.size();
    header_.units.values = fields_.quoted_words("sample units").empty() ? trimmed(fields_.text("sample units"))
                                                                        : fields_.quoted_words("sample units").front();
    if (directions_.empty()) {
      name_by_labels();
      place_along_axes();
    } else {
      place_by_directions();
    }
    convert_lengths(header_.axes, unit_of_, header_.units, header_.notes);
    if (header_.dimension == 2) header_.axes[2].step = std::abs(header_.axes[0].step);
    return std::move(header_);
  }

 private:
  void read_sizes() {
    int const dimension = fields_.number<int>("dimension", 0, 1);
    if (dimension > 16) fields_.refuse(ErrorCode::unsupported, "dimension", "exceeds 16, the maximum of NRRD");
    sizes_ = fields_.numbers<long long>("sizes", static_cast<std::size_t>(dimension));
    double all = 1;
    for (long long const size : sizes_) {
      if (size < 1) fields_.refuse(ErrorCode::invalid_value, "sizes", "must be positive");
      if (size > std::numeric_limits<int>::max())
        fields_.refuse(ErrorCode::out_of_range, "sizes", "is larger than any field");
      all *= static_cast<double>(size);
    }
    if (all > 1e15) fields_.refuse(ErrorCode::out_of_range, "sizes", "is larger than any field");
  }

  /// Selects the spatial axes: drops the axis of components, axes of length one without a direction ("none") and, while
  /// more than three remain, the last axis of length one.
  void choose(int values) {
    for (std::size_t axis = 0; axis < sizes_.size(); ++axis) kept_.push_back(axis);
    if (values > 1) {
      if (sizes_.size() < 3 || sizes_.front() != values) {
        fields_.refuse(ErrorCode::wrong_shape, "sizes",
                       fmt::format("has no first axis of {} components, which a velocity needs", values));
      }
      kept_.erase(kept_.begin());
    }
    std::erase_if(kept_, [this](std::size_t axis) {
      return !directions_.empty() && directions_[axis].empty() && sizes_[axis] == 1;
    });
    while (kept_.size() > 3) {
      auto const single = [this](std::size_t axis) { return sizes_[axis] == 1; };
      auto const last = std::find_if(kept_.rbegin(), kept_.rend(), single);
      if (last == kept_.rend()) break;
      kept_.erase(last.base() - 1);
    }
    if (kept_.size() == 2 || kept_.size() == 3) return;
    fields_.refuse(ErrorCode::wrong_shape, "dimension",
                   fmt::format("must be 2 or 3 ({} at every point), not counting axes of length one",
                               values == 1 ? "one number" : fmt::format("{} numbers", values)));
  }

  /// Names the world axes by "labels", if they are x, y and z.
  void name_by_labels() {
    auto const labels = fields_.quoted_words("labels");
    std::string names;  // letters of the axes, fastest first
    for (std::size_t const axis : kept_) {
      std::string const label = axis < labels.size() ? lower_case(labels[axis]) : "";
      if (label.size() == 1) names += label;
    }
    if (names.size() != kept_.size() || !is_axis_order(names)) return;
    name_axes(header_.axes, {names.rbegin(), names.rend()}, kept_.size(), "");
    header_.labelled = true;
  }

  /// Sets the axes from "spacings", or else from "axis mins" and "axis maxs".
  void place_along_axes() {
    auto const all = sizes_.size();
    auto const units = fields_.quoted_words("units");
    header_.units.spaced = fields_.has("spacings") || fields_.has("axis mins") || fields_.has("axis maxs");
    auto const spacings = fields_.has("spacings") ? fields_.numbers<double>("spacings", all) : std::vector<double>{};
    bool const ends = fields_.has("axis mins") && fields_.has("axis maxs");
    auto const lows = fields_.has("axis mins") ? fields_.numbers<double>("axis mins", all) : std::vector<double>{};
    auto const highs = fields_.has("axis maxs") ? fields_.numbers<double>("axis maxs", all) : std::vector<double>{};
    bool assumed_cells = false;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      std::size_t const axis = kept_[i];
      StoredAxis& placed = header_.axes[i];
      if (sizes_[axis] > 1 && header_.units.spaced) unit_of_[i] = axis < units.size() ? units[axis] : "";
      Centre const centre = centre_of(axis);
      double const cells = static_cast<double>(sizes_[axis]) - (centre == Centre::node ? 1 : 0);
      if (!spacings.empty() && std::isfinite(spacings[axis])) {
        placed.step = spacings[axis];
        placed.stated = true;
      } else if (ends && std::isfinite(lows[axis]) && std::isfinite(highs[axis]) && cells > 0) {
        placed.step = (highs[axis] - lows[axis]) / cells;
        placed.stated = true;
        assumed_cells = assumed_cells || centre == Centre::unknown;
      } else if (header_.units.spaced && sizes_[axis] > 1) {
        bool const infinite = !spacings.empty() && std::isinf(spacings[axis]);
        if (infinite) fields_.refuse(ErrorCode::invalid_value, "spacings", "must be finite");
        header_.units.unknown = fmt::format("the spacing of axis {} ({} nodes, taken as {}) is unknown in the header",
                                            axis + 1, sizes_[axis], placed.world);
      }
      if (placed.step == 0 || !std::isfinite(placed.step)) {
        fields_.refuse(ErrorCode::invalid_value, spacings.empty() ? "axis maxs" : "spacings",
                       "gives an axis zero length; it must not be 0");
      }
      if (!lows.empty() && std::isfinite(lows[axis])) {
        placed.first = lows[axis] + (centre == Centre::node ? 0.0 : placed.step / 2);
      }
    }
    if (assumed_cells) {
      header_.notes.push_back(
          {WarningCode::assumed, "",
           "\"axis mins\" and \"axis maxs\" without \"centers\" are taken as the outer faces of cells, as teem does; "
           "if they are the first and last node, write \"centers: node node node\""});
    }
  }

  enum class Centre { node, cell, unknown };
  Centre centre_of(std::size_t axis) const {
    std::istringstream words(lower_case(fields_.text(fields_.has("centers") ? "centers" : "centerings")));
    std::string word;
    for (std::size_t i = 0; i <= axis; ++i) {
      if (!(words >> word)) return Centre::unknown;
    }
    return word == "node" ? Centre::node : word == "cell" ? Centre::cell : Centre::unknown;
  }

  /// Sets the axes from "space directions", vectors parallel to x, y and z in any order and direction.
  void place_by_directions() {
    std::string const key = "space directions";
    auto const units = fields_.quoted_words("space units");
    auto const origins = fields_.has("space origin") && lower_case(fields_.text("space origin")) != "none"
                             ? fields_.vectors("space origin")
                             : std::vector<std::vector<double>>{};
    if (origins.size() > 1) fields_.refuse(ErrorCode::wrong_shape, "space origin", "must be one vector");
    header_.units.spaced = header_.directed = true;
    std::string taken;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      auto const& direction = directions_[kept_[i]];
      if (direction.size() < 2 || direction.size() > 3) {
        fields_.refuse(ErrorCode::wrong_shape, key, "must give each axis in space a vector of two or three numbers");
      }
      std::size_t along = 0;
      for (std::size_t k = 0; k < direction.size(); ++k) {
        if (!std::isfinite(direction[k]))
          fields_.refuse(ErrorCode::invalid_value, key, "must be vectors of finite numbers");
        if (std::abs(direction[k]) > std::abs(direction[along])) along = k;
      }
      double const step = direction[along];
      if (step == 0) fields_.refuse(ErrorCode::invalid_value, key, "gives an axis zero length");
      for (std::size_t k = 0; k < direction.size(); ++k) {
        constexpr double rounding = 1e-6;  // tolerance of angles [rad]: a millionth of the width of the field
        if (k != along && std::abs(direction[k]) > rounding * std::abs(step)) {
          fields_.refuse(ErrorCode::unsupported, key, "is oblique; resample the field along x, y, z");
        }
      }
      char const world = "xyz"[along];
      if (taken.find(world) != std::string::npos)
        fields_.refuse(ErrorCode::invalid_value, key, "gives two axes the same direction; correct it");
      taken += world;
      header_.axes[i].world = world;
      header_.axes[i].step = step;
      header_.axes[i].stated = true;
      if (sizes_[kept_[i]] > 1) unit_of_[i] = along < units.size() ? units[along] : "";
      if (origins.empty()) continue;
      if (origins[0].size() != direction.size())
        fields_.refuse(ErrorCode::wrong_shape, "space origin", "must have as many numbers as a direction");
      if (!std::isfinite(origins[0][along])) fields_.refuse(ErrorCode::invalid_value, "space origin", "must be finite");
      header_.axes[i].first = origins[0][along];
    }
    if (kept_.size() < 3) {
      std::string rest = "xyz";
      std::erase_if(rest, [&taken](char axis) { return taken.find(axis) != std::string::npos; });
      header_.axes[2].world = rest.front();
    }
  }

  NrrdFields const& fields_;
  NrrdHeader header_;
  std::vector<long long> sizes_;                       ///< number of nodes of all axes
  std::vector<std::size_t> kept_;                      ///< indices of the spatial axes, fastest first
  std::vector<std::vector<double>> directions_;        ///< direction vectors of all axes; empty: none in the header
  std::array<std::optional<std::string>, 3> unit_of_;  ///< units of the spatial axes; nullopt: a single node
};

}  // namespace

NrrdHeader with_nrrd_axes(NrrdHeader header, NrrdFields const& fields, int values) {
  return NrrdAxes(fields, std::move(header)).read(values);
}

}  // namespace gladstone::inline files
