#include "studies/case/case_kind.h"

#include "render/base/contracts.h"
#include "render/base/error.h"

namespace gladstone::inline cases {

CaseKind const& case_kind(Setup const& setup) {
  CaseKind const* const kind = find_kind(all_case_kinds, setup.experiment());
  GLADSTONE_EXPECTS(kind);
  return *kind;
}

void require_experiment(Setup const& setup, Experiment const& needed, std::string const& name,
                        std::string const& refusal) {
  if (&setup.experiment() != &needed) throw DataError(ErrorCode::wrong_format, name, refusal);
}

}  // namespace gladstone::inline cases
