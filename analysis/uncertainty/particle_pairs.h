#pragma once

#include <vector>

#include "analysis/uncertainty/matched_windows.h"

namespace gladstone {

/// One dot seen in both matched frames.
struct ParticleImagePair {
  Vec2d disparity;  ///< its place in the flow frame minus that in the reference [px]
  double weight;    ///< product of both images there, times the square of the window's weight
};

/// Dots of a window: maxima of the product of both frames, each with a maximum of either frame at most a pixel away,
/// set apart by least squares of the pixels around. Sciacchitano et al. (2013, section 2) place either maximum by three
/// points, which of dots that are flat on top, and of dots in their neighbours' light, find noise.
void find_particle_pairs(MatchedWindow const& window, std::vector<ParticleImagePair>& pairs);

/// Leaves out pairs whose disparity along either axis is further from the median than 3.5 deviations, which 1.4826
/// times the median distance from it stands for: where dots overlap, the maxima of the frames may belong to different
/// ones. Normal disparities lose 1 % of their variance by it, at 2.5 deviations 9 %.
void leave_out_mismatches(std::vector<ParticleImagePair>& pairs);

/// How many dots of equal weight scatter as much as these: (sum c)^2 / sum c^2.
double effective_number(std::vector<ParticleImagePair> const& pairs);

}  // namespace gladstone
