#include "analysis/density/density_integrator.h"

#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "analysis/density/density_methods.h"
#include "analysis/density/least_squares_solver.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline density {
namespace {

constexpr int not_unknown = -1;

/// Checks the reference against the map and returns the regions with the number of their reference nodes.
RegionMap count_references(GradientMap const& map, ReferenceDensity const& reference, RegionMap regions) {
  if (reference.value.size() != map.grid.size())
    throw SetupError(
        {SetupProblem{"reference", fmt::format("{} reference values for {} nodes; give one per node, NaN elsewhere",
                                               reference.value.size(), map.grid.size())}});
  std::size_t given = 0, used = 0;
  for (std::size_t i = 0; i < map.grid.size(); ++i) {
    if (std::isnan(reference.value[i])) continue;
    if (!std::isfinite(reference.value[i]))
      throw SetupError({SetupProblem{"reference", "a reference density is infinite; expected finite numbers"}});
    ++given;
    if (regions.label[i] < 0) continue;
    ++used;
    ++regions.regions[static_cast<std::size_t>(regions.label[i])].reference_nodes;
  }
  if (given == 0)
    throw SetupError({SetupProblem{"reference",
                                   "no reference density is given (the gradient determines the density up to a "
                                   "constant); specify a region of known density"}});
  if (used == 0)
    throw DataError(ErrorCode::undetermined, "reference",
                    fmt::format("all {} nodes of the reference region are masked or invalid (no node fixes "
                                "the density); move the reference region or the mask",
                                given));
  return regions;
}

void reject_unreferenced(RegionMap const& regions) {
  std::string list;
  std::size_t count = 0;
  for (Region const& region : regions.regions) {
    if (region.reference_nodes > 0) continue;
    if (count++ < 5) list += (list.empty() ? "" : "; ") + describe_region(region);
  }
  if (count == 0) return;
  throw DataError(ErrorCode::undetermined, "reference",
                  fmt::format("{} of {} disconnected regions have no reference density ({}{}); specify a reference "
                              "region in each of them, or exclude these regions",
                              count, regions.regions.size(), list, count > 5 ? "; ..." : ""));
}

}  // namespace

/// Equations of the integration and their factorised normal equations.
struct DensityIntegrator::System {
  PlaneGrid grid;
  RegionMap regions;
  ReferenceDensity reference;
  std::vector<std::uint8_t> determined, is_reference;
  /// Index of the unknown of every node; not_unknown: reference node or undetermined node.
  std::vector<int> unknown;
  std::vector<std::size_t> node;            ///< index of the grid node of every unknown
  std::vector<LineDifference> differences;  ///< difference equations of the determined nodes
  std::vector<double> weight;               ///< weight of every difference equation
  std::optional<NormalEquations> equations;

  /// Adds the contribution of difference equation k, whose right-hand side is `value`, to the right-hand side A^T W r
  /// of the normal equations.
  void add_difference(Eigen::VectorXd& right_side, std::size_t k, double value) const {
    int const from = unknown[differences[k].from], to = unknown[differences[k].to];
    if (from != not_unknown) right_side[from] -= weight[k] * value;
    if (to != not_unknown) right_side[to] += weight[k] * value;
  }

  double line_integral(LineDifference const& d, std::span<Vec2d const> gradient) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < d.terms; ++i) {
      Vec2d const& g = gradient[d.node[i]];
      sum += d.factor[i] * (d.axis == LineAxis::x ? g.x : g.y);
    }
    return sum;
  }

  /// Solves for the unknowns with the given density at the reference nodes.
  std::vector<double> solve(std::span<Vec2d const> gradient, bool with_reference) const {
    GLADSTONE_EXPECTS(gradient.size() == grid.size());
    std::vector<double> density(grid.size(), with_reference ? not_a_number : 0.0);
    if (with_reference)
      for (std::size_t i = 0; i < grid.size(); ++i)
        if (is_reference[i] != 0) density[i] = reference.value[i];
    if (node.empty()) return density;
    Eigen::VectorXd right_side = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(node.size()));
    for (std::size_t k = 0; k < differences.size(); ++k) {
      LineDifference const& d = differences[k];
      double value = line_integral(d, gradient);
      if (with_reference && is_reference[d.from] != 0) value += reference.value[d.from];
      if (with_reference && is_reference[d.to] != 0) value -= reference.value[d.to];
      add_difference(right_side, k, value);
    }
    Eigen::VectorXd const x = equations->solve(right_side);
    for (std::size_t i = 0; i < node.size(); ++i) density[node[i]] = x[static_cast<Eigen::Index>(i)];
    return density;
  }

  void factorize(std::size_t direct_limit) {
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(4 * differences.size());
    for (std::size_t k = 0; k < differences.size(); ++k) {
      int const from = unknown[differences[k].from], to = unknown[differences[k].to];
      if (from != not_unknown) triplets.emplace_back(from, from, weight[k]);
      if (to != not_unknown) triplets.emplace_back(to, to, weight[k]);
      if (from == not_unknown || to == not_unknown) continue;
      triplets.emplace_back(from, to, -weight[k]);
      triplets.emplace_back(to, from, -weight[k]);
    }
    auto const size = static_cast<Eigen::Index>(node.size());
    NormalEquations::Matrix matrix(size, size);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    equations.emplace(std::move(matrix), direct_limit);
  }
};

DensityIntegrator::DensityIntegrator(GradientMap const& map, ReferenceDensity const& reference,
                                     IntegrationSettings const& settings) {
  check_gradient_map(map);
  auto system = std::make_unique<System>();
  system->grid = map.grid;
  system->reference = reference;
  system->regions = count_references(map, reference, find_regions(map));
  if (settings.unreferenced == UnreferencedRegions::error) reject_unreferenced(system->regions);

  // Number the unknowns
  std::size_t const size = map.grid.size();
  system->determined.assign(size, 0);
  system->is_reference.assign(size, 0);
  system->unknown.assign(size, not_unknown);
  for (std::size_t i = 0; i < size; ++i) {
    int const label = system->regions.label[i];
    if (label < 0 || system->regions.regions[static_cast<std::size_t>(label)].reference_nodes == 0) continue;
    system->determined[i] = 1;
    if (!std::isnan(reference.value[i])) {
      system->is_reference[i] = 1;
      continue;
    }
    system->unknown[i] = static_cast<int>(system->node.size());
    system->node.push_back(i);
  }

  // Set up the equations and their weights
  IntegrationMethod const& method = integration_method(settings.method);
  for (LineDifference const& d : make_line_differences(map, method.rule.value_or(settings.rule))) {
    if (system->determined[d.from] == 0) continue;
    system->differences.push_back(d);
    system->weight.push_back(method.weight(d, map));
  }
  if (!system->node.empty()) system->factorize(settings.direct_limit);
  system_ = std::move(system);
}

DensityIntegrator::~DensityIntegrator() = default;
DensityIntegrator::DensityIntegrator(DensityIntegrator&&) noexcept = default;
DensityIntegrator& DensityIntegrator::operator=(DensityIntegrator&&) noexcept = default;

PlaneGrid const& DensityIntegrator::grid() const { return system_->grid; }
std::vector<Region> const& DensityIntegrator::regions() const { return system_->regions.regions; }
std::vector<int> const& DensityIntegrator::region_labels() const { return system_->regions.label; }
std::vector<std::uint8_t> const& DensityIntegrator::determined() const { return system_->determined; }
std::vector<std::uint8_t> const& DensityIntegrator::reference_nodes() const { return system_->is_reference; }
std::size_t DensityIntegrator::unknowns() const { return system_->node.size(); }

std::vector<double> DensityIntegrator::integrate(std::span<Vec2d const> gradient) const {
  return system_->solve(gradient, true);
}

std::vector<double> DensityIntegrator::integrate_error(std::span<Vec2d const> gradient_error) const {
  return system_->solve(gradient_error, false);
}

std::vector<Vec2d> DensityIntegrator::compute_sensitivity(std::size_t node) const {
  System const& s = *system_;
  GLADSTONE_EXPECTS(node < s.grid.size() && s.determined[node] != 0);
  std::vector<Vec2d> sensitivity(s.grid.size());
  if (s.unknown[node] == not_unknown) return sensitivity;
  // Compute the row of N^-1 A^T W B that belongs to the node; N is symmetric.
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(s.node.size()));
  unit[s.unknown[node]] = 1.0;
  Eigen::VectorXd const y = s.equations->solve(unit);
  for (std::size_t k = 0; k < s.differences.size(); ++k) {
    LineDifference const& d = s.differences[k];
    int const from = s.unknown[d.from], to = s.unknown[d.to];
    double const value = s.weight[k] * ((to != not_unknown ? y[to] : 0.0) - (from != not_unknown ? y[from] : 0.0));
    for (std::size_t i = 0; i < d.terms; ++i) {
      Vec2d& target = sensitivity[d.node[i]];
      (d.axis == LineAxis::x ? target.x : target.y) += d.factor[i] * value;
    }
  }
  return sensitivity;
}

}  // namespace gladstone::inline density
