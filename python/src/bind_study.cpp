#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "render/base/progress.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/figures/study_figures.h"
#include "studies/sweep/collect.h"
#include "studies/sweep/dataset.h"
#include "studies/sweep/plan.h"
#include "studies/sweep/ranking.h"
#include "studies/sweep/run.h"
#include "studies/sweep/state_report.h"
#include "studies/sweep/study_columns.h"

namespace gladstone::python {
namespace {

void plan(std::string const& study, std::string const& folder, std::string const& device) {
  StudyFile read = read_study(study);
  check_plan_folder(folder, read);
  std::string const planned = device == "auto" ? open_device(device).name() : device;
  StudyPlan const plan = plan_study(std::move(read), planned);
  log_warnings(plan.warnings());
  write_plan(folder, plan);
}

/// Computes the missing cases in this process, one after the other.
void compute(std::string const& folder, RunSelection const& selection) {
  Manifest const cases = read_manifest(folder);
  std::vector<std::size_t> const selected = selected_cases(cases.size(), selection);
  std::size_t const due = remove_failed_results(folder, cases, selected, selection).missing.size();
  if (due == 0) return;
  Progress progress("cases", due);
  ProgressMonitor of_cases;  // receives the progress of the steps of a case, which is not shown: `progress` counts
                             // whole cases
  ProgressMonitor::Scope const scope(of_cases);
  CaseRunner runner(open_device(cases[0].device));
  run_cases(folder, cases, selected, selection, computation_by(runner), 0, [&](std::size_t, CaseEvent event) {
    if (event == CaseEvent::finished) progress.advance();
  });
}

std::string state(std::string const& folder) {
  Manifest const cases = read_manifest(folder);
  std::vector<std::size_t> all(cases.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return json_text(state_json(folder, cases, determine_run_state(folder, cases, all)));
}

/// Returns the columns of a study's table: name to (values, labels, description).
nb::dict columns_of(StudyTable const& table) {
  nb::dict columns;
  for (StudyColumn const& column : table_columns(table)) {
    std::vector<double> values;
    for (StudyRow const& row : table.rows) values.push_back(column.number(row));
    std::size_t const count = values.size();
    columns[column.name.c_str()] =
        nb::make_tuple(array_of(std::move(values), {count}), nb::cast(column.labels), column.description);
  }
  return columns;
}

}  // namespace

void bind_study(nb::module_& module) {
  module.def(
      "study_plan",
      [](std::string const& study, std::string const& folder, std::string const& device, nb::handle progress) {
        run([&] { plan(study, folder, device); }, progress);
      },
      nb::arg("study"), nb::arg("folder"), nb::arg("device"), nb::arg("progress").none());
  module.def(
      "study_run",
      [](std::string const& folder, bool keep_images, bool pairs_only, bool retry_failed,
         std::optional<std::string> const& cases, nb::handle progress) {
        RunSelection selection;
        selection.only = cases;
        selection.pairs_only = pairs_only;
        selection.keep_images = keep_images;
        selection.retry_failed = retry_failed;
        run([&] { compute(folder, selection); }, progress);
      },
      nb::arg("folder"), nb::arg("keep_images"), nb::arg("pairs_only"), nb::arg("retry_failed"),
      nb::arg("cases").none(), nb::arg("progress").none());
  module.def(
      "study_state", [](std::string const& folder) { return run([&] { return state(folder); }); }, nb::arg("folder"));
  module.def(
      "study_collect", [](std::string const& folder) { return columns_of(run([&] { return collect_study(folder); })); },
      nb::arg("folder"));
  module.def(
      "study_ranking",
      [](std::string const& folder) {
        return run([&] {
          StudyTable const table = collect_study(folder);
          return json_text(ranking_json(table, rank_points(table)));
        });
      },
      nb::arg("folder"));
  module.def(
      "study_draw",
      [](std::string const& folder, std::string const& figures, std::vector<std::string> const& formats) {
        return run([&] { return draw_study(figures, collect_study(folder), formats); });
      },
      nb::arg("folder"), nb::arg("figures"), nb::arg("formats"));
  module.def(
      "study_dataset",
      [](std::string const& folder, std::string const& path, std::string const& device, nb::handle progress) {
        return run([&] { return pack_dataset(folder, path, *open_device(device).renderer).cases; }, progress);
      },
      nb::arg("folder"), nb::arg("path"), nb::arg("device"), nb::arg("progress").none());
}

}  // namespace gladstone::python
