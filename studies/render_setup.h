#pragma once

#include <string>
#include <vector>

#include "studies/cameras.h"
#include "studies/case.h"

namespace gladstone {

/// A setup of any experiment and any number of cameras, read and checked: what `gladstone render` does.
class SetupRendering {
 public:
  /// @param path of the setup file @throws SetupError
  SetupRendering(std::string path, std::vector<std::string> const& overrides);

  /// @throws OutputError where rendering into the folder would replace what is read for it
  void refuse_over_inputs(std::string const& folder) const;

  /// Renders into a CASE folder, all of it or nothing: one camera's case into the folder itself, those of several into
  /// folders of their names, beside the setup of all and a summary.json that has each one's.
  /// @return the text of summary.json
  std::string render(Renderer& renderer, std::string const& folder);

 private:
  struct OneCamera {
    std::string name;  ///< empty: the only one
    CaseSetup loaded;
  };
  std::string render_one(OneCamera& camera, Renderer& renderer, KnownParts const& known, BuiltMedium& medium,
                         std::string const& folder, class OutputFolder const& output) const;
  /// The setup as it was written, with the absolute names of its files.
  std::string written() const;

  std::string path_;
  SetupDocument document_;
  std::vector<OneCamera> cameras_;
};

}  // namespace gladstone
