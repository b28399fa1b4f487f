#pragma once

#include <vector>

#include "render/scene/renderer.h"

namespace gladstone {

enum class ToleranceKind { absolute, relative };

/// A number that theory knows and that our code can be asked for. Adding one: a function, and its row in validate.cpp.
struct Oracle {
  char const* name;
  char const* source;  ///< author, year, equation
  double exact;
  double tolerance;
  ToleranceKind kind;
  double (*measure)(Renderer& renderer);
};

/// An oracle's answer beside ours.
struct OracleResult {
  Oracle oracle;
  double measured = 0;

  double error() const;  ///< of the oracle's kind
  bool passed() const;   ///< false, too, where the measurement is no number
};

/// Asks every oracle; those that need rendering use `renderer`.
std::vector<OracleResult> run_oracles(Renderer& renderer);

}  // namespace gladstone
