#include "analysis/correlation/correlation_methods.h"

#include <array>

#include "render/base/contracts.h"

namespace gladstone {
namespace {

/// Every correlation method, one row each.
constexpr std::array rows{
    CorrelationMethod{"scc", correlate_scc, true},
    CorrelationMethod{"rpc", correlate_rpc},
    CorrelationMethod{"spc", correlate_spc},
    CorrelationMethod{"zncc", correlate_zncc},
    CorrelationMethod{"mqd", correlate_mqd},
    CorrelationMethod{.name = "opencv", .correlate = correlate_by_opencv, .in_ensembles = false},
};

}  // namespace

std::span<CorrelationMethod const> all_correlation_methods() { return rows; }

CorrelateWindows correlation_method(std::string const& name) {
  for (CorrelationMethod const& row : rows)
    if (name == row.name) return row.correlate;
  GLADSTONE_EXPECTS(!"the name of a correlation method");
  return nullptr;
}

}  // namespace gladstone
