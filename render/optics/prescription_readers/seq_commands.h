#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "render/optics/glass.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone {

/// Cuts a CODE V file into commands: line ends and ";" separate them, "&" joins lines, "!" begins a comment, none of
/// them within quotes.
void for_each_command(std::string_view text, std::function<void(std::string const& command, int line)> const& take);

/// Whether a command, in capitals, says nothing about where rays go: weights, variables, solves whose values are
/// written out, names.
bool is_harmless_command(std::string const& command);

/// Whether a command, in capitals, makes a surface one that is not traced: gratings, holograms, toroids, splines,
/// non-sequential parts, frames that return to another surface.
bool is_refused_command(std::string const& command);

/// Glasses that a file defines itself, between PRV and END: indices at the wavelengths of PWL [nm], or the coefficients
/// of Laurent's series (LAU), which is Schott's formula.
class PrivateGlasses {
 public:
  /// Reads a command of the block. @throws DataError
  void read(PrescriptionLine const& line);
  /// @return null: there is none of that name, in capitals
  Glass const* find(std::string const& name) const;

 private:
  std::vector<double> wavelengths_;  // [m]
  std::map<std::string, Glass> glasses_;
};

}  // namespace gladstone
