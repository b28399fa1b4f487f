#include "studies/commands/protected_files.h"

#include "studies/benchmark/benchmark_run.h"
#include "studies/case/case_files.h"
#include "studies/sweep/manifest.h"

namespace gladstone::inline commands {

std::vector<ProtectedFiles> protected_files() {
  return {{"study",
           {run_file::manifest, run_file::cases},
           {run_file::manifest, run_file::study, run_file::base, run_file::claims, run_file::table,
            run_file::table_text, run_file::points_text, run_file::job_files}},
          {"case",
           {case_file::setup, case_file::summary},
           {case_file::setup, case_file::summary, case_file::reference, case_file::flow, case_file::truth,
            case_file::any_plane}},
          {"benchmark case",
           {benchmark_truth, case_file::reference, case_file::flow},
           {benchmark_truth, case_file::reference, case_file::flow, case_file::setup}}};
}

}  // namespace gladstone::inline commands
