#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/stereo/reconstruct.h"
#include "analysis/stereo/sheet_alignment.h"
#include "render/base/warning.h"
#include "render/files/source_files.h"
#include "studies/case/backend.h"

namespace gladstone::inline compare {

/// Options of a stereoscopic measurement.
struct StereoOptions {
  std::array<std::string, 2> inputs;       ///< inputs of both cameras, see find_stereo_inputs()
  std::vector<std::string> calibrations;   ///< calibration.h5 of each camera; empty: exact cameras of rendered cases
  std::optional<std::string> conventions;  ///< conventions of the vectors given by the user; empty: those of the file's
                                           ///< format
  stereo::ObjectPlane plane;               ///< middle of the laser sheet; with `align`, the initial guess
  bool dewarp_images = false;              ///< correlate the dewarped frames of the cases, instead of reading vectors
  bool align = false;                      ///< determine the sheet from images; false: only measure the disparity
  /// images of the first and of the second camera in turn, two for each time; empty: both frames of the cases, if any
  std::vector<std::string> images;
  double spacing = 0.0;             ///< distance between nodes [m]; 0: mean distance of the vectors
  double residual_limit = 4.0;      ///< limit of the residual, see stereo::reject_large_residuals() [1]; 0: accept all
                                    ///< vectors
  std::optional<double> window_px;  ///< size of the interrogation windows [px]; empty: [correlate]
};

/// Displacement in three components, measured by two cameras.
struct StereoMeasurement {
  stereo::StereoField field;
  double pixel_size = 0.0;                  ///< mean size of a pixel on the plane at x = y = 0 [m]
  double view_angle = 0.0;                  ///< angle between the views at x = y = 0 [rad]
  std::array<std::string, 2> vectors;       ///< paths of the vectors
  std::array<std::string, 2> calibrations;  ///< paths of the calibrations; empty: exact camera of the setup
  std::array<double, 2> window_px{};        ///< size of the interrogation windows [px]
  /// Mean true displacement of the particles in each node's window, if both cases belong to one rendering [m,
  /// field.grid.size()]. NaN: fewer than three particles; empty: unknown.
  std::vector<Vec3d> truth;
  /// laser sheet as determined from images; empty: the sheet was given
  std::optional<stereo::SheetAlignment> alignment;
  /// disparity of the given sheet between the images of both cameras; empty: with `alignment`, or without images
  std::optional<stereo::SheetAlignment> given_sheet;
  Warnings warnings;
  std::string setup;         ///< resolved setup of the first camera
  std::uint64_t seed = 0;    ///< random seed of the rendering
  SourceFiles sources = {};  ///< vectors, calibrations, and truth

  /// Returns whether the plane of `alignment` is used: it has converged, and differs significantly from the given one.
  bool is_aligned() const { return alignment && alignment->has_converged() && alignment->is_significant(); }
};

/// Errors of one component against the truth.
struct ComponentErrors {
  std::size_t count = 0;
  double bias = 0.0, rms = 0.0;  ///< mean and root mean square [m]; NaN: no node with a displacement and a truth
  double coverage = 0.0;         ///< fraction of errors within sigma [1]; NaN: vectors without uncertainty
};

/// Computes the errors of u, v and w over all nodes with a valid displacement and a truth.
/// @pre measurement.truth is not empty
std::array<ComponentErrors, 3> compute_stereo_errors(StereoMeasurement const& measurement);

/// Computes the root mean square of StereoVector::residual_ratio of valid vectors; NaN: vectors without uncertainty.
double compute_residual_ratio(stereo::StereoField const& field);

/// Returns the case folder or the file of vectors of each camera.
/// @param inputs  case folder or file of vectors of each camera; if the second is empty, the first is the folder of a
/// case with two cameras
/// @throws DataError  if this folder has not two cameras
std::array<std::string, 2> find_stereo_inputs(std::array<std::string, 2> const& inputs);

/// Reads vectors and cameras, and reconstructs three components. If both inputs are cases of one PIV setup, also
/// determines the true displacement of their particles. Writes nothing.
/// @param device  for the correlation of dewarped images
/// @throws SetupError  for invalid options
/// @throws DataError   for files that are missing or do not fit together
StereoMeasurement measure_stereo(StereoOptions options, Backend const& device);

}  // namespace gladstone::inline compare
