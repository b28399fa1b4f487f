#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_json.h"
#include "studies/compare/sequence.h"
#include "studies/compare/sequence_frames.h"

namespace gladstone::python {
namespace {

/// Correlates the pairs of a sequence into a folder, as `gladstone correlate INPUTS -o FOLDER/`.
/// @param config  TOML file with a table [correlate]; empty: defaults
/// @return JSON text with the result of each pair
std::string correlate_pairs(std::vector<std::string> const& inputs, std::string const& pairing_name,
                            std::string const& folder, std::string const& config,
                            std::vector<std::string> const& overrides, std::string const& device) {
  Pairing const pairing = parse_pairing(pairing_name);
  SequenceSettings const settings = read_sequence_settings(pairing, config, overrides);
  std::vector<SequencePair> const pairs = form_pairs(list_sequence_files(inputs, pairing), pairing);
  SequenceResult const result = correlate_sequence(pairs, settings, folder, open_device(device), true);
  nlohmann::json list = nlohmann::json::array();
  for (PairRecord const& record : result.pairs) {
    list.push_back({{"a", record.pair.reference.name()},
                    {"b", record.pair.flow.name()},
                    {"vectors", record.has_vectors() ? nlohmann::json(record.pair.vectors) : nullptr},
                    {"error", record.error},
                    {"warnings", to_strings(record.warnings)},
                    {"warning_records", record.warnings},
                    {"resumed", record.resumed}});
  }
  report_sequence(result, folder);
  return json_text(nlohmann::json{{"pairs", std::move(list)}, {"device", result.device}, {"seconds", result.seconds}});
}

/// Returns the datasets of statistics.h5 by name, "u_mean_px", as arrays [rows, columns].
nb::dict read_statistics(std::string const& path) {
  Hdf5Reader const file(path);
  auto const size_of = [&file](char const* name) {
    return static_cast<std::size_t>(std::strtoul(file.attribute(name).c_str(), nullptr, 10));
  };
  std::size_t const columns = size_of("grid_columns"), rows = size_of("grid_rows");
  nb::dict arrays;
  for (std::string const& dataset : file.number_datasets()) {
    std::vector<double> values = file.read(dataset);
    std::size_t const count = values.size();
    bool const on_grid = columns * rows == count;
    arrays[dataset.substr(1).c_str()] =
        array_of(std::move(values), on_grid ? std::vector{rows, columns} : std::vector{count});
  }
  return arrays;
}

}  // namespace

void bind_sequence(nb::module_& module) {
  module.def(
      "correlate_sequence",
      [](std::vector<std::string> const& inputs, std::string const& pairing, std::string const& folder,
         std::string const& config, std::vector<std::string> const& overrides, std::string const& device,
         nb::handle progress) {
        return run([&] { return correlate_pairs(inputs, pairing, folder, config, overrides, device); }, progress);
      },
      nb::arg("inputs"), nb::arg("pairing"), nb::arg("folder"), nb::arg("config"), nb::arg("overrides"),
      nb::arg("device"), nb::arg("progress").none());
  module.def(
      "sequence_statistics", [](std::string const& path) { return read_statistics(path); }, nb::arg("path"));
}

}  // namespace gladstone::python
