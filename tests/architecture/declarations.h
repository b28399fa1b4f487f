#pragma once

#include <map>
#include <string>
#include <vector>

namespace gladstone::architecture {

/// Declaration or definition of a function at namespace scope.
struct FunctionSite {
  std::string function;  ///< qualified name and number of parameters: "gladstone::files::write_tiff/3"
  bool defined = false;
};

/// Returns the functions that a source declares or defines at namespace scope. Templates, inline and static functions,
/// operators, members and functions in unnamed namespaces are excluded.
std::vector<FunctionSite> functions_of(std::string const& source);

/// Returns one line for each function that a header declares and another file than that of the header defines.
/// Functions without a definition (generated ones) are excluded.
/// @param sources  sources by path
std::vector<std::string> strayed_declarations(std::map<std::string, std::string> const& sources);

/// Returns the headers that declare the functions of several files, with the reason. A registry of methods declares one
/// entry for each file of a list, so that a new method requires no header.
std::map<std::string, char const*> const& registry_headers();

}  // namespace gladstone::architecture
