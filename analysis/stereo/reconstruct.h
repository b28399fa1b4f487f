#pragma once

#include <array>
#include <optional>
#include <vector>

#include "analysis/stereo/dewarping.h"
#include "analysis/stereo/node_grid.h"
#include "analysis/stereo/stereo_camera.h"
#include "analysis/vectors/displacement_field.h"
#include "render/base/vec.h"

namespace gladstone::inline stereo {

struct StereoSettings {
  double spacing = 0.0;  ///< distance between nodes [m]; 0: mean distance between both cameras' vectors on the plane
  /// Sizes of the interrogation windows of the two cameras, see InterpolatedField [px]; 0: independent errors.
  double window_a_px = 0.0, window_b_px = 0.0;
  /// Dewarping by which dewarp_image() produced the images on which the vectors were measured, with the same cameras;
  /// empty: the vectors were measured on the original images.
  std::optional<Dewarping> dewarping = {};
};

/// Covariance matrix of (u, v, w): uu, vv, ww, uv, uw, vw [m^2].
using Covariance = std::array<double, 6>;

/// Displacement along the axes of the world at one node.
struct StereoVector {
  Vec3d displacement;            ///< u, v, w along X, Y, Z [m]
  Covariance covariance;         ///< covariance of the displacement; NaN: vectors without uncertainty
  Covariance from_calibration;   ///< contribution of the calibrations to the covariance [m^2]
  double residual_px = 0.0;      ///< root of the sum of squares of the four equations' residuals [px]
  double residual_ratio = 0.0;   ///< residual divided by its standard uncertainty [1]; NaN: vectors without uncertainty
  Vec2d image_a_px, image_b_px;  ///< displacements measured by the two cameras, interpolated at the node [px]
  VectorStatus status = VectorStatus::valid;  ///< invalid: see reject_large_residuals()

  /// Returns the standard uncertainties of u, v, w [m].
  Vec3d sigma() const;
};

/// Field of displacements with three components.
struct StereoField {
  NodeGrid grid;
  ObjectPlane plane;
  /// Vector of every node [grid.size()]; nullopt: one of the cameras has no vector at the node.
  std::vector<std::optional<StereoVector>> nodes;
};

/// Determines the displacement (u, v, w) at the nodes of a grid on the plane from the vectors of two cameras (Soloff,
/// Adrian & Liu, Meas. Sci. Technol. 8 (1997) 1441, section 4): if a particle moves from P - D/2 to P + D/2, where P is
/// the node and D the displacement, the images of these two points differ by the camera's vector at the image of P.
/// These four equations, two for each camera, are solved for the three components of D by least squares. They are
/// weighted by the uncertainties of the vectors if all four components have one. To first order, the covariance
/// contains
/// - the uncertainty of the vectors, as independent errors of the four components;
/// - the covariance of each calibration, which affects the projection and the position at which vectors are
///   interpolated. The calibrations of the two cameras are independent.
/// The grid covers the area that the vectors of both cameras have in common. Its nodes are at integer multiples of the
/// spacing, so that the point x = y = 0 is a node if it is inside.
/// @param field_a,  field_b vectors on regular grids (is_regular_grid()), at the mid-position between the frames
/// @pre the angle between the lines of sight (find_view_angle()) exceeds 0
StereoField reconstruct(CalibratedCamera const& camera_a, DisplacementField const& field_a,
                        CalibratedCamera const& camera_b, DisplacementField const& field_b, ObjectPlane const& plane,
                        StereoSettings const& settings = {});

/// Returns the grid that reconstruct() uses; empty if the views do not overlap on the plane.
NodeGrid find_common_grid(CalibratedCamera const& camera_a, DisplacementField const& field_a,
                          CalibratedCamera const& camera_b, DisplacementField const& field_b, ObjectPlane const& plane,
                          double spacing, std::optional<Dewarping> const& dewarping = {});

}  // namespace gladstone::inline stereo
