#pragma once

#include <cmath>

#include "render/base/units.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Two-dimensional Taylor-Green vortices in the XY plane: u = A sin(k x) cos(k y), v = -A cos(k x) sin(k y), k = 2 pi /
/// wavelength (Taylor & Green, Proc. R. Soc. A 158 (1937) 499).
struct TaylorGreenFlow {
  static constexpr char const* kind = "taylor_green";

  double amplitude = 0;  ///< A [m/s]
  double wave = 1;       ///< wavenumber k [rad/m]
  Vec3d center{};        ///< origin of x and y [m]

  static TaylorGreenFlow read(SetupTable& table) {
    TaylorGreenFlow flow;
    flow.amplitude = table.number("amplitude_m_s", 10.0, {-1e9, 1e9});
    flow.wave = 2 * pi / (table.number("wavelength_mm", 20.0, Range::positive(1e9)) * unit::millimetre);
    flow.center = table.quantities("center_mm", flow.center, unit::millimetre, {-1e9, 1e9});
    return flow;
  }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    using std::cos;
    using std::sin;
    T const x = T(wave) * (p.x - T(center.x)), y = T(wave) * (p.y - T(center.y));
    return {T(amplitude) * sin(x) * cos(y), T(-amplitude) * cos(x) * sin(y), T(0)};
  }
};

}  // namespace gladstone::inline light
