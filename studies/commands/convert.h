#pragma once

#include <string>

#include "analysis/errors/window_truth.h"
#include "studies/commands/description.h"
#include "studies/compare/displacement_truth.h"

namespace gladstone::inline commands {

/// Conversion of a file of vectors to another format.
struct VectorConversion {
  std::string input;        ///< vectors of any program, truth.h5 of a case, three components, or densities
  std::string output;       ///< file to write, whose ending selects the format
  std::string conventions;  ///< conventions of a foreign file, see parse_conventions(); empty: those of its format
  int image_rows = 0;       ///< rows of the image, for files that count y upwards from its last row; 0: unknown
  /// Distance of the pixels at which the truth of a case is computed [px]; 0: 1 for formats of grids (.nc, .vti), for
  /// others the truth of the dots or particles.
  int spacing_px = 0;
  TruthAt truth_at = TruthAt::mid_position;      ///< selects the dot whose displacement is the truth at a pixel: its
                                                 ///< path is centred there (mid_position) or begins there (reference)
  TracedPixels traced = TracedPixels::adaptive;  ///< pixels to which rays are traced
  std::string device = "auto";                   ///< device that computes the truth at pixels
};

struct ConvertedVectors {
  Description description;
  bool complete = true;  ///< false: the header of the input declares another number of vectors
};

/// Converts vectors, see load_for_export() and compute_map_for_export(). @throws DataError, OutputError
ConvertedVectors convert_vectors(VectorConversion const& conversion);

}  // namespace gladstone::inline commands
