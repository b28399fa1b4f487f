#include "studies/case/case_kind.h"

#include "render/base/contracts.h"
#include "render/base/error.h"

namespace gladstone::inline cases {

CaseKind const& case_kind(Setup const& setup) {
  for (CaseKind const* one : all_case_kinds)
    if (&one->experiment == &setup.experiment()) return *one;
  GLADSTONE_EXPECTS(!"the kind of a case");
  return *all_case_kinds.front();
}

void require_experiment(Setup const& setup, Experiment const& needed, std::string const& name,
                        std::string const& refusal) {
  if (&setup.experiment() != &needed) throw DataError(ErrorCode::wrong_format, name, refusal);
}

}  // namespace gladstone::inline cases
