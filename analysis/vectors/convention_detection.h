#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "analysis/vectors/vector_file.h"

namespace gladstone {

/// How vectors, read by some conventions, compare with the truth.
struct ConventionFit {
  VectorConventions conventions;
  double rms_px = 0.0;     ///< difference from the truth; each counts as at most 1 px or three times the signal
  double signal_px = 0.0;  ///< of the truth itself at these places, about zero: what vectors of no length are off by
  /// Share of the true displacement that the vectors follow, sum m t / sum t^2: 1 for right ones however noisy they
  /// are, 0 for unrelated ones.
  double slope = 0.0;
  double slope_error = 0.0;    ///< its standard error, neighbours taken to share half of their image
  std::size_t components = 0;  ///< of vectors, that were compared
};

/// What detect_conventions found.
struct DetectedConventions {
  enum class Verdict {
    fits,            ///< closer to the truth than vectors of no length would be, and not by chance
    noisy,           ///< not closer, but they follow it: right axes, large errors
    cannot_be_told,  ///< neither, and the truth is too small to tell by: the format's own conventions were kept
    fits_none,       ///< neither
  };
  VectorConventions conventions;
  Verdict verdict = Verdict::fits;
  ConventionFit fit;                 ///< of `conventions`
  ConventionFit without_offset;      ///< of the same axes and sign with offset 0
  std::vector<ConventionFit> tried;  ///< every choice of axes and sign with its best offset, the best first
  bool ambiguous = false;            ///< another choice of axes or sign is as good: the file's default was kept if so
  std::string report;                ///< one line for the log; of fits_none what was tried and what may be the cause
};

/// Truth smaller than this does not tell conventions apart: what correlation of good images is off by [px rms].
inline constexpr double telling_signal_px = 0.01;

/// Rms differences per component from the truth, of vectors that count.
/// @param truth displacement at a place in our conventions [px]; NaN outside the view
ConventionFit fit_conventions(DisplacementField const& field, VectorConventions const& conventions,
                              std::function<Vec2d(Vec2d)> const& truth, int image_rows);

/// Tries every choice of y axis, v sign, frame order and offset (0, -0.5, -1, -1.5 px and the format's own) against
/// the truth and takes the best. The offset moves away from the format's own only where that improves the rms by 5 %;
/// axes and sign are called ambiguous where the runner-up is within 10 %.
/// @pre the file's vectors are screened (screen_vectors)
DetectedConventions detect_conventions(VectorFile const& file, std::function<Vec2d(Vec2d)> const& truth,
                                       int image_rows);

/// "x - 0.5 px fits better: rms 0.0021 instead of 0.0050 px", or that it does not; empty for no offset.
std::string offset_report(DetectedConventions const& detected);

}  // namespace gladstone
