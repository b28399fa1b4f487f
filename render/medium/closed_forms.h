#pragma once

#include <variant>

#include "render/medium/fields/gaussian_blob.h"
#include "render/medium/fields/gaussian_plume.h"
#include "render/medium/fields/normal_shock.h"
#include "render/medium/fields/sinusoid.h"
#include "render/medium/fields/uniform_gradient.h"

namespace gladstone {

/// The density fields in closed form, each in a file of its own. Adding one: its struct there, and its name here.
/// Such a struct is a medium, with bounds() [m] and sample(p) -> IndexSample, as any Slab<T>; it has besides
///   kind, read(SetupTable&)     its word in a setup, and its keys, in SI (the slab's members are the medium's)
///   in_scalar<U>()              the same in another scalar
///   finest()                    the smallest length on which it changes, with which steps go [m]
///   steepest()                  upper bound of |grad n| [1/m]
///   densities(half_extent)      what it takes within half a width and height [m]
///   density_key, length_key     the keys that densities and finest() follow from, for messages
/// and, where it has them,
///   steepest_mean_density(half_extent)  largest gradient across the axis, within half a width and height, of the
///   density
///                               averaged over the slab [kg/m^4]
///   radius_along_z()            of a Gaussian along Z, which a slab can be too thin for [m]
///   endless_range               its density is negative somewhere, however small: a warning, not a mistake
template <class T>
using ClosedForm = std::variant<UniformGradient<T>, Sinusoid<T>, GaussianPlume<T>, GaussianBlob<T>, NormalShock<T>>;

}  // namespace gladstone
