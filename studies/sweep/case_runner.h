#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/case/write_case.h"
#include "studies/compare/compare.h"
#include "studies/sweep/results.h"

namespace gladstone::inline sweep {

/// Reuse of intermediate results from earlier cases. `identical` shares only what is identical. `over_repeats` also
/// shares, between cases that differ only in the random dots and rays, the planned step and number of rays and the
/// truth and theory at common vectors. These then depend on which of the cases was computed first, within the
/// tolerances of the ray budget.
enum class Sharing { identical, over_repeats };

/// Parts of a case that are computed: rendering, correlation and comparison, or the rendering alone.
enum class CaseParts { all, images };

/// Results of a case, passed to an observer before they are discarded.
struct ObservedCase {
  PreparedCase const& prepared;
  RenderedCase const& rendered;
  RecordedFrames const& frames;
  Comparison const& comparison;
};
using CaseObserver = std::function<void(ObservedCase const&)>;

/// Computes cases of a study in memory: rendering, correlation, comparison. A case's result depends only on its
/// manifest line (except for Sharing::over_repeats): shared intermediate results (fields and their splines, steps,
/// numbers of rays, renderings, truth at vectors) are bitwise equal to what the case itself would compute. The rays of
/// frame A are traced through the pupil of frame B, which is enlarged according to the medium; frames are therefore
/// shared only between cases with the same medium.
class CaseRunner {
 public:
  /// @param least_apart_px  minimum spacing of the compared vectors; of a denser lattice, only every n-th row and
  ///                        column is compared
  explicit CaseRunner(Backend device, Sharing sharing = Sharing::identical, int least_apart_px = 0);
  ~CaseRunner();

  /// Computes a case. Errors in the computation become a result with status `failed`.
  /// @param keep     folder in which all files of the case are written, as by render, correlate and compare but without
  ///                 figures; empty: none
  /// @param observe  called after the comparison; may be empty
  /// @param parts    `images` requires the folder `keep`
  /// @throws DataError if an input has changed since the study was planned; Interrupted; OutputError; DeviceError
  ///         (insufficient device memory only fails the case)
  CaseResult run(ManifestCase const& one, std::string const& keep = "", CaseObserver const& observe = {},
                 CaseParts parts = CaseParts::all);

 private:
  struct Shared;

  void check_inputs(ManifestCase const& one);
  void compute(ManifestCase const& one, std::string const& keep, CaseObserver const& observe, CaseParts parts,
               CaseResult& result);

  Backend device_;
  Sharing sharing_;
  int least_apart_px_;
  std::unique_ptr<Shared> shared_;
};

}  // namespace gladstone::inline sweep
