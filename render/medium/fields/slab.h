#pragma once

#include "render/base/host_device.h"
#include "render/medium/index_sample.h"

namespace gladstone::inline medium {

/// Range of densities in the region that rays cross [kg/m^3].
struct DensityRange {
  double lowest, highest;
};

/// Parameters common to all fields in closed form: a slab about the mid-plane, infinite in x and y. They are set from
/// table [medium], all other members from table [medium.field].
template <class T>
struct Slab {
  T half_thickness{};   ///< [m]
  T gladstone_dale{};   ///< K [m^3/kg]
  T ambient_density{};  ///< rho_0 [kg/m^3]

  GLADSTONE_HD Bounds<T> bounds() const {
    T const u = T(unbounded);
    return {{-u, -u, -half_thickness}, {u, u, half_thickness}};
  }
  /// Returns n - 1 = K rho (Gladstone & Dale 1863; Rajendran et al. 2019, eq. 1) and its gradient.
  GLADSTONE_HD IndexSample<T> from_density(T rho, Vec3<T> gradient) const {
    return {gladstone_dale * rho, gladstone_dale * gradient};
  }
};

/// Empty medium: rays are straight.
template <class T>
struct NoMedium {
  GLADSTONE_HD Bounds<T> bounds() const { return {{}, {}}; }
  GLADSTONE_HD IndexSample<T> sample(Vec3<T>) const { return {T(0), {}}; }
};

}  // namespace gladstone::inline medium
