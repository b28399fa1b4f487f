#include "render/files/fields/readers/vtk_legacy_array.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/fields/readers/word_cursor.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

/// Reads numbers written as text into `values`.
void load_text(InputFile const& file, VtkLegacyArray const& array, ValueStore& values) {
  WordCursor cursor(file);
  cursor.go_to(array.begin);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::string const word = cursor.word();
    double value = 0;
    std::size_t const sign = word.starts_with('+') ? 1 : 0;
    if (std::from_chars(word.data() + sign, word.data() + word.size(), value).ec == std::errc::invalid_argument) {
      throw DataError(ErrorCode::damaged, file.path(),
                      fmt::format("data array \"{}\" is damaged ({} of {} numbers are present); copy it again",
                                  excerpt(array.name), i, values.size()));
    }
    values.set(i, value);
  }
}

/// Reads numbers in binary into `values`.
void load_binary(InputFile const& file, VtkLegacyArray const& array, ValueStore& values) {
  bool const swap = std::endian::native == std::endian::little;  // legacy files are big-endian
  std::vector<char> bytes(std::min<std::size_t>(values.size(), 1 << 16) * array.number.bytes);
  for (std::size_t done = 0; done < values.size();) {
    throw_if_interrupted();
    std::size_t const part = std::min(values.size() - done, bytes.size() / array.number.bytes);
    std::size_t const size = part * array.number.bytes;
    if (file.read(array.begin + done * array.number.bytes, bytes.data(), size) < size) refuse_incomplete(file, array);
    for (std::size_t i = 0; i < part; ++i) {
      values.set(done + i, array.number.read(bytes.data() + i * array.number.bytes, swap));
    }
    done += part;
  }
}

}  // namespace

ValueStore load_legacy_array(InputFile const& file, VtkLegacyArray const& array, bool text) {
  ValueStore values;
  values.allocate(array.values(), array.number.significant_bits, file.path(),
                  "data array \"" + excerpt(array.name) + '"');
  if (text) {
    load_text(file, array, values);
  } else {
    load_binary(file, array, values);
  }
  return values;
}

void refuse_incomplete(InputFile const& file, VtkLegacyArray const& array) {
  throw DataError(ErrorCode::damaged, file.path(),
                  fmt::format("is cut short: data array \"{}\" is incomplete; copy it again", excerpt(array.name)));
}

}  // namespace gladstone::inline files
