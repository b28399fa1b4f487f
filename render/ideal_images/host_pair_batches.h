#pragma once

#include <memory>
#include <vector>

#include "render/ideal_images/pair_batch.h"

namespace gladstone::inline ideal_images {

/// Checks that models can be rendered in one batch. @throws DataError if their frames differ in size
void check_same_frames(std::vector<OwnedPairModel> const& models);

/// Checks the number of seeds of a batch: any number for one model, else one per model. @throws DataError
void check_seed_count(std::size_t models, std::size_t seeds);

/// Creates a renderer of batches of pairs on the CPU, whose buffers are in host memory. Grey levels are bitwise
/// identical for any number of threads. @param models  one or several, with frames of equal size
/// @throws DataError if the models cannot be rendered together
std::unique_ptr<PairBatchRenderer> make_host_pair_batches(std::vector<OwnedPairModel> models);

}  // namespace gladstone::inline ideal_images
