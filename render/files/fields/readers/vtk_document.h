#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "render/base/error.h"
#include "render/files/fields/readers/vtk_payload.h"
#include "render/files/fields/readers/vtk_pieces.h"
#include "render/files/input_file.h"

namespace pugi {
class xml_document;
class xml_node;
}  // namespace pugi

namespace gladstone::inline files {

/// XML tree of a VTK file, without the binary content of <AppendedData>, which remains in the file.
class VtkDocument {
 public:
  /// @param file  must exist as long as this object
  /// @throws DataError for other files, incomplete XML and unknown compressors
  explicit VtkDocument(InputFile const& file);
  ~VtkDocument();

  /// Type of the data set: "ImageData", "PolyData", ...
  std::string const& kind() const { return kind_; }
  VtkEncoding const& encoding() const { return encoding_; }
  bool states_byte_order() const;
  /// Returns the tag of the data set. @throws DataError if there is none
  pugi::xml_node data_set() const;
  /// Reads the type of the numbers of a <DataArray>, and where they are.
  /// @param piece  receives `payload` and `number`
  /// @throws DataError if they are not numeric or have no data
  void read_array(pugi::xml_node tag, VtkPiece& piece) const;

 private:
  [[noreturn]] void refuse(ErrorCode code, std::string const& why) const;
  void read_encoding(pugi::xml_node root);

  InputFile const& file_;
  std::string xml_;                        ///< text that the tree refers to
  std::optional<std::uint64_t> appended_;  ///< offset of the appended data in the file [bytes]
  std::unique_ptr<pugi::xml_document> tree_;
  std::string kind_;
  VtkEncoding encoding_;
  VtkPayload::Format appended_format_ = VtkPayload::Format::base64;
};

/// Reports an attribute that does not contain as many numbers as expected. @throws DataError
[[noreturn]] void refuse_vtk_numbers(std::string const& path, std::string const& attribute, std::string_view text,
                                     std::size_t count);

/// Parses the numbers of an attribute.
/// @param attribute  its tag and name, for the message
/// @throws DataError if there are not exactly `Count` numbers
template <class Number, std::size_t Count>
std::array<Number, Count> parse_vtk_numbers(std::string_view text, std::string const& path,
                                            std::string const& attribute) {
  constexpr std::string_view blanks = " \t\r\n";
  std::array<Number, Count> found{};
  std::size_t count = 0;
  for (std::size_t at = text.find_first_not_of(blanks); at != std::string_view::npos; ++count) {
    Number number{};
    auto const [rest, error] = std::from_chars(text.data() + at, text.data() + text.size(), number);
    if (error != std::errc() || count >= Count) refuse_vtk_numbers(path, attribute, text, Count);
    found[count] = number;
    at = text.find_first_not_of(blanks, static_cast<std::size_t>(rest - text.data()));
  }
  if (count != Count) refuse_vtk_numbers(path, attribute, text, Count);
  return found;
}

}  // namespace gladstone::inline files
