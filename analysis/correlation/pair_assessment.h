#pragma once

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/standard_correlator.h"

/// Assessment of an image pair as a whole: detects frames that do not correlate, identical frames and periodic
/// patterns.
namespace gladstone::inline correlation {

/// Invalidates vectors that correlate no better than unrelated frames (decorrelation test, VectorReason::uncorrelated).
/// Invalidates all vectors if fewer than a quarter of the windows with a signal pass the test.
/// - Unrelated frames with the same dots, density and noise are frame A and frame B rotated by 180 degrees.
/// - The correlation coefficients of these unrelated frames have a mean m and a standard deviation s. Their local mean
///   over the n independent windows within two windows of a vector has the standard deviation s/sqrt(n), and the mean m
///   over all N windows has s/sqrt(N).
/// - A vector passes if the local mean of the correlation of the measured frames exceeds m by two combined standard
///   deviations.
/// - No fixed threshold is used: noise, few dots and steep gradients reduce both means, and later passes increase
///   random peaks in the same way as true peaks.
/// - The test is not applicable to periodic patterns, which also match their rotated image.
/// @param chance  result of the same correlator for frame A and the rotated frame B, on the same grid
void reject_uncorrelated_vectors(DisplacementField& field, DisplacementField const& chance,
                                 CorrelationSettings const& settings);

/// Assesses a pair by its vectors: runs the decorrelation test, sets the field's verdict, and adds warnings to the
/// field, each as "problem (reason); suggestion".
/// - Warnings: identical frames, uncorrelated frames, displacements beyond the search range, a pattern whose period
///   makes displacements within the search range ambiguous, and at least a fifth of the vectors failing a test.
/// - If fewer than one in twenty vectors are replaced, invalid or ambiguous, the costly tests are skipped.
/// - Verdict: `correlates` if any vector is valid or replaced; `uncorrelated` if every vector with a signal is
///   uncorrelated or beyond the search range; otherwise the reason why the pair is not judged.
/// - Masked windows outside the frames are first marked by mark_windows_outside().
/// - Does nothing if the correlator has set a verdict itself.
/// @param field  result of the correlator for these frames
/// @throws the exceptions of Correlator::correlate()
void assess_pair(DisplacementField& field, StoredFrames const& frames, Correlator const& correlator,
                 CorrelationSettings const& settings);

/// Returns false if assess_pair() found that the frames do not correlate.
bool frames_correlate(DisplacementField const& field);

/// Returns whether two frames are bitwise identical.
bool are_identical_frames(Image<double> const& a, Image<double> const& b);

/// Assesses the vectors of an ensemble in the same way as assess_pair(). The frames count as identical if the two
/// frames of every pair are identical, the pattern as periodic if the pattern of any pair is periodic, and a pixel as
/// unknown if it is unknown in every pair. The decorrelation test uses the ensemble with every frame B rotated by 180
/// degrees.
/// @param field  result of correlate_ensemble() for these pairs
void assess_ensemble(DisplacementField& field, PairSequence const& pairs, CorrelationSettings const& settings);

}  // namespace gladstone::inline correlation
