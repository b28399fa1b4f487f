#pragma once

#include <variant>

#include "render/medium/fields/gaussian_blob.h"
#include "render/medium/fields/gaussian_plume.h"
#include "render/medium/fields/normal_shock.h"
#include "render/medium/fields/sinusoid.h"
#include "render/medium/fields/uniform_gradient.h"

namespace gladstone::inline medium {

/// Density fields in closed form, each in a separate file. To add one, write its struct and add its name to the list.
/// The struct is a medium, with bounds() [m] and sample(p) -> IndexSample, derives from Slab<T> and has
/// - kind, read(SetupTable&): name in a setup, and reader of its keys (the members of Slab are set from [medium])
/// - finest(): length scale that limits the step size [m]
/// - steepest(): upper bound of |grad n| [1/m]
/// - densities(half_extent): range of densities within a half width and half height [m]
/// - density_key, length_key: keys that determine densities() and finest(), for messages
///
/// Optional members:
/// - steepest_mean_density(half_extent): largest gradient in x and y, within a half width and half height, of the
///   density averaged over the thickness of the slab [kg/m^4]
/// - radius_along_z(): radius of a Gaussian profile along Z, to compare with the thickness of the slab [m]
/// - endless_range: the density is negative somewhere in the endless slab for any parameters, so report a warning only
template <class T>
using ClosedForm = std::variant<UniformGradient<T>, Sinusoid<T>, GaussianPlume<T>, GaussianBlob<T>, NormalShock<T>>;

}  // namespace gladstone::inline medium
