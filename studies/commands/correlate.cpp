#include "studies/correlate.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis/vector_file.h"
#include "render/base/error.h"
#include "render/base/image_file.h"
#include "studies/case.h"
#include "studies/commands/command.h"
#include "studies/json_text.h"

namespace gladstone {
namespace {

Image<double> read_frame(std::string const& path) {
  ImageMetadata metadata;
  Image<double> image = read_image(path, &metadata);
  if (metadata.channels >= 3) {
    spdlog::warn("{} is a colour picture: its luminance (Rec. 709) is correlated; cameras' raw grey images are better",
                 path);
  }
  return image;
}

}  // namespace

CommandBody attach_correlate(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::vector<std::string> inputs, overrides;
    std::string output, config;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("input", arguments->inputs, "A case folder, or two images: reference and flow")
      ->required()
      ->expected(1, 2);
  app.add_option("-o,--output", arguments->output, "Vectors to write: .h5 or .csv; default CASE/vectors.h5");
  app.add_option("--config", arguments->config,
                 "TOML file with a table [correlate], which may be a whole setup; default: the case's own");
  app.add_option("--set", arguments->overrides, "Override a key: --set correlate.overlap=0.75")
      ->expected(1)
      ->take_all();
  return [arguments, &options] {
    Device const device = options.open_device();
    std::string const& output = arguments->output;
    if (!output.empty() && !output.ends_with(".h5") && !output.ends_with(".csv")) {
      throw OutputError(output, "has an ending that is neither .h5 nor .csv; choose one of them");
    }
    bool const configured = !arguments->config.empty() || !arguments->overrides.empty();
    std::string config = arguments->config;
    if (config.empty() && configured && arguments->inputs.size() == 1) {
      config = in_case(arguments->inputs[0], case_file::setup);
    }
    CorrelationFile const other = !config.empty() ? read_correlation_file(config, arguments->overrides)
                                                  : default_correlation(arguments->overrides);
    Measurement measurement;
    std::string written = output;
    if (arguments->inputs.size() == 1) {
      std::string const& folder = arguments->inputs[0];
      if (!std::filesystem::is_directory(folder)) {
        throw DataError(
            folder, "is not a case folder (give one, or two images: gladstone correlate A.tif B.tif -o vectors.csv)");
      }
      measurement = correlate_case(folder, output, configured ? &other : nullptr, device);
      if (written.empty()) written = in_case(folder, case_file::vectors);
    } else {
      if (output.empty()) throw OutputError("correlate", "two images need -o FILE.h5 or FILE.csv");
      std::string const &a = arguments->inputs[0], &b = arguments->inputs[1];
      measurement = correlate_frames(a, read_frame(a), b, read_frame(b), other.settings, device);
      write_vectors(output, measurement.field, {"gladstone vectors", 1, other.resolved, 0, device.name()});
    }
    long long counts[4] = {};
    for (VectorStatus status : measurement.field.status) ++counts[static_cast<int>(status)];
    if (counts[0] + counts[1] == 0) {
      spdlog::warn("{}: none of {} vectors is valid; are these two frames of one scene, with dots in every window?",
                   written, measurement.field.size());
    }
    nlohmann::json const json{{"vectors", measurement.field.size()},
                              {"file", written},
                              {"valid", counts[0]},
                              {"replaced", counts[1]},
                              {"masked", counts[2]},
                              {"invalid", counts[3]},
                              {"device", device.name()},
                              {"seconds_correlate", measurement.seconds}};
    print_result(options, json_text(json),
                 fmt::format("{}: {} vectors, {} replaced, {} invalid, {:.2f} s", written, measurement.field.size(),
                             counts[1], counts[3], measurement.seconds));
    return ok;
  };
}

}  // namespace gladstone
