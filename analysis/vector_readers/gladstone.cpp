#include <fmt/format.h>

#include "analysis/vector_readers/vector_readers.h"
#include "render/base/error.h"

namespace gladstone::detail {
namespace {

DisplacementField whole_field(std::vector<double> const& x, std::vector<double> const& y, std::vector<double> const& u,
                              std::vector<double> const& v, std::vector<double> const& sigma_u,
                              std::vector<double> const& sigma_v, std::vector<double> const& peak_ratio) {
  DisplacementField field = plain_vectors(x, y, u, v);
  for (std::size_t i = 0; i < x.size(); ++i) field.sigma_px.push_back({sigma_u[i], sigma_v[i]});
  field.peak_ratio = peak_ratio;
  return field;
}

}  // namespace

VectorFile read_gladstone_hdf5(std::string const& path) {
  Hdf5Reader const file(path);
  std::size_t count = 0;
  auto const read = [&](std::string const& dataset) {
    if (!file.has(dataset)) {
      throw DataError(path, fmt::format("no dataset {} (the file holds {}); vectors.h5 of gladstone correlate has it",
                                        dataset, fmt::join(file.dataset_names(), ", ")));
    }
    std::vector<double> values = file.read(dataset);
    if (dataset == "/x_px") count = values.size();
    if (values.size() != count) {
      throw DataError(path, fmt::format("{}: {} values where /x_px has {}", dataset, values.size(), count));
    }
    return values;
  };
  auto const x = read("/x_px");
  DisplacementField field = whole_field(x, read("/y_px"), read("/u_px"), read("/v_px"), read("/sigma_u_px"),
                                        read("/sigma_v_px"), read("/peak_ratio"));
  std::vector<double> const status = read("/status");
  for (std::size_t i = 0; i < count; ++i) {
    if (!(status[i] == 0.0 || status[i] == 1.0 || status[i] == 2.0 || status[i] == 3.0)) {
      throw DataError(path, fmt::format("/status[{}] = {} is not 0, 1, 2 or 3", i, status[i]));
    }
    field.status[i] = static_cast<VectorStatus>(static_cast<int>(status[i]));
  }
  return {std::move(field), "gladstone", {}, false};
}

bool is_gladstone_csv(TextTable const& table) {
  for (std::string_view const name :
       {"x_px", "y_px", "u_px", "v_px", "sigma_u_px", "sigma_v_px", "peak_ratio", "status"}) {
    if (!table.find({name})) return false;
  }
  return true;
}

VectorFile read_gladstone_csv(TextTable const& table) {
  DisplacementField field =
      whole_field(table.column({"x_px"}), table.column({"y_px"}), table.column({"u_px"}), table.column({"v_px"}),
                  table.column({"sigma_u_px"}), table.column({"sigma_v_px"}), table.column({"peak_ratio"}));
  read_status(table, *table.find({"status"}), field);
  return {std::move(field), "gladstone", {}, false};
}

}  // namespace gladstone::detail
