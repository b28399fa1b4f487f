#pragma once

#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Parts of read_setup() and cross_check(). Each records problems at the keys concerned.

/// Returns the table of the camera; records a problem if the setup has several cameras.
SetupTable camera_table(SetupTable& root);

/// Returns the tables of the setup's optical elements, in the order of Setup::elements.
std::vector<ElementTable> element_tables(SetupTable root);

/// Refuses particles, laser, flow and a field at the second pulse in a setup that is not PIV.
void refuse_piv_tables(Setup const& setup, SetupTable root);

/// Returns a hint if a length in mm was probably given in metres (below 2 mm); otherwise an empty text.
/// @param length  length [m]
std::string metres_hint(double length);

/// Warns of read noise that is clipped at zero.
void cross_check_noise(Setup const& setup, Warnings& warnings);

/// Reports diffraction PSFs that are too wide to resolve anything.
void cross_check_spot(Setup const& setup, SetupTable root);

/// Checks the camera's noise, and the media between sources and camera, by the functions below.
void cross_check_medium(Setup const& setup, SetupTable root, Warnings& warnings);

/// Reports dots or a lens inside the medium.
void cross_check_geometry(Setup const& setup, SetupTable geometry);

/// Reports optical elements that overlap another object or violate the order of the light path along the camera's axis.
void cross_check_elements(Setup const& setup, SetupTable const& root);

/// Warns if the thickness of the medium truncates a field that is still significant there.
void cross_check_thickness(Setup const& setup, Warnings& warnings);

/// Reports closed-form fields with impossible refractive indices, and negative densities.
/// A uniform gradient reaches negative densities at some distance whatever its strength: inside the view this is only a
/// warning.
/// @param of_field  key of the field's table: "field", or "second_field" if `setup` contains the second field in its
///   place
void cross_check_density(Setup const& setup, SetupTable& medium, Warnings& warnings,
                         std::string const& of_field = "field");

/// Reports steps, or length scales of the field, that would require more than `max_step_count` integration steps across
/// the medium. A file that cannot be read is ignored; its reader reports it.
void cross_check_steps(Setup const& setup, SetupTable medium, std::string const& of_field = "field");

}  // namespace gladstone::inline scene
