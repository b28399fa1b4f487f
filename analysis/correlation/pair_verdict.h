#pragma once

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/ensemble.h"

/// What a measurement as a whole is worth.
namespace gladstone {

/// Leaves out the vectors that cannot be told from chance, and all of them where fewer than a quarter can
/// (VectorReason::uncorrelated). Chance is what the same correlator finds in frames that have the same dots, density
/// and noise but nothing in common: the reference, and the flow frame turned upside down. There the correlation of
/// single vectors has some mean and standard deviation s; the mean over the n independent windows within two windows of
/// a place then scatters by s/sqrt(n), the overall mean over N by s/sqrt(N), and a place is more than chance where the
/// pair's own mean is higher by two of their joint deviations. No level of correlation is set beforehand, since
/// noise, few dots and steep gradients lower both, and later passes sharpen chance peaks as they do others. A pattern
/// that repeats correlates with itself upside down, too: it is not to be judged so.
/// @param chance what the correlator gives for such frames, on the same grid
void leave_out_chance(DisplacementField& field, DisplacementField const& chance, CorrelationSettings const& settings);

/// Judges a pair by its vectors: calls those uncorrelated that cannot be told from chance, and puts into the field's
/// warnings, each as "problem (why); suggestion", what the user should know: frames that are the same, that do not
/// correlate, a pattern whose period makes displacements ambiguous within the search range, a fifth of the vectors or
/// more that failed a test. A pair whose vectors agree (at most one in twenty replaced, invalid or ambiguous) gives no
/// reason to look further, and takes no time.
///
/// The field's verdict is "correlates" then, and wherever some vectors are more than chance; "does not correlate" where
/// none is left; "not judged: " and why where vectors cannot tell: one picture twice, no signal, everything masked, a
/// pattern that repeats, optical flow, fewer windows than can agree, a median test that is off, or tests that no vector
/// passed. Windows that left the frames are told from masked ones: name_windows_outside().
/// @param field  what the correlator gave for the frames
/// @throws as Correlator::correlate
void judge_pair(DisplacementField& field, FramePair const& frames, Correlator const& correlator,
                CorrelationSettings const& settings);

/// Whether two frames are one picture, bit for bit.
bool same_picture(Image<double> const& a, Image<double> const& b);

/// The same for the vectors of an ensemble: it is the same picture if that holds of every pair, repeats if one does,
/// and a window is masked that no pair knows. Chance is what the ensemble gives whose flow frames are turned upside
/// down.
/// @param field what correlate_ensemble() gave for the pairs
void judge_ensemble(DisplacementField& field, PairSequence const& pairs, CorrelationSettings const& settings);

}  // namespace gladstone
