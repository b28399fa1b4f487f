#pragma once

#include <memory>
#include <variant>

#include "cuda/device/device_array.h"
#include "render/medium/cell_polynomials.h"
#include "render/scene/scene.h"

namespace gladstone::cuda::inline rays {

template <class Variant, class... More>
struct WithAlternatives;
template <class... Held, class... More>
struct WithAlternatives<std::variant<Held...>, More...> {
  using type = std::variant<Held..., More...>;
};

/// Any medium in the form traced on the device: volumes as cell polynomials if memory permits.
using DeviceMedium =
    WithAlternatives<Medium<double>, CellPolynomials<CubicBspline, false>, CellPolynomials<CubicBspline, true>,
                     CellPolynomials<Linear, false>, CellPolynomials<Linear, true>>::type;

/// Computes the polynomial coefficients of all cells. @param grid  with its coefficients in device memory
template <class Basis>
void fill_cells(GriddedIndex<double, float, Basis, 3> const& grid, double* out);
extern template void fill_cells(SplineVolume<double> const&, double*);
extern template void fill_cells(LinearVolume<double> const&, double*);

/// Owner of a medium's coefficients in device memory. Planes are stored as coefficients in double. Volumes are stored
/// as cell polynomials in double, with 64 numbers per cell (trilinear: 8), or, if these would need more than a quarter
/// of the device's memory, as one float coefficient per node.
class MirroredMedium {
 public:
  MirroredMedium() = default;
  /// Uploads a medium. @throws DeviceError if device memory is too small
  explicit MirroredMedium(Medium<double> const& medium);

  /// Returns the medium's view, with its coefficients in device memory.
  DeviceMedium const& view() const { return view_; }

 private:
  template <class Grid>
  DeviceMedium upload(Grid grid);

  DeviceMedium view_;
  DeviceArray<float> floats_;
  DeviceArray<double> doubles_;
  DeviceArray<double> polynomials_;
};

/// Cache of the last scene's medium, which is often that of the next scene, too.
class MediumCache {
 public:
  /// Returns whether the cache holds the scene's medium. Always false for media without a grid, whose upload takes no
  /// time.
  bool serves(Scene const& scene) const { return scene.medium.owner && owner_ == scene.medium.owner; }
  /// Uploads the scene's medium.
  void upload(Scene const& scene) {
    owner_.reset();
    medium_ = MirroredMedium();
    medium_ = MirroredMedium(scene.medium.view);
    owner_ = scene.medium.owner;
  }
  MirroredMedium const& medium() const { return medium_; }

 private:
  std::shared_ptr<void const> owner_;  ///< owner of the medium on the device
  MirroredMedium medium_;
};

}  // namespace gladstone::cuda::inline rays
