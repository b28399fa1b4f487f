// The table "Adding something, in one place" of CONTRIBUTING.md: the name of an entry (a field, a reader, a method, a
// command ...) may occur in its own file and in the files that its row permits, so that a new entry touches no others.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace gladstone::architecture {
namespace {

namespace fs = std::filesystem;

/// One row of the table.
struct Row {
  char const* thing;
  std::string folder;              ///< folder whose files are the entries
  std::regex name;                 ///< finds the names of an entry in its file, as the first group
  std::set<std::string> registry;  ///< files that a new entry touches
  /// Files that may name one particular entry, since they need this very entry and no other.
  std::map<std::string, std::set<std::string>> needed = {};
};

/// Finds the definitions of functions whose names begin with a prefix.
std::regex function(std::string const& prefix) { return std::regex("\\b(" + prefix + "_\\w+)\\([^;{}]*\\) \\{"); }

std::vector<Row> const& rows() {
  static std::string const fields = "render/medium/fields", flows = "render/light/flows";
  static std::regex const kind("struct (\\w+)[^;{]*\\{\\s+(?:using [^;]+;\\s+)*static constexpr char const\\* kind");
  static std::vector<Row> const table{
      {"density field",
       fields,
       kind,
       {"render/medium/closed_forms.h"},
       // a moving shock and the density behind it are set by one table; a uniform gradient is the cost of a cheap
       // medium
       {{"NormalShock", {"render/scene/experiments/piv.cpp"}}, {"UniformGradient", {"studies/case/render_cost.cpp"}}}},
      {"velocity field",
       flows,
       kind,
       {"render/light/flow.h"},
       {{"NormalShockFlow", {"render/light/flow.cpp", "render/scene/experiments/piv.cpp"}},
        {"UniformFlow", {"render/light/flow.cpp"}},  // the flow of a setup without [flow]
        // it refers to memory that its owner keeps, on the host and on a GPU
        {"FileFlow",
         {"render/light/velocity_file.h", "render/light/velocity_file.cpp",
          "cuda/ideal_images/cuda_pair_batches.cpp"}}}},
      {"optical element",
       "render/optics/elements",
       kind,
       {"render/optics/element_kinds.h"},
       // views are those of a plenoptic camera, and so is what an overview says about them
       {{"LensletSetup",
         {"studies/case/plenoptic_views.h", "studies/case/plenoptic_views.cpp", "studies/design/setup_overview.cpp"}}}},
      {"reader of fields",
       "render/files/fields/readers",
       std::regex(
           "^std::unique_ptr<CheckedSource> (open_(?!array_field)\\w+)\\([^;{}]*FieldSelection const& selection\\) \\{",
           std::regex::multiline),
       {"render/files/fields/field_file.cpp", "render/files/fields/readers/vtk.h"},
       {{"open_hdf5", {"render/files/fields/readers/matlab.cpp"}}}},  // MATLAB 7.3 writes HDF5
      {"reader of lens prescriptions",
       "render/optics/prescription_readers",
       std::regex("^Prescription (read_\\w+)\\([^;]*\\{", std::regex::multiline),
       {"render/optics/prescription.cpp", "render/optics/prescription_readers/readers.h"}},
      {"reader of vectors",
       "analysis/vectors/vector_readers",
       std::regex("\\bbool (is_\\w+)\\(TextTable const& table\\) \\{"),
       {"analysis/vectors/vector_file.cpp", "analysis/vectors/vector_readers/vector_readers.h"}},
      {"correlator",
       "analysis/correlation/methods",
       function("correlate"),
       {"analysis/correlation/correlation_methods.cpp", "analysis/correlation/correlation_methods.h"}},
      {"subpixel fit",
       "analysis/correlation/subpixel",
       function("fit"),
       {"analysis/correlation/subpixel_fit.cpp", "analysis/correlation/subpixel_fit.h"},
       // the default, which is computed for several windows at a time; an uncertainty method is defined by this fit
       {{"fit_gauss3",
         {"analysis/correlation/interrogation_job.h", "analysis/correlation/lane_peaks.cpp",
          "analysis/correlation/subpixel/centroid.cpp", "analysis/uncertainty/moment_of_correlation.cpp"}}}},
      {"mask",
       "analysis/preparation/masks",
       function("read"),
       {"analysis/preparation/frame_changes.h", "analysis/preparation/frame_preparation.cpp"}},
      {"preprocessing step",
       "analysis/preparation/steps",
       function("read"),
       {"analysis/preparation/frame_changes.h", "analysis/preparation/frame_preparation.cpp"},
       {{"read_background", {"render/sensor/camera_setup.cpp"}}}},  // another function, which reads camera.background
      {"kind of experiment",
       "render/scene/experiments",
       std::regex("\\bExperiment const (\\w+_experiment)\\{"),
       // the list, the experiment of a setup in memory, and the rows of an overview
       {"render/scene/experiment.h", "render/scene/experiment.cpp", "studies/design/setup_overview.cpp"},
       // the cases and comparisons of the experiment, and commands for this experiment alone
       {{"bos_experiment",
         {"studies/case/kinds/bos.cpp", "studies/compare/kinds/bos.cpp", "studies/compare/reconstruct_case.cpp",
          "studies/compare/tomography_view.cpp"}},
        {"piv_experiment",
         {"studies/case/kinds/piv.cpp", "studies/compare/kinds/piv.cpp", "studies/compare/stereo_input.cpp",
          "studies/commands/info_particles.cpp"}},
        {"calibration_experiment", {"studies/case/kinds/calibration.cpp", "studies/compare/calibrate.cpp"}}}},
      {"kind of case",
       "studies/case/kinds",
       std::regex("\\bCaseKind const (\\w+_case_kind)\\{"),
       {"studies/case/case_kind.h"}},
      {"command",
       "studies/commands",
       function("attach"),
       {"studies/commands/command.h", "studies/main.cpp",
        "studies/commands/sweep.cpp"}},  // plan, run, collect: in sweep
  };
  return table;
}

std::string source_without_comments(fs::path const& path) {
  std::ifstream in(path);
  std::string const text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return std::regex_replace(text, std::regex("//[^\n]*"), "");
}

/// Sources of the product by path, without comments. Oracles may name any entry, since they compare it with a formula.
std::map<std::string, std::string> const& sources() {
  static std::map<std::string, std::string> const all = [] {
    std::map<std::string, std::string> texts;
    fs::path const root = GLADSTONE_SOURCE_DIR;
    for (std::string const room : {"render", "analysis", "cuda", "studies", "python"}) {
      for (fs::directory_entry const& entry : fs::recursive_directory_iterator(root / room)) {
        std::string const path = entry.path().lexically_relative(root).string();
        if (entry.is_regular_file() && path.rfind("studies/oracles/", 0) != 0) {
          if (std::set<std::string>{".h", ".cpp", ".cu", ".cuh"}.count(entry.path().extension().string()) > 0)
            texts[path] = source_without_comments(entry.path());
        }
      }
    }
    return texts;
  }();
  return all;
}

bool names(std::string const& text, std::string const& word) {
  auto const inside = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    bool const begins = at == 0 || !inside(text[at - 1]), ends = !inside((text + " ")[at + word.size()]);
    if (begins && ends) return true;
  }
  return false;
}

/// Returns the names of the entries of a row, with the files that define them (a header and a source of one name).
std::map<std::string, std::string> entries(Row const& row) {
  std::map<std::string, std::string> found;
  for (auto const& [path, text] : sources()) {
    if (path.rfind(row.folder + "/", 0) != 0) continue;
    for (std::sregex_iterator match(text.begin(), text.end(), row.name), end; match != end; ++match) {
      auto const group = std::find_if(match->begin() + 1, match->end(), [](auto const& sub) { return sub.matched; });
      found.emplace(group->str(), fs::path(path).replace_extension().string());
    }
  }
  return found;
}

class Adding : public testing::TestWithParam<std::size_t> {};

TEST_P(Adding, TouchesWhatTheTableNames) {
  Row const& row = rows()[GetParam()];
  std::map<std::string, std::string> const all = entries(row);
  ASSERT_GE(all.size(), 3U) << row.thing << ": the expression no longer finds the entries of " << row.folder;
  for (auto const& [name, own] : all) {
    std::set<std::string> permitted = row.registry;
    if (auto const needed = row.needed.find(name); needed != row.needed.end()) {
      permitted.insert(needed->second.begin(), needed->second.end());
    }
    for (auto const& [path, text] : sources()) {
      if (fs::path(path).replace_extension().string() == own || permitted.count(path) > 0) continue;
      EXPECT_FALSE(names(text, name)) << path << " names the " << row.thing << " " << name << " of " << own;
    }
  }
}

TEST_P(Adding, TheEntriesAreRegistered) {
  Row const& row = rows()[GetParam()];
  for (auto const& [name, own] : entries(row)) {
    EXPECT_TRUE(std::any_of(row.registry.begin(), row.registry.end(),
                            [&name = name](std::string const& file) { return names(sources().at(file), name); }))
        << name << " of " << own;
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, Adding, testing::Range(std::size_t{0}, rows().size()),
                         [](testing::TestParamInfo<std::size_t> const& info) {
                           std::string name = rows()[info.param].thing;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

// A figure is data; its appearance is defined only by the writer and its templates.
TEST(Figures, AreDataWithoutCommandsOfGnuplot) {
  std::set<std::string> const writer{"studies/drawing/draw_figure.cpp", "studies/drawing/gnuplot.cpp"};
  std::regex const command("linecolor|linewidth [0-9{]|pointtype|\"set [a-z]+ |with (lines|points|boxes)");
  std::size_t found = 0;
  for (auto const& [path, text] : sources()) {
    bool const is_command = std::regex_search(text, command);
    if (writer.count(path) > 0) {
      found += is_command ? 1 : 0;
    } else {
      EXPECT_FALSE(is_command) << path << " writes commands of gnuplot";
    }
  }
  EXPECT_GE(found, 1U) << "the expression no longer finds commands";
}

}  // namespace
}  // namespace gladstone::architecture
