#pragma once

#include <vector>

#include "render/scene/renderer.h"

namespace gladstone::inline oracles {

enum class ToleranceKind { absolute, relative };

/// A quantity with a known exact value and the function that measures it with our code. To add one, write the function
/// and add a row in validate.cpp.
struct Oracle {
  char const* name;
  char const* source;  ///< author, year, equation
  double exact;
  double tolerance;
  ToleranceKind kind;
  double (*measure)(Renderer& renderer);
};

/// Exact and measured value of an oracle.
struct OracleResult {
  Oracle oracle;
  double measured = 0;

  double error() const;  ///< absolute or relative error, as the oracle specifies
  bool passed() const;   ///< false also if the measurement is NaN
};

/// Measures all oracles.
/// @param renderer  used by those that require rendering
std::vector<OracleResult> run_oracles(Renderer& renderer);

}  // namespace gladstone::inline oracles
