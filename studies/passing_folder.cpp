#include "studies/passing_folder.h"

#include <stdlib.h>

#include <filesystem>

#include "render/base/error.h"

namespace gladstone {

PassingFolder::PassingFolder() : path_((std::filesystem::temp_directory_path() / "gladstone_XXXXXX").string()) {
  if (::mkdtemp(path_.data()) == nullptr) throw OutputError(path_, "cannot be made");
}

PassingFolder::~PassingFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace gladstone
