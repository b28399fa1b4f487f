#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
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

/// What is wrong with vectors that another reading than their format's own fits better.
struct LikelyMistake {
  std::string text;          ///< "v points up", "displacements are 10 times the truth"; empty: none was found
  std::string conventions;   ///< that read them rightly, for --conventions; empty: none do
  double rms_px = 0.0;       ///< from the truth without the mistake
  double rms_as_read = 0.0;  ///< from the truth as they are read

  bool found() const { return !text.empty(); }
  /// "v points up: so read they differ from the truth by ... px rms instead of ...", with the remedy.
  std::string warning() const;
};

/// What detect_conventions found.
struct DetectedConventions {
  enum class Verdict {
    fits,            ///< closer to the truth than vectors of no length would be, and not by chance
    noisy,           ///< not closer, but they follow it: right axes, large errors
    mistaken,        ///< another reading, scale or place than the format's own fits clearly better
    cannot_be_told,  ///< neither, and the truth is too small to tell by
    fits_none,       ///< neither
  };
  VectorConventions conventions;  ///< by which the vectors are to be read: of the format's own the one that fits best
  Verdict verdict = Verdict::fits;
  LikelyMistake mistake;
  ConventionFit fit;                 ///< of `conventions`
  ConventionFit best;                ///< of all readings, the format's own or not; of equal ones the likeliest
  ConventionFit without_offset;      ///< of `conventions` with offset 0
  std::vector<ConventionFit> tried;  ///< every choice of axes, signs and columns with its best offset, the best first
  bool ambiguous = false;            ///< another choice of axes or sign is as good: the file's default was kept if so
  std::string report;                ///< one line for the log; of fits_none what was tried and what may be the cause
};

/// Truth smaller than this does not tell conventions apart: what correlation of good images is off by [px rms].
inline constexpr double telling_signal_px = 0.01;

/// Rms differences per component from the truth, of vectors that count.
/// @param truth displacement at a place in our conventions [px]; NaN outside the view
ConventionFit fit_conventions(DisplacementField const& field, VectorConventions const& conventions,
                              std::function<Vec2d(Vec2d)> const& truth, int image_rows);

/// Reads vectors as their format says, and finds what they may have wrong. Of several readings that are the format's
/// own (VectorFile::also) another than the first is taken only where it fits better by more than chance. Every other
/// choice of y axis, v sign, frame order, exchange of columns and offset (0, -0.5, -1, -1.5 px), then a factor of all
/// displacements and a shift of all places, is a likely mistake where it fits better than the format's own by 10 % (an
/// offset by 5 %, factor and shift by 30 %) and not by chance. A factor counts outside 0.9 to 1.1 times what windows of
/// 64 px leave of the truth.
/// @pre the file's vectors are in px and screened (convert_to_pixels, screen_vectors)
DetectedConventions detect_conventions(VectorFile const& file, std::function<Vec2d(Vec2d)> const& truth,
                                       int image_rows);

/// In what a reading differs from the format's own, as a mistake: "v points up", "the frames were exchanged".
std::string difference_of(VectorConventions const& reading, VectorConventions const& own);

/// In how many ways a reading differs from the format's own: what is likelier has fewer. y and v that both point up are
/// one choice, and how pixels are counted is less of a mistake than an axis.
double unlikelihood(VectorConventions const& reading, VectorConventions const& own);

/// "x - 0.5 px fits better: rms 0.0021 instead of 0.0050 px", or that it does not; empty for no offset.
std::string offset_report(DetectedConventions const& detected);

/// Twice the logarithm of the ratio of likelihoods of a and b, of normal errors: 9 is three standard deviations. At an
/// overlap of one half every vector shares its image with three others. Below 1e-4 px all fit alike.
double evidence_for(ConventionFit const& a, ConventionFit const& b);

}  // namespace gladstone
