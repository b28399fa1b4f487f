#include "studies/case_files.h"

#include <filesystem>

#include "render/base/error.h"
#include "render/base/output_file.h"

namespace gladstone {

FolderContent case_content() { return {case_file::setup, {case_file::derived.begin(), case_file::derived.end()}}; }

namespace {

template <class Names>
std::vector<std::string> in_folder(std::string const& folder, Names const& names) {
  std::vector<std::string> paths;
  for (char const* name : names) paths.push_back((std::filesystem::path(folder) / name).string());
  return paths;
}

}  // namespace

std::vector<std::string> rendered_files(std::string const& folder) {
  return in_folder(folder, std::array{case_file::reference, case_file::flow, case_file::truth, case_file::setup,
                                      case_file::summary});
}

std::vector<std::string> derived_files(std::string const& folder) { return in_folder(folder, case_file::derived); }

void refuse_case_over_inputs(std::string const& folder, std::vector<std::string> const& inputs) {
  refuse_inputs_as_outputs(rendered_files(folder), inputs);
  refuse_inputs_as_outputs(derived_files(folder), inputs);
}

std::string in_case(std::string const& folder, std::string const& name) {
  namespace fs = std::filesystem;
  if (!is_complete(folder, case_content())) {
    throw DataError(folder,
                    "is not a case (it holds no setup.toml); make one with: gladstone render SETUP.toml -o " + folder);
  }
  return (fs::path(folder) / name).string();
}

}  // namespace gladstone
