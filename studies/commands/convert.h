#pragma once

#include <string>

#include "studies/commands/description.h"

namespace gladstone {

/// Conversion of a file of vectors to another format.
struct VectorConversion {
  std::string input;        ///< vectors of any program, truth.h5 of a case, or three components
  std::string output;       ///< file to write, whose ending selects the format
  std::string conventions;  ///< conventions of a foreign file, see parse_conventions(); empty: those of its format
  int image_rows = 0;       ///< rows of the image, for files that count y upwards from its last row; 0: unknown
};

struct ConvertedVectors {
  Description description;
  bool complete = true;  ///< false: the header of the input declares another number of vectors
};

/// Converts vectors, see load_for_export(). @throws DataError, OutputError
ConvertedVectors convert_vectors(VectorConversion const& conversion);

}  // namespace gladstone
