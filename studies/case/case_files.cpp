#include "studies/case/case_files.h"

#include <fmt/format.h>

#include <filesystem>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/files/output_destination.h"
#include "render/scene/experiment.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/cameras.h"
#include "studies/case/rendered_sequence_folder.h"

namespace gladstone::inline cases {
namespace {

namespace fs = std::filesystem;

template <class Names>
std::vector<std::string> in_folder(std::string const& folder, Names const& names) {
  std::vector<std::string> paths;
  for (char const* name : names) paths.push_back((fs::path(folder) / name).string());
  return paths;
}

/// Throws, with an explanation, if a case holds several cameras or a calibration instead of an image pair.
void require_pair(std::string const& folder) {
  std::error_code error;
  if (fs::exists(fs::path(folder) / case_file::reference, error)) return;
  SetupDocument const setup = read_setup_document((fs::path(folder) / case_file::setup).string());
  if (std::vector<std::string> const names = camera_names(setup); !names.empty()) {
    throw DataError(ErrorCode::undetermined, folder,
                    fmt::format("contains one case for each of its cameras, {}; name one of them: {}",
                                quoted_list(names), (fs::path(folder) / names.front()).string()));
  }
  if (!find_experiment(setup).correlated) {
    throw DataError(
        ErrorCode::wrong_format, folder,
        "is a calibration (it has planes of dots and no pair of frames); use gladstone calibrate " + folder);
  }
}

}  // namespace

std::string case_file::plane(std::size_t index) { return fmt::format("plane_{:03}.tif", index); }

FolderContent case_content() {
  FolderContent content{case_file::setup, {case_file::derived.begin(), case_file::derived.end()}};
  for (char const* other : {case_file::reference, case_file::flow, case_file::truth, case_file::any_plane,
                            case_file::calibration, case_file::calibration_figure}) {
    content.derived.emplace_back(other);
  }
  return content;
}

std::vector<std::string> rendered_files(std::string const& folder) {
  return in_folder(folder, std::array{case_file::reference, case_file::flow, case_file::truth, case_file::setup,
                                      case_file::summary});
}

std::vector<std::string> derived_files(std::string const& folder) { return in_folder(folder, case_file::derived); }

void refuse_case_over_inputs(std::string const& folder, std::vector<std::string> const& inputs) {
  refuse_inputs_as_outputs(rendered_files(folder), inputs);
  refuse_inputs_as_outputs(derived_files(folder), inputs);
  std::vector<std::string> there;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (is_derived(entry->path().filename().string(), case_content())) there.push_back(entry->path().string());
  }
  refuse_inputs_as_outputs(there, inputs);
}

void require_case(std::string const& folder) {
  complete_parent_replacement(folder, case_content());
  if (!is_complete(folder, case_content())) {
    std::error_code error;
    if (fs::is_regular_file(folder, error))
      throw DataError(ErrorCode::wrong_format, folder,
                      "is a file, not the folder of a case; create one with: gladstone render SETUP.toml -o CASE");
    for (std::size_t const first : {0, 1}) {
      std::string const pair = rendered_sequence_file::pair(first);
      if (fs::exists(fs::path(folder) / rendered_sequence_file::setup, error) &&
          fs::exists(fs::path(folder) / pair, error)) {
        throw DataError(ErrorCode::wrong_format, folder,
                        fmt::format("is a rendered sequence; name one of its cases, such as {}",
                                    (fs::path(folder) / pair).string()));
      }
    }
    throw DataError(
        ErrorCode::wrong_format, folder,
        "is not a case (it contains no setup.toml); create one with: gladstone render SETUP.toml -o " + folder);
  }
}

std::string in_case(std::string const& folder, std::string const& name) {
  require_case(folder);
  if (name != case_file::setup) require_pair(folder);
  return (fs::path(folder) / name).string();
}

}  // namespace gladstone::inline cases
