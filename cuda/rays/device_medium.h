#pragma once

#include <memory>
#include <type_traits>
#include <variant>
#include <vector>

#include "cuda/device/device_array.h"
#include "cuda/device/scalar_cast.h"
#include "render/medium/cell_polynomials.h"
#include "render/scene/scene.h"

namespace gladstone::cuda {

template <class Variant, class... More>
struct WithAlternatives;
template <class... Held, class... More>
struct WithAlternatives<std::variant<Held...>, More...> {
  using type = std::variant<Held..., More...>;
};

/// Any medium in the form traced on the device: volumes as cell polynomials if memory permits.
template <class T>
using DeviceMedium =
    typename WithAlternatives<Medium<T>, CellPolynomials<T, CubicBspline, false>,
                              CellPolynomials<T, CubicBspline, true>, CellPolynomials<T, Linear, false>,
                              CellPolynomials<T, Linear, true>>::type;

/// Computes the polynomial coefficients of all cells. @param grid  with its coefficients in device memory
template <class T, class Basis>
void fill_cells(GriddedIndex<double, float, Basis, 3> const& grid, T* out);
extern template void fill_cells(SplineVolume<double> const&, double*);
extern template void fill_cells(SplineVolume<double> const&, float*);
extern template void fill_cells(LinearVolume<double> const&, double*);
extern template void fill_cells(LinearVolume<double> const&, float*);

/// Owner of a medium's coefficients in device memory. Planes are stored as coefficients in double. Volumes are stored
/// as cell polynomials in double, with 64 numbers per cell (trilinear: 8), or, if these would need more than a quarter
/// of the device's memory, as one float coefficient per node.
/// For rays in single precision, a volume is stored as polynomials in float for the rays, and also as coefficients for
/// theory and deflection tables, which remain in double so that they do not depend on the precision of the rays. The
/// latter add one sixty-fourth (trilinear: one eighth) to the memory of the polynomials.
class MirroredMedium {
 public:
  MirroredMedium() = default;
  /// Uploads a medium. @param wide  true: for rays in double precision; false: in single precision
  /// @throws DeviceError if device memory is too small
  MirroredMedium(Medium<double> const& medium, bool wide);

  /// Returns the medium's view in scalar type T, with its coefficients in device memory.
  template <class T>
  DeviceMedium<T> view() const {
    return std::visit(
        [this](auto const& medium) -> DeviceMedium<T> {
          using Held = std::remove_cvref_t<decltype(medium)>;
          if constexpr (requires { medium.coefficients; }) {
            using Stored = std::remove_cvref_t<decltype(*medium.coefficients)>;
            if constexpr (Held::dimensions == 3) {
              T const* const cells = polynomials<T>().data();
              if (cells && (medium.periodic[0] || medium.periodic[1] || medium.periodic[2])) {
                return CellPolynomials<T, typename Held::Interpolant, true>(medium, cells);
              }
              if (cells) return CellPolynomials<T, typename Held::Interpolant, false>(medium, cells);
            }
            if constexpr (std::is_same_v<Stored, float>) {
              return cast_grid<T>(medium, floats_.data());
            } else {
              return cast_grid<T>(medium, doubles_.data());
            }
          } else {
            return cast<T>(medium);
          }
        },
        host_);
  }

 private:
  template <class T>
  DeviceArray<T> const& polynomials() const {
    if constexpr (std::is_same_v<T, double>) {
      return polynomials_;
    } else {
      return single_polynomials_;
    }
  }

  Medium<double> host_;
  DeviceArray<float> floats_;
  DeviceArray<double> doubles_;
  DeviceArray<double> polynomials_;
  DeviceArray<float> single_polynomials_;
};

/// Cache of the last scene's medium, which is often that of the next scene, too.
class MediumCache {
 public:
  /// Returns whether the cache holds the scene's medium. Always false for media without a grid, whose upload takes no
  /// time.
  bool serves(Scene const& scene, bool wide) const {
    return scene.medium.owner && owner_ == scene.medium.owner && wide_ == wide;
  }
  /// Uploads the scene's medium. @param wide  as in MirroredMedium
  void upload(Scene const& scene, bool wide) {
    owner_.reset();
    medium_ = MirroredMedium();
    medium_ = MirroredMedium(scene.medium.view, wide);
    owner_ = scene.medium.owner;
    wide_ = wide;
  }
  MirroredMedium const& medium() const { return medium_; }

 private:
  std::shared_ptr<void const> owner_;  ///< owner of the medium on the device
  MirroredMedium medium_;
  bool wide_ = false;
};

}  // namespace gladstone::cuda
