#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "render/files/fields/field_file.h"
#include "render/files/fields/resampled_field.h"

namespace gladstone::fuzz {

/// Opens a field and reads its planes in two parts, as far as a small machine would hold them.
inline void read_field(std::string const& path, int values_a_point = 1) {
  auto const source = open_field(path, "", values_a_point);
  source->significant_bits();
  source->reading().text();
  std::array<int, 3> const nodes = source->grid().nodes;
  double const plane = static_cast<double>(values_a_point) * nodes[0] * nodes[1];
  constexpr double most = 1 << 20;
  if (plane > most) return;
  bool const whole_in_memory = dynamic_cast<ResampledField const*>(source.get()) != nullptr;
  if (whole_in_memory && plane * nodes[2] > most) return;
  int const planes = static_cast<int>(std::min<double>(nodes[2], most / plane));
  std::vector<double> values(static_cast<std::size_t>(plane) * static_cast<std::size_t>(planes));
  int const first = planes / 2;
  std::size_t const middle = static_cast<std::size_t>(plane) * static_cast<std::size_t>(first);
  if (first > 0) source->read_planes(0, first, std::span(values).first(middle));
  source->read_planes(first, planes - first, std::span(values).subspan(middle));
  source->notes();
}

}  // namespace gladstone::fuzz
