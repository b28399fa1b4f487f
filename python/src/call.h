#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

namespace gladstone::python {

namespace nb = nanobind;

/// Routes the log of the library to Python: warnings become Python warnings, information goes to
/// logging.getLogger("gladstone"). Messages are delivered when the call during which they were logged ends.
void route_log_to_python();

/// Runs `work` in a new thread without the GIL, so that other Python threads continue. The calling thread handles
/// Python's signals: an exception from a handler, such as KeyboardInterrupt, stops the computation at its next check of
/// the interrupt flag and is then raised.
/// @param progress  callable (number, label, done, total), called at most ten times a second; or None
void run_released(std::function<void()> const& work, nb::handle progress);

/// Returns the result of `work`, run by run_released().
template <class Work>
auto run(Work&& work, nb::handle progress = nb::none()) {
  using Result = std::invoke_result_t<Work>;
  if constexpr (std::is_void_v<Result>) {
    run_released(std::forward<Work>(work), progress);
  } else {
    std::optional<Result> result;
    run_released([&] { result.emplace(work()); }, progress);
    return std::move(*result);
  }
}

/// Registers the translation of C++ exceptions to those of gladstone._errors.
void translate_errors();

// Functions that define the contents of the module, one for each topic.
void bind_setup(nb::module_& module);
void bind_case(nb::module_& module);
void bind_truth(nb::module_& module);
void bind_field(nb::module_& module);
void bind_comparison(nb::module_& module);
void bind_density(nb::module_& module);
void bind_stereo(nb::module_& module);
void bind_information(nb::module_& module);
void bind_benchmark(nb::module_& module);
void bind_calibration(nb::module_& module);
void bind_design(nb::module_& module);
void bind_study(nb::module_& module);
void bind_tomography(nb::module_& module);
void bind_sequence(nb::module_& module);
void bind_batches(nb::module_& module);
void bind_commands(nb::module_& module);

}  // namespace gladstone::python
