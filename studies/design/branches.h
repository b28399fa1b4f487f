#pragma once

#include <memory>
#include <string>
#include <vector>

#include "studies/case/case.h"
#include "studies/design/bounds.h"

namespace gladstone::inline design {

/// A combination of a camera with a lens prescription, or with the thin lens defined by the design variables.
struct DesignVariant {
  std::string camera;  ///< file of the inventory; empty: the setup's camera
  std::string lens;    ///< prescription of the inventory; empty: thin lens, or the setup's prescription
  SetupDocument document;
  Setup setup;
  std::unique_ptr<FixedDesignParameters> given;
};

/// A camera or lens of the inventory that is incompatible with the setup.
struct SkippedVariant {
  std::string camera, lens;  ///< files; empty as in DesignVariant
  std::string reason;
  std::string name() const;  ///< returns a name for messages
};

/// Combines every camera of the inventory with the setup's lens and with every prescription.
/// @param document  a valid setup
/// @param skipped   receives the incompatible combinations
/// @param loaded    the same setup, loaded; null: it is loaded if needed
/// @throws SetupError if no combination is compatible, if the setup's camera and lens are not, or if the closed forms
///   do not apply
std::vector<DesignVariant> design_variants(SetupDocument const& document, DesignQuestion const& question,
                                           std::vector<SkippedVariant>& skipped, CaseSetup const* loaded = nullptr);

/// Returns all combinations of the variants and the discrete values of the design variables. The variants must outlive
/// them.
std::vector<DesignBranch> design_branches(std::vector<DesignVariant> const& variants, DesignQuestion const& question);

/// Returns camera, lens and values of a branch as text.
std::string branch_name(DesignBranch const& branch, std::vector<DesignVariant> const& variants,
                        DesignQuestion const& question);

/// Returns the setup of a design, ready to render: the variant's setup with the design's values, without the tables
/// that request the design.
SetupDocument applied_setup(DesignVariant const& variant, DesignQuestion const& question,
                            DesignPoint<double> const& bench);

}  // namespace gladstone::inline design
