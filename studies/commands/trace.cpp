#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "render/files/output_file.h"
#include "render/files/source_files.h"
#include "render/files/stop_point.h"
#include "render/planning.h"
#include "studies/case/case.h"
#include "studies/case/json_text.h"
#include "studies/case/ray_file.h"
#include "studies/case/warning_log.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"

namespace gladstone::inline commands {

CommandBody attach_trace(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string setup, rays, output, through = "all";
    std::vector<std::string> overrides;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("setup", arguments->setup, "Setup file (TOML)")->required();
  app.add_option("--rays", arguments->rays, "CSV x_mm,y_mm,z_mm,dx,dy,dz in the world frame")->required();
  app.add_option("-o,--output", arguments->output, "CSV file to write")->required();
  app.add_option("--through", arguments->through, "End of the trace: medium, optics, or all (the sensor)")
      ->check(one_of({"medium", "optics", "all"}));
  app.add_option("--set", arguments->overrides, "Override a key: --set lens.f_number=16")->expected(1)->take_all();
  return [arguments, &options] {
    SourceFiles sources;
    sources.add("", arguments->setup, SourceFiles::Holds::bytes);
    sources.add("", arguments->rays, SourceFiles::Holds::bytes);
    CaseSetup loaded = load_case_setup(arguments->setup, arguments->overrides);
    std::vector<std::string> inputs = loaded.document.file_names();
    inputs.insert(inputs.end(), {arguments->setup, arguments->rays});
    refuse_inputs_as_outputs({arguments->output}, inputs);
    OutputFile output(arguments->output);
    std::vector<Ray<double>> const rays = read_rays(arguments->rays, loaded.setup.max_off_axis_distance());
    stop_point("tracing-rays");
    if (options.device == "cuda") throw DeviceError("trace: traces its few rays on the CPU; use --device cpu or auto");
    log_warnings(loaded.warnings);
    Scene const scene = build_scene(loaded.setup);
    log_warnings(scene.medium.warnings);
    double const step = plan_step(scene).step;
    Through const through = arguments->through == "medium"   ? Through::medium
                            : arguments->through == "optics" ? Through::optics
                                                             : Through::all;
    std::vector<TracedRay> const traced = trace_rays(scene, step, rays, through);
    std::string const text_of_rays = traced_rays_csv(traced);
    output.write(text_of_rays.data(), text_of_rays.size());
    sources.check();
    output.commit();
    std::size_t counts[ray_status_count] = {};
    for (TracedRay const& ray : traced) ++counts[static_cast<int>(ray.status)];
    nlohmann::json json{{"file", arguments->output}, {"rays", traced.size()}, {"step_mm", step * 1e3}};
    std::string text = fmt::format("{}: {} rays", arguments->output, traced.size());
    for (int status = 0; status < ray_status_count; ++status) {
      char const* const word = to_string(static_cast<RayStatus>(status));
      json["status"][word] = counts[status];
      if (counts[status] > 0) text += fmt::format(", {} {}", counts[status], word);
    }
    print_result(options, json_text(json), text);
    return ok;
  };
}

}  // namespace gladstone::inline commands
