#include <CLI/CLI.hpp>

#include "render/base/error.h"
#include "render/scene/read_setup_document.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/figure_ending.h"
#include "studies/commands/info_field.h"
#include "studies/commands/info_image.h"
#include "studies/commands/info_lens.h"
#include "studies/commands/info_mie.h"
#include "studies/commands/info_particles.h"
#include "studies/commands/info_setup.h"

namespace gladstone::inline commands {
namespace {

/// @param csv  true: prints the quantities as CSV instead of the text
int print(GlobalOptions const& options, Description const& description, bool csv) {
  print_result(options, description.json, csv ? rows_csv(description.rows) : description.text);
  return ok;
}

}  // namespace

CommandBody attach_info(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string kind, file, dataset, axes, setup, figure, x, m;
    std::vector<std::string> overrides;
    LensQuestion lens;
    bool csv = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("kind", arguments->kind, "field, image, lens, mie, particles or setup")
      ->required()
      ->check(one_of({"field", "image", "lens", "mie", "particles", "setup"}));
  app.add_option("file", arguments->file, "Input file; for particles and setup a setup, for mie none");
  app.add_option("--dataset", arguments->dataset, "Dataset inside the file");
  app.add_option("--axes", arguments->axes,
                 "World axes in the order of the field's file, the slowest first (\"zxy\"), see medium.field.axes");
  app.add_option("--setup", arguments->setup, "Setup (TOML) for which the filled fraction of the view is reported");
  app.add_option("--set", arguments->overrides,
                 "Override a key of the setup for info setup or particles: "
                 "--set lens.f_number=16")
      ->take_all()
      ->expected(1)
      ->trigger_on_parse(false);
  app.add_option("--glass", arguments->lens.glasses, "Additional glass catalogue (AGF) for info lens");
  app.add_option("--wavelength-nm", arguments->lens.wavelength_nm, "Wavelength for info lens")
      ->check(number(100, 20'000));
  app.add_option(
      "--figure", arguments->figure,
      "Figure of info field (planes through its middle), lens, mie or setup (its layout): .png, .svg or .pdf");
  app.add_option("--x", arguments->x, "Size parameter pi d n / lambda of the sphere, for info mie");
  app.add_option("--m", arguments->m,
                 "Refractive index of the sphere relative to its surroundings, for info mie: RE or RE,IM");
  app.add_flag("--csv", arguments->csv, csv_help);
  return [arguments, &options] {
    check_figure_ending(arguments->figure);
    if (arguments->kind == "mie") {
      if (!arguments->file.empty())
        throw DataError(ErrorCode::arguments, arguments->file, "is not read by info mie; give only --x and --m");
      MieQuestion mie = read_mie_question(arguments->x, arguments->m);
      mie.figure = arguments->figure;
      return print(options, describe_mie(mie), arguments->csv);
    }
    if (!arguments->x.empty() || !arguments->m.empty()) {
      throw DataError(ErrorCode::arguments, arguments->x.empty() ? "--m" : "--x",
                      "belongs to info mie, not to info " + arguments->kind + "; remove it");
    }
    if (!arguments->figure.empty() && (arguments->kind == "image" || arguments->kind == "particles")) {
      throw DataError(ErrorCode::arguments, "--figure", "is not drawn by info " + arguments->kind + "; remove it");
    }
    if (!arguments->overrides.empty() && arguments->kind != "setup" && arguments->kind != "particles") {
      throw DataError(ErrorCode::arguments, "--set",
                      "requires a setup, which info " + arguments->kind + " does not read; remove it");
    }
    if (arguments->file.empty())
      throw DataError(ErrorCode::arguments, "info " + arguments->kind, "requires a file; add its name");
    if (arguments->kind == "lens") {
      arguments->lens.file = arguments->file;
      arguments->lens.figure = arguments->figure;
      return print(options, describe_lens(arguments->lens), arguments->csv);
    }
    bool const particles = arguments->kind == "particles";
    if (particles || arguments->kind == "setup") {
      SetupDocument setup = read_setup_document(arguments->file, arguments->overrides);
      return print(options,
                   particles ? describe_particles(setup, arguments->file)
                             : describe_setup(setup, arguments->file, arguments->figure),
                   arguments->csv);
    }
    if (arguments->kind == "image") return print(options, describe_image(arguments->file), arguments->csv);
    return print(
        options,
        describe_field(arguments->file, arguments->dataset, arguments->axes, arguments->setup, arguments->figure),
        arguments->csv);
  };
}

}  // namespace gladstone::inline commands
