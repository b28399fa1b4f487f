#include "analysis/errors/error_budget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline errors {
namespace {

/// One link of the chain: a stage, and the term that is the difference from the previous stage; the first stage has no
/// term.
struct Link {
  std::string_view stage;
  std::string_view term;
};
constexpr std::array<Link, 9> bos_chain{{{"eq9", ""},
                                         {"straight", "small_angle"},
                                         {"eq9_cone", "cone"},
                                         {"thin_lens", "refraction"},
                                         {"lens", "aberration"},
                                         {"window", "window"},
                                         {"estimator", "estimator"},
                                         {"noise_free", "pattern"},
                                         {"measured", "noise"}}};
constexpr std::array<Link, 7> piv_chain{{{"flow", ""},
                                         {"ambient", "projection"},
                                         {"seen", "refraction"},
                                         {"window", "window"},
                                         {"estimator", "estimator"},
                                         {"noise_free", "pattern"},
                                         {"measured", "noise"}}};

std::span<Link const> links_of(BudgetChain chain) {
  if (chain == BudgetChain::piv) return piv_chain;
  return bos_chain;
}

using Differences = std::vector<Vec2d>;  // values of one term at the counted vectors [px]; empty: unknown

Vec2d mean(Differences const& values) {
  Vec2d sum{};
  for (Vec2d const& value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

BudgetTerm term_of(std::string_view name, Differences const& values) {
  BudgetTerm term{std::string(name), {}, not_a_number, not_a_number, not_a_number, not_a_number, not_a_number};
  if (values.empty()) return term;
  Vec2d const bias = mean(values);
  Vec2d variance{};
  double square = 0.0;
  for (Vec2d const& value : values) {
    Vec2d const rest = value - bias;
    variance += Vec2d{rest.x * rest.x, rest.y * rest.y};
    square += dot(value, value);
  }
  auto const n = static_cast<double>(values.size());
  term.bias_u_px = bias.x;
  term.bias_v_px = bias.y;
  term.random_u_px = std::sqrt(variance.x / n);
  term.random_v_px = std::sqrt(variance.y / n);
  term.rms_px = std::sqrt(0.5 * square / n);
  return term;
}

/// Computes C_u, C_v and their mean from the values of the terms.
void fill_covariance(std::vector<Differences> const& terms, ErrorBudget& budget) {
  std::size_t const size = terms.size();
  CovarianceMatrix const unknown{size, std::vector<double>(size * size, not_a_number)};
  budget.covariance = budget.covariance_u = budget.covariance_v = unknown;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      if (terms[i].empty() || terms[j].empty()) continue;
      Vec2d const bias_i = mean(terms[i]);
      Vec2d const bias_j = mean(terms[j]);
      Vec2d sum{};
      for (std::size_t k = 0; k < terms[i].size(); ++k) {
        Vec2d const a = terms[i][k] - bias_i;
        Vec2d const b = terms[j][k] - bias_j;
        sum += Vec2d{a.x * b.x, a.y * b.y};
      }
      Vec2d const covariance = sum / static_cast<double>(terms[i].size());
      budget.covariance_u.values[i * size + j] = covariance.x;
      budget.covariance_v.values[i * size + j] = covariance.y;
      budget.covariance.values[i * size + j] = 0.5 * (covariance.x + covariance.y);
    }
  }
}

}  // namespace

std::vector<std::string_view> budget_stage_names(BudgetChain chain) {
  std::vector<std::string_view> names;
  for (Link const& link : links_of(chain)) names.push_back(link.stage);
  return names;
}

std::vector<std::string_view> budget_term_names(BudgetChain chain) {
  std::vector<std::string_view> names;
  for (Link const& link : links_of(chain).subspan(1)) names.push_back(link.term);
  return names;
}

ErrorBudget error_budget(std::span<BudgetStage const> stages, VectorMask const& mask, BudgetChain kind) {
  std::span<Link const> const chain = links_of(kind);
  auto const place_of = [chain](std::string_view stage) {
    auto const link = std::find_if(chain.begin(), chain.end(), [&](Link const& l) { return l.stage == stage; });
    GLADSTONE_EXPECTS(link != chain.end());
    return static_cast<std::size_t>(link - chain.begin());
  };
  // Sort the available stages into the order of the chain.
  std::vector<std::vector<Vec2d> const*> at(chain.size());
  for (BudgetStage const& stage : stages) {
    auto& place = at[place_of(stage.name)];
    GLADSTONE_EXPECTS(place == nullptr);
    if (stage.displacement_px.empty()) continue;
    GLADSTONE_EXPECTS(stage.displacement_px.size() == mask.size());
    place = &stage.displacement_px;
  }

  // Use the same vectors for all terms.
  std::vector<std::size_t> counted;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    bool const whole =
        mask[i] != 0 && std::all_of(at.begin(), at.end(), [i](auto const* d) { return !d || is_finite((*d)[i]); });
    if (whole) counted.push_back(i);
  }

  auto const difference = [&](std::size_t to, std::size_t from) {
    Differences values;
    for (std::size_t const i : counted) values.push_back((*at[to])[i] - (*at[from])[i]);
    return values;
  };

  // If stages are missing, assign the difference across the gap to the gap's first term.
  std::vector<Differences> differences(chain.size() - 1);
  std::vector<std::vector<std::string>> includes(chain.size() - 1);
  std::optional<std::size_t> first, last;
  for (std::size_t to = 0; to < chain.size(); ++to) {
    if (at[to] == nullptr) continue;
    if (last) {
      differences[*last] = difference(to, *last);
      for (std::size_t skipped = *last + 1; skipped < to; ++skipped) {
        includes[*last].emplace_back(chain[skipped + 1].term);
      }
    } else {
      first = to;
    }
    last = to;
  }

  ErrorBudget budget;
  budget.count = counted.size();
  for (std::size_t i = 0; i < differences.size(); ++i) {
    budget.terms.push_back(term_of(chain[i + 1].term, differences[i]));
    budget.terms.back().includes = includes[i];
  }
  Differences const total = first && *last != *first ? difference(*last, *first) : Differences{};
  budget.total = term_of("total", total);
  fill_covariance(differences, budget);

  for (std::size_t k = 0; k < total.size(); ++k) {
    Vec2d sum{};
    for (Differences const& term : differences) {
      if (!term.empty()) sum += term[k];
    }
    Vec2d const gap = sum - total[k];
    budget.closure_px = std::max({budget.closure_px, std::abs(gap.x), std::abs(gap.y)});
  }

  // Peak locking: use the estimator error on noise-free images if available, otherwise that of the measurement.
  std::size_t const window = place_of("window"), noise_free = place_of("noise_free"), measured = place_of("measured");
  std::size_t const estimate = at[noise_free] ? noise_free : measured;
  budget.peak_locking_px = not_a_number;
  if (at[window] && at[estimate]) {
    Differences truth;
    for (std::size_t const i : counted) truth.push_back((*at[window])[i]);
    budget.peak_locking_px = peak_locking(truth, difference(estimate, window));
  }
  return budget;
}

double peak_locking(std::span<Vec2d const> truth_px, std::span<Vec2d const> error_px) {
  GLADSTONE_EXPECTS(truth_px.size() == error_px.size());
  constexpr int bins = 20;
  std::array<double, bins> sum{};
  std::array<std::size_t, bins> count{};
  auto const add = [&](double displacement, double error) {
    double const fraction = displacement - std::floor(displacement);
    auto const bin = static_cast<std::size_t>(std::min(bins - 1, static_cast<int>(fraction * bins)));
    sum[bin] += error;
    ++count[bin];
  };
  for (std::size_t i = 0; i < truth_px.size(); ++i) {
    if (!is_finite(truth_px[i]) || !is_finite(error_px[i])) continue;
    add(truth_px[i].x, error_px[i].x);
    add(truth_px[i].y, error_px[i].y);
  }
  double square = 0.0;
  int filled = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    if (count[bin] == 0) continue;
    double const bin_mean = sum[bin] / static_cast<double>(count[bin]);
    square += bin_mean * bin_mean;
    ++filled;
  }
  return filled == 0 ? not_a_number : std::sqrt(square / filled);
}

}  // namespace gladstone::inline errors
