#pragma once

#include <string>
#include <vector>

#include "render/setup/setup_table.h"

namespace gladstone::inline cases {

/// Returns true if a setup describes all pairs of a sequence: it has a table [sequence] without the key `pair`.
bool describes_sequence(SetupDocument const& setup);

/// Returns the density files of a BOS sequence, one for each frame after the reference: absolute names, in the order of
/// the setup, with the files of a pattern in natural order (2 before 10). Problems are added to the setup at
/// sequence.files: files that do not exist, patterns that match none. Empty if the key is absent or invalid.
std::vector<std::string> sequence_fields(SetupDocument& setup);

/// Selects the pair of a BOS setup: sets medium.field.file to the file of the pair in sequence.files, and removes
/// sequence.files. Without a key `pair`, the first file is selected. Problems are added to the setup. Other setups are
/// not changed.
void select_pair(SetupDocument& setup);

}  // namespace gladstone::inline cases
