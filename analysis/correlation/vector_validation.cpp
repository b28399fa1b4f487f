#include "analysis/correlation/vector_validation.h"

#include <utility>

#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone::inline correlation {
namespace {

constexpr std::size_t validated_per_chunk = 256;

void validate_by(ValidationStage by, std::span<GridVector> vectors, int columns, ValidationRule const& rule) {
  int const count = static_cast<int>(vectors.size()), rows = count / columns;
  std::vector<FailedTest> failed(vectors.size());
  parallel_chunks(vectors.size(), validated_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      failed[i] = failed_test(vectors.data(), static_cast<int>(i), columns, rows, rule, by);
  });
  std::vector<int> spurious;
  for (int i = 0; i < count; ++i)
    if (failed[i] != FailedTest::none) spurious.push_back(i);
  for (int const i : spurious) reject_vector(vectors[i], failed[i]);
  if (!rule.replaces) return;

  // Replace spurious vectors from the rim of each group inwards; within a round, only vectors that were valid or
  // replaced before the round serve as neighbours.
  while (!spurious.empty()) {
    std::vector<int> left;
    std::vector<std::pair<int, VectorReplacement>> replaced;
    for (int const i : spurious) {
      VectorReplacement found{};
      if (find_replacement(vectors.data(), i, columns, rows, rule, found))
        replaced.emplace_back(i, found);
      else
        left.push_back(i);
    }
    for (auto const& [i, found] : replaced) replace(vectors[i], found, rule);
    if (replaced.empty()) break;
    spurious = std::move(left);
  }
}

}  // namespace

void validate_vectors(std::span<GridVector> vectors, int columns, ValidationRule const& rule) {
  GLADSTONE_EXPECTS(columns > 0 && vectors.size() % columns == 0);
  for (int by = 0; by < validation_stage_count(rule); ++by)
    validate_by(static_cast<ValidationStage>(by), vectors, columns, rule);
}

std::vector<Vec2d> filled_displacement(std::span<GridVector const> vectors, int columns) {
  GLADSTONE_EXPECTS(columns > 0 && vectors.size() % columns == 0);
  int const rows = static_cast<int>(vectors.size()) / columns;
  std::vector<Vec2d> filled(vectors.size());
  std::vector<char> known(vectors.size(), false);
  std::vector<int> holes;
  for (int i = 0; i < static_cast<int>(vectors.size()); ++i) {
    known[i] = is_valid_or_replaced(vectors[i].status);
    if (known[i])
      filled[i] = vectors[i].displacement;
    else
      holes.push_back(i);
  }
  if (holes.size() == vectors.size()) return filled;
  while (!holes.empty()) {
    std::vector<int> left, done;
    for (int const i : holes) {
      bool const found = find_gap_value(
          filled.data(), i, columns, rows, [&](int k) { return known[k] != 0; }, filled[i]);
      (found ? done : left).push_back(i);
    }
    for (int const i : done) known[i] = true;
    holes = std::move(left);
  }
  return filled;
}

std::vector<Vec2d> smoothed_displacement(std::span<Vec2d const> nodes, int columns, double part) {
  GLADSTONE_EXPECTS(columns > 0 && nodes.size() % columns == 0);
  int const rows = static_cast<int>(nodes.size()) / columns;
  std::vector<Vec2d> across(nodes.begin(), nodes.end()), result;
  for (int j = 0; j < rows; ++j)
    for (int i = 1; i + 1 < columns; ++i) {
      std::size_t const k = static_cast<std::size_t>(j) * columns + i;
      across[k] = smoothed(nodes[k - 1], nodes[k], nodes[k + 1], part);
    }
  result = across;
  for (int j = 1; j + 1 < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      std::size_t const k = static_cast<std::size_t>(j) * columns + i;
      result[k] = smoothed(across[k - columns], across[k], across[k + columns], part);
    }
  return result;
}

}  // namespace gladstone::inline correlation
