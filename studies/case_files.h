#pragma once

#include <array>
#include <string>
#include <vector>

#include "render/base/folder_replacement.h"

namespace gladstone {

/// The name of every file in a CASE.
namespace case_file {
inline constexpr char const* reference = "reference.tif";
inline constexpr char const* flow = "flow.tif";
inline constexpr char const* truth = "truth.h5";
inline constexpr char const* setup = "setup.toml";
inline constexpr char const* summary = "summary.json";
inline constexpr char const* vectors = "vectors.h5";
inline constexpr char const* vectors_text = "vectors.csv";
inline constexpr char const* errors = "errors.json";
inline constexpr char const* comparison = "comparison.h5";
/// Of one plane of a calibration.
std::string plane(std::size_t index);
inline constexpr char const* any_plane = "plane_*.tif";
inline constexpr char const* calibration = "calibration.h5";
inline constexpr char const* calibration_figure = "calibration_residuals.png";
/// What correlate and compare make of a rendering: it goes when the case is rendered again.
inline constexpr std::array derived{vectors,
                                    vectors_text,
                                    errors,
                                    comparison,
                                    "displacement_maps.png",
                                    "error_histograms.png",
                                    "error_against_gradient.png",
                                    "error_budget.png",
                                    "report.html",
                                    "report.md"};
}  // namespace case_file

/// What makes a folder a CASE, and what goes when it is rendered again.
FolderContent case_content();

/// Paths of the files of a CASE of a pair that render writes.
std::vector<std::string> rendered_files(std::string const& folder);
/// Paths of those derived from them.
std::vector<std::string> derived_files(std::string const& folder);

/// Makes sure that rendering into a CASE replaces or removes nothing that is read for it. @throws OutputError
void refuse_case_over_inputs(std::string const& folder, std::vector<std::string> const& inputs);

/// Completes a replacement of the case's files that was broken off.
/// @throws DataError where the folder is no CASE (has no setup.toml)
void require_case(std::string const& folder);

/// "folder/name" of a CASE that holds a pair of frames. @throws DataError where it holds several cameras or a
/// calibration; as require_case
std::string in_case(std::string const& folder, std::string const& name);

}  // namespace gladstone
