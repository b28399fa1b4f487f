#include "studies/commands/convert.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "analysis/vectors/three_components.h"
#include "analysis/vectors/vector_file.h"
#include "render/base/error.h"
#include "render/files/input_file.h"
#include "render/files/output_file.h"
#include "studies/case/backend.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/compare/density_table.h"
#include "studies/compare/exported_vectors.h"

namespace gladstone::inline commands {
namespace {

void require_ending(std::string const& output, std::vector<std::string> const& endings) {
  if (std::any_of(endings.begin(), endings.end(), [&](auto const& ending) { return output.ends_with(ending); })) return;
  throw OutputError(output, fmt::format("must end in one of {}, which selects the format", fmt::join(endings, ", ")));
}

/// Converts a file of three components.
/// @return JSON and text of the result
Description convert_three_components(std::string const& input, std::string const& output) {
  require_ending(output, three_component_extensions());
  ExportedComponents const exported = load_components_for_export(input);
  ThreeComponentField const& field = exported.field;
  write_three_components(output, field, exported.origin);
  auto const valid = std::count(field.status.begin(), field.status.end(), VectorStatus::valid);
  return {json_text(nlohmann::json{{"file", output},
                                   {"format", "gladstone stereo"},
                                   {"vectors", field.size()},
                                   {"valid", valid},
                                   {"columns", field.x_mm.size()},
                                   {"rows", field.y_mm.size()}}),
          fmt::format("{}: {} vectors of three components, {} valid", output, field.size(), valid)};
}

/// Converts a file of densities in a plane or a volume.
/// @return JSON and text of the result
Description convert_density(std::string const& input, std::string const& output) {
  require_ending(output, grid_table_extensions());
  ExportedDensity const exported = load_density_for_export(input);
  write_grid_table(output, exported.table, exported.origin);
  nlohmann::json names = nlohmann::json::array();
  for (auto const& column : exported.table.columns) names.push_back(column.name);
  return {json_text(nlohmann::json{
              {"file", output}, {"format", exported.format}, {"nodes", exported.table.nodes()}, {"quantities", names}}),
          fmt::format("{}: {} quantities at {} nodes", output, names.size(), exported.table.nodes())};
}

/// Loads the vectors to convert; computes them if they are the truth at pixels.
/// @throws DataError if a spacing or exactness is given for other files than truth.h5
ExportedVectors load_vectors(VectorConversion const& conversion) {
  std::string const& input = conversion.input;
  bool const truth = is_truth_file(input);
  if (!truth && conversion.spacing_px > 0)
    throw DataError(ErrorCode::arguments, "--spacing", "has an effect on truth.h5 of a case only; remove it");
  bool const grid_format = conversion.output.ends_with(".nc") || conversion.output.ends_with(".vti");
  bool const exact = conversion.traced == TracedPixels::all;
  if (!truth && exact)
    throw DataError(ErrorCode::arguments, "--exact", "has an effect on truth.h5 of a case only; remove it");
  if (!truth || (conversion.spacing_px == 0 && !grid_format && !exact))
    return load_for_export(input, conversion.conventions, conversion.image_rows);
  return compute_map_for_export(input, *open_device(conversion.device).renderer, conversion.truth_at,
                                std::max(conversion.spacing_px, 1), conversion.traced);
}

}  // namespace

ConvertedVectors convert_vectors(VectorConversion const& conversion) {
  std::string const &input = conversion.input, &output = conversion.output;
  require_ending(output, vector_extensions());
  require_input_file(input, "a file of vectors");
  refuse_inputs_as_outputs({output}, {input});
  OutputFile const tried(output);
  if (is_density_file(input)) return {convert_density(input, output)};
  if (is_three_component_file(input)) return {convert_three_components(input, output)};
  ExportedVectors const vectors = load_vectors(conversion);
  write_vectors(output, vectors.field, vectors.origin);
  std::size_t counted = 0;
  for (std::size_t i = 0; i < vectors.field.size(); ++i) counted += vectors.field.counts(i) ? 1 : 0;
  nlohmann::json json{{"file", output},   {"format", vectors.format},         {"vectors", vectors.field.size()},
                      {"valid", counted}, {"columns", vectors.field.columns}, {"rows", vectors.field.rows}};
  if (vectors.foreign) json["conventions"] = vectors.conventions;
  std::string const text = fmt::format("{}: {} vectors of {}{}, {} valid", output, vectors.field.size(), vectors.format,
                                       vectors.foreign ? " read as " + vectors.conventions : "", counted);
  return {{json_text(json), text}, vectors.complete};
}

CommandBody attach_convert(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    VectorConversion conversion;
    std::string truth_at = "mid";
    bool exact = false;
  };
  auto arguments = std::make_shared<Arguments>();
  VectorConversion& conversion = arguments->conversion;
  app.add_option(
         "input", conversion.input,
         "Vectors of gladstone in any of these formats, of OpenPIV, PIVlab, DaVis, Insight, Dantec, JPIV, PIVPy "
         "or any x,y,u,v; truth.h5 of a case, for the true displacements of its dots or particles, or of its "
         "pixels; three components of gladstone stereo; or densities of gladstone reconstruct or tomography")
      ->required();
  app.add_option(
         "-o,--output", conversion.output,
         fmt::format("File to write, whose ending selects the format: {}", fmt::join(vector_extensions(), ", ")))
      ->required();
  app.add_option(
      "--conventions", conversion.conventions,
      "Conventions of a file of another program, instead of those of its format, see gladstone compare --help");
  app.add_option("--image-rows", conversion.image_rows,
                 "Rows of the image, for files that count y upwards from its last row")
      ->check(whole_number(1, 1'000'000));
  app.add_option("--spacing", conversion.spacing_px,
                 "truth.h5: computes the true displacement at every Nth column and row of the image, instead of the "
                 "dots or particles; .nc and .vti always contain such a grid, by default of every pixel")
      ->check(whole_number(1, 10'000));
  app.add_flag("--exact", arguments->exact,
               "truth.h5: traces light rays to every pixel (of --spacing), not only to every fourth and where the "
               "displacement is not smooth; takes about 8 times as long for 256 x 256 px");
  app.add_option("--truth-at", arguments->truth_at,
                 "Position to which the displacement at a pixel belongs: mid (midway between both frames) or reference")
      ->check(one_of({"mid", "reference"}));
  return [arguments, &options]() -> int {
    VectorConversion conversion = arguments->conversion;
    if (arguments->truth_at == "reference") conversion.truth_at = TruthAt::reference;
    if (arguments->exact) conversion.traced = TracedPixels::all;
    conversion.device = options.device;
    ConvertedVectors const converted = convert_vectors(conversion);
    print_result(options, converted.description.json, converted.description.text);
    return converted.complete ? ok : check_missed;
  };
}

}  // namespace gladstone::inline commands
