#include "render/files/fields/readers/nrrd.h"

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>

#include "render/base/error.h"
#include "render/files/fields/readers/checked_source.h"
#include "render/files/fields/readers/nrrd_bytes.h"
#include "render/files/fields/readers/nrrd_header.h"

namespace gladstone::inline files {
namespace {

template <class Stored>
void convert(std::vector<char> const& bytes, bool swap, std::span<double> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    std::array<char, sizeof(Stored)> value;
    std::copy_n(bytes.data() + i * sizeof(Stored), sizeof(Stored), value.data());
    if (swap) std::reverse(value.begin(), value.end());
    out[i] = static_cast<double>(std::bit_cast<Stored>(value));
  }
}

void convert(NrrdHeader::Type type, std::vector<char> const& bytes, bool swap, std::span<double> out) {
  using Type = NrrdHeader::Type;
  switch (type) {
    case Type::int8:
      return convert<std::int8_t>(bytes, swap, out);
    case Type::uint8:
      return convert<std::uint8_t>(bytes, swap, out);
    case Type::int16:
      return convert<std::int16_t>(bytes, swap, out);
    case Type::uint16:
      return convert<std::uint16_t>(bytes, swap, out);
    case Type::int32:
      return convert<std::int32_t>(bytes, swap, out);
    case Type::uint32:
      return convert<std::uint32_t>(bytes, swap, out);
    case Type::int64:
      return convert<std::int64_t>(bytes, swap, out);
    case Type::uint64:
      return convert<std::uint64_t>(bytes, swap, out);
    case Type::float32:
      return convert<float>(bytes, swap, out);
    case Type::float64:
      return convert<double>(bytes, swap, out);
  }
}

class NrrdSource final : public CheckedSource {
 public:
  NrrdSource(std::string const& path, NrrdHeader header, FieldSelection const& selection)
      : CheckedSource(path, header.content.empty() ? std::filesystem::path(path).filename().string() : header.content,
                      selection.values),
        header_(std::move(header)),
        bytes_(header_) {
    units_ = header_.units;
    notes_ = header_.notes;
    axes_ = header_.axes;
    name_axes(axes_, selection.axes, header_.dimension, path);
    describe(header_.sizes, header_.dimension,
             !selection.axes.empty() ? "axes = \"" + selection.axes + '"'
             : header_.directed      ? "by its space directions"
             : header_.labelled      ? "by its labels"
                                     : "the default order");
  }

 private:
  int significant_bits() const override { return header_.significant_bits(); }

  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    bool const text = header_.encoding == NrrdHeader::Encoding::ascii;  // text is decoded to doubles
    std::size_t const bytes = text ? sizeof(double) : header_.value_bytes();
    std::size_t const row = row_values() * bytes;
    std::size_t const first = row * (static_cast<std::size_t>(plane) * static_cast<std::size_t>(nodes_[1]) +
                                     static_cast<std::size_t>(first_row));
    bool const swap = !text && header_.big_endian != (std::endian::native == std::endian::big);
    stored_.resize(row * static_cast<std::size_t>(count));
    bytes_.read(first, stored_.data(), stored_.size());
    convert(text ? NrrdHeader::Type::float64 : header_.type, stored_, swap, out);
  }

  NrrdHeader header_;
  NrrdBytes bytes_;
  std::vector<char> stored_;  ///< bytes of rows before conversion to double, reused between calls
};

}  // namespace

std::unique_ptr<CheckedSource> open_nrrd(std::string const& path, FieldSelection const& selection) {
  if (!selection.dataset.empty()) {
    throw DataError(ErrorCode::missing_content, path,
                    "contains a single unnamed field; remove dataset = \"" + selection.dataset + "\"");
  }
  return std::make_unique<NrrdSource>(path, read_nrrd_header(path, selection.values), selection);
}

}  // namespace gladstone::inline files
