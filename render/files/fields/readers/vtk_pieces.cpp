#include "render/files/fields/readers/vtk_pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "render/base/error.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {

std::size_t offset_in(std::array<int, 6> const& part, std::array<int, 6> const& whole, std::size_t axis) {
  return static_cast<std::size_t>(part[2 * axis] - whole[2 * axis]);
}

VtkPieceNumbers::VtkPieceNumbers(VtkPiece const& piece, VtkEncoding const& encoding, InputFile const& file,
                                 std::string const& name, std::uint64_t count)
    : number_(piece.number),
      is_text_(piece.payload.format == VtkPayload::Format::ascii),
      swap_(encoding.big_endian != (std::endian::native == std::endian::big)) {
  if (is_text_) {
    text_ = decode_text(piece.payload, file, name, count);
  } else {
    bytes_ = decode_bytes(piece.payload, encoding, file, name, count * number_.bytes);
  }
}

ValueStore load_pieces(VtkArrays const& arrays) {
  std::array<std::size_t, 3> all{};
  for (std::size_t i = 0; i < 3; ++i) all[i] = static_cast<std::size_t>(VtkGrid::count(arrays.whole, i, arrays.place));
  int bits = 0;
  for (VtkPiece const& piece : arrays.pieces) bits = std::max(bits, piece.number.significant_bits);
  ValueStore store;
  std::size_t const nodes = all[0] * all[1] * all[2];
  store.allocate(nodes * arrays.values, bits, arrays.file.path(), "data array \"" + excerpt(arrays.name) + '"');
  std::vector<bool> filled(nodes);
  std::size_t missing = nodes;
  for (VtkPiece const& piece : arrays.pieces) {
    std::array<std::size_t, 3> size{}, from{};
    for (std::size_t i = 0; i < 3; ++i) {
      size[i] = static_cast<std::size_t>(VtkGrid::count(piece.extent, i, arrays.place));
      from[i] = offset_in(piece.extent, arrays.whole, i);
    }
    std::uint64_t const count = std::uint64_t{size[0]} * size[1] * size[2] * arrays.values;
    VtkPieceNumbers const numbers(piece, arrays.encoding, arrays.file, arrays.name, count);
    std::size_t next = 0;
    for (std::size_t z = 0; z < size[2]; ++z) {
      for (std::size_t y = 0; y < size[1]; ++y) {
        std::size_t const row = (from[2] + z) * all[1] * all[0] + (from[1] + y) * all[0] + from[0];
        for (std::size_t x = 0; x < size[0]; ++x) {
          if (!filled[row + x]) --missing;
          filled[row + x] = true;
          for (std::size_t k = 0; k < arrays.values; ++k, ++next) {
            store.set((row + x) * arrays.values + k, numbers[next]);
          }
        }
      }
    }
  }
  if (missing > 0) {
    throw DataError(ErrorCode::missing_content, arrays.file.path(),
                    fmt::format("lacks {} of {} values of \"{}\": its pieces do not fill its "
                                "WholeExtent; write it as one piece",
                                missing, nodes, excerpt(arrays.name)));
  }
  return store;
}

}  // namespace gladstone::inline files
