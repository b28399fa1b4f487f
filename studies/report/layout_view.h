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

namespace gladstone {

/// Set-up of a setup as drawn in its report.
struct LayoutView {
  std::unique_ptr<FixedDesignParameters> given;  ///< null for PIV
  DesignPoint<double> bench;                     ///< unused for PIV
  std::optional<Setup> piv;
};

/// Returns nullopt for set-ups that the drawing does not cover: a calibration, a posed, tilted or plenoptic camera,
/// windows, no aperture stop, a lens that is neither thin nor rotationally symmetric on the axis, or, for PIV, a laser
/// sheet outside the plane Z = 0. The medium's field is not read.
std::optional<LayoutView> layout_view(CaseSetup loaded);

/// Returns the layout.
Figure make_view_figure(LayoutView const& view);

/// Describes the contents of the layout in numbers.
std::string layout_text(LayoutView const& view);

/// Returns the section "Set-up": the layout to scale, and the design map with the set-up as a point (for PIV, particle
/// images against f-number).
/// @param whose  "the measurement", "the base"
ReportSection layout_section(LayoutView const& view, std::string const& whose);

/// Returns the layout only.
/// @param whose  e.g. "case 3"
ReportBlock layout_block(LayoutView const& view, std::string const& whose);

/// Draws layout and design map into files for a publication.
/// @return paths of the files
/// @throws GnuplotMissing, OutputError
std::vector<std::string> draw_layout_and_map(std::string const& folder, std::string const& format,
                                             LayoutView const& view);

}  // namespace gladstone
