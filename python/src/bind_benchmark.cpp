#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/field.h"
#include "render/base/error.h"
#include "studies/benchmark/benchmark_run.h"
#include "studies/compare/correlate.h"

namespace gladstone::python {
namespace {

/// Published case, rendered in memory.
struct MadePair {
  MadeCase made;
  std::vector<std::uint8_t> images;  ///< grey levels [2, rows, columns]
};

std::shared_ptr<MadePair> render_published_case(std::string const& name, std::string const& device_name) {
  auto const& cases = benchmark_cases();
  auto const found =
      std::find_if(cases.begin(), cases.end(), [&](BenchmarkCase const& one) { return one.name == name; });
  if (found == cases.end())
    throw DataError(ErrorCode::unknown_choice, name, "is not a case of the benchmark; see gladstone.benchmark_cases()");
  Backend const device = open_device(device_name);
  auto const pair = std::make_shared<MadePair>(MadePair{make_case(*found, device), {}});
  for (Image<double> const* frame : {&pair->made.frames.reference(), &pair->made.frames.flow()}) {
    std::transform(frame->begin(), frame->end(), std::back_inserter(pair->images),
                   [](double level) { return static_cast<std::uint8_t>(level); });
  }
  return pair;
}

/// True displacement at points, in the central definition. @return [count, 2], in px
nb::object truth_at(MadePair const& pair, NumberArray const& x, NumberArray const& y) {
  std::size_t const count = std::min(x.shape(0), y.shape(0));
  std::vector<double> truth;
  for (std::size_t i = 0; i < count; ++i) {
    Vec2d const d = pair.made.truth({x.data()[i], y.data()[i]});
    truth.insert(truth.end(), {d.x, d.y});
  }
  return array_of(std::move(truth), {count, 2});
}

nb::dict score(MadePair const& pair, MeasuredField const& field) {
  BenchmarkScore const scored = run([&] {
    return score_case(pair.made.record.of.name, field.field, pair.made.truth, pair.made.columns(), pair.made.rows());
  });
  nb::dict measures;
  for (auto const& [name, value] : score_measures(scored)) measures[nb::str(name.data(), name.size())] = value;
  return measures;
}

/// Measures the case with one of our estimators.
std::shared_ptr<MeasuredField> estimate(MadePair const& pair, std::string const& name, std::string const& device_name) {
  auto const& all = benchmark_estimators();
  auto const found = std::find_if(all.begin(), all.end(), [&](auto const& one) { return one.name == name; });
  if (found == all.end())
    throw DataError(ErrorCode::unknown_choice, name,
                    "is not an estimator of the benchmark; see gladstone.benchmark_estimators()");
  Backend const device = open_device(device_name);
  Measurement measured = correlate_frames(pair.made.frames, found->settings, device);
  auto field = std::make_shared<MeasuredField>();
  field->field = std::move(measured.field);
  field->seconds = measured.seconds;
  field->device = measured.device;
  field->foreign = false;
  return field;
}

}  // namespace

void bind_benchmark(nb::module_& module) {
  nb::class_<MadePair>(module, "MadePair", "Image pair of a published case.")
      .def_prop_ro("name", [](MadePair const& self) { return self.made.record.of.name; })
      .def_prop_ro("what", [](MadePair const& self) { return self.made.record.of.what; })
      .def("images",
           [](nb::handle_t<MadePair> self) {
             auto& held = nb::cast<MadePair&>(self);
             return view_of(
                 held.images.data(),
                 {2, static_cast<std::size_t>(held.made.rows()), static_cast<std::size_t>(held.made.columns())}, self);
           })
      .def("truth", &truth_at, nb::arg("x"), nb::arg("y"))
      .def("score", &score, nb::arg("field"));
  module.def(
      "benchmark_case",
      [](std::string const& name, std::string const& device) {
        return run([&] { return render_published_case(name, device); });
      },
      nb::arg("name"), nb::arg("device"));
  module.def(
      "benchmark_estimate",
      [](MadePair const& pair, std::string const& name, std::string const& device) {
        return run([&] { return estimate(pair, name, device); });
      },
      nb::arg("case"), nb::arg("name"), nb::arg("device"));
  module.def("benchmark_cases", [] {
    std::vector<std::string> names;
    for (BenchmarkCase const& one : benchmark_cases()) names.push_back(one.name);
    return names;
  });
  module.def("benchmark_estimators", [] {
    std::vector<std::string> names;
    for (BenchmarkEstimator const& one : benchmark_estimators()) {
      if (!one.of_curve) names.push_back(one.name);
    }
    return names;
  });
}

}  // namespace gladstone::python
