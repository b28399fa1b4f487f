#include <nanobind/stl/string.h>

#include "python/src/call.h"
#include "python/src/setup_text.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/design/design.h"

namespace gladstone::python {
namespace {

DesignReport answer(SetupText const& setup, DesignRequest request, std::string const& device) {
  request.setup = setup.name;
  request.open_device = [&device] { return open_device(device); };
  DesignReport report = design(setup.document(), request);
  log_warnings(report.warnings);
  return report;
}

}  // namespace

void bind_design(nb::module_& module) {
  module.def(
      "design",
      [](SetupText const& setup, int verify, int repeats, std::int64_t seed, std::string const& apply,
         std::string const& figures, std::string const& figure_format, std::string const& device, nb::handle progress) {
        DesignRequest request;
        request.figures = figures;
        request.figure_format = figure_format;
        request.apply = apply;
        if (verify >= 0) request.verification.benches = verify;
        if (repeats > 0) request.verification.repeats = repeats;
        if (seed >= 0) request.verification.seed = seed;
        DesignReport const report = run([&] { return answer(setup, request, device); }, progress);
        return nb::make_tuple(json_text(report.json), report.text, report.feasible);
      },
      nb::arg("setup"), nb::arg("verify"), nb::arg("repeats"), nb::arg("seed"), nb::arg("apply"), nb::arg("figures"),
      nb::arg("figure_format"), nb::arg("device"), nb::arg("progress").none());
}

}  // namespace gladstone::python
