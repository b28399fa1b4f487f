#pragma once

#include <string>
#include <vector>

#include "studies/compare/reconstruct.h"
#include "studies/report/report_page.h"

namespace gladstone::inline report {

/// Returns a sentence with range and uncertainty of a density, for a rendered case with its error.
std::string summarize_density(Reconstruction const& reconstruction);

/// Returns the section "Density": maps of density, uncertainty and, for a rendered case, truth and error; a profile
/// with its uncertainty; a table of its numbers; and the error budget. Stores summarize_reconstruction() as "density"
/// in the page's data.
ReportSection density_section(ReportPage& page, Reconstruction const& reconstruction);

/// Returns the section "Density" of a report without a reconstruction: how to add one.
/// @param command  command of the report
ReportSection missing_density_section(std::string const& command);

/// Draws the maps and the profile of the density for a publication.
/// @return paths of the files
/// @throws GnuplotMissing, OutputError
std::vector<std::string> draw_density_figures(std::string const& folder, std::string const& format,
                                              Reconstruction const& reconstruction);

}  // namespace gladstone::inline report
