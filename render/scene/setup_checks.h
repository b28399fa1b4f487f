#pragma once

#include <string>
#include <vector>

#include "render/scene/setup.h"

namespace gladstone {

/// The parts of reading and of cross_check(); each puts its problems at their keys.

/// The table of the setup's one camera.
SetupTable camera_table(SetupTable& root);

/// A hint where a length in mm looks like one in metres; empty where it does not.
std::string metres_hint(double length);

/// Refuses dots or a lens inside the medium.
void cross_check_geometry(Setup const& setup, SetupTable geometry);

/// Refuses windows within another thing, or out of the order that light meets them in, along the camera's axis.
void cross_check_windows(Setup const& setup, SetupTable root);

/// Warns of fields whose slab ends where they are still large.
void cross_check_thickness(Setup const& setup, std::vector<std::string>& warnings);

/// Refuses closed forms that make no medium of which a file would be accepted, and densities below zero, which no gas
/// has. A uniform gradient has those somewhere whatever it is: there they are a warning, and optically linear beyond.
/// @param of_field the key of the field's table: "field", or "second_field" where that stands in its place in `setup`
void cross_check_density(Setup const& setup, SetupTable medium, std::vector<std::string>& warnings,
                         std::string const& of_field = "field");

/// Refuses what no ray would ever come to the end of: a step, or a length of the field, that is tiny beside the medium.
/// A file that cannot be read is left to those who read it.
void cross_check_steps(Setup const& setup, SetupTable medium, std::string const& of_field = "field");

}  // namespace gladstone
