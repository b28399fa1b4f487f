#pragma once

#include <span>
#include <string>

#include "analysis/correlation/interrogation_job.h"
#include "analysis/correlation/optical_flow/dense_flow.h"

namespace gladstone::inline correlation {

/// Standard cross-correlation of weighted windows without their mean.
std::vector<WindowCorrelation> correlate_scc(InterrogationJob const& job);
/// Robust phase correlation: the phase of the cross spectrum, weighted by the spectrum of particle images of 2.8 px
/// diameter. Eckstein & Vlachos, Meas. Sci. Technol. 20 (2009) 055401, Eqs. 10 and 11.
std::vector<WindowCorrelation> correlate_rpc(InterrogationJob const& job);
/// Symmetric phase-only filter: the cross spectrum divided by the square root of its magnitude. Wernet, Exp. Fluids 38
/// (2005) 601.
std::vector<WindowCorrelation> correlate_spc(InterrogationJob const& job);
/// Zero-padded normalised correlation: the plane is divided, at each shift, by the energies of both windows in their
/// region of overlap. Raffel et al., Particle Image Velocimetry (2018), Eq. 5.6, weighted by the product of both window
/// weights.
std::vector<WindowCorrelation> correlate_zncc(InterrogationJob const& job);
/// Minimum quadratic difference: the window of each frame is compared with the whole of the other frame around it. The
/// plane is 1 - sum w (A - B)^2 / sum w (A^2 + B^2), where both sums run over the two comparisons. A single comparison
/// is the tracking function of Gui & Merzkirch, Exp. Fluids 21 (1996) 465, normalised by the energies; its displacement
/// belongs to the dot positions in the frame that contains the window. The displacement of both comparisons together
/// belongs to the mid-position and changes its sign if the frames are exchanged.
std::vector<WindowCorrelation> correlate_mqd(InterrogationJob const& job);
/// Standard cross-correlation by OpenCV's Fourier transforms in double precision: reference for the faster methods.
std::vector<WindowCorrelation> correlate_by_opencv(InterrogationJob const& job);

/// Displacement measurement method: correlation of windows, optical flow, or tracking of dots.
struct CorrelationMethod {
  char const* name;
  CorrelateWindows correlate = nullptr;
  /// Optical flow estimator used instead of the correlation of windows; null: none.
  EstimateFlow optical_flow = nullptr;
  bool on_gpu = false;  ///< whether the CUDA correlator supports the method
  /// Whether the height of a peak measures the agreement of phases instead of grey levels.
  bool by_phase = false;
  bool in_ensembles = true;  ///< whether the method supports InterrogationJob::ensemble
  bool tracks_dots = false;  ///< dots are tracked: tracking::make_cpu_correlator() creates the correlator, which
                             ///< estimates sigma_px itself
};

/// Returns all methods.
std::span<CorrelationMethod const> all_correlation_methods();

/// Returns the method of that name. @pre name is one of correlation_methods()
CorrelationMethod const& correlation_method(std::string const& name);

}  // namespace gladstone::inline correlation
