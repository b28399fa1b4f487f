#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "studies/case.h"
#include "studies/design/bench.h"
#include "studies/report/report_page.h"

namespace gladstone {

/// The bench of a setup as its report draws it.
struct BenchView {
  std::unique_ptr<BenchGiven> given;
  Bench<double> bench;
};

/// Nothing where a setup is of no thin or rotationally symmetric lens on the axis before dots: of PIV, of a
/// calibration, posed, tilted, plenoptic, behind windows or without a stop. The medium's field is not read.
std::optional<BenchView> bench_view(CaseSetup loaded);

/// What the layout shows, in numbers.
std::string layout_text(BenchView const& view);

/// Section "Set-up": the layout to scale, and the design map with the set-up as a point, both drawn now and held by the
/// page; without gnuplot their words.
/// @param whose "the measurement", "the base"
ReportSection bench_section(BenchView const& view, std::string const& whose);

/// The layout alone. @param whose "case 3"
ReportBlock layout_block(BenchView const& view, std::string const& whose);

/// The same as files of a paper. @return their paths @throws GnuplotMissing, OutputError
std::vector<std::string> draw_bench(std::string const& folder, std::string const& format, BenchView const& view);

}  // namespace gladstone
