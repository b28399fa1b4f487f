// The tables of the documentation list the methods, measures and requirements that are registered, and a setup offers
// the same names.
#include <gmock/gmock.h>

#include <fstream>
#include <set>
#include <sstream>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/subpixel_fit.h"
#include "analysis/density/density_methods.h"
#include "analysis/errors/error_summary.h"
#include "analysis/uncertainty/uncertainty.h"
#include "studies/benchmark/benchmark_results.h"
#include "studies/benchmark/benchmark_run.h"
#include "studies/commands/setup_keys.h"
#include "studies/design/bounds.h"
#include "tests/support/reader_keys.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

std::string read_page(std::string const& name) {
  std::ifstream in(std::string(GLADSTONE_DATA_DIR) + "/../docs/" + name);
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_FALSE(text.str().empty()) << name;
  return text.str();
}

/// Returns the quoted names in the first column of the table with this header.
std::set<std::string> table_names(std::string const& page, std::string const& header) {
  std::set<std::string> names;
  std::istringstream lines(page.substr(std::min(page.find('\n' + header + '\n'), page.size() - 1) + 1));
  std::string line;
  for (int row = 0; std::getline(lines, line) && line.starts_with('|'); ++row)
    if (row >= 2) names.insert(test::between_texts(line, "\"", "\""));
  return names;
}

/// Returns the words that the reader of a setup offers for a key.
std::set<std::string> offered_words(std::string const& key) {
  std::string const words = test::allowed_values("experiment = \"bos\"\n[correlate]\n", key);
  std::set<std::string> names;
  std::istringstream parts(words);
  for (std::string part; std::getline(parts, part, ',');) names.insert(test::between_texts(part, "\"", "\""));
  return names;
}

std::set<std::string> as_set(std::vector<std::string> const& names) { return {names.begin(), names.end()}; }

std::string joined(std::vector<std::string> const& names, std::string const& separator) {
  std::string text;
  for (std::string const& name : names) text += (text.empty() ? "" : separator) + name;
  return text;
}

TEST(DocumentedNames, OfTheCorrelationAreThoseOfTheRegistries) {
  std::string const page = read_page("file-formats.md");
  EXPECT_EQ(table_names(page, "| `method` | |"), as_set(correlation_methods()));
  EXPECT_EQ(offered_words("correlate.method"), as_set(correlation_methods()));
  EXPECT_EQ(table_names(page, "| `subpixel` | |"), as_set(subpixel_fits()));
  EXPECT_EQ(offered_words("correlate.subpixel"), as_set(subpixel_fits()));
  std::set<std::string> uncertainty = as_set(uncertainty_methods());
  uncertainty.insert({"auto", "none"});
  EXPECT_EQ(table_names(page, "| `uncertainty` | |"), uncertainty);
  EXPECT_EQ(offered_words("correlate.uncertainty"), uncertainty);
}

TEST(DocumentedNames, OfDensitySolversAreThoseOfTheRegistry) {
  std::string const page = read_page("commands.md");
  EXPECT_THAT(page,
              HasSubstr("`--method " + joined(density::method_names(density::integration_methods()), "\\|") + '`'));
  EXPECT_THAT(page, HasSubstr("`--abel " + joined(density::method_names(density::abel_methods()), "\\|") + '`'));
}

TEST(DocumentedNames, OfErrorMeasuresAreThoseOfTheTable) {
  std::vector<std::string> names;
  for (ErrorMeasure const& measure : all_error_measures())
    if (measure.of_case) names.emplace_back(measure.name);
  std::string const page = read_page("file-formats.md");
  EXPECT_THAT(page, HasSubstr('`' + joined(names, ", ") + '`'));
  std::string const csv = benchmark_csv({});
  EXPECT_THAT(page, HasSubstr('`' + csv.substr(0, csv.find('\n')) + '`'));
}

TEST(DocumentedNames, OfRequirementsAreThoseOfTheTable) {
  std::set<std::string> keys, documented;
  for (Bound const& bound : requirements()) keys.insert(bound.table() + '.' + bound.key());
  for (SetupKeyTable const& table : setup_key_tables())
    for (SetupKey const& key : table.keys)
      if (key.path.starts_with("requirements.") && key.name() != "objective") documented.insert(key.path);
  documented.insert("limits.z_total_max_mm");
  EXPECT_EQ(documented, keys);
  std::string const page = read_page("design.md");
  for (Bound const& bound : requirements()) EXPECT_THAT(page, HasSubstr("| `" + bound.key() + "` |"));
}

}  // namespace
}  // namespace gladstone::end_to_end
