#include "studies/case/shared_folder.h"

#include <filesystem>
#include <system_error>

#include "render/base/error.h"

namespace gladstone {

std::string shared_folder() {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path const executable = fs::read_symlink("/proc/self/exe", error);
  fs::path const installed = executable.parent_path().parent_path() / "share" / "gladstone";
  for (fs::path const& folder : {installed, fs::path(GLADSTONE_SOURCE_DIR)}) {
    if (fs::exists(folder / "studies" / "cases" / "table1.toml")) return folder.string();
  }
  throw DataError(installed.string(),
                  "studies/cases/table1.toml does not exist (incomplete installation); install gladstone again");
}

}  // namespace gladstone
