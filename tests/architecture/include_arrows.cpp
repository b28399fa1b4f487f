#include "tests/architecture/include_arrows.h"

#include <algorithm>
#include <initializer_list>
#include <regex>

#include "tests/architecture/product_sources.h"

namespace gladstone::architecture {
namespace {

using Names = std::vector<std::string>;

/// Permitted includes of a room: other rooms, libraries anywhere, and libraries in .cpp files only.
struct Room {
  std::string name;
  Names rooms;
  Names libraries;
  Names libraries_in_cpp;
};

Names const render = {"render/base",   "render/setup",  "render/files",  "render/light",
                      "render/medium", "render/optics", "render/sensor", "render/scene"};
Names const renderers = {"render/rays", "render/focused_dots", "render/ideal_images"};
Names const analysis = {"analysis/vectors",     "analysis/correlation", "analysis/errors",   "analysis/calibration",
                        "analysis/uncertainty", "analysis/preparation", "analysis/tracking", "analysis/density",
                        "analysis/stereo",      "analysis/tomography"};
Names const cuda = {"cuda/device",       "cuda/rays",        "cuda/focused_dots",
                    "cuda/ideal_images", "cuda/correlation", "cuda/tomography"};

Names const studies = {"studies/drawing", "studies/case",   "studies/compare",   "studies/sweep",   "studies/design",
                       "studies/figures", "studies/report", "studies/benchmark", "studies/oracles", "studies/examples"};
Names const studies_use = {"Eigen", "fmt", "spdlog", "nlohmann_json"};

Names operator+(Names a, Names const& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Names const libraries = render + renderers + Names{"render"} + analysis;

/// The table of rooms and permitted includes. Every room may also include itself, the standard library and, in .cpp
/// files, POSIX.
std::vector<Room> const& table() {
  static std::vector<Room> const rooms = {
      {"render/base", {}, {"x86 intrinsics"}, {"TBB", "fmt"}},
      {"render/setup", {"render/base"}, {}, {"toml++", "fmt"}},
      {"render/files",
       {"render/base"},
       {},
       {"HDF5", "libtiff", "OpenSSL", "zlib", "bzip2", "lz4", "lzma", "pugixml", "xxHash", "fmt"}},
      {"render/image_codecs", {"render/base", "render/files"}, {}, {"OpenImageIO"}},
      {"render/light", {"render/base", "render/setup", "render/files"}, {"Eigen"}, {"fmt"}},
      {"render/medium", {"render/base", "render/setup", "render/files"}, {"Eigen"}, {"fmt"}},
      {"render/optics", {"render/base", "render/setup", "render/files"}, {"Eigen"}, {"fmt"}},
      {"render/sensor", {"render/base", "render/setup", "render/files"}, {"Eigen"}, {"fmt"}},
      {"render/scene", render, {"Eigen"}, {"Ceres", "fmt"}},
      {"render/rays", render, {"Eigen"}, {"fmt"}},
      {"render/focused_dots", render, {"Eigen"}, {"fmt"}},
      {"render/ideal_images", render, {"Eigen"}, {"fmt"}},
      {"render", render + renderers, {"Eigen"}, {"fmt"}},
      {"analysis/vectors", {"render/base", "render/files"}, {"Eigen"}, {"fmt"}},
      {"analysis/preparation", {"render/base", "render/files"}, {"Eigen"}, {"OpenCV", "fmt"}},
      {"analysis/correlation",
       {"render/base", "render/files", "analysis/vectors", "analysis/preparation"},
       {"Eigen"},
       {"x86 intrinsics", "OpenCV", "fmt"}},
      {"analysis/uncertainty",
       {"render/base", "render/files", "analysis/vectors", "analysis/correlation"},
       {"Eigen"},
       {"fmt"}},
      {"analysis/errors",
       {"render/base", "render/files", "analysis/vectors", "analysis/correlation"},
       {"Eigen", "Ceres"},
       {"fmt"}},
      {"analysis/tracking",
       {"render/base", "analysis/vectors", "analysis/preparation", "analysis/correlation"},
       {"Eigen"},
       {"OpenCV", "Ceres", "fmt"}},
      {"analysis/calibration",
       {"render/base", "render/files", "analysis/preparation"},
       {"Eigen"},
       {"OpenCV", "Ceres", "fmt"}},
      {"analysis/density", {"render/base", "analysis/vectors"}, {"Eigen"}, {"fmt"}},
      {"analysis/stereo",
       {"render/base", "analysis/vectors", "analysis/correlation", "analysis/calibration"},
       {"Eigen"},
       {"fmt"}},
      {"analysis/tomography", {"render/base", "analysis/vectors", "analysis/density"}, {"Eigen"}, {"fmt"}},
      {"cuda/device", render, {"Eigen", "CUDA"}, {"fmt"}},
      {"cuda/rays", render + Names{"render/rays", "cuda/device"}, {"Eigen", "CUDA"}, {"fmt"}},
      {"cuda/focused_dots",
       render + Names{"render/focused_dots", "cuda/device", "cuda/rays"},
       {"Eigen", "CUDA"},
       {"fmt"}},
      {"cuda/ideal_images", render + Names{"render/ideal_images", "cuda/device"}, {"Eigen", "CUDA"}, {"fmt"}},
      {"cuda/correlation",
       render + Names{"analysis/correlation", "analysis/uncertainty", "cuda/device"},
       {"Eigen", "CUDA"},
       {"fmt"}},
      {"cuda/tomography",
       render + Names{"analysis/vectors", "analysis/density", "analysis/tomography", "cuda/device"},
       {"Eigen", "CUDA"},
       {"fmt"}},
      {"cuda", render + renderers + analysis + cuda, {"Eigen", "CUDA"}, {"fmt"}},
      {"studies/drawing", {"render/base", "render/files"}, studies_use, {}},
      {"studies/case", libraries + Names{"cuda"}, studies_use, {}},
      {"studies/compare", libraries + Names{"studies/drawing", "studies/case"}, studies_use, {}},
      {"studies/sweep", libraries + Names{"studies/case", "studies/compare"}, studies_use, {}},
      {"studies/design",
       libraries + Names{"studies/case", "studies/compare", "studies/sweep"},
       studies_use,
       {"Ceres", "NLopt"}},
      {"studies/figures",
       libraries + Names{"studies/drawing", "studies/case", "studies/compare", "studies/sweep", "studies/design"},
       studies_use,
       {}},
      {"studies/report",
       libraries + Names{"studies/drawing", "studies/case", "studies/compare", "studies/sweep", "studies/design",
                         "studies/figures"},
       studies_use,
       {}},
      {"studies/benchmark",
       libraries + Names{"studies/drawing", "studies/case", "studies/compare", "studies/figures", "studies/report"},
       studies_use,
       {}},
      {"studies/oracles", libraries + Names{"studies/case"}, studies_use, {}},
      {"studies/examples",
       libraries + Names{"studies/drawing", "studies/case", "studies/compare", "studies/figures"},
       studies_use,
       {}},
      {"studies/commands", libraries + studies, studies_use + Names{"CLI11"}, {}},
      {"python/src", libraries + studies + Names{"studies/commands"}, studies_use + Names{"nanobind"}, {}},
      {"studies", libraries + studies + Names{"studies/commands"}, studies_use + Names{"CLI11"}, {}},  // main.cpp
  };
  return rooms;
}

struct LibraryPattern {
  std::string library;
  std::string header;  ///< regular expression
};

std::vector<LibraryPattern> const& known_libraries() {
  static std::vector<LibraryPattern> const libraries = {
      {"Eigen", "Eigen/.*|unsupported/Eigen/.*"},
      {"HDF5", "hdf5\\.h|hdf5_hl\\.h|H5.*\\.h"},
      {"libtiff", "tiff(io)?\\.h"},
      {"OpenImageIO", "OpenImageIO/.*"},
      {"OpenSSL", "openssl/.*"},
      {"toml++", "toml\\+\\+/.*|toml\\.hpp|toml\\.h"},
      {"x86 intrinsics", "immintrin\\.h"},
      {"TBB", "tbb/.*|oneapi/.*"},
      {"fmt", "fmt/.*"},
      {"spdlog", "spdlog/.*"},
      {"nlohmann_json", "nlohmann/.*"},
      {"CLI11", "CLI/.*"},
      {"nanobind", "nanobind/.*"},
      {"OpenCV", "opencv2/.*"},
      {"Ceres", "ceres/.*"},
      {"NLopt", "nlopt\\.h(pp)?"},
      {"zlib", "zlib\\.h"},
      {"bzip2", "bzlib\\.h"},
      {"lz4", "lz4\\.h"},
      {"lzma", "lzma\\.h"},
      {"pugixml", "pugixml\\.hpp"},
      {"xxHash", "xxhash\\.h"},
      {"CUDA",
       "cu(da|fft|rand|blas|solver|sparse)[^/]*|cuda/.*|cub/.*|thrust/.*|cooperative_groups.*|mma\\.h|nv[^/]*/.*|"
       "nv(ml|rtc|Toolsext)\\w*\\.h|device_(launch_parameters|functions|types)\\.h|driver_types\\.h|"
       "(vector|sm_[0-9]+)_[a-z_]+\\.h(pp)?"},
      {"POSIX",
       "sys/.*|(stdio|stdlib|unistd|fcntl|signal|dirent|dlfcn|glob|poll|termios|pthread|spawn|malloc|fnmatch)\\.h"},
      {"std", "[a-z_0-9]+"},
  };
  return libraries;
}

bool contains(Names const& names, std::string const& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool ends_with_one_of(std::string_view path, std::initializer_list<std::string_view> endings) {
  return std::any_of(endings.begin(), endings.end(), [&](std::string_view ending) { return path.ends_with(ending); });
}

/// Returns the problem of this include in this room; empty if it is permitted.
std::string fault(Room const& room, std::string const& path, Include const& include) {
  std::string const shown = include.quoted ? '"' + include.target + '"' : '<' + include.target + '>';
  if (!include.quoted) {
    std::string const library = library_of(include.target);
    if (library.empty()) return shown + " belongs to no library of the table";
    if (library == "std" || contains(room.libraries, library)) return "";
    if (library != "POSIX" && !contains(room.libraries_in_cpp, library)) {
      return room.name + " may not include " + library + ": " + shown;
    }
    return path.ends_with(".cpp") ? "" : library + " may be included in .cpp files only: " + shown;
  }
  std::string const target = room_of(include.target);
  if (target.empty()) return shown + " is not a path from the root of the tree into a room";
  if (target == room.name || contains(room.rooms, target)) return "";
  return room.name + " may not include " + target + ": " + shown;
}

}  // namespace

std::vector<Include> includes_of(std::string_view source) {
  static std::regex const directive(R"(^\s*#\s*(?:include|include_next|import)\b\s*(.*?)\s*$)");
  std::string const text = without_comments(source);
  std::vector<Include> found;
  int line = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t const end = std::min(text.find('\n', begin), text.size());
    std::string const code = text.substr(begin, end - begin);
    begin = end + 1;
    ++line;
    std::smatch match;
    if (!std::regex_match(code, match, directive)) continue;
    std::string const named = match[1];
    bool const bracketed = named.size() > 2 && ((named.front() == '"' && named.back() == '"') ||
                                                (named.front() == '<' && named.back() == '>'));
    found.push_back({line, bracketed ? named.substr(1, named.size() - 2) : named, !bracketed || named.front() == '"'});
  }
  return found;
}

std::string room_of(std::string_view path) {
  if (path.find("..") != std::string_view::npos) return "";
  for (Room const& room : table()) {
    if (!path.starts_with(room.name + "/")) continue;
    bool const has_rooms = room.name.find('/') == std::string::npos;  // "studies": its folders are separate rooms
    if (!has_rooms || path.find('/', room.name.size() + 1) == std::string_view::npos) return room.name;
  }
  return path.starts_with("tests/") ? "tests" : "";
}

std::map<std::string, std::set<std::string>> permitted_rooms() {
  std::map<std::string, std::set<std::string>> permitted;
  for (Room const& room : table()) {
    permitted[room.name].insert(room.rooms.begin(), room.rooms.end());
    permitted[room.name].erase(room.name);
  }
  return permitted;
}

std::string library_of(std::string_view header) {
  for (LibraryPattern const& known : known_libraries()) {
    if (std::regex_match(header.begin(), header.end(), std::regex(known.header))) return known.library;
  }
  return "";
}

std::vector<std::string> forbidden_arrows(std::string const& path, std::string_view source) {
  std::vector<std::string> faults;
  std::string const name = room_of(path);
  auto const room = std::find_if(table().begin(), table().end(), [&](Room const& r) { return r.name == name; });
  if (!path.starts_with("cuda/") && ends_with_one_of(path, {".cu", ".cuh"}))
    faults.push_back(path + ": CUDA code outside cuda/");
  if (name == "tests") {  // tests may include everything except CUDA
    for (Include const& include : includes_of(source)) {
      if (include.quoted || library_of(include.target) != "CUDA") continue;
      faults.push_back(path + ":" + std::to_string(include.line) + ": tests may not include CUDA: <" + include.target +
                       '>');
    }
    return faults;
  }
  if (room == table().end()) return {path + ": lies in no room"};
  for (Include const& include : includes_of(source)) {
    std::string const what = fault(*room, path, include);
    if (!what.empty()) faults.push_back(path + ":" + std::to_string(include.line) + ": " + what);
  }
  return faults;
}

}  // namespace gladstone::architecture
