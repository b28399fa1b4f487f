#include "analysis/vectors/vector_conventions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/vectors/vector_file.h"
#include "render/base/error.h"

namespace gladstone::inline vectors {
namespace {

using Exchange = VectorConventions::Exchange;
using Mirror = VectorConventions::Mirror;

/// Words for exchanged columns; Exchange::none has no word.
constexpr std::array<std::pair<Exchange, std::string_view>, 4> exchange_words{
    {{Exchange::none, ""},
     {Exchange::places, "places-exchanged"},
     {Exchange::components, "components-exchanged"},
     {Exchange::axes, "axes-exchanged"}}};

/// Parses the number in NAME=NUMBER. @throws DataError
double number_of(std::string_view word) {
  std::size_t const equals = word.find('=');
  std::string_view const text = word.substr(equals + 1);
  double number = 0.0;
  auto const [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc{} && stop == text.data() + text.size() && std::isfinite(number)) return number;
  throw DataError(ErrorCode::arguments, "--conventions",
                  fmt::format("{} is not {}=NUMBER, such as {}={}", word, word.substr(0, equals),
                              word.substr(0, equals), word.starts_with("offset") ? "-0.5" : "0.0614"));
}

/// Parses a positive number. @throws DataError
double scale_of(std::string_view word) {
  double const scale = number_of(word);
  if (scale > 0.0) return scale;
  throw DataError(ErrorCode::arguments, "--conventions",
                  fmt::format("{} is not above 0; give the size of a pixel in the unit of the file", word));
}

}  // namespace

VectorConventions parse_conventions(std::string_view text, VectorConventions from) {
  VectorConventions conventions = from;
  while (!text.empty()) {
    std::size_t const end = std::min(text.find(','), text.size());
    std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    auto const* const exchange = std::find_if(exchange_words.begin() + 1, exchange_words.end(),
                                              [&](auto const& known) { return known.second == word; });
    if (word == "y-down") {
      conventions.y_up = false;
    } else if (word == "y-up") {
      conventions.y_up = true;
      conventions.mirror = Mirror::grid;
    } else if (word == "y-up-image") {
      conventions.y_up = true;
      conventions.mirror = Mirror::image;
    } else if (word == "v-down" || word == "v-up") {
      conventions.v_up = word == "v-up";
    } else if (word == "frames-exchanged" || word == "swapped") {
      conventions.swapped = true;
    } else if (exchange != exchange_words.end()) {
      conventions.exchange = exchange->first;
    } else if (word.starts_with("offset=")) {
      conventions.offset_px = number_of(word);
    } else if (word.starts_with("px=")) {
      conventions.px = scale_of(word);
    } else if (word.starts_with("px/frame=")) {
      conventions.px_per_frame = scale_of(word);
    } else {
      throw DataError(
          ErrorCode::arguments, "--conventions",
          fmt::format(
              "unknown word \"{}\"; use y-down, y-up, y-up-image, v-down, v-up, frames-exchanged, "
              "axes-exchanged, places-exchanged, components-exchanged, offset=NUMBER, px=NUMBER, px/frame=NUMBER",
              word));
    }
  }
  return conventions;
}

std::string describe(VectorConventions const& conventions) {
  std::string_view const y = !conventions.y_up ? "y-down" : conventions.mirror == Mirror::grid ? "y-up" : "y-up-image";
  std::string words = fmt::format("{},{}", y, conventions.v_up ? "v-up" : "v-down");
  if (conventions.swapped) words += ",frames-exchanged";
  if (conventions.exchange != Exchange::none)
    words += fmt::format(",{}", exchange_words.at(static_cast<std::size_t>(conventions.exchange)).second);
  words += fmt::format(",offset={}", conventions.offset_px);
  if (conventions.px) words += fmt::format(",px={}", *conventions.px);
  if (conventions.px_per_frame) words += fmt::format(",px/frame={}", *conventions.px_per_frame);
  return words;
}

bool specifies_reading(std::string_view text) {
  while (!text.empty()) {
    std::size_t const end = std::min(text.find(','), text.size());
    std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    if (!word.empty() && !word.starts_with("px=") && !word.starts_with("px/frame=")) return true;
  }
  return false;
}

DisplacementField apply_conventions(DisplacementField field, VectorConventions const& conventions, int image_rows) {
  if (conventions.exchanges_places()) {
    for (Vec2d& p : field.position_px) std::swap(p.x, p.y);
  }
  if (conventions.exchanges_components()) {
    for (std::vector<Vec2d>* const values : {&field.displacement_px, &field.sigma_px, &field.raw_px}) {
      for (Vec2d& d : *values) std::swap(d.x, d.y);
    }
  }
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (Vec2d& p : field.position_px) {
    p += Vec2d{conventions.offset_px, conventions.offset_px};
    if (!std::isfinite(p.y)) continue;
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  if (conventions.y_up) {
    double const mirror = conventions.mirror == Mirror::grid ? low + high : image_rows - 1.0;
    for (Vec2d& p : field.position_px) p.y = mirror - p.y;
  }
  double const u_sign = conventions.swapped ? -1.0 : 1.0;
  double const v_sign = conventions.v_up ? -u_sign : u_sign;
  for (Vec2d& d : field.displacement_px) d = {u_sign * d.x, v_sign * d.y};
  for (Vec2d& d : field.raw_px) d = {u_sign * d.x, v_sign * d.y};
  arrange_as_grid(field);
  return field;
}

}  // namespace gladstone::inline vectors
