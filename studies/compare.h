#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/errors/error_budget.h"
#include "analysis/errors/error_summary.h"
#include "analysis/errors/window_truth.h"
#include "analysis/vectors/convention_detection.h"
#include "analysis/vectors/vector_screening.h"
#include "render/scene/renderer.h"
#include "studies/case.h"
#include "studies/compared_files.h"
#include "studies/device.h"

namespace gladstone {

/// How a comparison is to be made.
struct CompareOptions {
  std::string vectors;  ///< file; empty: CASE/vectors.h5
  TruthAt truth_at = TruthAt::mid_position;
  std::optional<std::string> conventions;  ///< as the user tells them; empty: detected for foreign files
  bool figures = true;
  bool reuse = false;  ///< takes what the last comparison stored in the CASE, where it was made from the same
};

/// Everything that is known at every vector: the chain from Eq. 9 to the measurement.
struct Comparison {
  DisplacementField measured;
  BudgetChain chain = BudgetChain::bos;
  GroundTruth point;  ///< truth and theory of the virtual dot (particle) whose place the vector is; of PIV no theory
  std::vector<Vec2d> thin_lens;  ///< of the same virtual dots as an ideal lens focused on the target sees them; not PIV
  std::vector<Vec2d> flow_px, ambient_px;  ///< of PIV alone: see ParticlePoints
  WindowTruth window, deformed_window;
  bool frames_deformed = false;   ///< several passes: deformed_window is what they measure, of one pass window is
  std::vector<Vec2d> noise_free;  ///< measured on noise-free, unquantised images; empty for foreign vectors
  VectorMask mask;
  ErrorBudget budget;               ///< its stage `window` is `window`, of one pass
  ErrorBudget budget_after_passes;  ///< its stage `window` is `deformed_window`; empty unless frames_deformed
  std::string report;               ///< what was detected about a foreign file; empty for ours
  LeftOutVectors left_out;          ///< of the file; `measured` holds the others
  std::optional<DetectedConventions> detected;  ///< of a foreign file
  bool foreign = false;
  std::vector<std::string> warnings;  ///< comparison_warnings() of a case
  SourceFiles sources;      ///< what the files held that were compared; nothing for vectors that never were in files
  std::string fingerprint;  ///< comparison_fingerprint() of a CASE
  bool verified = false;    ///< the vectors were measured on the very frames that the truth belongs to

  /// Truth that the correlated frames hold of each window: what errors are measured against where they are the
  /// estimator's and the noise's alone.
  WindowTruth const& recorded() const { return frames_deformed ? deformed_window : window; }
  char const* recorded_name() const {
    return frames_deformed ? "truth on the window of deformed frames" : "truth on the window";
  }

  /// The budget whose terms are causes: deforming passes win back what a window loses, so that the terms `window` and
  /// `estimator` of an undeformed window largely cancel.
  ErrorBudget const& shown_budget() const { return frames_deformed ? budget_after_passes : budget; }

  std::size_t vectors_in_file() const { return measured.size() + left_out.without_place(); }
};

/// Virtual dots of the target's size whose mid-position (or reference position) is each of `centres_px`: two rounds of
/// correction with few rays, then the truth and theory there with all of them.
GroundTruth truth_at_points(Scene& scene, Renderer& renderer, std::vector<Vec2d> const& centres_px, TruthAt at,
                            RenderTheory theory);

/// Displacements of those virtual dots through an ideal thin lens that images the target sharply at the scene's own
/// magnification, with the same rays and the same stop: where a ray ends is where it seems to come from on the target.
/// What the actual lens adds, defocus included, is the budget's aberration.
std::vector<Vec2d> ideal_lens_truth(Scene scene, Renderer& renderer, GroundTruth const& point);

/// Vectors to be compared, and how they came about.
struct MeasuredVectors {
  DisplacementField field;
  CorrelationSettings settings;  ///< that gave them, if ours; else the case's own
  bool foreign = false;          ///< not to be measured again on noise-free images
  std::string report;            ///< what was detected about a foreign file
  std::string name;              ///< of the file or the case, for messages
  LeftOutVectors left_out{};
  std::optional<DetectedConventions> detected{};  ///< of a foreign file
  int every = 1;                                  ///< of the lattice that the settings give, as every_nth() thins it
};

/// Truth and theory at the places of vectors: all of a comparison that does not depend on what was measured there.
struct PointTruth {
  GroundTruth point;
  std::vector<Vec2d> thin_lens;
  std::vector<Vec2d> flow_px, ambient_px;  ///< of PIV alone
};
PointTruth truth_of_vectors(PreparedCase const& prepared, Renderer& renderer, std::vector<Vec2d> const& position_px,
                            TruthAt at);

/// Compares vectors with the truth and theory of a case in memory; nothing is read, rendered or written.
/// @param dots     truth of the case's own dots
/// @param rendered what the vectors were measured on; null for foreign vectors
/// @param truth    at the vectors
/// @throws DataError where no vector can be compared
Comparison compare_vectors(PreparedCase const& prepared, GroundTruth const& dots, RenderedCase const* rendered,
                           MeasuredVectors vectors, PointTruth truth, Device const& device,
                           TruthAt at = TruthAt::mid_position);

/// Lets a comparison's errors.json name those files by what they hold.
void name_sources(Comparison& comparison, ComparedFiles files);

/// Compares the vectors of a CASE with its truth and theory, rendering again what the comparison needs, unless that is
/// stored in the CASE and to be reused.
Comparison compare_case(std::string const& folder, Device const& device, CompareOptions const& options);

/// For each of ray_truth, eq9, eq9_cone and window_truth the measures, and the budget.
nlohmann::ordered_json errors_of(Comparison const& comparison);
/// The same as the text of errors.json.
std::string errors_json(Comparison const& comparison);

/// Draws displacement maps, histograms, error against gradient and the budget into a folder.
/// @param format "png", "svg" or "pdf" @return their paths
std::vector<std::string> draw_comparison(std::string const& folder, Comparison const& comparison,
                                         std::string const& format = "png");

}  // namespace gladstone
