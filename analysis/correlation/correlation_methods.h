#pragma once

#include <span>
#include <string>

#include "analysis/correlation/interrogation_job.h"
#include "analysis/correlation/optical_flow/dense_flow.h"

namespace gladstone {

/// Standard cross-correlation of weighted, mean-free windows.
std::vector<WindowCorrelation> correlate_scc(InterrogationJob const& job);
/// Robust phase correlation: the phase of the cross spectrum alone, weighted by the spectrum of particle images of 2.8
/// px. Eckstein & Vlachos, Meas. Sci. Technol. 20 (2009) 055401, eqs. 10 and 11.
std::vector<WindowCorrelation> correlate_rpc(InterrogationJob const& job);
/// Symmetric phase-only filter: the cross spectrum over the root of its magnitude. Wernet, Exp. Fluids 38 (2005) 601.
std::vector<WindowCorrelation> correlate_spc(InterrogationJob const& job);
/// Zero-padded normalised correlation: at each shift over the energies of what both windows then have in common.
/// Raffel et al., Particle Image Velocimetry (2018), eq. 5.6; with the product of both weights as weight.
std::vector<WindowCorrelation> correlate_zncc(InterrogationJob const& job);
/// Minimum quadratic difference: either frame's window against the whole other frame around it; the plane is
/// 1 - sum w (A - B)^2 / sum w (A^2 + B^2), with both sums over the two comparisons. The maximum of one comparison is
/// that of the tracking function of Gui & Merzkirch, Exp. Fluids 21 (1996) 465, over the energies, and belongs to where
/// the dots of the frame are whose window it is; both together belong to the mid-position, and exchanged frames give
/// the negative displacement.
std::vector<WindowCorrelation> correlate_mqd(InterrogationJob const& job);
/// The planes of scc by OpenCV's transforms in double precision: the reference that others are compared with.
std::vector<WindowCorrelation> correlate_by_opencv(InterrogationJob const& job);

/// One way of measuring displacement: by windows, or pixel by pixel.
struct CorrelationMethod {
  char const* name;
  CorrelateWindows correlate = nullptr;
  EstimateFlow optical_flow = nullptr;  ///< instead of correlating windows
  bool on_gpu = false;                  ///< whether the correlator of CUDA has it, too
  bool in_ensembles = true;             ///< whether it heeds a job's ensemble
};

/// Every method.
std::span<CorrelationMethod const> all_correlation_methods();

/// The method of that name. @pre it is known
CorrelationMethod const& correlation_method(std::string const& name);

}  // namespace gladstone
