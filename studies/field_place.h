#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "render/base/fields/field_file.h"

namespace gladstone {

/// Where a field's file puts it, in what units, and how much of a setup's view it would fill.
struct FieldPlace {
  nlohmann::json
      units;  ///< of lengths and values, null where the file names none; `length_m`, what was taken; `unknown`
  nlohmann::json extent_mm;  ///< from the first node to the last along x, y, z
  nlohmann::json coverage;   ///< {share, view_mm, setup}; null without a setup
  std::string text;          ///< the same to read
};

/// @param axes  world axes in the file's order, as the source was opened with; empty: as the file has them
/// @param setup file of a setup, or empty; where its own field is a file too, its spacing, place and periods are taken
FieldPlace field_place(FieldSource const& source, std::string const& path, std::string const& dataset,
                       std::string const& axes, std::string const& setup);

}  // namespace gladstone
