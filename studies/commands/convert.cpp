#include "studies/commands/convert.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "analysis/vectors/three_components.h"
#include "analysis/vectors/vector_file.h"
#include "render/base/error.h"
#include "render/files/input_file.h"
#include "render/files/output_file.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/compare/exported_vectors.h"

namespace gladstone {
namespace {

/// Converts a file of three components.
/// @return JSON and text of the result
Description convert_three_components(std::string const& input, std::string const& output) {
  std::vector<std::string> const endings = three_component_extensions();
  bool const known =
      std::any_of(endings.begin(), endings.end(), [&](auto const& ending) { return output.ends_with(ending); });
  if (!known)
    throw OutputError(output, fmt::format("has an ending that selects no format of three components; choose one of {}",
                                          fmt::join(endings, ", ")));
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

}  // namespace

ConvertedVectors convert_vectors(VectorConversion const& conversion) {
  std::string const &input = conversion.input, &output = conversion.output;
  if (!has_vector_extension(output)) {
    throw OutputError(output, fmt::format("has an ending that selects no format; choose one of {}",
                                          fmt::join(vector_extensions(), ", ")));
  }
  require_input_file(input, "a file of vectors");
  refuse_inputs_as_outputs({output}, {input});
  OutputFile const tried(output);
  if (is_three_component_file(input)) return {convert_three_components(input, output)};
  ExportedVectors const vectors = load_for_export(input, conversion.conventions, conversion.image_rows);
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
  auto arguments = std::make_shared<VectorConversion>();
  app.add_option("input", arguments->input,
                 "Vectors of gladstone, OpenPIV, PIVlab, DaVis, Insight, Dantec, JPIV or any x,y,u,v; truth.h5 of a "
                 "case, for the true displacements of its dots or particles; or three components of gladstone stereo")
      ->required();
  app.add_option(
         "-o,--output", arguments->output,
         fmt::format("File to write, whose ending selects the format: {}", fmt::join(vector_extensions(), ", ")))
      ->required();
  app.add_option("--conventions", arguments->conventions,
                 "Conventions of a file of another program, instead of those of its format, as for gladstone compare");
  app.add_option("--image-rows", arguments->image_rows,
                 "Rows of the image, for files that count y upwards from its last row")
      ->check(whole_number(1, 1'000'000));
  return [arguments, &options]() -> int {
    ConvertedVectors const converted = convert_vectors(*arguments);
    print_result(options, converted.description.json, converted.description.text);
    return converted.complete ? ok : check_missed;
  };
}

}  // namespace gladstone
