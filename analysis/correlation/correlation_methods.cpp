#include "analysis/correlation/correlation_methods.h"

#include <array>

#include "render/base/contracts.h"

namespace gladstone::inline correlation {
namespace {

/// Table of all correlation methods.
constexpr std::array rows{
    CorrelationMethod{.name = "scc", .correlate = correlate_scc, .on_gpu = true},
    CorrelationMethod{.name = "rpc", .correlate = correlate_rpc, .on_gpu = true, .by_phase = true},
    CorrelationMethod{.name = "spc", .correlate = correlate_spc, .by_phase = true},
    CorrelationMethod{.name = "zncc", .correlate = correlate_zncc},
    CorrelationMethod{.name = "mqd", .correlate = correlate_mqd},
    CorrelationMethod{.name = "opencv", .correlate = correlate_by_opencv, .in_ensembles = false},
    CorrelationMethod{.name = "dis", .optical_flow = dense_inverse_search, .in_ensembles = false},
    CorrelationMethod{.name = "horn_schunck", .optical_flow = horn_schunck_flow, .in_ensembles = false},
    CorrelationMethod{.name = "tracking", .in_ensembles = false, .tracks_dots = true},
};

}  // namespace

std::span<CorrelationMethod const> all_correlation_methods() { return rows; }

CorrelationMethod const& correlation_method(std::string const& name) {
  for (CorrelationMethod const& row : rows)
    if (name == row.name) return row;
  GLADSTONE_EXPECTS(!"the name of a correlation method");
  return rows.front();
}

}  // namespace gladstone::inline correlation
