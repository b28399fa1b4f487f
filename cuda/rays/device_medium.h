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

/// Every medium as the device traces it: volumes as polynomials, where there is room for them.
template <class T>
using DeviceMedium =
    typename WithAlternatives<Medium<T>, CellPolynomials<T, CubicBspline, false>,
                              CellPolynomials<T, CubicBspline, true>, CellPolynomials<T, Linear, false>,
                              CellPolynomials<T, Linear, true>>::type;

/// Fills the coefficients of all cells. @param grid with its coefficients on the device
template <class T, class Basis>
void fill_cells(GriddedIndex<double, float, Basis, 3> const& grid, T* out);
extern template void fill_cells(SplineVolume<double> const&, double*);
extern template void fill_cells(SplineVolume<double> const&, float*);
extern template void fill_cells(LinearVolume<double> const&, double*);
extern template void fill_cells(LinearVolume<double> const&, float*);

/// Owner of a medium's coefficients on the device, which has n - 1 once: a plane as its coefficients in double; a
/// volume as polynomials in double, 64 numbers a cell (trilinear: 8), or, where these would take more than a quarter of
/// the device's memory, as its coefficients in float, one a node. With single precision a volume is there once in float
/// and once more: rays cross polynomials in float, while theory and the deflection table, which stay double so that
/// they do not change with the rays' precision, read the coefficients. That adds a sixty-fourth (an eighth) of what the
/// polynomials take.
class MirroredMedium {
 public:
  MirroredMedium() = default;
  /// Uploads. @param wide rays will cross it in double, not in single precision @throws DeviceError where the card is
  /// too small
  MirroredMedium(Medium<double> const& medium, bool wide);

  /// The medium's view in scalar T, its coefficients on the device.
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

/// The medium of the last scene, which often is the next one's too.
class MediumCache {
 public:
  /// Whether it is the scene's. Views without a grid cost nothing to mirror: it never is.
  bool serves(Scene const& scene, bool wide) const {
    return scene.medium.owner && owner_ == scene.medium.owner && wide_ == wide;
  }
  /// @param wide as MirroredMedium
  void upload(Scene const& scene, bool wide) {
    owner_.reset();
    medium_ = MirroredMedium();
    medium_ = MirroredMedium(scene.medium.view, wide);
    owner_ = scene.medium.owner;
    wide_ = wide;
  }
  MirroredMedium const& medium() const { return medium_; }

 private:
  std::shared_ptr<void const> owner_;  ///< of the medium that is on the device
  MirroredMedium medium_;
  bool wide_ = false;
};

}  // namespace gladstone::cuda
