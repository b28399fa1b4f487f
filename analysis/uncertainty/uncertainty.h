#pragma once

#include <string>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/window_deformation.h"
#include "analysis/correlation/window_ops.h"
#include "render/base/displacement_field.h"
#include "render/base/frame_pair.h"

namespace gladstone {

/// A measurement whose uncertainty is asked for.
struct UncertaintyInput {
  DisplacementField const& field;
  ImagePair const& matched;  ///< both frames deformed by the field, so that they coincide but for errors
  InterrogationGrid const& grid;
  CorrelationSettings const& settings;
};

/// Standard uncertainty of each vector of the field [px]; NaN where it cannot be told.
using UncertaintyMethod = std::vector<Vec2d> (*)(UncertaintyInput const& input);

/// From the sums whose difference shows that a correlation peak is not symmetric: they vanish but for noise, whose
/// variance is that of their terms and of the terms' covariance with their neighbours. Wieneke, Meas. Sci. Technol. 26
/// (2015) 074002, eqs. 6 to 12, the sums rearranged so that covariances reach no farther than those of pixels' noise,
/// times amplification_of_passes(). No factor is fitted.
std::vector<Vec2d> correlation_statistics(UncertaintyInput const& input);
/// From the distances of paired particle images in the matched frames: their scatter over the root of their number.
/// Sciacchitano, Wieneke & Scarano, Meas. Sci. Technol. 24 (2013) 045302, eqs. 5 to 8, the scatter about zero, of a
/// window's dots and its neighbours', times amplification_of_passes(). Their mean is not counted besides: frames that
/// were matched by the vectors themselves leave none but by the scatter. No factor is fitted.
std::vector<Vec2d> image_matching(UncertaintyInput const& input);
/// From the ratio Q of the highest correlation peak to the next: sigma^2 = (a Q^-b)^2 + c^2, the form of Charonko &
/// Vlachos, Meas. Sci. Technol. 24 (2013) 065301, eq. 10, without its term for gross errors.
std::vector<Vec2d> peak_ratio_uncertainty(UncertaintyInput const& input);
/// From the width of the displacements' probability, which the phase correlation's peak is once the filter's width is
/// taken off, over the root of the number of particle images. Bhattacharya, Charonko & Vlachos, Meas. Sci. Technol. 29
/// (2018) 115301, eqs. 6 to 11.
std::vector<Vec2d> moment_of_correlation(UncertaintyInput const& input);

/// From the methods before, by weights that were learnt where errors are known: shipped_combination(). Where one of
/// them tells nothing the others do: UncertaintyCombination::log_sigma().
std::vector<Vec2d> combined_uncertainty(UncertaintyInput const& input);

/// Names of the methods, in the order of their table, without "none".
std::vector<std::string> uncertainty_methods();

/// Whether the correlator of CUDA estimates it along with the vectors, too. @param method one of these, or "none"
bool uncertainty_on_gpu(std::string const& method);

/// What is to be known of an uncertainty with these settings: the methods tell what noise does to peaks of linear
/// correlation in frames that passes have matched, and too little of others (docs/estimators.md). Empty: nothing.
std::string uncertainty_caveat(CorrelationSettings const& settings);

/// Estimates field.sigma_px by settings.uncertainty; leaves the field as it is for "none". Vectors that are neither
/// valid nor replaced get NaN, and so do replaced ones: what stands there was not measured in their window.
/// @param field what a correlator gave for the frames with these settings
void estimate_uncertainty(DisplacementField& field, FramePair const& frames, CorrelationSettings const& settings);

/// The same after a correlator that may have estimated it along with the vectors, and the pair's verdict. What stands
/// there stays, unless the verdict has left vectors out since: then none may rest on them, and all are estimated again.
void complete_uncertainty(DisplacementField& field, FramePair const& frames, CorrelationSettings const& settings);

}  // namespace gladstone
