#include "analysis/errors/deformed_window_truth.h"

#include <optional>

#include "analysis/correlation/standard_correlator.h"
#include "analysis/correlation/vector_validation.h"
#include "analysis/correlation/window_deformation.h"
#include "analysis/correlation/window_ops.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline errors {
namespace {

/// Predictor by which a pass deforms the frames; zero in the first pass.
struct Predictor {
  std::optional<DensePredictor> field;

  Vec2d at(Vec2d position_px) const {
    if (!field) return {};
    return is_finite(position_px) ? field->at(position_px) : Vec2d{not_a_number, not_a_number};
  }
};

std::vector<Vec2d> centres_of(InterrogationGrid const& grid) {
  std::vector<Vec2d> centres(grid.size());
  for (std::size_t i = 0; i < centres.size(); ++i) centres[i] = grid.centre(i);
  return centres;
}

/// Computes the predictor of the next pass from the displacements at the grid nodes of the current pass.
DensePredictor make_predictor(InterrogationGrid const& grid, std::span<Vec2d const> measured, double smoothing,
                              int columns, int rows) {
  std::vector<GridVector> vectors(measured.size());
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    vectors[i].displacement = measured[i];
    vectors[i].status = is_finite(measured[i]) ? VectorStatus::valid : VectorStatus::masked;
  }
  return {grid, smoothed_displacement(filled_displacement(vectors, grid.columns), grid.columns, smoothing), columns,
          rows};
}

}  // namespace

WindowTruth deformed_window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                                  std::span<double const> flux, std::span<Vec2d const> centres_px,
                                  CorrelationSettings const& settings, int columns, int rows, TruthAt at) {
  CorrelationSchedule const schedule(settings);
  std::vector<Vec2d> position(reference_px.begin(), reference_px.end());
  std::vector<Vec2d> left(displacement_px.begin(), displacement_px.end());
  if (at == TruthAt::mid_position)
    for (std::size_t i = 0; i < position.size(); ++i) position[i] += 0.5 * left[i];
  Predictor predictor;
  auto const measured = [&](std::span<Vec2d const> centres, int window_px) {
    WindowTruth truth = window_truth(position, left, flux, centres, correlation_window(schedule.weighting(), window_px),
                                     TruthAt::reference);
    for (std::size_t i = 0; i < centres.size(); ++i) truth.displacement_px[i] += predictor.at(centres[i]);
    return truth;
  };
  for (int pass = 0; !schedule.is_last(pass); ++pass) {
    InterrogationGrid const grid = schedule.grid(pass, columns, rows);
    if (grid.size() == 0) continue;
    predictor.field = make_predictor(grid, measured(centres_of(grid), grid.window_px).displacement_px,
                                     schedule.smoothing(pass), columns, rows);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = displacement_px[i] - predictor.at(position[i]);
  }
  return measured(centres_px, settings.window_px.back());
}

}  // namespace gladstone::inline errors
