#pragma once

#include "analysis/vectors/vector_file.h"
#include "render/files/source_files.h"
#include "studies/case/truth_file.h"
#include "tests/fuzz/fields.h"
#include "tests/fuzz/input.h"

namespace gladstone::fuzz {

/// Gives an HDF5 file to everybody who reads one.
inline void read_hdf5(std::string_view input, std::string const& path) {
  read(input, [&] { read_field(path); });
  read(input, [&] { read_field(path, 3); });
  read(input, [&] { read_vectors(path); });
  read(input, [&] { read_truth(path); });
  read(input, [&] { read_field_map(path); });
  read(input, [&] { dataset_sha256(path); });
  read(input, [&] { Hdf5Reader(path).attribute("setup"); });
}

}  // namespace gladstone::fuzz
