#include "python/src/call.h"

NB_MODULE(_core, module) {
  using namespace gladstone::python;
  module.doc() = "Compiled part of gladstone; use the package gladstone.";
  nb::set_leak_warnings(false);  // arrays in global variables may outlive the module at exit
  route_log_to_python();
  translate_errors();
  bind_setup(module);
  bind_case(module);
  bind_truth(module);
  bind_field(module);
  bind_comparison(module);
  bind_density(module);
  bind_stereo(module);
  bind_information(module);
  bind_benchmark(module);
  bind_calibration(module);
  bind_design(module);
  bind_study(module);
  bind_sequence(module);
  bind_batches(module);
  bind_commands(module);
  bind_tomography(module);
}
