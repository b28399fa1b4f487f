#pragma once

#include <array>
#include <string>
#include <vector>

#include "render/files/folder_replacement.h"

namespace gladstone::inline cases {

/// File names of a CASE folder.
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
/// Returns the image file name of a calibration plane, e.g. "plane_000.tif".
std::string plane(std::size_t index);
inline constexpr char const* any_plane = "plane_*.tif";
inline constexpr char const* calibration = "calibration.h5";
inline constexpr char const* calibration_figure = "calibration_residuals.png";
/// Files written by correlate, compare and report; removed when the case is rendered again.
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

/// Describes the contents of a CASE folder: the file that identifies it and the files removed when it is rendered
/// again.
FolderContent case_content();

/// Returns the paths of the files that render writes for a case with an image pair.
std::vector<std::string> rendered_files(std::string const& folder);
/// Returns the paths of the files derived from the rendered ones.
std::vector<std::string> derived_files(std::string const& folder);

/// Checks that rendering into a CASE does not overwrite or remove any of its input files.
/// @throws OutputError if it would
void refuse_case_over_inputs(std::string const& folder, std::vector<std::string> const& inputs);

/// Completes an interrupted replacement of the case's files.
/// @throws DataError if the folder is not a CASE (has no setup.toml)
void require_case(std::string const& folder);

/// Returns "folder/name" for a CASE that holds an image pair.
/// @throws DataError if it holds several cameras or a calibration; as require_case()
std::string in_case(std::string const& folder, std::string const& name);

}  // namespace gladstone::inline cases
