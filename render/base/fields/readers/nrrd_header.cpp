#include "render/base/fields/readers/nrrd_header.h"

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
#include "render/base/text_file.h"

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

std::string trimmed(std::string const& text) {
  auto const first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

template <class Number>
std::optional<Number> parsed(std::string const& word) {
  Number value{};
  auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The fields of a header, and the refusals that name them.
class Fields {
 public:
  explicit Fields(std::string path) : path_(std::move(path)) {}

  /// Reads up to the empty line that ends an attached header, or the end of a detached one.
  /// @return whether the empty line was there
  bool read(LineReader& file) {
    constexpr std::uint64_t most_bytes = std::uint64_t{16} << 20;
    while (auto const text = file.next()) {
      if (file.offset() > most_bytes) throw DataError(path_, "has a header of more than 16 MiB, as no NRRD file has");
      std::string const line = trimmed(std::string(*text));
      if (line.empty()) return true;
      if (line.front() == '#' || line.find(":=") != std::string::npos) continue;
      auto const colon = line.find(": ");
      if (colon == std::string::npos && line.back() != ':') {
        throw DataError(path_, "header line \"" + excerpt(line) + "\" is no NRRD field");
      }
      std::string const key = lower(line.substr(0, std::min(colon, line.size() - 1)));
      values_[canonical(key)] = colon == std::string::npos ? std::string() : trimmed(line.substr(colon + 2));
    }
    return false;
  }

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

  /// "(1,0,0) (0,1,0)" as vectors.
  std::vector<std::vector<double>> vectors(std::string const& key) const {
    std::vector<std::vector<double>> result;
    std::string const text = required(key);
    for (std::size_t at = 0; at < text.size();) {
      if (text[at] == ' ') {
        ++at;
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
  /// Two spellings exist of some fields.
  static std::string canonical(std::string const& key) {
    if (key == "datafile") return "data file";
    if (key == "lineskip") return "line skip";
    if (key == "byteskip") return "byte skip";
    return key;
  }

  std::string path_;
  std::map<std::string, std::string> values_;
};

void read_type(Fields const& fields, NrrdHeader& header) {
  std::string const name = lower(fields.required("type"));
  auto const& all = type_names();
  auto const found = std::find_if(all.begin(), all.end(), [&](TypeName const& type) {
    return std::find(type.names.begin(), type.names.end(), name) != type.names.end();
  });
  if (found == all.end()) fields.refuse("type", "is no type of numbers; write float, double, or an integer type");
  header.type = found->type;
  std::string const endian = lower(fields.text("endian"));
  if (found->bytes > 1 && endian != "little" && endian != "big") fields.refuse("endian", "must be little or big");
  header.big_endian = endian == "big";
}

void read_encoding(Fields const& fields, NrrdHeader& header) {
  std::string const name = lower(fields.required("encoding"));
  if (name == "raw") {
    header.encoding = NrrdHeader::Encoding::raw;
  } else if (name == "gzip" || name == "gz") {
    header.encoding = NrrdHeader::Encoding::gzip;
  } else {
    fields.refuse("encoding", "is not read here; write the field in encoding raw or gzip");
  }
}

std::size_t read_sizes(Fields const& fields, NrrdHeader& header) {
  int const dimension = fields.number<int>("dimension", 0, 1);
  if (dimension != 2 && dimension != 3) fields.refuse("dimension", "must be 2 or 3 (one number at every point)");
  auto const sizes = fields.numbers<long long>("sizes", static_cast<std::size_t>(dimension));
  for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
    if (sizes[axis] < 1) fields.refuse("sizes", "must be positive");
    if (sizes[axis] > std::numeric_limits<int>::max()) fields.refuse("sizes", "is larger than any field");
    header.sizes[axis] = static_cast<int>(sizes[axis]);
  }
  if (static_cast<double>(header.sizes[0]) * header.sizes[1] * header.sizes[2] > 1e15) {
    fields.refuse("sizes", "is larger than any field");
  }
  return static_cast<std::size_t>(dimension);
}

/// The unit that a field of quoted units, one an axis, names for all of them; empty where it names none.
std::string one_unit(Fields const& fields, std::string const& key) {
  std::string unit;
  std::istringstream text(fields.text(key));
  for (std::string before, word; std::getline(text, before, '"') && std::getline(text, word, '"');) {
    if (word.empty() || word == unit) continue;
    if (!unit.empty()) fields.refuse(key, "must name one unit for all axes");
    unit = word;
  }
  return unit;
}

void read_axes(Fields const& fields, std::size_t dimension, NrrdHeader& header) {
  if (fields.has("space directions")) {
    auto const directions = fields.vectors("space directions");
    if (directions.size() != dimension) fields.refuse("space directions", "must be one vector for each axis");
    for (std::size_t axis = 0; axis < dimension; ++axis) {
      if (directions[axis].size() <= axis) fields.refuse("space directions", "has too short a vector");
      for (std::size_t component = 0; component < directions[axis].size(); ++component) {
        bool const off_axis = component != axis && directions[axis][component] != 0.0;
        if (off_axis) fields.refuse("space directions", "is oblique; resample the field along x, y, z");
      }
      header.spacing[axis] = directions[axis][axis];
    }
  } else if (fields.has("spacings")) {
    auto const spacings = fields.numbers<double>("spacings", dimension);
    for (std::size_t axis = 0; axis < dimension; ++axis) {
      if (!std::isnan(spacings[axis])) header.spacing[axis] = spacings[axis];  // nan: not known
    }
  } else if (fields.has("axis mins") || fields.has("axis maxs")) {
    fields.refuse(fields.has("axis mins") ? "axis mins" : "axis maxs", "is not read here; write spacings instead");
  }
  std::string const key = fields.has("space directions") ? "space directions" : "spacings";
  header.units.spaced = fields.has(key);
  header.units.length = one_unit(fields, fields.has("space directions") ? "space units" : "units");
  header.units.values = one_unit(fields, "sample units");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bool const usable = std::isfinite(header.spacing[axis]) && header.spacing[axis] > 0.0;
    if (!usable) fields.refuse(key, "must give positive spacings; turn an axis that runs backwards round");
  }
  if (dimension == 2) header.spacing[2] = header.spacing[0];
  if (!fields.has("space origin")) return;
  auto const origin = fields.vectors("space origin");
  if (origin.size() != 1 || origin[0].size() < dimension || origin[0].size() > 3) {
    fields.refuse("space origin", "must be one vector");
  }
  for (std::size_t axis = 0; axis < origin[0].size(); ++axis) {
    if (!std::isfinite(origin[0][axis])) fields.refuse("space origin", "must be finite");
    header.origin[axis] = origin[0][axis];
  }
}

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
  return value_bytes() * static_cast<std::size_t>(sizes[0]) * static_cast<std::size_t>(sizes[1]);
}

NrrdHeader read_nrrd_header(std::string const& path) {
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
  read_axes(fields, read_sizes(fields, header), header);
  header.content = fields.text("content");
  header.line_skip = fields.number<long>("line skip", 0, 0);
  header.byte_skip = fields.number<long long>("byte skip", 0, -1);
  if (header.byte_skip == -1 && header.encoding != NrrdHeader::Encoding::raw) {
    fields.refuse("byte skip", "goes with encoding raw only");
  }
  if (!fields.has("data file")) {
    if (!attached)
      throw DataError(path, "has no data: an empty line after the header, or a field \"data file\", is missing");
    header.data_path = path;
    header.data_offset = static_cast<std::size_t>(file.offset());
    return header;
  }
  std::string const data = fields.text("data file");
  bool const several = data == "LIST" || data.starts_with("LIST ") || data.find('%') != std::string::npos;
  if (several) fields.refuse("data file", "names several files; join them into one");
  if (data.empty()) fields.refuse("data file", "must be a file name");
  header.data_path = (std::filesystem::path(path).parent_path() / data).string();
  return header;
}

}  // namespace gladstone
