#pragma once

#include <type_traits>
#include <variant>
#include <vector>

#include "cuda/device_array.h"
#include "cuda/scalar_cast.h"

namespace gladstone::cuda {

/// Small volumes are held in double on the device: converting sixty-four floats a sample costs more than reading twice
/// the bytes.
template <class T>
using WideVolume = GriddedIndex<T, double, CubicBspline, 3>;

template <class Variant, class More>
struct WithAlternative;
template <class... Held, class More>
struct WithAlternative<std::variant<Held...>, More> {
  using type = std::variant<Held..., More>;
};

/// Every medium as the device holds it.
template <class T>
using DeviceMedium = typename WithAlternative<Medium<T>, WideVolume<T>>::type;

/// Owner of a medium's coefficients on the device; n - 1 is held once.
class MirroredMedium {
 public:
  MirroredMedium() = default;
  /// Uploads. @param wide may hold a volume in double @throws DeviceError where the card is too small
  MirroredMedium(Medium<double> const& medium, bool wide);

  /// The medium's view in scalar T, its coefficients on the device.
  template <class T>
  DeviceMedium<T> view() const {
    return std::visit(
        [this](auto const& medium) -> DeviceMedium<T> {
          if constexpr (requires { medium.coefficients; }) {
            using Stored = std::remove_cvref_t<decltype(*medium.coefficients)>;
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(medium)>, SplineVolume<double>>) {
              if (doubles_.size() > 0) return cast_grid<T>(medium, doubles_.data());
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
  Medium<double> host_;
  DeviceArray<float> floats_;
  DeviceArray<double> doubles_;
};

}  // namespace gladstone::cuda
