#include "render/files/fields/readers/vtk_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <pugixml.hpp>
#include <utility>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/files/fields/readers/vtk_document.h"
#include "render/files/fields/readers/vtk_source.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

class PointReader {
 public:
  PointReader(std::string const& path, std::string const& wanted) : file_(path, wanted), document_(file_) {
    bool const image = document_.kind() == "ImageData";
    if (!image && document_.kind() != "PolyData")
      refuse(ErrorCode::unsupported,
             fmt::format("holds VTK's \"{}\" (\"ImageData\" and \"PolyData\" are read); save it as .vtp",
                         excerpt(document_.kind())));
    pugi::xml_node const set = document_.data_set();
    std::size_t pieces = 0;
    for (pugi::xml_node const piece : set.children("Piece")) {
      if (image && pieces++ > 0) refuse(ErrorCode::unsupported, "has several pieces; save it as one piece");
      std::size_t const count = image ? add_nodes(set, piece) : add_points(piece);
      add_arrays(piece.child("PointData"), count);
    }
  }
  VtkPoints take() { return std::move(points_); }

 private:
  [[noreturn]] void refuse(ErrorCode code, std::string const& why) const { throw DataError(code, file_.path(), why); }

  /// Adds the nodes of an image, x fastest. @return their number
  std::size_t add_nodes(pugi::xml_node image, pugi::xml_node piece) {
    VtkGrid grid;
    auto const numbers = [&](char const* key) {
      return parse_vtk_numbers<double, 3>(image.attribute(key).as_string(), file_.path(),
                                          std::string("ImageData ") + key);
    };
    grid.extent = parse_vtk_numbers<int, 6>(piece.attribute("Extent").as_string(), file_.path(), "Piece Extent");
    if (image.attribute("Origin")) grid.origin = numbers("Origin");
    if (image.attribute("Spacing")) grid.spacing = numbers("Spacing");
    if (image.attribute("Direction") &&
        parse_vtk_numbers<double, 9>(image.attribute("Direction").as_string(), file_.path(), "ImageData Direction") !=
            grid.direction)
      refuse(ErrorCode::unsupported, "has turned axes (Direction); save it as .vtp");
    check_grid(grid, 3, file_.path());
    std::array<std::size_t, 3> size{};
    for (std::size_t i = 0; i < 3; ++i)
      size[i] = static_cast<std::size_t>(VtkGrid::count(grid.extent, i, VtkPlace::points));
    std::size_t const count = size[0] * size[1] * size[2];
    require_memory(file_.path(), "its points", 3.0 * static_cast<double>(count) * sizeof(double));
    for (std::size_t node = 0; node < count; ++node) {
      std::array<std::size_t, 3> const index{node % size[0], node / size[0] % size[1], node / size[0] / size[1]};
      for (std::size_t i = 0; i < 3; ++i)
        points_.positions.push_back(grid.origin[i] +
                                    (grid.extent[2 * i] + static_cast<double>(index[i])) * grid.spacing[i]);
    }
    return count;
  }

  /// Adds the points of a piece of polygonal data. @return their number
  std::size_t add_points(pugi::xml_node piece) {
    std::uint64_t const count = parse_vtk_numbers<std::uint64_t, 1>(piece.attribute("NumberOfPoints").as_string(),
                                                                    file_.path(), "Piece NumberOfPoints")[0];
    if (count > 0) append(points_.positions, piece.child("Points").child("DataArray"), count, 3);
    return count;
  }

  /// Appends the numbers of an array.
  void append(std::vector<double>& values, pugi::xml_node tag, std::uint64_t points, std::uint64_t components) {
    constexpr double most_numbers = 1e15;
    if (static_cast<double>(points) * static_cast<double>(components) > most_numbers)
      refuse(ErrorCode::damaged, fmt::format("declares {} points; copy it again", points));
    VtkPiece piece;
    document_.read_array(tag, piece);
    std::string const name = tag.attribute("Name").as_string();
    VtkPieceNumbers const numbers(piece, document_.encoding(), file_, name, points * components);
    require_memory(file_.path(), fmt::format("data array \"{}\"", excerpt(name)),
                   static_cast<double>(points * components) * sizeof(double));
    for (std::uint64_t i = 0; i < points * components; ++i) values.push_back(numbers[i]);
  }

  void add_arrays(pugi::xml_node data, std::size_t points) {
    for (pugi::xml_node const tag : data.children("DataArray")) {
      std::string const name = tag.attribute("Name").as_string();
      if (points == 0 || marks_ghosts(name)) continue;
      int const components = tag.attribute("NumberOfComponents").as_int(1);
      if (components < 1) refuse(ErrorCode::damaged, fmt::format("data array \"{}\" has no components", excerpt(name)));
      auto known = std::find_if(points_.arrays.begin(), points_.arrays.end(),
                                [&](VtkPointArray const& one) { return one.name == name; });
      if (known == points_.arrays.end()) {
        points_.arrays.push_back({name, static_cast<std::size_t>(components), {}});
        known = std::prev(points_.arrays.end());
      }
      append(known->values, tag, points, known->components);
    }
  }

  InputFile file_;
  VtkDocument document_;
  VtkPoints points_;
};

}  // namespace

VtkPoints read_vtk_points(std::string const& path, std::string const& wanted) {
  return PointReader(path, wanted).take();
}

}  // namespace gladstone::inline files
