#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "render/base/vec.h"
#include "render/files/fields/field_file.h"
#include "render/scene/field_coverage.h"

namespace gladstone::inline commands {

/// File of a field as it was opened.
struct FieldFile {
  std::string path, dataset;
  std::string axes;  ///< world axes in the file's order; empty: the file's own
};

/// Position and extent of a field file, and its coverage of a setup's view.
struct FieldPlace {
  Vec3d spacing{};    ///< spacing as stated, in the file's unit of length; NaN: not stated, or a single node
  Vec3d extent_mm{};  ///< distance from the first node to the last along x, y, z [mm]; NaN: undefined
  std::optional<FieldCoverage> coverage;  ///< empty without a setup
  std::string text;                       ///< units, and a warning of the coverage, as readable text
  std::string assumption;                 ///< assumption made about lengths, or why they are undefined; empty: neither
};

/// Determines the position and coverage of a field file.
/// @param file   file from which the source was opened
/// @param setup  path of a setup, or empty; if its field (of a velocity: its flow) is a file too, its spacing, position
///               and periods are used
FieldPlace field_place(FieldSource const& source, FieldFile const& file, std::string const& setup);

/// Returns the units of lengths and values as JSON, null if the file names none; `length_m`, the unit used; `unknown`.
nlohmann::json units_json(FieldUnits const& units);

}  // namespace gladstone::inline commands
