#pragma once

#include <vector>

#include "analysis/uncertainty/matched_windows.h"

namespace gladstone::inline uncertainty {

/// Dot that is visible in both matched frames.
struct ParticleImagePair {
  Vec2d disparity;  ///< position of the dot in frame B minus its position in frame A [px]
  double weight;    ///< product of the grey levels of both frames at the dot, times the squared weight of the window
};

/// Finds the dots of a window: maxima of the product of both frames for which each frame has a maximum at most one
/// pixel away. Their disparity is determined by a least-squares fit to the surrounding pixels. Sciacchitano et al.
/// (2013, section 2) instead locate each maximum by three points, which is dominated by noise for flat-topped or
/// overlapping dots.
void find_particle_pairs(MatchedWindow const& window, std::vector<ParticleImagePair>& pairs);

/// Removes outliers: pairs whose disparity along either axis deviates from the median by more than 3.5 standard
/// deviations, estimated as 1.4826 times the median absolute deviation. Outliers occur if dots overlap and the maxima
/// in the two frames belong to different dots. For normally distributed disparities, the removal reduces the variance
/// by 1 % (by 9 % for a limit of 2.5 standard deviations).
void remove_mismatched_pairs(std::vector<ParticleImagePair>& pairs);

/// Returns the equivalent number of dots with equal weights c: (sum c)^2 / sum c^2.
double effective_number(std::vector<ParticleImagePair> const& pairs);

}  // namespace gladstone::inline uncertainty
