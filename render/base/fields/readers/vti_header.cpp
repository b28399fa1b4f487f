#include "render/base/fields/readers/vti_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/nearest_name.h"
#include "render/base/text_file.h"

namespace gladstone {
namespace {

constexpr std::string_view appended = "<AppendedData";
constexpr std::size_t read_at_once = std::size_t{1} << 18;

/// One <Tag key="value">, and where what it holds begins.
struct Tag {
  std::string_view name;
  std::map<std::string_view, std::string_view> keys;
  std::size_t end = 0;  ///< behind its >

  std::string text(std::string_view key, std::string const& fallback = "") const {
    auto const found = keys.find(key);
    return found == keys.end() ? fallback : std::string(found->second);
  }
};

constexpr std::string_view blanks = " \t\r\n";

/// The next tag that opens something, from a place of the text on.
std::optional<Tag> next_tag(std::string_view text, std::size_t at) {
  while (true) {
    std::size_t const begin = text.find('<', at);
    std::size_t const end = begin == std::string_view::npos ? begin : text.find('>', begin);
    if (end == std::string_view::npos) return std::nullopt;
    at = end + 1;
    if (std::string_view("/!?").find(text[begin + 1]) != std::string_view::npos) continue;
    std::string_view inside = text.substr(begin + 1, end - begin - 1);
    Tag tag;
    tag.end = end + 1;
    tag.name = inside.substr(0, inside.find_first_of(" \t\r\n/"));
    inside.remove_prefix(tag.name.size());
    while (true) {
      std::size_t const key = inside.find_first_not_of(blanks), equals = inside.find('=');
      if (key == std::string_view::npos || equals == std::string_view::npos || equals < key) break;
      std::size_t const open = inside.find_first_of("\"'", equals);
      std::size_t const close = open == std::string_view::npos ? open : inside.find(inside[open], open + 1);
      if (close == std::string_view::npos) break;
      std::string_view const name = inside.substr(key, equals - key);
      std::size_t const last = name.find_last_not_of(blanks);
      tag.keys[name.substr(0, last + 1)] = inside.substr(open + 1, close - open - 1);
      inside.remove_prefix(close + 1);
    }
    return tag;
  }
}

/// The file up to its appended data, or all of it where there are none.
std::string head_of(InputFile const& file) {
  std::string text;
  while (true) {
    throw_if_interrupted();
    std::size_t const before = text.size();
    require_memory(file.path(), "its header", 2.0 * static_cast<double>(before + read_at_once));
    text.resize(before + read_at_once);
    text.resize(before + file.read(before, text.data() + before, read_at_once));
    std::size_t const from = before > appended.size() ? before - appended.size() : 0;
    std::size_t const found = text.find(appended, from);
    if (found != std::string::npos && text.find('_', found) != std::string::npos) return text;
    if (text.size() < before + read_at_once) return text;
  }
}

/// Reads a file's tags one after the other.
class VtiReader {
 public:
  VtiReader(InputFile const& file, std::string const& dataset, int components)
      : path_(file.path()), text_(head_of(file)), dataset_(dataset), components_(components) {
    bool points = false;
    for (std::optional<Tag> tag = next_tag(text_, 0); tag; tag = next_tag(text_, tag->end)) {
      if (tag->name == "VTKFile") read_kind(*tag);
      if (tag->name == "ImageData") read_grid(*tag);
      if (tag->name == "Piece") read_piece(*tag);
      if (tag->name == "PointData") points = true;
      if (tag->name == "CellData") points = false;
      if (tag->name == "DataArray" && points) read_array(*tag);
      if (tag->name == "AppendedData") read_appended(*tag);
      if (tag->name == "AppendedData") break;
    }
    finish();
  }
  VtiHeader header() const { return header_; }

 private:
  [[noreturn]] void refuse(std::string const& why) const { throw DataError(path_, why); }

  template <class Number>
  std::vector<Number> numbers(Tag const& tag, std::string_view key, std::size_t count, std::string const& fallback) {
    std::string const text = tag.text(key, fallback);
    std::vector<Number> found;
    for (std::size_t at = text.find_first_not_of(blanks); at != std::string::npos;) {
      Number number{};
      auto const [rest, error] = std::from_chars(text.data() + at, text.data() + text.size(), number);
      if (error != std::errc()) break;
      found.push_back(number);
      at = text.find_first_not_of(blanks, static_cast<std::size_t>(rest - text.data()));
    }
    if (found.size() != count) {
      refuse(fmt::format("{} {} = \"{}\" is not {} numbers", tag.name, key, excerpt(text), count));
    }
    return found;
  }

  void read_kind(Tag const& tag) {
    if (tag.text("type") != "ImageData") {
      refuse(fmt::format("holds VTK's \"{}\" (fields on a regular grid are read, type \"ImageData\"); resample it",
                         excerpt(tag.text("type"))));
    }
    header_.big_endian = tag.text("byte_order") == "BigEndian";
    header_.size_bytes = tag.text("header_type", "UInt32") == "UInt64" ? 8 : 4;
    std::string const compressor = tag.text("compressor");
    header_.compressed = !compressor.empty();
    if (header_.compressed && compressor != "vtkZLibDataCompressor") {
      refuse(fmt::format("is compressed by \"{}\", which is not read here; use zlib, or none", excerpt(compressor)));
    }
  }

  void read_grid(Tag const& tag) {
    extent_ = numbers<int>(tag, "WholeExtent", 6, "");
    auto const origin = numbers<double>(tag, "Origin", 3, "0 0 0"),
               spacing = numbers<double>(tag, "Spacing", 3, "1 1 1");
    auto const turned = numbers<double>(tag, "Direction", 9, "1 0 0 0 1 0 0 0 1");
    if (turned != std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}) {
      refuse("has turned axes (Direction), which are not read here; resample it along X, Y and Z");
    }
    double values = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double const nodes = 1.0 + extent_[2 * axis + 1] - extent_[2 * axis];
      bool const usable = nodes >= 1 && nodes <= std::numeric_limits<int>::max();
      if (!usable || !std::isfinite(origin[axis]) || !(spacing[axis] > 0 && std::isfinite(spacing[axis]))) {
        refuse("has no usable grid (WholeExtent must ascend, Spacing must be positive)");
      }
      header_.nodes[axis] = static_cast<int>(nodes);
      header_.spacing[static_cast<int>(axis)] = spacing[axis];
      header_.origin[static_cast<int>(axis)] = origin[axis] + spacing[axis] * extent_[2 * axis];
      values *= nodes;
    }
    if (values * components_ * sizeof(double) > 1e15) refuse("has a grid larger than any field");
  }

  void read_piece(Tag const& tag) {
    if (numbers<int>(tag, "Extent", 6, "") != extent_) {
      refuse("is in several pieces, which are not read here; write it as one");
    }
  }

  void read_array(Tag const& tag) {
    std::string const name = tag.text("Name");
    names_.push_back(name);
    bool const fits = tag.text("NumberOfComponents", "1") == std::to_string(components_);
    if (dataset_.empty() ? !fits : name != dataset_) return;
    if (!fits) {
      refuse(fmt::format("data array \"{}\" holds {} values a point where {} are needed", excerpt(name),
                         excerpt(tag.text("NumberOfComponents", "1")), components_));
    }
    if (++found_ > 1) refuse("has several such fields; say which with dataset = " + quoted_list(names_));
    header_.name = name;
    header_.type = tag.text("type");
    std::string const format = tag.text("format", "ascii");
    header_.format = format == "ascii" ? VtiFormat::ascii : VtiFormat::base64;
    in_place_ = format != "appended";
    header_.begin =
        in_place_ ? text_.find_first_not_of(blanks, tag.end) : numbers<std::uint64_t>(tag, "offset", 1, "")[0];
    header_.end = text_.find('<', tag.end);
  }

  void read_appended(Tag const& tag) {
    if (found_ == 0 || in_place_) return;
    header_.format = tag.text("encoding") == "raw" ? VtiFormat::raw : VtiFormat::base64;
    std::size_t const mark = text_.find('_', tag.end);
    if (mark == std::string::npos) refuse("has no data behind <AppendedData>; copy it again");
    header_.begin += mark + 1;
    appended_ = true;
  }

  void finish() const {
    if (extent_.empty()) refuse("is no VTK image (XML, type \"ImageData\")");
    if (found_ == 0) {
      std::string const wanted = components_ == 1 ? "scalar field" : fmt::format("field of {} components", components_);
      refuse(fmt::format("has no {}{} among its PointData{}", wanted, dataset_.empty() ? "" : " \"" + dataset_ + '"',
                         names_.empty() ? "" : ", which are " + quoted_list(names_)));
    }
    bool const there = in_place_ ? header_.begin < header_.end && header_.end < text_.size() : appended_;
    if (!there) refuse(fmt::format("data array \"{}\" has no data; copy it again", excerpt(header_.name)));
  }

  std::string path_, text_;
  std::string const& dataset_;
  int components_;
  VtiHeader header_;
  std::vector<int> extent_;
  std::vector<std::string> names_;
  int found_ = 0;
  bool in_place_ = false, appended_ = false;
};

}  // namespace

VtiHeader read_vti_header(InputFile const& file, std::string const& dataset, int components) {
  return VtiReader(file, dataset, components).header();
}

}  // namespace gladstone
