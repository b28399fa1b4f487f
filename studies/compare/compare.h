#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/errors/error_budget.h"
#include "analysis/errors/error_summary.h"
#include "analysis/errors/window_truth.h"
#include "analysis/vectors/convention_detection.h"
#include "analysis/vectors/vector_screening.h"
#include "render/base/warning.h"
#include "render/scene/renderer.h"
#include "studies/case/backend.h"
#include "studies/case/case.h"
#include "studies/case/write_case.h"
#include "studies/compare/compared_files.h"

namespace gladstone::inline compare {

/// Options of a comparison.
struct CompareOptions {
  std::string vectors;  ///< path of the vectors; empty: CASE/vectors.h5
  TruthAt truth_at = TruthAt::mid_position;
  std::optional<std::string> conventions;  ///< conventions given by the user; empty: detected for foreign files
  bool figures = true;
  bool reuse = false;  ///< reuse the stored comparison of the CASE if it was computed from the same files
};

/// All quantities at every vector: the chain from the small-angle theory (BOS) or the flow (PIV) to the measurement.
struct Comparison {
  DisplacementField measured;
  BudgetChain chain = BudgetChain::bos;
  GroundTruth point;  ///< truth and theory of the virtual dot (particle) at each vector's position; no theory for PIV
  /// displacements of the virtual dots of `point` through an ideal lens focused on the target [px]; empty for PIV
  std::vector<Vec2d> thin_lens;
  std::vector<Vec2d> flow_px, ambient_px;  ///< PIV only: displacement by the flow alone, and by ray tracing without the
                                           ///< medium, see ParticlePoints [px]
  WindowTruth window, deformed_window;
  bool frames_deformed = false;  ///< true: several passes, whose vectors measure deformed_window; false: a single pass,
                                 ///< which measures window
  /// vectors measured on noise-free, unquantised images [px]; empty for foreign vectors
  std::vector<Vec2d> noise_free;
  VectorMask mask;
  ErrorBudget budget;  ///< budget relative to the truth on undeformed windows, as measured by a single pass
  ErrorBudget budget_after_passes;  ///< budget relative to the truth on deformed windows; empty unless frames_deformed
  std::string report;               ///< conventions detected in a foreign file; empty for our own
  RejectedVectors left_out;         ///< vectors of the file that were rejected; `measured` holds the others
  std::optional<DetectedConventions> detected;  ///< conventions detected in a foreign file
  bool complete = true;                         ///< false: the file's header declares another number of vectors
  bool foreign = false;
  Warnings warnings;                       ///< comparison_warnings() of the case
  std::shared_ptr<CaseSetup const> setup;  ///< setup of the case as it was read; null for vectors in memory
  SourceFiles sources;      ///< contents of the compared files; empty for vectors that were never stored in files
  std::string fingerprint;  ///< comparison_fingerprint() of a CASE
  bool verified = false;    ///< true if the vectors were measured on exactly the frames that the truth belongs to

  /// Returns the window-averaged truth that the correlation is expected to measure. The difference from it contains
  /// only the errors of the estimator and of noise.
  WindowTruth const& recorded() const { return frames_deformed ? deformed_window : window; }
  char const* recorded_name() const {
    return frames_deformed ? "truth on the window of deformed frames" : "truth on the window";
  }

  /// Returns the budget whose terms are independent causes. Deforming passes recover part of the amplitude that an
  /// interrogation window averages out, so in the budget of undeformed windows the terms `window` and `estimator`
  /// largely cancel.
  ErrorBudget const& shown_budget() const { return frames_deformed ? budget_after_passes : budget; }

  std::size_t vectors_in_file() const { return measured.size() + left_out.without_place(); }
};

/// Traces virtual dots of the target's size whose mid-position (or reference position) is each of `centres_px`. Finds
/// their positions on the target by two corrections with few rays, then computes truth and theory with all rays.
GroundTruth truth_at_points(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                            std::vector<Vec2d> const& centres_px, TruthAt at, RenderTheory theory);

/// Computes the displacements of the virtual dots of `point` through an ideal thin lens that images the target sharply
/// at the scene's magnification, with the same rays and aperture stop [px]. The difference from the actual lens,
/// including
/// defocus, is the budget's aberration.
std::vector<Vec2d> ideal_lens_truth(Scene scene, RenderPlan plan, Renderer& renderer, GroundTruth const& point);

/// Vectors to be compared and their origin.
struct MeasuredVectors {
  DisplacementField field;
  CorrelationSettings settings;  ///< settings of our correlation; for foreign vectors those of the case
  bool foreign = false;          ///< true if the vectors cannot be measured again on noise-free images
  std::string report{};          ///< conventions detected in a foreign file
  std::string name{};            ///< name of the file or the case, for messages
  RejectedVectors left_out{};
  std::optional<DetectedConventions> detected{};  ///< conventions detected in a foreign file
  bool complete = true;                           ///< false: the file's header declares another number of vectors
  /// the vectors are every n-th of the lattice defined by the settings, see every_nth()
  int every = 1;
};

/// Truth and theory at the vectors' positions, independent of the measured displacements.
struct PointTruth {
  GroundTruth point;
  std::vector<Vec2d> thin_lens;
  std::vector<Vec2d> flow_px, ambient_px;  ///< PIV only: displacement by the flow alone, and by ray tracing without the
                                           ///< medium, see ParticlePoints [px]
};
PointTruth truth_of_vectors(PreparedCase const& prepared, Renderer& renderer, std::vector<Vec2d> const& position_px,
                            TruthAt at);

/// Compares vectors with truth and theory of a case in memory; reads, renders and writes nothing.
/// @param dots      truth of the case's own dots or particles
/// @param rendered  images that the vectors were measured on; null for foreign vectors
/// @param truth     truth and theory at the vectors
/// @throws DataError if no vector can be compared
Comparison compare_vectors(PreparedCase const& prepared, GroundTruth const& dots, RenderedCase const* rendered,
                           MeasuredVectors vectors, PointTruth truth, Backend const& device,
                           TruthAt at = TruthAt::mid_position);

/// Stores the compared files and their hashes in a comparison, for errors.json.
void name_sources(Comparison& comparison, ComparedFiles files);

/// Compares the vectors of a CASE with its truth and theory. Renders again what the comparison needs, unless
/// options.reuse is set and a stored comparison of the same files exists.
/// @param known  setup of the CASE; null: it is loaded
Comparison compare_case(std::string const& folder, Backend const& device, CompareOptions const& options,
                        CaseSetup const* known = nullptr);

}  // namespace gladstone::inline compare
