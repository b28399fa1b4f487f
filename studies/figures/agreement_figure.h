#pragma once

#include <string>
#include <vector>

#include "studies/cone_theory.h"

namespace gladstone {

/// Agreement of rays with Eq. 9 on one field, at several sizes of its structures over the cone's width.
struct AgreementSeries {
  std::string name;
  struct Point {
    double size_over_cone = 0;  ///< GradientSpectrum::structure_size() over cone_width() [1]
    int nodes = 0;              ///< across the view
    Agreement value, error;
  };
  std::vector<Point> points;  ///< traced
  struct Prediction {
    double size_over_cone = 0;
    Agreement value;
  };
  std::vector<Prediction> prediction;  ///< by predicted_agreement(), ascending
};

/// Sizes over the cone's width at which curves are to be predicted, from end to end of the figure [1].
std::vector<double> agreement_sizes();

/// Two panels over the size of structures: correlation of rays and Eq. 9, and the ratio of their rms. Points with
/// standard errors are traced, curves predicted; in the right panel, grey, what a single wave of that size would keep.
/// @param single_wave the ratio of one wave at agreement_sizes()
/// @throws GnuplotMissing, OutputError
void write_agreement_figure(std::string const& path, std::vector<AgreementSeries> const& series,
                            std::vector<double> const& single_wave);

}  // namespace gladstone
