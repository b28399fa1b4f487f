#include "render/scene/read_setup_document.h"

#include <filesystem>

#include "render/base/error.h"
#include "render/files/text_file.h"

namespace gladstone::inline scene {

SetupDocument read_setup_document(std::string const& path, std::vector<std::string> const& overrides) {
  std::string text;
  try {
    text = read_text_file(path, "a setup file", most_setup_bytes);
  } catch (DataError const& error) {
    throw SetupError({{path, error.message(), "", error.code()}});
  }
  auto const folder = std::filesystem::absolute(path).parent_path();
  SetupDocument document = SetupDocument::from_text(text, path, folder.string());
  if (document.empty()) {
    throw SetupError({{path, "is empty (no key is set); gladstone render --help shows a setup to begin with", "",
                       ErrorCode::syntax}});
  }
  for (std::string const& assignment : overrides) document.override_key(assignment);
  return document;
}

}  // namespace gladstone::inline scene
