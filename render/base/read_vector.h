#pragma once

#include <string>

#include "render/base/setup_table.h"
#include "render/base/vec.h"

namespace gladstone {

/// Three numbers of a setup as a vector. @param fallback in the key's own unit, whose size in SI is `unit`
inline Vec3d read_vector(SetupTable& table, std::string const& key, Vec3d fallback, double unit, Range range) {
  auto const v = table.numbers(key, {fallback.x, fallback.y, fallback.z}, 3, range);
  return v.size() == 3 ? Vec3d{v[0] * unit, v[1] * unit, v[2] * unit} : fallback * unit;
}

}  // namespace gladstone
