#pragma once

#include <string>
#include <vector>

#include "studies/compare/cone_theory.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Agreement of rays with the small-angle theory (Eq. 9) on one field, at several ratios of structure size to cone
/// diameter.
struct AgreementSeries {
  std::string name;
  struct Point {
    double size_over_cone = 0;  ///< GradientSpectrum::structure_size() over cone_width() [1]
    int nodes = 0;              ///< number of nodes across the view
    Agreement value, error;
  };
  std::vector<Point> points;  ///< ray-traced
  struct Prediction {
    double size_over_cone = 0;
    Agreement value;
  };
  std::vector<Prediction> prediction;  ///< curve by predicted_agreement(), in ascending order
};

/// Returns the ratios of structure size to cone diameter at which curves are predicted, over the range of the figure
/// [1].
std::vector<double> agreement_sizes();

/// Two panels against structure size over cone diameter: correlation of rays with Eq. 9, and ratio of their rms.
/// Ray-traced points have error bars of one standard error; predictions are curves. The grey curve in the right panel
/// is the amplitude ratio of a single wave of that size.
/// @param single_wave  amplitude ratio of a single wave at agreement_sizes() [1]
Figure make_agreement_figure(std::vector<AgreementSeries> const& series, std::vector<double> const& single_wave);

}  // namespace gladstone::inline figures
