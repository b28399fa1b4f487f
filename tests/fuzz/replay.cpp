// Main program of the targets in a build without libFuzzer: passes the files and the files of the folders on its
// command line to the target.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "render/files/text_file.h"
#include "tests/fuzz/input.h"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  for (fs::path const argument : std::vector<std::string>(argv + 1, argv + argc)) {
    if (!fs::is_directory(argument)) files.push_back(argument);
    if (!fs::is_directory(argument)) continue;
    for (auto const& entry : fs::directory_iterator(argument)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (fs::path const& file : files) {
    std::printf("%s\n", file.c_str());
    std::fflush(stdout);
    std::string const content = gladstone::read_text_file(file.string());
    LLVMFuzzerTestOneInput(reinterpret_cast<std::uint8_t const*>(content.data()), content.size());
  }
  return files.empty() ? 1 : 0;
}
