#include "studies/compare/reconstruct.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "render/base/error.h"
#include "render/files/output_file.h"
#include "studies/case/case_files.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/density_options.h"
#include "studies/compare/density_file.h"
#include "studies/compare/density_table.h"
#include "studies/compare/reconstruct_case.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/density_figure.h"
#include "studies/figures/draw_or_warn.h"

namespace gladstone::inline commands {
namespace {

/// Draws the figure, or warns if gnuplot is not installed.
void draw_density(std::string const& path, Reconstruction const& reconstruction) {
  if (draw_or_warn([&] { draw_figure(make_density_figure(reconstruction), path); })) spdlog::info("drew {}", path);
}

}  // namespace

CommandBody attach_reconstruct(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string place, output, vectors, conventions;
    DensityArguments density;
    bool budget = false, no_figures = false, csv = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("case", arguments->place,
                 "Case folder, or with --vectors the setup (TOML) of measured images, whose camera, lens, geometry and "
                 "medium convert displacement to density")
      ->required();
  app.add_option("-o,--output", arguments->output,
                 "File for the density, .h5, .nc, .vti, .mat or .csv; the figure has the same name with .png")
      ->required();
  app.add_option("--vectors", arguments->vectors, "Vectors of gladstone or another program, default CASE/vectors.h5");
  app.add_option("--conventions", arguments->conventions, "Conventions of --vectors, see gladstone compare --help");
  arguments->density.add_to(app);
  app.add_flag("--budget", arguments->budget,
               "Split the error of a rendered case into its causes, from the comparison of the vectors with truth and "
               "theory, which is computed unless gladstone compare has stored it");
  app.add_flag("--no-figures", arguments->no_figures, "Draw no figure");
  app.add_flag("--csv", arguments->csv, csv_help);
  return [arguments, &options] {
    Backend const device = options.open_device();
    ReconstructOptions reconstruct = arguments->density.options();
    reconstruct.vectors = arguments->vectors;
    if (!arguments->conventions.empty()) reconstruct.conventions = arguments->conventions;
    reconstruct.budget = arguments->budget;
    std::string const& output = arguments->output;
    require_density_ending(output);
    std::string const figure = std::filesystem::path(output).replace_extension(".png").string();
    std::vector<std::string> inputs = rendered_files(arguments->place);
    inputs.push_back(arguments->place);
    inputs.push_back(reconstruct.vectors.empty()
                         ? (std::filesystem::path(arguments->place) / case_file::vectors).string()
                         : reconstruct.vectors);
    refuse_inputs_as_outputs({output, figure}, inputs);
    OutputFile const tried(output, "gladstone density");
    Reconstruction const result = reconstruct_case(arguments->place, reconstruct, device);
    write_density(output, result);
    if (!arguments->no_figures) draw_density(figure, result);
    nlohmann::ordered_json json = summarize_reconstruction(result);
    json["file"] = output;
    print_result(options, json_text(json),
                 arguments->csv ? rows_csv(reconstruction_rows(result)) : reconstruction_report(result));
    return ok;
  };
}

}  // namespace gladstone::inline commands
