#pragma once

#include <array>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/files/hdf5_file.h"
#include "render/scene/experiment.h"
#include "studies/case/peak_locking.h"
#include "studies/case/render_setup.h"
#include "studies/case/write_case.h"

namespace gladstone::inline cases {

/// Writes the files of a rendered case into a folder.
/// @return the contents of summary.json
using CaseWriter = std::function<nlohmann::ordered_json(std::string const& folder)>;

/// Kind of case: how a case of an experiment is checked, rendered and written.
struct CaseKind {
  Experiment const& experiment;
  /// Checks the correlation of a loaded setup, and adds warnings.
  void (*cross_check)(CaseSetup& loaded);
  /// Returns the expected images of the sources, see expected_images().
  ImageDiameters (*expected_images)(Setup const& setup);
  /// Returns the expected number of sources in the scene of estimate_render_cost(); NaN: unknown.
  double (*expected_sources)(Scene const& scene);
  /// Estimates the number of rays that "auto" chooses for most sources; null: unknown.
  /// @param largest  largest number that may be chosen
  double (*expected_rays)(Setup const& setup, double largest);
  /// Replaces the sources in the setups of all cameras by common ones.
  void (*share_sources)(std::vector<CameraCase>& cameras);
  /// Renders the case of one camera.
  /// @param shared   exposure, images and particles that earlier pairs of the sequence determined
  /// @param entry    receives the numbers for the report, except the folder
  /// @param medium   receives the medium of the case
  /// @return writer of the case's files, valid while `loaded` and `renderer` exist
  CaseWriter (*render)(CaseSetup& loaded, Renderer& renderer, ReusableParts const& known,
                       SharedParts::OfCamera const& shared, RenderedCamera& entry, BuiltMedium& medium);
  /// Warns if no source is in the camera's view, or for unsuitable sources.
  void (*warn_of_view)(Scene const& scene, Warnings& warnings);
  /// Writes truth.h5.
  void (*write_truth)(std::string const& path, Scene const& scene, Rendering const& rendering,
                      CaseOutcome const& outcome, FileOrigin const& origin);
  /// Returns the entries of summary.json that other kinds do not have.
  nlohmann::json (*own_summary)(Scene const& scene, GroundTruth const& truth, double exposure_e);
};

extern CaseKind const bos_case_kind, piv_case_kind, calibration_case_kind;

/// All kinds of cases. To add one, write its file in studies/case/kinds/ and add its name above and here.
inline constexpr std::array all_case_kinds{&bos_case_kind, &piv_case_kind, &calibration_case_kind};

/// Returns the kind of the case that a setup describes.
CaseKind const& case_kind(Setup const& setup);

/// Throws DataError (wrong_format) unless a setup is of the given experiment.
/// @param name     name of the setup or its folder
/// @param refusal  end of the sentence that begins with the name, with the remedy
void require_experiment(Setup const& setup, Experiment const& needed, std::string const& name,
                        std::string const& refusal);

}  // namespace gladstone::inline cases
