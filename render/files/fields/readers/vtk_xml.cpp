#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <pugixml.hpp>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/nearest_name.h"
#include "render/files/fields/readers/vtk.h"
#include "render/files/fields/readers/vtk_numbers.h"
#include "render/files/fields/readers/vtk_payload.h"
#include "render/files/fields/readers/vtk_pieces.h"
#include "render/files/fields/readers/vtk_source.h"
#include "render/files/text_file.h"

namespace gladstone {
namespace {

constexpr std::string_view appended = "<AppendedData";
constexpr std::size_t read_at_once = std::size_t{1} << 18;

/// XML part of a file, without the binary content of <AppendedData>.
struct Head {
  std::string xml;
  std::optional<std::uint64_t> data;  ///< offset of the appended data in the file [bytes]
};

Head read_head(InputFile const& file) {
  std::string text;
  while (true) {
    throw_if_interrupted();
    std::size_t const before = text.size();
    require_memory(file.path(), "its header", 3.0 * static_cast<double>(before + read_at_once));
    text.resize(before + read_at_once);
    text.resize(before + file.read(before, text.data() + before, read_at_once));
    bool const whole = text.size() < before + read_at_once;
    std::size_t const from = before > appended.size() ? before - appended.size() : 0;
    std::size_t const tag = text.find(appended, from);
    std::size_t const close = tag == std::string::npos ? tag : text.find('>', tag);
    std::size_t const mark = close == std::string::npos ? close : text.find('_', close);
    if (mark != std::string::npos) {
      text.resize(close);
      if (text.back() == '/') text.pop_back();
      return {text + "></AppendedData></VTKFile>", mark + 1};
    }
    if (whole) return {std::move(text), std::nullopt};
  }
}

/// Reader of the XML tree of a file.
class VtkXmlReader {
 public:
  VtkXmlReader(std::string const& path, FieldSelection const& selection)
      : arrays_(std::make_shared<VtkArrays>(VtkArrays{InputFile(path, "a field file"), {}, {}, {}, {}, {}, {}})),
        path_(path),
        selection_(selection),
        head_(read_head(arrays_->file)) {
    arrays_->values = static_cast<std::size_t>(selection.values);
    pugi::xml_document document;
    auto const result = document.load_buffer_inplace(head_.xml.data(), head_.xml.size());
    pugi::xml_node const root = document.child("VTKFile");
    if (!root) refuse(ErrorCode::wrong_format, "is not a VTK file (XML, with a tag <VTKFile>)");
    if (!result) {
      refuse(ErrorCode::damaged,
             fmt::format("is not complete XML ({} at byte {}); copy it again", result.description(), result.offset));
    }
    read_kind(root);
    pugi::xml_node const grid = root.child(kind_.c_str());
    if (!grid) refuse(ErrorCode::damaged, "has no tag <" + kind_ + ">; copy it again");
    read_grid(grid);
    appended_format_ = root.child("AppendedData").attribute("encoding").as_string("base64") == std::string_view("raw")
                           ? VtkPayload::Format::raw
                           : VtkPayload::Format::base64;
    choose(grid);
    read_pieces(grid);
  }

  VtkField field() && {
    int bits = 0;
    for (VtkPiece const& piece : arrays_->pieces) bits = std::max(bits, piece.number.significant_bits);
    return {arrays_->name, arrays_->place, bits, grid_, notes_, [arrays = arrays_] { return load_pieces(*arrays); }};
  }

 private:
  [[noreturn]] void refuse(ErrorCode code, std::string const& why) const { throw DataError(code, path_, why); }

  template <class Number, std::size_t Count>
  std::array<Number, Count> numbers(pugi::xml_node tag, char const* key, std::array<Number, Count> const* fallback) {
    std::string_view const text = tag.attribute(key).as_string();
    if (!tag.attribute(key) && fallback) return *fallback;
    std::array<Number, Count> found{};
    std::size_t count = 0;
    constexpr std::string_view blanks = " \t\r\n";
    for (std::size_t at = text.find_first_not_of(blanks); at != std::string_view::npos; ++count) {
      Number number{};
      auto const [rest, error] = std::from_chars(text.data() + at, text.data() + text.size(), number);
      if (error != std::errc() || count >= Count) {
        count = Count + 1;
        break;
      }
      found[count] = number;
      at = text.find_first_not_of(blanks, static_cast<std::size_t>(rest - text.data()));
    }
    if (count != Count)
      refuse(ErrorCode::syntax, fmt::format("{} {} = \"{}\" is not {} numbers", tag.name(), key, excerpt(text), Count));
    return found;
  }

  void read_kind(pugi::xml_node root) {
    kind_ = root.attribute("type").as_string();
    if (kind_ != "ImageData" && kind_ != "RectilinearGrid") {
      refuse(
          ErrorCode::unsupported,
          fmt::format("holds VTK's \"{}\" (fields on a regular grid are read, \"ImageData\" and \"RectilinearGrid\"); "
                      "resample it to an image",
                      excerpt(kind_)));
    }
    VtkEncoding& encoding = arrays_->encoding;
    encoding.big_endian = root.attribute("byte_order").as_string() == std::string_view("BigEndian");
    encoding.length_bytes = root.attribute("header_type").as_string() == std::string_view("UInt64") ? 8 : 4;
    std::string const compressor = root.attribute("compressor").as_string();
    if (compressor == "vtkZLibDataCompressor") encoding.compressor = VtkEncoding::Compressor::zlib;
    if (compressor == "vtkLZ4DataCompressor") encoding.compressor = VtkEncoding::Compressor::lz4;
    if (compressor == "vtkLZMADataCompressor") encoding.compressor = VtkEncoding::Compressor::lzma;
    if (!compressor.empty() && encoding.compressor == VtkEncoding::Compressor::none) {
      refuse(ErrorCode::unsupported,
             fmt::format("is compressed by \"{}\", which is not supported; use zlib, LZ4, LZMA or none",
                         excerpt(compressor)));
    }
  }

  void read_grid(pugi::xml_node tag) {
    VtkGrid const usual;
    grid_.extent = numbers<int, 6>(tag, "WholeExtent", nullptr);
    if (kind_ == "ImageData") {
      grid_.origin = numbers(tag, "Origin", &usual.origin);
      grid_.spacing = numbers(tag, "Spacing", &usual.spacing);
      grid_.direction = numbers(tag, "Direction", &usual.direction);
    }
    check_grid(grid_, selection_.values, path_);
    arrays_->whole = grid_.extent;
  }

  /// Selects the array, from the first piece that has data.
  void choose(pugi::xml_node grid) {
    std::vector<std::string> names, fitting;
    std::vector<VtkPlace> places;
    std::string components;
    for (pugi::xml_node const piece : grid.children("Piece")) {
      for (VtkPlace const place : {VtkPlace::points, VtkPlace::cells}) {
        for (pugi::xml_node const array : data_of(piece, place).children("DataArray")) {
          std::string const name = array.attribute("Name").as_string();
          if (marks_ghosts(name) && name != selection_.dataset) continue;
          names.push_back(name);
          int const count = array.attribute("NumberOfComponents").as_int(1);
          bool const named = selection_.dataset.empty() || name == selection_.dataset;
          if (named && count != selection_.values) components = std::to_string(count);
          if (!named || count != selection_.values) continue;
          fitting.push_back(name);
          places.push_back(place);
        }
      }
      if (!names.empty()) break;
    }
    if (fitting.empty() && !selection_.dataset.empty() && !components.empty()) {
      refuse(ErrorCode::wrong_shape, fmt::format("data array \"{}\" has {} values per point, but {} are needed",
                                                 excerpt(selection_.dataset), components, selection_.values));
    }
    if (fitting.empty()) refuse(ErrorCode::missing_content, no_such_array(selection_, names));
    if (fitting.size() > 1 && selection_.dataset.empty()) {
      refuse(ErrorCode::undetermined, "has several such fields; select one with dataset = " + quoted_list(names));
    }
    if (fitting.size() > 1) {
      notes_.push_back(fmt::format("\"{}\" exists for points and for cells; that of {} is used", fitting.front(),
                                   places.front() == VtkPlace::points ? "points" : "cells"));
    }
    arrays_->name = fitting.front();
    arrays_->place = places.front();
  }

  static pugi::xml_node data_of(pugi::xml_node piece, VtkPlace place) {
    return piece.child(place == VtkPlace::points ? "PointData" : "CellData");
  }

  void read_pieces(pugi::xml_node grid) {
    bool const rectilinear = kind_ == "RectilinearGrid";
    if (rectilinear) {
      for (std::size_t i = 0; i < 3; ++i) {
        grid_.coordinates[i].resize(static_cast<std::size_t>(VtkGrid::count(grid_.extent, i, VtkPlace::points)),
                                    std::numeric_limits<double>::quiet_NaN());
      }
    }
    for (pugi::xml_node const tag : grid.children("Piece")) {
      VtkPiece piece;
      piece.extent = numbers(tag, "Extent", &grid_.extent);
      bool empty = false;
      for (std::size_t i = 0; i < 3; ++i) {
        empty = empty || piece.extent[2 * i + 1] < piece.extent[2 * i];
      }
      if (empty) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        if (piece.extent[2 * i] >= grid_.extent[2 * i] && piece.extent[2 * i + 1] <= grid_.extent[2 * i + 1]) continue;
        refuse(ErrorCode::damaged, "has a piece that reaches beyond its WholeExtent; write it as one piece");
      }
      pugi::xml_node const array =
          data_of(tag, arrays_->place).find_child_by_attribute("DataArray", "Name", arrays_->name.c_str());
      if (!array)
        refuse(ErrorCode::missing_content,
               fmt::format("lacks \"{}\" in one of its pieces; write it anew", excerpt(arrays_->name)));
      read_array(array, piece);
      arrays_->pieces.push_back(piece);
      if (rectilinear) read_coordinates(tag.child("Coordinates"), piece.extent);
    }
    if (arrays_->pieces.empty()) refuse(ErrorCode::missing_content, "has no piece with data; write it anew");
    bool const ascii = std::all_of(arrays_->pieces.begin(), arrays_->pieces.end(), [](VtkPiece const& piece) {
      return piece.payload.format == VtkPayload::Format::ascii;
    });
    if (!ascii && !grid.parent().attribute("byte_order")) {
      notes_.emplace_back("the file names no byte_order; its numbers are taken as little endian");
    }
  }

  void read_array(pugi::xml_node tag, VtkPiece& piece) {
    std::string_view const type = tag.attribute("type").as_string();
    std::string const name = tag.attribute("Name").as_string();
    auto const* const number =
        std::find_if(vtk_numbers.begin(), vtk_numbers.end(), [type](VtkNumber const& one) { return one.xml == type; });
    if (number == vtk_numbers.end()) {
      refuse(ErrorCode::wrong_type,
             fmt::format("data array \"{}\" is of type \"{}\", which is not numeric", excerpt(name), excerpt(type)));
    }
    piece.number = *number;
    VtkPayload& payload = piece.payload;
    std::string_view const format = tag.attribute("format").as_string("ascii");
    payload.appended = format == "appended";
    if (payload.appended) {
      if (!head_.data)
        refuse(ErrorCode::damaged, fmt::format("data array \"{}\" has no data; copy it again", excerpt(name)));
      payload.format = appended_format_;
      payload.offset = *head_.data + numbers<std::uint64_t, 1>(tag, "offset", nullptr)[0];
      if (payload.offset < *head_.data) refuse(ErrorCode::damaged, "has an impossible offset; copy it again");
      return;
    }
    payload.format = format == "ascii" ? VtkPayload::Format::ascii : VtkPayload::Format::base64;
    // comments divide the text into several nodes
    for (pugi::xml_node const text : tag.children()) payload.text += text.value();
  }

  /// Copies the coordinates of a piece into those of the whole grid.
  void read_coordinates(pugi::xml_node tag, std::array<int, 6> const& extent) {
    std::size_t axis = 0;
    for (pugi::xml_node const array : tag.children("DataArray")) {
      if (axis == 3) break;
      VtkPiece one;
      read_array(array, one);
      std::size_t const count = static_cast<std::size_t>(VtkGrid::count(extent, axis, VtkPlace::points));
      std::string const name = fmt::format("coordinates along {}", "xyz"[axis]);
      VtkPieceNumbers const numbers(one, arrays_->encoding, arrays_->file, name, count);
      auto const from = static_cast<std::ptrdiff_t>(offset_in(extent, grid_.extent, axis));
      auto place = grid_.coordinates[axis].begin() + from;
      for (std::size_t i = 0; i < count; ++i) *place++ = numbers[i];
      ++axis;
    }
    if (axis < 3) refuse(ErrorCode::wrong_shape, "does not have three arrays in <Coordinates>; write it anew");
  }

  std::shared_ptr<VtkArrays> arrays_;
  std::string path_;
  FieldSelection const& selection_;
  Head head_;
  std::string kind_;
  VtkGrid grid_;
  VtkPayload::Format appended_format_ = VtkPayload::Format::base64;
  std::vector<std::string> notes_;
};

}  // namespace

std::unique_ptr<CheckedSource> open_vtk_xml(std::string const& path, FieldSelection const& selection) {
  return make_vtk_source(path, VtkXmlReader(path, selection).field(), selection);
}

}  // namespace gladstone
