#include "render/optics/paraxial.h"

#include <cmath>
#include <limits>

namespace gladstone::inline optics {

RayTransfer ray_transfer(Lens const& lens, int first, int last) {
  RayTransfer m;
  for (int i = first; i < last; ++i) {
    ParaxialSurface const& s = lens.paraxial[static_cast<std::size_t>(i)];
    double const power = s.total_power();
    m.c -= power * m.a;
    m.d -= power * m.b;
    if (i + 1 == static_cast<int>(lens.paraxial.size())) break;  // the distance to the image is excluded
    double const way = s.to_next / s.n_after;
    m.a += way * m.c;
    m.b += way * m.d;
  }
  return m;
}

ParaxialLens paraxial_lens(Lens const& lens) {
  int const count = static_cast<int>(lens.paraxial.size());
  RayTransfer const all = ray_transfer(lens, 0, count);
  double const infinite = std::numeric_limits<double>::infinity();
  ParaxialLens result;
  // Scale of rounding errors of the lens' power: sum of the absolute powers of the surfaces.
  double largest = 0;
  for (ParaxialSurface const& s : lens.paraxial) largest += std::abs(s.total_power());
  bool const afocal = std::abs(all.c) <= 1e-12 * largest;
  double const f = afocal ? infinite : -1 / all.c;
  double const n_object = lens.object_index, n_image = std::abs(lens.paraxial.back().n_after);
  result.effective_focal_length = f;
  result.back_focal_length = afocal ? infinite : -n_image * all.a / all.c;
  result.front_focal_length = afocal ? infinite : n_object * all.d / all.c;
  result.front_principal_plane = afocal ? infinite : result.front_focal_length + n_object * f;
  result.rear_principal_plane = afocal ? infinite : result.back_focal_length - n_image * f;

  RayTransfer const before = ray_transfer(lens, 0, lens.stop), after = ray_transfer(lens, lens.stop, count);
  double const diameter = 2 * lens.paraxial_stop_radius;
  auto const finite = [infinite](double over, double under, double scale) {
    return std::abs(under) <= 1e-12 * scale ? infinite : over / under;
  };
  // ray through the centre of the stop: a y + b n u = 0 ahead of it; y = b, n u = d behind the last surface
  result.entrance = {finite(n_object * before.b, before.a, 1), std::abs(finite(diameter, before.a, 1))};
  result.exit = {finite(-n_image * after.b, after.d, 1), std::abs(finite(diameter, after.d, 1))};
  result.telecentric = is_telecentric(before);
  result.f_number = result.telecentric ? infinite : std::abs(f) / result.entrance.diameter;
  return result;
}

bool is_telecentric(RayTransfer const& to_stop) {
  constexpr double magnified = 20;
  return magnified * std::abs(to_stop.a) < 1;
}

}  // namespace gladstone::inline optics
