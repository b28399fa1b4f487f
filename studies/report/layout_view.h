#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/setup.h"
#include "studies/case/case.h"
#include "studies/design/design_point.h"
#include "studies/drawing/figure.h"
#include "studies/report/report_page.h"

namespace gladstone::inline report {

struct LayoutKind;

/// Optical layout of a setup, as drawn in a report.
struct LayoutView {
  LayoutKind const* kind;  ///< functions that draw and describe it
  Setup setup;
  std::unique_ptr<FixedDesignParameters> given;  ///< given properties of the set-up; null for PIV
  DesignPoint<double> bench;                     ///< model of the set-up; unused for PIV
};

/// Creates the layout of a setup; nullopt if the drawing does not cover it: a calibration, a posed, tilted or plenoptic
/// camera, windows, no aperture stop, a lens that is neither thin nor rotationally symmetric on the axis, or, for PIV,
/// a laser sheet outside the plane Z = 0. The medium's field is not read.
std::optional<LayoutView> layout_view(CaseSetup loaded);

/// Returns the layout.
Figure make_view_figure(LayoutView const& view);

/// Describes the contents of the layout in numbers.
std::string layout_text(LayoutView const& view);

/// Returns the section "Set-up": the layout to scale, and the design map with the set-up as a point (for PIV, particle
/// images against f-number). Both are drawn now and embedded in the page; without gnuplot, they are replaced by their
/// descriptions.
/// @param whose  owner of the set-up in the texts: "the measurement", "the base"
ReportSection layout_section(LayoutView const& view, std::string const& whose);

/// Returns the layout without the design map.
/// @param whose  owner of the set-up in the texts, e.g. "case 3"
ReportBlock layout_block(LayoutView const& view, std::string const& whose);

/// Draws layout and design map into files for a publication.
/// @return paths of the files
/// @throws GnuplotMissing, OutputError
std::vector<std::string> draw_layout_and_map(std::string const& folder, std::string const& format,
                                             LayoutView const& view);

}  // namespace gladstone::inline report
