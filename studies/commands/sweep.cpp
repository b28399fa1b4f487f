#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>

#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/commands/command.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/study_figures.h"
#include "studies/sweep/collect.h"
#include "studies/sweep/dataset.h"
#include "studies/sweep/plan.h"
#include "studies/sweep/ranking.h"
#include "studies/sweep/state_report.h"

namespace gladstone::inline commands {
namespace {

char const* to_string(PlanOutcome planned) {
  switch (planned) {
    case PlanOutcome::fresh:
      return "fresh";
    case PlanOutcome::unchanged:
      return "unchanged";
    case PlanOutcome::replaced:
      break;
  }
  return "replaced";
}

constexpr char const* example_study =
    R"(A study to begin with; docs/studies.md describes all keys.

  base = "setup.toml"                # relative to this file
  [axes]
  "lens.f_number" = [4, 8, 16]
  "geometry.z_d_mm" = { linear = [100, 1000, 10] }   # first, last, count
  [study]
  repeats = 3)";

CommandBody attach_plan(CLI::App& app, GlobalOptions const& options) {
  app.footer(app.get_footer() + "\n\n" + example_study);
  struct Arguments {
    std::string study, run;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("study", arguments->study, "Study file (TOML): base setup and axes")->required();
  app.add_option("-o,--output", arguments->run, "RUN folder to create")->required();
  return [arguments, &options] {
    StudyFile read = read_study(arguments->study);
    check_plan_folder(arguments->run, read);
    std::string const device = options.device == "auto" ? options.open_device().name() : options.device;
    StudyPlan const plan = plan_study(std::move(read), device);
    log_warnings(plan.warnings());
    StudyFile const& study = plan.study();
    PlanOutcome const planned = write_plan(arguments->run, plan);
    nlohmann::ordered_json json{{"run", arguments->run},
                                {"cases", plan.size()},
                                {"repeats", study.repeats},
                                {"device", device},
                                {"planned", to_string(planned)}};
    json["axes"] = nlohmann::ordered_json::array();
    std::string axes;
    for (AxisPlan const& axis : study.axes) {
      std::size_t const values = study.mode == StudyMode::sobol && axis.range ? study.samples : axis.size();
      json["axes"].push_back({{"key", axis.key}, {"values", values}});
      axes += fmt::format("  {}: {} values\n", axis.key, values);
    }
    print_result(options, json_text(json),
                 fmt::format("{}: {} cases for {}{}\n{}", arguments->run, plan.size(), device,
                             planned == PlanOutcome::unchanged ? ", planned already" : "", axes));
    return ok;
  };
}

std::vector<std::size_t> all_of(Manifest const& cases) {
  std::vector<std::size_t> all(cases.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

CommandBody attach_status(CLI::App& app, GlobalOptions const& options) {
  auto run = std::make_shared<std::string>();
  app.add_option("run", *run, "RUN folder")->required();
  return [run, &options] {
    Manifest const cases = read_manifest(*run);
    RunState const state = determine_run_state(*run, cases, all_of(cases));
    print_result(options, json_text(state_json(*run, cases, state)), state_text(*run, cases, state));
    return ok;
  };
}

/// Draws the figures of RUN/figures/. @return their paths; empty without gnuplot
std::vector<std::string> draw_figures(std::string const& run, StudyTable const& table) {
  std::vector<std::string> drawn;
  draw_or_warn([&] { drawn = draw_study((std::filesystem::path(run) / "figures").string(), table); });
  return drawn;
}

CommandBody attach_collect(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string run, dataset;
    bool no_figures = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("run", arguments->run, "RUN folder")->required();
  app.add_flag("--no-figures", arguments->no_figures, "Draw no figures");
  app.add_option("--dataset", arguments->dataset,
                 "Pack images and true displacements of the cases that were run with --keep-images into one HDF5 file");
  return [arguments, &options] {
    std::string const& run = arguments->run;
    if (!arguments->dataset.empty())
      refuse_files_of_study(run, arguments->dataset);  // check the path before anything
                                                       // is written
    StudyTable const table = collect_study(run);
    if (table.builds.size() > 1) {
      log_warning({WarningCode::inconsistent, run,
                   fmt::format("the cases were computed by {} builds of gladstone ({}), whose numbers may differ",
                               table.builds.size(), fmt::join(table.builds, ", "))});
    }
    Manifest const cases = read_manifest(run);
    RunState const state = determine_run_state(run, cases, all_of(cases));
    std::vector<std::string> figures;
    if (!arguments->no_figures) figures = draw_figures(run, table);
    nlohmann::ordered_json json = state_json(run, cases, state);
    json["axes"] = table.axes.size();
    json["measures"] = table.measures.size();
    std::vector<std::string> files{run + '/' + run_file::table_text, run + '/' + run_file::table};
    if (table.repeats() > 1) files.push_back(run + '/' + run_file::points_text);
    json["files"] = files;
    json["figures"] = figures;
    std::vector<std::size_t> const warned = table.warned();
    json["warned"] = warned.size();
    if (!warned.empty()) {
      log_warning(
          {table.first_warning->code, run,
           fmt::format("{} of {} cases have warnings, see {}/cases/*.json; case {}: {}", warned.size(),
                       table.rows.size(), run, table.rows[warned.front()].index, to_string(*table.first_warning))});
    }
    std::vector<StudyRanking> const rankings = rank_points(table);
    if (options.json) json["ranking"] = ranking_json(table, rankings);  // with all points
    std::string packed;
    if (!arguments->dataset.empty()) {
      PackedDataset const set = pack_dataset(run, arguments->dataset, *options.open_device().renderer);
      json["dataset"] = {{"file", arguments->dataset}, {"cases", set.cases}, {"without", set.without}};
      packed = fmt::format("packed {} cases into {}{}\n", set.cases, arguments->dataset,
                           set.without ? fmt::format("; {} have no images or are not finished", set.without) : "");
    }
    std::string const drawn =
        figures.empty() ? "" : fmt::format("drew {} figures in {}/figures\n", figures.size(), run);
    print_result(options, json_text(json),
                 state_text(run, cases, state) + fmt::format("wrote {}\n{}{}{}", fmt::join(files, ", "), drawn, packed,
                                                             ranking_text(table, rankings)));
    return table.unfinished().empty() ? ok : incomplete;
  };
}

}  // namespace

CommandBody attach_sweep(CLI::App& app, GlobalOptions const& options) {
  struct Action {
    char const* name;
    char const* summary;
    char const* example;
    CommandBody (*attach)(CLI::App& app, GlobalOptions const& options);
  };
  static constexpr std::array actions{
      Action{"plan", "Write every case of a study into RUN/manifest.jsonl",
             "gladstone sweep plan study.toml -o out/run", attach_plan},
      Action{"run", "Compute the missing cases; can be interrupted and repeated at any time",
             "gladstone sweep run out/run --jobs 2", attach_sweep_run},
      Action{"status", "Report done, failed, missing and running cases; only reads files",
             "gladstone sweep status out/run --json", attach_status},
      Action{"collect", "Write RUN/study.csv and RUN/study.h5, one row per case, and draw RUN/figures/",
             "gladstone sweep collect out/run", attach_collect},
  };
  app.require_subcommand(0, 1);
  auto parsed = std::make_shared<std::vector<std::pair<CLI::App*, CommandBody>>>();
  for (Action const& action : actions) {
    CLI::App* const sub = app.add_subcommand(action.name, action.summary);
    sub->footer(
        fmt::format("Example:\n  {}\n\nGlobal options (--json --quiet --threads N --device D) may be placed anywhere.",
                    action.example));
    parsed->emplace_back(sub, action.attach(*sub, options));
  }
  return [parsed]() -> int {
    for (auto const& [sub, body] : *parsed) {
      if (sub->parsed()) return body();
    }
    print_error("gladstone: sweep requires one of plan, run, status, collect. See gladstone sweep --help");
    return bad_input;
  };
}

}  // namespace gladstone::inline commands
