#pragma once

#include <memory>
#include <string>
#include <vector>

#include "studies/case.h"
#include "studies/design/bounds.h"

namespace gladstone {

/// One camera with one lens, or with the thin lenses that the choices describe.
struct DesignVariant {
  std::string camera;  ///< file of the inventory; empty: the setup's own
  std::string lens;    ///< prescription of the inventory; empty: thin, or the setup's own
  SetupDocument document;
  Setup setup;
  std::unique_ptr<BenchGiven> given;
};

/// A camera or lens of the inventory that does not go with the setup.
struct SkippedVariant {
  std::string camera, lens;  ///< files; empty as above
  std::string reason;
  std::string name() const;  ///< for the reader
};

/// Every camera of the inventory with the setup's lens and with every prescription.
/// @param document a setup that can be loaded
/// @param skipped gets those that do not go with the setup
/// @throws SetupError where none does, where the setup's own do not, or where closed forms do not describe it
std::vector<DesignVariant> design_variants(SetupDocument const& document, DesignQuestion const& question,
                                           std::vector<SkippedVariant>& skipped);

/// All combinations of the variants and of the values to choose from. The variants must outlive them.
std::vector<DesignBranch> design_branches(std::vector<DesignVariant> const& variants, DesignQuestion const& question);

/// Camera, lens and values of a branch, for the reader.
std::string branch_name(DesignBranch const& branch, std::vector<DesignVariant> const& variants,
                        DesignQuestion const& question);

/// The setup of a bench, ready to render: the variant's, with the bench's choices, without the tables of the question.
std::string applied_setup(DesignVariant const& variant, DesignQuestion const& question, Bench<double> const& bench);

}  // namespace gladstone
