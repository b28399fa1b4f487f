#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "render/base/warning.h"
#include "render/scene/ray_budget.h"
#include "render/scene/renderer.h"
#include "studies/case/case.h"
#include "studies/case/write_case.h"

/// Warnings about a rendered case, with remedies.
namespace gladstone::inline cases {

/// Logs a warning and appends it to `warnings`, which are stored in summary.json.
void warn(Warnings& warnings, Warning warning);
void warn(Warnings& warnings, Warnings const& added);

/// Formats an error: "0.012 px"; "less than 0.0001 px" if it is below the resolution of its estimate; "an unknown
/// amount" if NaN.
/// @param error       error, in `unit`; NaN: unknown
/// @param resolution  smallest error that the estimate resolves, in `unit`
std::string describe_error(double error, double resolution, std::string_view unit);
/// Warns if sources use the largest number of rays of rays_per_dot = "auto", since they may need more.
void warn_of_ray_limit(Warnings& warnings, PreparedCase const& prepared, Rendering const& rendering);

/// Warns if the standard error of the images exceeds the goal of rays_per_dot = "auto".
/// @param error_levels  as CaseOutcome::image_error_levels
void warn_of_images(Warnings& warnings, CameraSetup const& camera, double error_levels);

/// Returns the accuracy of the truth of dots at side faces; nullopt if none is in view or all dots are traced by rays.
std::optional<SideFaceAccuracy> side_face_accuracy(Scene const& scene, Rendering const& rendering);

/// Warns of dots at side faces of a volume that have too few rays for the requested accuracy of the truth.
void warn_of_side_faces(Warnings& warnings, Scene const& scene, SideFaceAccuracy const& there);

/// Warns if the truth is less accurate than requested or its accuracy is unknown.
/// @param sources  "dots" or "particles"
void warn_of_truth(Warnings& warnings, Rendering const& rendering, TruthAccuracy const& accuracy,
                   std::string_view sources);

/// Warns if the interpolation error of the deflection table exceeds the requested accuracy of truth or images.
void warn_of_table(Warnings& warnings, TableError const& error);

/// Warns of dots that are not seen in one of the frames, and names the cause: the lens, the flow or too few rays.
/// @param where  plane of the dots, for the message, such as " of the plane Z = 10 mm"
/// @return number of unseen sources; particles count although no warning is given for them
std::size_t warn_of_unseen(Warnings& warnings, Scene const& scene, Rendering const& rendering,
                           std::string_view where = "");

/// Warns of saturated pixels and names the dominant cause.
/// @param light_e  charge that light releases in the brightest pixel [e]
void warn_of_saturation(Warnings& warnings, CameraSetup const& camera, std::size_t in_reference, std::size_t in_flow,
                        double light_e);

/// Warns if the particles' photons do not suffice for a PIV exposure: "auto" limited by them, a number beyond them, or
/// an "absolute" exposure whose brightest pixel has less than ten times its noise.
/// @param brightest  light of the brightest pixel of both frames, in units of the scene's photon_unit
void warn_of_exposure(Warnings& warnings, Scene const& scene, double exposure_e, double brightest);

/// Warns of saturation, insufficient light, unseen dots and inaccurate truth of a rendered case.
RenderedOutcome warn_of_rendering(Warnings& warnings, PreparedCase const& prepared, RenderedCase const& rendered,
                                  RecordedFrames const& frames);

}  // namespace gladstone::inline cases
