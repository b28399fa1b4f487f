#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "python/src/call.h"
#include "python/src/setup_text.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/design/design.h"
#include "studies/figures/design_figures.h"

namespace gladstone::python {
namespace {

/// Folder and format of figures; an empty folder: none are drawn.
struct FigureOptions {
  std::string folder, format;
};

struct DesignAnswer {
  std::string json, text;
  bool feasible = true;
};

DesignAnswer answer(SetupText const& setup, DesignRequest request, FigureOptions const& figures,
                    std::string const& device) {
  request.setup = setup.name;
  request.open_device = [&device] { return open_device(device); };
  DesignReport const report = answer_design(setup.document(), request);
  log_warnings(report.warnings);
  nlohmann::ordered_json json;
  if (!figures.folder.empty()) json["figures"] = draw_design(report, figures.folder, figures.format);
  json.update(design_json(report));
  return {json_text(json), report.text, report.feasible};
}

}  // namespace

void bind_design(nb::module_& module) {
  module.def(
      "design",
      [](SetupText const& setup, int verify, int repeats, std::int64_t seed, std::string const& apply,
         std::string const& figures, std::string const& figure_format, std::string const& device, nb::handle progress) {
        DesignRequest request;
        request.apply = apply;
        if (verify >= 0) request.verification.benches = verify;
        if (repeats > 0) request.verification.repeats = repeats;
        if (seed >= 0) request.verification.seed = seed;
        DesignAnswer const answered = run(
            [&] {
              return answer(setup, request, {figures, figure_format}, device);
            },
            progress);
        return nb::make_tuple(answered.json, answered.text, answered.feasible);
      },
      nb::arg("setup"), nb::arg("verify"), nb::arg("repeats"), nb::arg("seed"), nb::arg("apply"), nb::arg("figures"),
      nb::arg("figure_format"), nb::arg("device"), nb::arg("progress").none());
}

}  // namespace gladstone::python
