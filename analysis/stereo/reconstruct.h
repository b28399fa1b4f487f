#pragma once

#include <array>
#include <optional>
#include <vector>

#include "analysis/stereo/dewarping.h"
#include "analysis/stereo/node_grid.h"
#include "analysis/stereo/stereo_camera.h"
#include "analysis/vectors/displacement_field.h"
#include "render/base/vec.h"

namespace gladstone::stereo {

struct StereoSettings {
  double spacing = 0.0;  ///< distance between nodes [m]; 0: mean distance of both cameras' vectors on the plane
  /// sizes of both cameras' interrogation windows, see InterpolatedField [px]; 0: independent errors
  double window_a_px = 0.0, window_b_px = 0.0;
  /// The vectors were measured on images that dewarp_image() dewarped with the same cameras; empty: on the original
  /// images.
  std::optional<Dewarping> dewarping = {};
};

/// Covariance matrix of (u, v, w): uu, vv, ww, uv, uw, vw [m^2].
using Covariance = std::array<double, 6>;

/// Displacement along the axes of the world at one node.
struct StereoVector {
  Vec3d displacement;            ///< u, v, w along X, Y, Z [m]
  Covariance covariance;         ///< covariance of the displacement; NaN: vectors without uncertainty
  Covariance from_calibration;   ///< part of the covariance due to the calibrations
  double residual_px = 0.0;      ///< root of the sum of squares of the four equations' residuals [px]
  double residual_ratio = 0.0;   ///< residual divided by its standard uncertainty [1]; NaN: vectors without uncertainty
  Vec2d image_a_px, image_b_px;  ///< the vectors of both cameras, interpolated at the node [px]
  VectorStatus status = VectorStatus::valid;  ///< invalid: see reject_large_residuals()

  /// Standard uncertainties of u, v, w [m].
  Vec3d sigma() const;
};

/// Displacements in three components; nullopt at nodes that have no vector in one of the cameras.
struct StereoField {
  NodeGrid grid;
  ObjectPlane plane;
  std::vector<std::optional<StereoVector>> nodes;  ///< [grid.size()]
};

/// Determines the displacement (u, v, w) at the nodes of a grid on the plane from the vectors of two cameras (Soloff,
/// Adrian & Liu, Meas. Sci. Technol. 8 (1997) 1441, section 4): for every camera, the images of P + D/2 and P - D/2,
/// with the node P, differ by the camera's vector at the image of P. These four equations for the three components of D
/// are solved by least squares, weighted by the vectors' uncertainty where all four have one. To first order, the
/// covariance contains
/// - the uncertainty of the vectors, as independent errors of the four components;
/// - the covariance of each calibration, which affects the projection and the position at which vectors are
///   interpolated. The calibrations of the two cameras are independent.
/// The grid covers the area that the vectors of both cameras have in common, and contains x = y = 0 or is aligned with
/// it.
/// @param field_a, field_b  is_regular_grid(); vectors at the mid-position between the frames
/// @pre find_view_angle() exceeds 0
StereoField reconstruct(CalibratedCamera const& camera_a, DisplacementField const& field_a,
                        CalibratedCamera const& camera_b, DisplacementField const& field_b, ObjectPlane const& plane,
                        StereoSettings const& settings = {});

/// Returns the grid that reconstruct() uses; empty if the views do not overlap on the plane.
NodeGrid find_common_grid(CalibratedCamera const& camera_a, DisplacementField const& field_a,
                          CalibratedCamera const& camera_b, DisplacementField const& field_b, ObjectPlane const& plane,
                          double spacing, std::optional<Dewarping> const& dewarping = {});

}  // namespace gladstone::stereo
