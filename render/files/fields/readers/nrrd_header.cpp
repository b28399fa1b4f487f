#include "render/files/fields/readers/nrrd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/text_file.h"

namespace gladstone {
namespace {

using Type = NrrdHeader::Type;

struct TypeName {
  Type type;
  std::size_t bytes;
  std::vector<std::string> names;
};

std::vector<TypeName> const& type_names() {
  static std::vector<TypeName> const names{
      {Type::int8, 1, {"signed char", "int8", "int8_t"}},
      {Type::uint8, 1, {"uchar", "unsigned char", "uint8", "uint8_t"}},
      {Type::int16, 2, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"}},
      {Type::uint16, 2, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
      {Type::int32, 4, {"int", "signed int", "int32", "int32_t"}},
      {Type::uint32, 4, {"uint", "unsigned int", "uint32", "uint32_t"}},
      {Type::int64,
       8,
       {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"}},
      {Type::uint64, 8, {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"}},
      {Type::float32, 4, {"float"}},
      {Type::float64, 8, {"double"}},
  };
  return names;
}

template <class Number>
std::optional<Number> parsed(std::string const& word) {
  Number value{};
  auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Fields of a header by name, with errors that name the field.
class Fields {
 public:
  explicit Fields(std::string path) : path_(std::move(path)) {}

  /// Reads up to the empty line that ends an attached header, or to the end of a detached one.
  /// @return true if there was an empty line
  bool read(LineReader& file) {
    constexpr std::uint64_t most_bytes = std::uint64_t{16} << 20;
    while (auto const text = file.next()) {
      if (file.offset() > most_bytes)
        throw DataError(path_, "has a header of more than 16 MiB, which no NRRD file has");
      std::string const line = trimmed(*text);
      if (line.empty()) return true;
      if (line.front() == '#' || line.find(":=") != std::string::npos) continue;
      auto const colon = line.find(':');
      if (colon == std::string::npos) {
        throw DataError(path_, "header line \"" + excerpt(line) + "\" is not an NRRD field");
      }
      std::string const key = canonical(trimmed(lower_case(line.substr(0, colon))));
      std::string const value = trimmed(line.substr(colon + 1));
      auto const [given, first] = values_.try_emplace(key, value);
      if (first) {
        lines_[key] = file.number();
      } else if (given->second != value) {
        throw DataError(file.place(),
                        fmt::format("repeats the NRRD field \"{}\" as \"{}\" (line {} says \"{}\"); remove one of them",
                                    excerpt(key), excerpt(value), lines_[key], excerpt(given->second)));
      }
      if (key == "data file" && is_list(value)) {
        read_list(file);
        return false;
      }
    }
    return false;
  }

  /// Returns the names of the data files after "data file: LIST".
  std::vector<std::string> const& listed_files() const { return listed_files_; }
  static bool is_list(std::string const& value) { return value == "LIST" || value.starts_with("LIST "); }

  [[noreturn]] void refuse(std::string const& key, std::string const& why) const {
    auto const found = values_.find(key);
    std::string const value = found == values_.end() ? "" : ": " + excerpt(found->second);
    throw DataError(path_, "NRRD field \"" + key + value + "\" " + why);
  }

  bool has(std::string const& key) const { return values_.count(key) > 0; }

  std::string const& required(std::string const& key) const {
    if (!has(key)) refuse(key, "is missing");
    return values_.at(key);
  }

  std::string text(std::string const& key) const { return has(key) ? values_.at(key) : std::string(); }

  template <class Number>
  Number number(std::string const& key, Number fallback, Number low) const {
    if (!has(key)) return fallback;
    auto const value = parsed<Number>(values_.at(key));
    if (!value || *value < low) refuse(key, "must be a whole number of at least " + std::to_string(low));
    return *value;
  }

  template <class Number>
  std::vector<Number> numbers(std::string const& key, std::size_t count) const {
    std::istringstream words(required(key));
    std::vector<Number> values;
    for (std::string word; words >> word;) {
      auto const value = parsed<Number>(word);
      if (!value) refuse(key, parsed<double>(word) ? "must be whole numbers, of 18 digits at most" : "must be numbers");
      values.push_back(*value);
    }
    if (values.size() != count) refuse(key, fmt::format("must be {} numbers", count));
    return values;
  }

  /// Parses vectors, "(1,0,0) none (0,1,0)"; "none" gives an empty vector.
  std::vector<std::vector<double>> vectors(std::string const& key) const {
    std::vector<std::vector<double>> result;
    std::string const text = required(key);
    for (std::size_t at = 0; at < text.size();) {
      if (text[at] == ' ' || text[at] == '\t') {
        ++at;
        continue;
      }
      if (lower_case(text.substr(at, 4)) == "none") {
        result.emplace_back();
        at += 4;
        continue;
      }
      auto const close = text.find(')', at);
      if (text[at] != '(' || close == std::string::npos) refuse(key, "must be vectors like (1,0,0)");
      std::istringstream parts(text.substr(at + 1, close - at - 1));
      auto& vector = result.emplace_back();
      for (std::string part; std::getline(parts, part, ',');) {
        auto const value = parsed<double>(trimmed(part));
        if (!value) refuse(key, "must be vectors of numbers");
        vector.push_back(*value);
      }
      at = close + 1;
    }
    return result;
  }

 private:
  /// Returns the standard spelling of a field name that has two.
  static std::string canonical(std::string const& key) {
    if (key == "datafile") return "data file";
    if (key == "lineskip") return "line skip";
    if (key == "byteskip") return "byte skip";
    return key;
  }

  void read_list(LineReader& file) {
    while (auto const text = file.next()) {
      std::string const name = trimmed(*text);
      if (name.empty()) return;
      require_room(listed_files_, path_, "data files");
      listed_files_.push_back(name);
    }
  }

  std::string path_;
  std::map<std::string, std::string> values_;
  std::map<std::string, std::size_t> lines_;  ///< number of the line of each field
  std::vector<std::string> listed_files_;
};

void read_type(Fields const& fields, NrrdHeader& header) {
  std::string const name = lower_case(fields.required("type"));
  auto const& all = type_names();
  auto const found = std::find_if(all.begin(), all.end(), [&](TypeName const& type) {
    return std::find(type.names.begin(), type.names.end(), name) != type.names.end();
  });
  if (found == all.end()) fields.refuse("type", "is not a numeric type; write float, double, or an integer type");
  header.type = found->type;
}

void read_encoding(Fields const& fields, NrrdHeader& header) {
  using Encoding = NrrdHeader::Encoding;
  std::string const name = lower_case(fields.required("encoding"));
  static std::map<std::string, Encoding> const known{
      {"raw", Encoding::raw},     {"gzip", Encoding::gzip}, {"gz", Encoding::gzip},
      {"bzip2", Encoding::bzip2}, {"bz2", Encoding::bzip2}, {"ascii", Encoding::ascii},
      {"text", Encoding::ascii},  {"txt", Encoding::ascii}, {"hex", Encoding::hex}};
  auto const found = known.find(name);
  if (found == known.end()) {
    fields.refuse("encoding", "is not supported; write the field in encoding raw, gzip, bzip2, ascii or hex");
  }
  header.encoding = found->second;
  std::string const endian = lower_case(fields.text("endian"));
  bool const matters = header.value_bytes() > 1 && header.encoding != Encoding::ascii;
  if (matters && endian != "little" && endian != "big") fields.refuse("endian", "must be little or big");
  header.big_endian = endian == "big";
}

/// Parses the quoted words of a field, one per axis: "mm" "mm" "???"; "???" gives an empty text.
std::vector<std::string> quoted_words(Fields const& fields, std::string const& key) {
  std::vector<std::string> words;
  std::istringstream text(fields.text(key));
  for (std::string before, word; std::getline(text, before, '"') && std::getline(text, word, '"');) {
    words.push_back(word == "???" ? "" : trimmed(word));
  }
  return words;
}

/// Reads the axes of a header and selects the spatial ones.
class Axes {
 public:
  Axes(Fields const& fields, NrrdHeader& header) : fields_(fields), header_(header) {}

  /// Fills in what the header says of axes.
  void read(int values) {
    header_.values = values;
    read_sizes();
    if (fields_.has("space directions")) {
      directions_ = fields_.vectors("space directions");
      if (directions_.size() != sizes_.size()) fields_.refuse("space directions", "must be one vector for each axis");
    }
    choose(values);
    for (std::size_t i = 0; i < kept_.size(); ++i) header_.sizes[i] = static_cast<int>(sizes_[kept_[i]]);
    header_.dimension = kept_.size();
    header_.units.values = quoted_words(fields_, "sample units").empty()
                               ? trimmed(fields_.text("sample units"))
                               : quoted_words(fields_, "sample units").front();
    if (directions_.empty()) {
      name_by_labels();
      place_along_axes();
    } else {
      place_by_directions();
    }
    convert_lengths(header_.axes, unit_of_, header_.units, header_.notes);
    if (header_.dimension == 2) header_.axes[2].step = std::abs(header_.axes[0].step);
  }

 private:
  void read_sizes() {
    int const dimension = fields_.number<int>("dimension", 0, 1);
    if (dimension > 16) fields_.refuse("dimension", "exceeds 16, the maximum of NRRD");
    sizes_ = fields_.numbers<long long>("sizes", static_cast<std::size_t>(dimension));
    double all = 1;
    for (long long const size : sizes_) {
      if (size < 1) fields_.refuse("sizes", "must be positive");
      if (size > std::numeric_limits<int>::max()) fields_.refuse("sizes", "is larger than any field");
      all *= static_cast<double>(size);
    }
    if (all > 1e15) fields_.refuse("sizes", "is larger than any field");
  }

  /// Selects the spatial axes: drops the axis of components, axes of length one without a direction ("none") and, while
  /// more than three remain, the last axis of length one.
  void choose(int values) {
    for (std::size_t axis = 0; axis < sizes_.size(); ++axis) kept_.push_back(axis);
    if (values > 1) {
      if (sizes_.size() < 3 || sizes_.front() != values) {
        fields_.refuse("sizes", fmt::format("has no first axis of {} components, which a velocity needs", values));
      }
      kept_.erase(kept_.begin());
    }
    std::erase_if(kept_, [this](std::size_t axis) {
      return !directions_.empty() && directions_[axis].empty() && sizes_[axis] == 1;
    });
    while (kept_.size() > 3) {
      auto const single = [this](std::size_t axis) { return sizes_[axis] == 1; };
      auto const last = std::find_if(kept_.rbegin(), kept_.rend(), single);
      if (last == kept_.rend()) break;
      kept_.erase(last.base() - 1);
    }
    if (kept_.size() == 2 || kept_.size() == 3) return;
    fields_.refuse("dimension", fmt::format("must be 2 or 3 ({} at every point), not counting axes of length one",
                                            values == 1 ? "one number" : fmt::format("{} numbers", values)));
  }

  /// Names the world axes by "labels", if they are x, y and z.
  void name_by_labels() {
    auto const labels = quoted_words(fields_, "labels");
    std::string names;  // letters of the axes, fastest first
    for (std::size_t const axis : kept_) {
      std::string const label = axis < labels.size() ? lower_case(labels[axis]) : "";
      if (label.size() == 1) names += label;
    }
    if (names.size() != kept_.size() || !is_axis_order(names)) return;
    name_axes(header_.axes, {names.rbegin(), names.rend()}, kept_.size(), "");
    header_.labelled = true;
  }

  /// Sets the axes from "spacings", or else from "axis mins" and "axis maxs".
  void place_along_axes() {
    auto const all = sizes_.size();
    auto const units = quoted_words(fields_, "units");
    header_.units.spaced = fields_.has("spacings") || fields_.has("axis mins") || fields_.has("axis maxs");
    auto const spacings = fields_.has("spacings") ? fields_.numbers<double>("spacings", all) : std::vector<double>{};
    bool const ends = fields_.has("axis mins") && fields_.has("axis maxs");
    auto const lows = fields_.has("axis mins") ? fields_.numbers<double>("axis mins", all) : std::vector<double>{};
    auto const highs = fields_.has("axis maxs") ? fields_.numbers<double>("axis maxs", all) : std::vector<double>{};
    bool assumed_cells = false;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      std::size_t const axis = kept_[i];
      StoredAxis& placed = header_.axes[i];
      if (sizes_[axis] > 1 && header_.units.spaced) unit_of_[i] = axis < units.size() ? units[axis] : "";
      Centre const centre = centre_of(axis);
      double const cells = static_cast<double>(sizes_[axis]) - (centre == Centre::node ? 1 : 0);
      if (!spacings.empty() && std::isfinite(spacings[axis])) {
        placed.step = spacings[axis];
        placed.stated = true;
      } else if (ends && std::isfinite(lows[axis]) && std::isfinite(highs[axis]) && cells > 0) {
        placed.step = (highs[axis] - lows[axis]) / cells;
        placed.stated = true;
        assumed_cells = assumed_cells || centre == Centre::unknown;
      } else if (header_.units.spaced && sizes_[axis] > 1) {
        bool const infinite = !spacings.empty() && std::isinf(spacings[axis]);
        if (infinite) fields_.refuse("spacings", "must be finite");
        header_.units.unknown = fmt::format("the spacing of axis {} ({} nodes, taken as {}) is unknown in the header",
                                            axis + 1, sizes_[axis], placed.world);
      }
      if (placed.step == 0 || !std::isfinite(placed.step)) {
        fields_.refuse(spacings.empty() ? "axis maxs" : "spacings", "gives an axis zero length; it must not be 0");
      }
      if (!lows.empty() && std::isfinite(lows[axis])) {
        placed.first = lows[axis] + (centre == Centre::node ? 0.0 : placed.step / 2);
      }
    }
    if (assumed_cells) {
      header_.notes.emplace_back(
          "\"axis mins\" and \"axis maxs\" without \"centers\" are taken as the outer faces of cells, as teem does; "
          "if they are the first and last node, write \"centers: node node node\"");
    }
  }

  enum class Centre { node, cell, unknown };
  Centre centre_of(std::size_t axis) const {
    std::istringstream words(lower_case(fields_.text(fields_.has("centers") ? "centers" : "centerings")));
    std::string word;
    for (std::size_t i = 0; i <= axis; ++i) {
      if (!(words >> word)) return Centre::unknown;
    }
    return word == "node" ? Centre::node : word == "cell" ? Centre::cell : Centre::unknown;
  }

  /// Sets the axes from "space directions", vectors parallel to x, y and z in any order and direction.
  void place_by_directions() {
    std::string const key = "space directions";
    auto const units = quoted_words(fields_, "space units");
    auto const origins = fields_.has("space origin") && lower_case(fields_.text("space origin")) != "none"
                             ? fields_.vectors("space origin")
                             : std::vector<std::vector<double>>{};
    if (origins.size() > 1) fields_.refuse("space origin", "must be one vector");
    header_.units.spaced = header_.directed = true;
    std::string taken;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      auto const& direction = directions_[kept_[i]];
      if (direction.size() < 2 || direction.size() > 3) {
        fields_.refuse(key, "must give each axis in space a vector of two or three numbers");
      }
      std::size_t along = 0;
      for (std::size_t k = 0; k < direction.size(); ++k) {
        if (!std::isfinite(direction[k])) fields_.refuse(key, "must be vectors of finite numbers");
        if (std::abs(direction[k]) > std::abs(direction[along])) along = k;
      }
      double const step = direction[along];
      if (step == 0) fields_.refuse(key, "gives an axis zero length");
      for (std::size_t k = 0; k < direction.size(); ++k) {
        constexpr double rounding = 1e-6;  // tolerance of angles [rad]: a millionth of the width of the field
        if (k != along && std::abs(direction[k]) > rounding * std::abs(step)) {
          fields_.refuse(key, "is oblique; resample the field along x, y, z");
        }
      }
      char const world = "xyz"[along];
      if (taken.find(world) != std::string::npos) fields_.refuse(key, "gives two axes the same direction");
      taken += world;
      header_.axes[i].world = world;
      header_.axes[i].step = step;
      header_.axes[i].stated = true;
      if (sizes_[kept_[i]] > 1) unit_of_[i] = along < units.size() ? units[along] : "";
      if (origins.empty()) continue;
      if (origins[0].size() != direction.size())
        fields_.refuse("space origin", "must have as many numbers as a direction");
      if (!std::isfinite(origins[0][along])) fields_.refuse("space origin", "must be finite");
      header_.axes[i].first = origins[0][along];
    }
    if (kept_.size() < 3) {
      std::string rest = "xyz";
      std::erase_if(rest, [&taken](char axis) { return taken.find(axis) != std::string::npos; });
      header_.axes[2].world = rest.front();
    }
  }

  Fields const& fields_;
  NrrdHeader& header_;
  std::vector<long long> sizes_;                       ///< number of nodes of all axes
  std::vector<std::size_t> kept_;                      ///< indices of the spatial axes, fastest first
  std::vector<std::vector<double>> directions_;        ///< direction vectors of all axes; empty: none in the header
  std::array<std::optional<std::string>, 3> unit_of_;  ///< units of the spatial axes; nullopt: a single node
};

}  // namespace

std::size_t NrrdHeader::value_bytes() const {
  auto const& all = type_names();
  return std::find_if(all.begin(), all.end(), [&](TypeName const& name) { return name.type == type; })->bytes;
}

int NrrdHeader::significant_bits() const {
  if (type == Type::float32) return std::numeric_limits<float>::digits;
  if (type == Type::float64) return std::numeric_limits<double>::digits;
  return 8 * static_cast<int>(value_bytes());
}

std::size_t NrrdHeader::plane_bytes() const {
  return value_bytes() * static_cast<std::size_t>(values) * static_cast<std::size_t>(sizes[0]) *
         static_cast<std::size_t>(sizes[1]);
}

std::string NrrdHeader::sizes_text() const {
  std::string text = values == 1 ? "" : std::to_string(values) + " x ";
  text += std::to_string(sizes[0]) + " x " + std::to_string(sizes[1]);
  return dimension == 2 ? text : text + " x " + std::to_string(sizes[2]);
}

NrrdHeader read_nrrd_header(std::string const& path, int values) {
  LineReader file(path, "a field file");
  char magic[7] = {};
  bool const nrrd = InputFile(path).read(0, magic, sizeof magic) == sizeof magic &&
                    std::string_view(magic, sizeof magic) == "NRRD000";
  if (!nrrd) throw DataError(path, "is not a NRRD file (it does not begin with NRRD000)");
  file.next();
  Fields fields(path);
  bool const attached = fields.read(file);

  NrrdHeader header;
  read_type(fields, header);
  read_encoding(fields, header);
  Axes(fields, header).read(values);
  header.content = fields.text("content");
  header.line_skip = fields.number<long>("line skip", 0, 0);
  header.byte_skip = fields.number<long long>("byte skip", 0, -1);
  if (header.byte_skip == -1 && header.encoding != NrrdHeader::Encoding::raw) {
    fields.refuse("byte skip", "requires encoding raw");
  }
  if (!fields.has("data file")) {
    if (!attached)
      throw DataError(path, "has no data: an empty line after the header, or a field \"data file\", is missing");
    header.data_path = path;
    header.data_offset = static_cast<std::size_t>(file.offset());
    return header;
  }
  std::string data = fields.text("data file");
  auto const& listed = fields.listed_files();
  if (Fields::is_list(data) && listed.size() == 1) data = listed.front();
  if (Fields::is_list(data) || data.find('%') != std::string::npos) {
    std::string const which = Fields::is_list(data) ? fmt::format(" ({})", listed.size()) : " by a pattern";
    fields.refuse("data file", "names several files" + which +
                                   "; data in several files are not supported: join them into one file, in the order "
                                   "of the field, and name that");
  }
  if (data.empty()) fields.refuse("data file", "must be a file name");
  header.data_path = (std::filesystem::path(path).parent_path() / data).string();
  return header;
}

}  // namespace gladstone
