#pragma once

#include <string>
#include <vector>

#include "render/scene/setup.h"

namespace gladstone::inline cases {

/// Dots of a target for printing, exactly those that the renderer uses (build_target()).
struct TargetPattern {
  std::vector<Vec2d> centre;  ///< centres in the target's plane, X to the right and Y upwards [m]
  double diameter = 0;        ///< diameter of every dot [m]
  Vec2d middle{};             ///< centre of the pattern [m]
  Vec2d extent{};             ///< width and height that contain all dots entirely [m]
  Polarity polarity = Polarity::bright;
};

/// Page with a pattern at its true scale.
struct TargetPage {
  Vec2d size_mm{};          ///< width and height of the page [mm]
  Vec2d corner_mm{};        ///< upper left corner of the pattern, relative to that of the page [mm]
  double scale_bar_mm = 0;  ///< length of the scale bar [mm]
};

/// @param name  name of the setup in messages
/// @throws DataError for PIV and image targets, which have no dots, and if the dots cannot be placed
TargetPattern make_target_pattern(Setup const& setup, std::string const& name);

/// Returns the page of a pattern: margins of 10 mm, and below the pattern 20 mm for the scale bar and the page size.
TargetPage make_target_page(TargetPattern const& pattern);

/// Formats the page as SVG 1.1 or PDF 1.4, in mm, dots as circles (PDF: four cubic Bezier curves, whose radius deviates
/// by at most 2.8e-4 of itself). Bright dots are white on black, dark dots black on white.
/// @throws DataError if the dots have no size, or if the page exceeds the largest one of PDF (5080 mm)
std::string target_svg(TargetPattern const& pattern);
std::string target_pdf(TargetPattern const& pattern);

/// Formats the centres as a table x_mm,y_mm, which target.kind = "points" reads.
std::string target_csv(TargetPattern const& pattern);

}  // namespace gladstone::inline cases
