#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "analysis/vectors/vector_file.h"

namespace gladstone::inline vectors {

/// Agreement of vectors, interpreted by given conventions, with the true displacement.
struct ConventionFit {
  VectorConventions conventions;
  /// RMS difference from the truth; each difference is limited to the larger of 1 px and three times the signal [px].
  double rms_px = 0.0;
  double signal_px = 0.0;  ///< rms of the truth at the vectors, which would be the error of zero vectors [px]
  /// Robust versions of rms_px and signal_px, which are used for decisions: rms over both components of the robust
  /// standard deviations, which a few per cent of outliers hardly change [px].
  double spread_px = 0.0, signal_spread_px = 0.0;
  /// Regression slope of the vectors m on the truth t, sum m t / sum t^2 [1]: 1 for unbiased vectors regardless of
  /// their noise, 0 for vectors unrelated to the truth.
  double slope = 0.0;
  double slope_error = 0.0;    ///< standard error of `slope`, assuming that neighbouring windows overlap by half
  std::size_t components = 0;  ///< number of compared vector components
};

/// Correction of a file's vectors along the axes of the file, applied before the conversion by its conventions.
struct VectorCorrection {
  Vec2d factor{1.0, 1.0};     ///< number by which the displacements are divided
  Vec2d offset_px{};          ///< displacement that is subtracted from all displacements
  double place_factor = 1.0;  ///< number by which the positions are divided
  Vec2d shift_px{};           ///< vector that is added to the positions

  friend bool operator==(VectorCorrection const&, VectorCorrection const&) = default;
};

/// A possible reason why vectors do not follow the conventions of their format; see describe_reason().
struct MistakeReason {
  enum class Kind {
    interpretation,  ///< no other difference than that between `interpretation` and `own`
    factor,          ///< displacements are `value` times the truth [1]; NaN: not determined
    offset,          ///< displacements are `value` greater than the truth [px]
    shift,           ///< positions are shifted by `value`, to within `uncertainty` [px]
    position_factor  ///< positions are `value` times the true ones [1]
  };
  Kind kind = Kind::interpretation;
  VectorConventions interpretation{};  ///< conventions in which the vectors were probably written
  VectorConventions own{};             ///< conventions of the format, by which the vectors are read
  Vec2d value{};                       ///< factor [1], or offset or shift [px] in our axes
  Vec2d uncertainty{};                 ///< three standard errors of a shift [px]
};

/// Uncertainty above which a component of a shift counts as not determined [px].
inline constexpr double max_shift_uncertainty_px = 2.0;

/// Probable error in foreign vectors: an interpretation other than the format's own fits the truth clearly better.
struct ProbableMistake {
  /// Reasons that the vectors do not distinguish, the likeliest first; empty: no mistake found.
  std::vector<MistakeReason> reasons;
  std::string conventions;        ///< words for --conventions that correct the mistake; empty: no words correct it
  ConventionFit corrected_fit{};  ///< fit of the vectors after correction of the mistake
  ConventionFit as_read{};        ///< fit of the vectors as the format defines them, without correction
  VectorCorrection correction{};  ///< correction of the file's numbers that removes the mistake

  bool found() const { return !reasons.empty(); }
};

/// Result of detect_conventions().
struct DetectedConventions {
  enum class Verdict {
    fits,  ///< the vectors are significantly closer to the truth than zero vectors
    /// The vectors are not closer to the truth than zero vectors, but correlated with it: correct axes, large errors.
    noisy,
    mistaken,  ///< an interpretation, scale or shift that differs from the format's own fits clearly better
    /// Neither `fits` nor `noisy`, and the truth is too small or varies on too small a scale to decide.
    cannot_be_told,
    no_convention_fits,  ///< neither `fits` nor `noisy`, although the truth is large and smooth enough to decide
  };
  std::string format;             ///< format of the vectors
  VectorConventions conventions;  ///< conventions to be used: the best fitting of the format's own conventions
  Verdict verdict = Verdict::fits;
  ProbableMistake mistake;
  ConventionFit fit;  ///< fit of `conventions`
  /// Best fit of all interpretations; of equally good fits, that of the likeliest interpretation.
  ConventionFit best;
  ConventionFit without_offset;  ///< fit of `conventions` with offset 0
  /// Every combination of axes, signs and columns with its best offset, in ascending order of rms.
  std::vector<ConventionFit> tried;
  /// True if another choice of axes or signs fits equally well; `conventions` are then the format's own.
  bool ambiguous = false;
  bool all_zero = false;  ///< true if no displacement differs from 0
};

/// Minimum rms of the truth for which conventions can be distinguished: approximately the error of a correlation of
/// good images [px].
inline constexpr double min_decidable_signal_px = 0.01;

/// Returns true if the truth varies so much within windows of four grid spacings (16 to 64 px) that vectors of such
/// windows follow less than a fifth of it.
bool is_too_fine_for_windows(DisplacementField const& ours, std::function<Vec2d(Vec2d)> const& truth);

/// Determines the conventions of a file's vectors and detects probable mistakes by comparison with the truth.
/// - Of the format's own interpretations (VectorFile::also), the first is used unless another of them fits
///   significantly better.
/// - Alternatives to these are all combinations of y axis, v sign and frame order, with each offset (0, -0.5, -1, -1.5
///   px) or with exchanged columns. Further alternatives are a factor or offset of the displacements and a shift or
///   factor of the positions.
/// - An alternative is a probable mistake if it fits significantly better and reduces the rms by 10 % (an offset of the
///   positions by 5 %; factors, shift, and offset of the displacements by 50 %).
/// - A factor of the displacements is considered above 1.05, or below 0.9 times the slope of the truth averaged over
///   windows of 64 px; an offset of the displacements above 0.2 px.
/// @pre the vectors are in px and screened (convert_to_pixels, screen_vectors)
DetectedConventions detect_conventions(VectorFile const& file, std::function<Vec2d(Vec2d)> const& truth,
                                       int image_rows);

}  // namespace gladstone::inline vectors
