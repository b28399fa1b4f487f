#include "studies/case/shared_folder.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "render/base/error.h"

namespace gladstone::inline cases {

std::string shared_folder() {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path const executable = fs::read_symlink("/proc/self/exe", error);
  fs::path const installed = executable.parent_path().parent_path() / "share" / "gladstone";
  // The Python package contains the folder next to its extension module.
  Dl_info module{};
  fs::path const packaged = ::dladdr(reinterpret_cast<void const*>(&shared_folder), &module) != 0
                                ? fs::path(module.dli_fname).parent_path() / "share" / "gladstone"
                                : fs::path();
  // Programs in the build folder use the source tree.
  bool const built = fs::equivalent(executable.parent_path(), GLADSTONE_PROGRAM_DIR, error);
  for (fs::path const& folder : {installed, packaged, built ? fs::path(GLADSTONE_SOURCE_DIR) : fs::path()}) {
    if (!folder.empty() && fs::exists(folder / "studies" / "cases" / "table1.toml")) return folder.string();
  }
  throw DataError(ErrorCode::missing_file, installed.string(),
                  "studies/cases/table1.toml does not exist (incomplete installation); install gladstone again");
}

}  // namespace gladstone::inline cases
