#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/compare.h"
#include "studies/sweep/results.h"

namespace gladstone {

/// Whether a runner takes over from the cases before what this one agrees with them on. Over repeats: also what other
/// dots and rays were planned (step, number of rays) and what truth and theory they had at the same vectors, which then
/// hang on which of them came first, by no more than what those plans allow.
enum class Sharing { yes, no, over_repeats };

/// A case in memory, before it is let go.
struct ObservedCase {
  PreparedCase const& prepared;
  RenderedCase const& rendered;
  RecordedFrames const& frames;
  Comparison const& comparison;
};
using CaseObserver = std::function<void(ObservedCase const&)>;

/// Computes cases of a study in memory: rendering, correlation, comparison. A case's result depends on its manifest
/// line alone (but for Sharing::over_repeats): what is shared between cases (fields and their splines, planned steps and rays, renderings, truth at
/// vectors) is what the case itself would have computed, to the last bit. A reference frame is traced with the rays of
/// its flow frame, whose pupil is as wide as the medium bends; so frames are shared where the medium agrees too.
class CaseRunner {
 public:
  /// @param least_apart_px of the vectors that are compared: of a lattice that is denser, every second is, or third ...
  explicit CaseRunner(Device device, Sharing sharing = Sharing::yes, int least_apart_px = 0);
  ~CaseRunner();

  /// Computes a case. What goes wrong in computing it is its result (`failed`).
  /// @param keep folder to write the whole CASE to, as render, correlate and compare would, without figures; empty:
  /// nothing is written
  /// @param observe told of the case once it is compared; empty: nobody
  /// @throws DataError where an input is not what it was when the study was planned; Interrupted, OutputError,
  ///         DeviceError (but a device without enough memory fails the case alone)
  CaseResult run(ManifestCase const& one, std::string const& keep = "", CaseObserver const& observe = {});

 private:
  struct Shared;

  void check_inputs(ManifestCase const& one);
  void compute(ManifestCase const& one, std::string const& keep, CaseObserver const& observe, CaseResult& result);

  Device device_;
  Sharing sharing_;
  int least_apart_px_;
  std::unique_ptr<Shared> shared_;
};

/// The numbers of what errors.json holds by their path ("budget.terms.cone.rms_px"), in its order; arrays and texts are
/// left out, null is NaN.
std::vector<std::pair<std::string, double>> flat_measures(nlohmann::ordered_json const& errors);

}  // namespace gladstone
