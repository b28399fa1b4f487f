#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/setup.h"
#include "studies/case.h"
#include "studies/design/bench.h"
#include "studies/report/report_page.h"

namespace gladstone {

/// The bench of a setup as its report draws it.
struct BenchView {
  std::unique_ptr<BenchGiven> given;  ///< null of PIV
  Bench<double> bench;                ///< of PIV nothing
  std::optional<Setup> piv;
};

/// Nothing where a setup is of no thin or rotationally symmetric lens on the axis before dots or particles: of a
/// calibration, posed, tilted, plenoptic, behind windows or without a stop; of PIV where the sheet stands
/// elsewhere than in the plane Z = 0. The medium's field is not read.
std::optional<BenchView> bench_view(CaseSetup loaded);

/// What the layout shows, in numbers.
std::string layout_text(BenchView const& view);

/// Section "Set-up": the layout to scale, and the design map with the set-up as a point (of PIV, what each stop makes
/// of the particles), both drawn now and held by the page; without gnuplot their words.
/// @param whose "the measurement", "the base"
ReportSection bench_section(BenchView const& view, std::string const& whose);

/// The layout alone. @param whose "case 3"
ReportBlock layout_block(BenchView const& view, std::string const& whose);

/// The same as files of a paper. @return their paths @throws GnuplotMissing, OutputError
std::vector<std::string> draw_bench(std::string const& folder, std::string const& format, BenchView const& view);

}  // namespace gladstone
