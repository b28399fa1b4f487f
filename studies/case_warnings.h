#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/scene/ray_plan.h"
#include "render/scene/renderer.h"
#include "studies/case.h"

/// What a user is warned of when a case is rendered, and what would cure it.
namespace gladstone {

/// Logs a warning, and keeps it for summary.json.
void warn(std::vector<std::string>& warnings, std::string text);

/// "0.012 px"; "less than 0.0001 px" where no more than that was resolved; "an unknown amount".
std::string error_in_words(double error, double resolution, std::string_view unit);
/// A plan's errors so: those of images in grey levels.
std::string image_error_in_words(RaysPlan const& plan);
std::string truth_error_in_words(RaysPlan const& plan);

/// Warns where the rays that "auto" takes are too few.
void warn_of_few_rays(std::vector<std::string>& warnings, Scene const& scene, RaysPlan const& plan);

/// Warns of dots at side faces of a volume whose rays are too few for truth or images.
void warn_of_side_faces(std::vector<std::string>& warnings, Scene const& scene, RaysPlan const& plan);

/// Warns of a truth that is not known well.
/// @param sources what they are: dots or particles
void warn_of_truth(std::vector<std::string>& warnings, Rendering const& rendering, TruthAccuracy const& accuracy,
                   RaysPlan const& plan, std::string_view sources);

/// Warns of what the deflection table leaves of truth and images, where it is more than is asked.
void warn_of_table(std::vector<std::string>& warnings, RaysPlan const& error);

/// Warns of dots that are not seen. @param pupil_margin that the rendering took [m]
/// @return how many sources are not, of any kind
std::size_t warn_of_unseen(std::vector<std::string>& warnings, Scene const& scene, GroundTruth const& truth,
                           double pupil_margin);

/// Warns of pixels that are saturated.
/// @param light_e electrons that light sets free in the brightest pixel
void warn_of_saturation(std::vector<std::string>& warnings, CameraSetup const& camera, std::size_t in_reference,
                        std::size_t in_flow, double light_e);

/// Warns of a PIV exposure that the particles' photons do not give: "auto" limited by them, or a number beyond them.
/// @param brightest light of the brightest pixel of both frames, in units of the scene's photon_unit
void warn_of_exposure(std::vector<std::string>& warnings, Scene const& scene, double exposure_e, double brightest);

/// What can be said of a rendered case.
struct RenderedOutcome {
  std::size_t unseen = 0;  ///< sources that are not seen, of any kind
  TruthAccuracy accuracy;
};

/// Warns of a rendered case's frames and truth: saturation, dots that are not seen, a truth that is not known well.
RenderedOutcome warn_of_rendering(std::vector<std::string>& warnings, PreparedCase const& prepared,
                                  RenderedCase const& rendered, RecordedFrames const& frames);

}  // namespace gladstone
