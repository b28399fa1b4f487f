#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "render/base/frame_pair.h"
#include "render/files/source_files.h"
#include "studies/case/backend.h"
#include "studies/compare/reconstruct.h"
#include "studies/report/report_page.h"

namespace gladstone::inline report {

/// Options of a report.
struct ReportOptions {
  std::string source;                ///< RUN or CASE folder
  std::string output;                ///< path of the report
  bool markdown = false;             ///< true: Markdown, false: HTML
  std::string figures;               ///< folder of figures for a publication; empty: none
  std::string figure_format;         ///< "png", "svg" or "pdf"
  std::string vectors;               ///< path of the vectors of a CASE; empty: those in its folder
  std::vector<std::string> repeats;  ///< vectors of repeated measurements, for a measurement
  /// conventions of the vectors of a CASE or a measurement, as for parse_conventions(); empty: those of the format
  std::string conventions;
  /// for a CASE or a measurement: reconstruction of the density, without vectors, conventions and budget; empty: none
  std::optional<ReconstructOptions> density;
  std::vector<std::string> density_words;  ///< options of the density as words of the command line
};

/// Summary of a report that was written.
struct WrittenReport {
  std::string findings;               ///< findings, one per line
  std::vector<std::string> doubtful;  ///< files of vectors that the report should not be based on, see ReportPage
};

/// Writes the report of a study, a case or a measurement, and its figures.
/// @throws DataError if the folder contains no study, case or measurement, no finished case, or no vectors
/// @throws OutputError if a file cannot be written
WrittenReport write_report(ReportOptions const& options, Backend const& device);

/// Creates the report of a RUN from the finished cases, without computations.
ReportPage run_report(ReportOptions const& options);

/// Creates the report of a CASE, which is compared with truth and theory again; with options.density, of its density.
ReportPage case_report(ReportOptions const& options, Backend const& device);

/// Creates the uncertainty report of a measurement, a folder without truth that contains the setup, the vectors and,
/// optionally, the frames. It reports density gradients with uncertainties, the errors of a simulated twin, and with
/// options.density the density.
/// @throws SetupError, DataError
ReportPage measured_report(ReportOptions const& options, Backend const& device);

/// Returns the figures for a publication as blocks that name their files; empty if none are requested.
/// @param draw  draws the figures into a folder in a format and returns their paths; skipped without gnuplot
ReportSection drawn_figures(
    ReportOptions const& options,
    std::function<std::vector<std::string>(std::string const& folder, std::string const& format)> const& draw);

/// Returns the final section of every report: versions, checksums, commands, citation.
/// @param sources  inputs of the report; those with a name are listed with their SHA-256
ReportSection provenance_section(SourceFiles const& sources, std::vector<std::string> const& commands);

/// Converts both frames to 8-bit images of equal grey scale; of large frames, the central part.
FramePictures frame_pictures(FramePair<double> const& frames, std::string const& title);

}  // namespace gladstone::inline report
