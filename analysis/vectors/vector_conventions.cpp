#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/vectors/vector_file.h"

namespace gladstone {
namespace {

using Mirror = VectorConventions::Mirror;

}  // namespace

VectorConventions parse_conventions(std::string_view text, VectorConventions from) {
  VectorConventions conventions = from;
  while (!text.empty()) {
    std::size_t const end = std::min(text.find(','), text.size());
    std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    constexpr std::string_view offset = "offset=";
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
    } else if (word == "swapped") {
      conventions.swapped = true;
    } else if (word.starts_with(offset)) {
      std::string_view const number = word.substr(offset.size());
      auto const [stop, error] = std::from_chars(number.data(), number.data() + number.size(), conventions.offset_px);
      if (error != std::errc{} || stop != number.data() + number.size() || !std::isfinite(conventions.offset_px)) {
        throw std::invalid_argument(fmt::format("conventions: {} is not offset=NUMBER, such as offset=-0.5", word));
      }
    } else {
      throw std::invalid_argument(fmt::format(
          "conventions: unknown word \"{}\"; use y-down, y-up, y-up-image, v-down, v-up, swapped, offset=NUMBER",
          word));
    }
  }
  return conventions;
}

std::string describe(VectorConventions const& conventions) {
  std::string_view const y = !conventions.y_up ? "y-down" : conventions.mirror == Mirror::grid ? "y-up" : "y-up-image";
  return fmt::format("{},{}{},offset={}", y, conventions.v_up ? "v-up" : "v-down",
                     conventions.swapped ? ",swapped" : "", conventions.offset_px);
}

DisplacementField apply_conventions(DisplacementField field, VectorConventions const& conventions, int image_rows) {
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

}  // namespace gladstone
