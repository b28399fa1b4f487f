#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "render/files/fields/readers/vtk_numbers.h"
#include "render/files/fields/readers/vtk_payload.h"
#include "render/files/fields/readers/vtk_source.h"
#include "render/files/fields/value_store.h"
#include "render/files/input_file.h"

namespace gladstone::inline files {

/// One <Piece> of a grid, with the selected array.
struct VtkPiece {
  std::array<int, 6> extent{};  ///< index of the piece's first and last point along i, j and k
  VtkPayload payload;
  VtkNumber number{};
};

/// State needed to load an array later, shared with the loader function of its VtkField.
struct VtkArrays {
  InputFile file;
  std::string name;
  VtkEncoding encoding;
  VtkPlace place = VtkPlace::points;
  std::array<int, 6> whole{};  ///< extent of the whole grid
  std::size_t values = 1;      ///< number of values per node
  std::vector<VtkPiece> pieces;
};

/// Returns the number of points along an axis between the first point of a grid and that of a part of the grid.
std::size_t offset_in(std::array<int, 6> const& part, std::array<int, 6> const& whole, std::size_t axis);

/// The numbers of a piece, in the order of the file.
class VtkPieceNumbers {
 public:
  /// @param name   of the array, for errors
  /// @param count  number of numbers that the grid requires
  /// @throws DataError if the array is damaged or contains another number of values
  VtkPieceNumbers(VtkPiece const& piece, VtkEncoding const& encoding, InputFile const& file, std::string const& name,
                  std::uint64_t count);

  double operator[](std::size_t i) const {
    return is_text_ ? text_[i] : number_.read(bytes_.data() + i * number_.bytes, swap_);
  }

 private:
  VtkNumber number_;
  bool is_text_;
  bool swap_;                 ///< the bytes have the other order than those of this machine
  std::vector<double> text_;  ///< numbers of a piece in text
  std::vector<char> bytes_;   ///< numbers of a piece in binary
};

/// Loads the values of all pieces and assembles them on the whole grid.
/// @throws DataError if the pieces do not cover the grid
ValueStore load_pieces(VtkArrays const& arrays);

}  // namespace gladstone::inline files
