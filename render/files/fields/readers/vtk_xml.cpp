#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <pugixml.hpp>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/files/fields/readers/vtk.h"
#include "render/files/fields/readers/vtk_document.h"
#include "render/files/fields/readers/vtk_payload.h"
#include "render/files/fields/readers/vtk_pieces.h"
#include "render/files/fields/readers/vtk_source.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

/// Reader of the XML tree of a file.
class VtkXmlReader {
 public:
  VtkXmlReader(std::string const& path, FieldSelection const& selection)
      : arrays_(std::make_shared<VtkArrays>(VtkArrays{InputFile(path, "a field file"), {}, {}, {}, {}, {}, {}})),
        path_(path),
        selection_(selection),
        document_(arrays_->file) {
    arrays_->values = static_cast<std::size_t>(selection.values);
    std::string const& kind = document_.kind();
    if (kind != "ImageData" && kind != "RectilinearGrid") {
      refuse(
          ErrorCode::unsupported,
          fmt::format("holds VTK's \"{}\" (fields on a regular grid are read, \"ImageData\" and \"RectilinearGrid\"); "
                      "resample it to an image",
                      excerpt(kind)));
    }
    arrays_->encoding = document_.encoding();
    pugi::xml_node const grid = document_.data_set();
    read_grid(grid);
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
    if (!tag.attribute(key) && fallback) return *fallback;
    return parse_vtk_numbers<Number, Count>(tag.attribute(key).as_string(), path_,
                                            fmt::format("{} {}", tag.name(), key));
  }

  void read_grid(pugi::xml_node tag) {
    VtkGrid const usual;
    grid_.extent = numbers<int, 6>(tag, "WholeExtent", nullptr);
    if (document_.kind() == "ImageData") {
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
      notes_.push_back({WarningCode::assumed, "",
                        fmt::format("\"{}\" exists for points and for cells; that of {} is used", fitting.front(),
                                    places.front() == VtkPlace::points ? "points" : "cells")});
    }
    arrays_->name = fitting.front();
    arrays_->place = places.front();
  }

  static pugi::xml_node data_of(pugi::xml_node piece, VtkPlace place) {
    return piece.child(place == VtkPlace::points ? "PointData" : "CellData");
  }

  void read_pieces(pugi::xml_node grid) {
    bool const rectilinear = document_.kind() == "RectilinearGrid";
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
      document_.read_array(array, piece);
      arrays_->pieces.push_back(piece);
      if (rectilinear) read_coordinates(tag.child("Coordinates"), piece.extent);
    }
    if (arrays_->pieces.empty()) refuse(ErrorCode::missing_content, "has no piece with data; write it anew");
    bool const ascii = std::all_of(arrays_->pieces.begin(), arrays_->pieces.end(), [](VtkPiece const& piece) {
      return piece.payload.format == VtkPayload::Format::ascii;
    });
    if (!ascii && !document_.states_byte_order()) {
      notes_.push_back(
          {WarningCode::assumed, "", "the file names no byte_order; its numbers are taken as little endian"});
    }
  }

  /// Copies the coordinates of a piece into those of the whole grid.
  void read_coordinates(pugi::xml_node tag, std::array<int, 6> const& extent) {
    std::size_t axis = 0;
    for (pugi::xml_node const array : tag.children("DataArray")) {
      if (axis == 3) break;
      VtkPiece one;
      document_.read_array(array, one);
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
  VtkDocument document_;
  VtkGrid grid_;
  Warnings notes_;
};

}  // namespace

std::unique_ptr<CheckedSource> open_vtk_xml(std::string const& path, FieldSelection const& selection) {
  return make_vtk_source(path, VtkXmlReader(path, selection).field(), selection);
}

}  // namespace gladstone::inline files
