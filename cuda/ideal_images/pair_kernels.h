#pragma once

#include "cuda/ideal_images/tile_lists.h"
#include "render/ideal_images/pair_batch.h"

namespace gladstone::cuda::inline ideal_images {

/// Pairs to render and their models, in device memory.
struct PairsOnDevice {
  PairModel const* models = nullptr;
  /// step of the model index from pair to pair; 0: all pairs have the first model, 1: pair i has model i
  std::size_t model_stride = 0;
  PairSeeds const* seeds = nullptr;
  std::size_t pairs = 0;

  GLADSTONE_HD PairModel const& model(std::size_t pair) const { return models[pair * model_stride]; }
};

/// Computes the images of all particles, with light in photons, and lists them in their tiles.
/// @param images  [pair][frame][particle]; images without light behind the last particle of a model
/// @param count   number of particles for which memory is allocated
/// @param unit    photons of the brightest image of each pair, as bits of a double; must be initialised to zero
void make_particle_images(PairsOnDevice const& pairs, std::size_t count, ParticleImage* images,
                          unsigned long long* unit, TileLists const& lists);

/// Records the light of pairs with the exposure, noise and quantisation of their models.
/// @param brightest, unit  see draw_images() and make_particle_images()
/// @param levels           [pair][frame][pixel] of the given type
void record_pairs(PairsOnDevice const& pairs, double const* light, std::size_t pixels,
                  unsigned long long const* brightest, unsigned long long const* unit, LevelType type, void* levels);

/// Computes the displacement of every model at every pixel. @param out  [model][component][row][column]
void compute_displacements(PairModel const* models, std::size_t count, int columns, int rows, float* out);

}  // namespace gladstone::cuda::inline ideal_images
