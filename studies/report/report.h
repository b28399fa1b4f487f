#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/base/source_files.h"
#include "studies/device.h"
#include "studies/report/report_page.h"

namespace gladstone {

/// What a report is written from and as.
struct ReportOptions {
  std::string source;                ///< RUN or CASE folder
  std::string output;                ///< file
  bool markdown = false;             ///< else HTML
  std::string figures;               ///< folder for the figures of a paper; empty: none
  std::string figure_format;         ///< "png", "svg" or "pdf"
  std::string vectors;               ///< of a CASE: file; empty: its own
  std::vector<std::string> repeats;  ///< of a measured case: vectors of the same measured again
  std::string
      conventions;  ///< of a measured case's foreign vectors, as parse_conventions() reads them; empty: their format's
};

/// Writes the report of a study or of a case, and its figures. @return the findings, a line each
/// @throws DataError where the folder is neither, holds no finished case, or was never correlated; OutputError
std::string write_report(ReportOptions const& options, Device const& device);

/// The report of a RUN from what is finished: nothing is computed.
ReportPage run_report(ReportOptions const& options);

/// The report of a CASE, which is compared with truth and theory anew.
ReportPage case_report(ReportOptions const& options, Device const& device);

/// The uncertainty report of a measurement: a folder with the setup that describes it and its vectors, and frames or
/// not, but no truth. Gradients of density with what they are uncertain by, and the errors of a simulated twin.
/// @throws SetupError, DataError
ReportPage measured_report(ReportOptions const& options, Device const& device);

/// The figures of a paper, as blocks that name them: what `draw` draws into a folder in a format, without gnuplot none.
/// Empty where none are wanted.
ReportSection drawn_figures(
    ReportOptions const& options,
    std::function<std::vector<std::string>(std::string const& folder, std::string const& format)> const& draw);

/// How every report ends: versions, checksums, commands, how to cite.
/// @param sources what it was made from: those that have a name are told, with their SHA-256
ReportSection how_it_was_made(SourceFiles const& sources, std::vector<std::string> const& commands);

/// Two frames as 8-bit pictures of equal grey scale; of large ones the middle.
FramePictures frame_pictures(std::string const& folder, std::string const& title);

}  // namespace gladstone
