#pragma once

#include <string>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/window_deformation.h"
#include "analysis/correlation/window_ops.h"
#include "analysis/vectors/displacement_field.h"
#include "render/base/frame_pair.h"

namespace gladstone::inline uncertainty {

/// Input of an uncertainty estimate.
struct UncertaintyInput {
  DisplacementField const& field;
  /// Both frames, deformed by the measured field so that they coincide apart from its errors.
  ImagePair const& matched;
  InterrogationGrid const& grid;
  CorrelationSettings const& settings;
};

/// Estimates the standard uncertainty of each vector of the field [px]; NaN: no estimate.
using UncertaintyMethod = std::vector<Vec2d> (*)(UncertaintyInput const& input);

/// Estimates the uncertainty from the asymmetry of the correlation peak (correlation statistics). Without noise, the
/// correlations on both sides of the peak would be equal. The variance of their difference follows from the terms of
/// the difference (one for each pixel) and the covariances between terms of neighbouring pixels. Wieneke, Meas. Sci.
/// Technol. 26 (2015) 074002, Eqs. 6 to 12, with the sums rearranged so that covariances extend no farther than those
/// of the pixel noise, times amplification_of_passes(). Contains no fitted factor.
std::vector<Vec2d> correlation_statistics(UncertaintyInput const& input);
/// Estimates the uncertainty from the disparities of paired particle images in the matched frames: their scatter
/// divided by the square root of their number. Sciacchitano, Wieneke & Scarano, Meas. Sci. Technol. 24 (2013) 045302,
/// Eqs. 5 to 8, with the scatter about zero of the dots of a window and its neighbours, times
/// amplification_of_passes(). The mean disparity is not added, because it is zero apart from the scatter if the frames
/// were matched by the vectors themselves. Contains no fitted factor.
std::vector<Vec2d> image_matching(UncertaintyInput const& input);
/// Estimates the uncertainty from the ratio Q of the highest to the second highest correlation peak: sigma^2 = (a
/// Q^-b)^2 + c^2, the form of Charonko & Vlachos, Meas. Sci. Technol. 24 (2013) 065301, Eq. 10, without its term for
/// gross errors.
std::vector<Vec2d> peak_ratio_uncertainty(UncertaintyInput const& input);
/// Estimates the uncertainty from the width of the probability distribution of the displacement, divided by the square
/// root of the number of particle images. The width of the distribution is that of the peak of the phase correlation,
/// from which the width of the spectral filter is subtracted. Bhattacharya, Charonko & Vlachos, Meas. Sci. Technol. 29
/// (2018) 115301, Eqs. 6 to 11.
std::vector<Vec2d> moment_of_correlation(UncertaintyInput const& input);

/// Combines the methods above with the weights of shipped_combination(). For methods without an estimate see
/// UncertaintyCombination::log_sigma().
std::vector<Vec2d> combined_uncertainty(UncertaintyInput const& input);

/// Returns the names of the methods, without "none".
std::vector<std::string> uncertainty_methods();

/// Returns whether the CUDA correlator estimates the uncertainty together with the vectors.
/// @param method  one of uncertainty_methods(), or "none"
bool uncertainty_on_gpu(std::string const& method);

/// Returns the settings with uncertainty = "auto" replaced: by correlation statistics on a CPU, where they cost about
/// half as much as the correlation, if this method does not underestimate the uncertainty with these settings
/// (uncertainty_caveat()), else by "none". All other settings remain unchanged.
/// @param on_cpu  whether the vectors are correlated on a CPU
CorrelationSettings choose_uncertainty(CorrelationSettings settings, bool on_cpu);

/// Kinds of frames and devices of a correlation, on which the choice of uncertainty = "auto" depends.
enum class CorrelatedFrames { pair_on_cpu, pair_on_gpu, sequence, ensemble };

/// Records in the field which method estimated its uncertainty, and which key selected it. If "auto" selected no
/// method, the reason follows the key, e.g. `correlate.uncertainty = "auto" (on a GPU)`.
/// @param given  settings before choose_uncertainty()
void record_uncertainty(DisplacementField& field, CorrelationSettings const& given, CorrelatedFrames frames);

/// Returns a warning if the uncertainty is underestimated with these settings: the methods describe the effect of noise
/// on peaks of a linear correlation between frames that were matched in several passes (docs/estimators.md). Empty: no
/// warning.
std::string uncertainty_caveat(CorrelationSettings const& settings);

/// Estimates field.sigma_px by settings.uncertainty; does nothing without a method and for tracked dots. The
/// uncertainty of vectors whose status is not valid is set to NaN; replaced vectors, for example, were not measured in
/// their own window.
/// @param field  result of a correlator for these frames and settings
void estimate_uncertainty(DisplacementField& field, StoredFrames const& frames, CorrelationSettings const& settings);

/// Estimates field.sigma_px if it is empty, or if the decorrelation test has invalidated vectors since. In all other
/// cases, an existing estimate remains. After the test, the uncertainties of all vectors are recomputed, because
/// invalidated vectors must not affect the deformation of the frames.
void complete_uncertainty(DisplacementField& field, StoredFrames const& frames, CorrelationSettings const& settings);

}  // namespace gladstone::inline uncertainty
