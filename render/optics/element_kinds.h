#pragma once

#include "render/optics/elements/lenslets.h"
#include "render/optics/elements/wedge.h"
#include "render/optics/elements/window.h"

namespace gladstone::inline optics {

template <class... Kinds>
struct ElementKinds {};

/// Optical elements besides the lens that a setup can contain, each in a separate file. To add one, write its struct
/// and add its name to the list. The struct has
/// - kind, read(SetupTable&): name in a setup, and reader of its keys in table [[element]]
/// - side: part of the light path, see ElementSide
/// - add_surfaces(at, fresnel, add): calls add(surface, name of the surface) for what acts on rays, in the order of the
///   light, with `at` the pose in the world; with Fresnel losses if `fresnel`
/// - OwnSurfaces<T>: types of its surfaces other than those of lenses; each has a pose, interact(), meet() and
///   in_scalar<U>(), see PosedThinLens
///
/// Optional members:
/// - pose(): pose of its middle in the frame of its side; default: identity
/// - glass, index, absorption: name of its glass, from which the others are set for the setup's wavelength
/// - thickness: extent along its z [m], by which positions on the light path are checked
/// - shift(): apparent displacement of objects towards the observer along the axis [m]
/// - deflects(): the axis of the camera is deflected, so that the view is found by tracing rays
/// - divides_light: the light cone of a point is divided among many images; the position of its image is that without
///   the element
/// - image_f_number(): f-number of these images, on which their diffraction depends [1]
/// - to_sensor: distance from the image plane of the lens, in which it is placed, to the sensor [m]
/// - imaging_warning(imaging, f_number): warning about an unsuitable lens; nullopt: none
/// - root_table, camera_table: name of a table at the root, or of the camera, that is an element of this kind
using AllElements = ElementKinds<OpticalWindow, WedgePrism, LensletSetup>;

}  // namespace gladstone::inline optics
