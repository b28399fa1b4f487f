#include "render/files/file_kind.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "render/files/input_guard.h"

namespace gladstone::inline files {
namespace {

using namespace std::string_view_literals;

std::string first_bytes(std::string const& path) {
  std::string bytes(4096, '\0');
  int const file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return "";
  ssize_t const size = ::pread(file, bytes.data(), bytes.size(), 0);
  ::close(file);
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  return bytes;
}

std::string kind_of_hdf5(std::string const& path) {
  UnrecordedReading const unguarded;
  try {
    std::string const filetype = Hdf5Reader(path).attribute("filetype");
    return filetype.empty() ? "HDF5" : filetype;
  } catch (DataError const&) {
    return damaged_hdf5;  // parts of it may be recoverable
  }
}

bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '.' || c == '"';
}

/// Returns the kind of an XML file by its root element, which is looked for in its first bytes.
std::string kind_of_xml(std::string_view text) {
  if (text.find("<svg"sv) != std::string_view::npos) return "SVG";
  return text.find("<VTKFile"sv) != std::string_view::npos ? "VTK" : "XML";
}

/// Returns true if the first line that is neither empty nor a comment is a table header or "key = ...".
bool reads_as_toml(std::string_view text) {
  while (!text.empty()) {
    std::size_t const end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!line.empty() && (line.front() == ' ' || line.front() == '\t' || line.front() == '\r'))
      line.remove_prefix(1);
    if (line.empty() || line.front() == '#') continue;
    if (line.front() == '[') return true;
    while (!line.empty() && is_name(line.front())) line.remove_prefix(1);
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    return line.starts_with('=');
  }
  return false;
}

/// Returns the kind of a CSV file that gladstone writes, determined from its column names; empty for other text.
std::string kind_of_table(std::string_view text) {
  std::string const header = ',' + std::string(text.substr(0, text.find('\n'))) + ',';
  auto const begins = [&](std::string_view names) { return header.starts_with(names); };
  auto const has = [&](std::string_view names) { return header.find(names) != std::string::npos; };
  if (begins(",x_px,y_px,u_px,v_px,")) return "gladstone vectors";
  if (begins(",status,x_mm,y_mm,z_mm,dx,dy,dz,opl_mm,")) return "gladstone rays";
  if (begins(",estimator,case,")) return "gladstone benchmark";
  if (begins(",term,coefficient,")) return "gladstone uncertainty combination";
  if (has(",case,seed,status,repeat,")) return "gladstone study table";
  if (has(",case,") && has(".mean,")) return "gladstone study points";
  return "";
}

}  // namespace

std::string file_kind(std::string const& path, std::string const& name) {
  constexpr std::array signatures{std::pair{"II*\0"sv, "TIFF"},
                                  std::pair{"MM\0*"sv, "TIFF"},
                                  std::pair{"II+\0"sv, "TIFF"},
                                  std::pair{"MM\0+"sv, "TIFF"},
                                  std::pair{"\x89PNG"sv, "PNG"},
                                  std::pair{"%PDF"sv, "PDF"},
                                  std::pair{"<html"sv, "HTML"},
                                  std::pair{"<!DOCTYPE html"sv, "HTML"},
                                  std::pair{"<!doctype html"sv, "HTML"},
                                  std::pair{"<svg"sv, "SVG"},
                                  std::pair{"<VTKFile"sv, "VTK"},
                                  std::pair{"# vtk DataFile"sv, "VTK"},
                                  std::pair{"NRRD000"sv, "NRRD"},
                                  std::pair{"{"sv, "JSON"},
                                  std::pair{"MATLAB 5.0 MAT-file"sv, "MATLAB"},
                                  std::pair{"\x93NUMPY"sv, "NumPy"}};
  std::string const bytes = first_bytes(path);
  if (bytes.starts_with("\x89HDF\r\n\x1a\n")) return kind_of_hdf5(path);
  if (bytes.starts_with("<?xml")) return kind_of_xml(bytes);
  for (auto const& [signature, kind] : signatures) {
    if (bytes.starts_with(signature)) return kind;
  }
  if (name.ends_with(".toml")) return reads_as_toml(bytes) ? "TOML" : "";
  if (name.ends_with(".md") && bytes.starts_with("# ")) return "Markdown";
  return kind_of_table(bytes);
}

}  // namespace gladstone::inline files
