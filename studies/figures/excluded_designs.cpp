#include "studies/figures/excluded_designs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "studies/design/bounds.h"
#include "studies/figures/design_map.h"

namespace gladstone::inline figures {
namespace {

constexpr int map_columns = 160, map_rows = 240;

/// Limit with its name for the user.
struct MapLimit {
  std::string name;
  std::function<bool(DesignPoint<double> const&)> is_missed;
};

std::vector<MapLimit> limits_of_map(DesignPoint<double> const& bench, DesignQuestion const* question) {
  std::vector<MapLimit> all;
  auto const add = [&all](std::string name, Limit const& limit) {
    all.push_back({std::move(name), [limit](DesignPoint<double> const& one) { return excess(limit, one) > 0; }});
  };
  if (question) {
    for (Limit const& limit : question->requirements.limits) {
      add(fmt::format("{} = {:.4g}", limit.bound->name, limit.value / limit.bound->unit), limit);
    }
    for (FreeChoice const& free : question->free) {
      if (!free.values.empty() || (free.choice != Choice::z_d && free.choice != Choice::f_number)) continue;
      ChoiceKey const& key = choice_key(free.choice);
      all.push_back({fmt::format("limits.{} = [{:.4g}, {:.4g}]", key.limit, free.low / key.unit, free.high / key.unit),
                     [free](DesignPoint<double> const& one) {
                       double const value = free.choice == Choice::z_d ? one.z_d : one.f_number;
                       return value < free.low || value > free.high;
                     }});
    }
  }
  for (Limit const& limit : feasibility_limits(*bench.given)) add(limit.bound->name, limit);
  return all;
}

}  // namespace

std::vector<ExcludedDesigns> excluded_designs(DesignPoint<double> const& bench, DesignQuestion const* question) {
  std::vector<MapLimit> const limits = limits_of_map(bench, question);
  std::vector<ExcludedDesigns> excluded;
  for (MapLimit const& limit : limits) excluded.push_back({limit.name, {}});

  // A column has one Z_D, hence one sensitivity. Its rows are f-numbers, and adjacent rows form one rectangle.
  auto const z_d_at = [&](double column) { return map_z_d(bench, column / map_columns); };
  auto const f_number_at = [](double row) {
    return map_f_numbers.front() * std::pow(map_f_numbers.back() / map_f_numbers.front(), row / map_rows);
  };
  for (int column = 0; column < map_columns; ++column) {
    double const z_d = z_d_at(column + 0.5);
    auto const left = design_on_map(bench, bench.f_number, z_d_at(column));
    auto const right = design_on_map(bench, bench.f_number, z_d_at(column + 1));
    if (!left || !right) continue;
    auto const first_missed = [&](int row) {
      DesignPoint<double> const one = *design_on_map(bench, f_number_at(row + 0.5), z_d);
      return std::find_if(limits.begin(), limits.end(), [&](MapLimit const& limit) { return limit.is_missed(one); });
    };
    auto const wavelength_at = [&](int row) {
      return resolved_wavelength(*design_on_map(bench, f_number_at(row), z_d));
    };
    auto missed = first_missed(0);
    for (int row = 1, first_row = 0; row <= map_rows; ++row) {
      auto const next = row < map_rows ? first_missed(row) : limits.end();
      if (next == missed && row < map_rows) continue;
      if (missed != limits.end()) {
        excluded[static_cast<std::size_t>(missed - limits.begin())].areas.push_back(
            {left->sensitivity(), right->sensitivity(), wavelength_at(row), wavelength_at(first_row)});
      }
      missed = next;
      first_row = row;
    }
  }
  std::erase_if(excluded, [](ExcludedDesigns const& one) { return one.areas.empty(); });
  return excluded;
}

}  // namespace gladstone::inline figures
