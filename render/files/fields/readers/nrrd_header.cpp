#include "render/files/fields/readers/nrrd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <vector>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/fields/readers/nrrd_axes.h"
#include "render/files/fields/readers/nrrd_fields.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
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

void read_type(NrrdFields const& fields, NrrdHeader& header) {
  std::string const name = lower_case(fields.required("type"));
  auto const& all = type_names();
  auto const found = std::find_if(all.begin(), all.end(), [&](TypeName const& type) {
    return std::find(type.names.begin(), type.names.end(), name) != type.names.end();
  });
  if (found == all.end())
    fields.refuse(ErrorCode::wrong_type, "type", "is not a numeric type; write float, double, or an integer type");
  header.type = found->type;
}

void read_encoding(NrrdFields const& fields, NrrdHeader& header) {
  using Encoding = NrrdHeader::Encoding;
  std::string const name = lower_case(fields.required("encoding"));
  static std::map<std::string, Encoding> const known{
      {"raw", Encoding::raw},     {"gzip", Encoding::gzip}, {"gz", Encoding::gzip},
      {"bzip2", Encoding::bzip2}, {"bz2", Encoding::bzip2}, {"ascii", Encoding::ascii},
      {"text", Encoding::ascii},  {"txt", Encoding::ascii}, {"hex", Encoding::hex}};
  auto const found = known.find(name);
  if (found == known.end()) {
    fields.refuse(ErrorCode::unsupported, "encoding",
                  "is not supported; write the field in encoding raw, gzip, bzip2, ascii or hex");
  }
  header.encoding = found->second;
  std::string const endian = lower_case(fields.text("endian"));
  bool const matters = header.value_bytes() > 1 && header.encoding != Encoding::ascii;
  if (matters && endian != "little" && endian != "big")
    fields.refuse(ErrorCode::syntax, "endian", "must be little or big");
  header.big_endian = endian == "big";
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
  if (!nrrd) throw DataError(ErrorCode::wrong_format, path, "is not a NRRD file (it does not begin with NRRD000)");
  file.next();
  NrrdFields fields(path);
  bool const attached = fields.read(file);

  NrrdHeader header;
  read_type(fields, header);
  read_encoding(fields, header);
  header = with_nrrd_axes(std::move(header), fields, values);
  header.content = fields.text("content");
  header.line_skip = fields.number<long>("line skip", 0, 0);
  header.byte_skip = fields.number<long long>("byte skip", 0, -1);
  if (header.byte_skip == -1 && header.encoding != NrrdHeader::Encoding::raw) {
    fields.refuse(ErrorCode::unsupported, "byte skip", "requires encoding raw");
  }
  if (!fields.has("data file")) {
    if (!attached)
      throw DataError(ErrorCode::missing_content, path,
                      "has no data: an empty line after the header, or a field \"data file\", is missing");
    header.data_path = path;
    header.data_offset = static_cast<std::size_t>(file.offset());
    return header;
  }
  std::string data = fields.text("data file");
  auto const& listed = fields.listed_files();
  if (NrrdFields::is_list(data) && listed.size() == 1) data = listed.front();
  if (NrrdFields::is_list(data) || data.find('%') != std::string::npos) {
    std::string const which = NrrdFields::is_list(data) ? fmt::format(" ({})", listed.size()) : " by a pattern";
    fields.refuse(ErrorCode::unsupported, "data file",
                  "names several files" + which +
                      "; data in several files are not supported: join them into one file, in the order "
                      "of the field, and name that");
  }
  if (data.empty()) fields.refuse(ErrorCode::syntax, "data file", "must be a file name");
  header.data_path = (std::filesystem::path(path).parent_path() / data).string();
  return header;
}

}  // namespace gladstone::inline files
