#include <nlohmann/json.hpp>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// Errors with --json: one object on stdout; the text for people stays on stderr.
class JsonErrors : public ProgramFixture {
 protected:
  nlohmann::json run_with_errors(std::vector<std::string> arguments, int exit_code) const {
    arguments.emplace_back("--json");
    Outcome const outcome = gladstone(std::move(arguments));
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_THAT(outcome.err, testing::Not(testing::IsEmpty()));
    auto const json = nlohmann::json::parse(outcome.out, nullptr, false);
    if (!json.is_object()) {
      ADD_FAILURE() << outcome.out;
      return nlohmann::json::array();
    }
    EXPECT_EQ(json["exit_code"], exit_code);
    EXPECT_TRUE(json["warnings"].is_array() && json["warning_records"].is_array());
    return json["errors"];
  }
};

TEST_F(JsonErrors, ListAllProblemsOfASetup) {
  write("setup.toml", "[lens]\nfocal_lenght_mm = 105\nf_number = -1\n");
  nlohmann::json const errors = run_with_errors({"render", "setup.toml", "-o", "case"}, 2);
  auto const find = [&](std::string const& key) {
    for (auto const& error : errors)
      if (error.value("key", "") == key) return error;
    ADD_FAILURE() << key << " is not in " << errors.dump(2);
    return nlohmann::json::object();
  };
  nlohmann::json const unknown = find("lens.focal_lenght_mm"), range = find("lens.f_number");
  EXPECT_EQ(unknown.value("code", ""), "unknown_key");
  EXPECT_EQ(unknown.value("line", 0), 2);
  EXPECT_EQ(unknown.value("column", 0), 1);
  EXPECT_THAT(unknown.value("file", ""), testing::EndsWith("setup.toml"));
  EXPECT_THAT(unknown.value("message", ""), testing::HasSubstr("\"focal_length_mm\""));
  EXPECT_EQ(range.value("code", ""), "out_of_range");
  EXPECT_EQ(range.value("line", 0), 3);
}

TEST_F(JsonErrors, NameTheFile) {
  nlohmann::json const missing = run_with_errors({"render", "none.toml", "-o", "case"}, 2);
  ASSERT_EQ(missing.size(), 1u);
  EXPECT_EQ(missing[0]["code"], "missing_file");
  EXPECT_THAT(missing[0]["file"], testing::EndsWith("none.toml"));
  EXPECT_FALSE(missing[0].contains("line"));

  nlohmann::json const image = run_with_errors({"info", "image", "none.tif"}, 2);
  ASSERT_EQ(image.size(), 1u);
  EXPECT_EQ(image[0]["code"], "missing_file");
  EXPECT_THAT(image[0]["file"], testing::EndsWith("none.tif"));

  write("bad.csv", "x,y,u,v\n1,2,3,4\n1,2,3,4x\n");
  nlohmann::json const row = run_with_errors({"convert", "bad.csv", "-o", "good.h5"}, 2);
  ASSERT_EQ(row.size(), 1u);
  EXPECT_EQ(row[0]["code"], "syntax");
  EXPECT_THAT(row[0]["file"], testing::EndsWith("bad.csv"));
  EXPECT_EQ(row[0]["line"], 3);
  EXPECT_FALSE(row[0].contains("column"));
}

TEST_F(JsonErrors, NameNoFileForAnOption) {
  using Arguments = std::vector<std::string>;
  succeed({"render", "setup.toml", "-o", "case", "--quiet"});
  succeed({"correlate", "case", "--quiet"});
  for (auto const& [wrong, code, place] :
       {std::tuple{Arguments{"reconstruct", "case", "-o", "d.h5"}, "arguments", "--reference"},
        {Arguments{"reconstruct", "case", "-o", "d.h5", "--reference", "middle"}, "invalid_value", "--reference"},
        {Arguments{"correlate", "case/flow.tif"}, "arguments", "--output"},
        {Arguments{"tomography", "case", "case", "--reference", "left", "-o", "v.h5"}, "arguments", "views"},
        {Arguments{"render", "setup.toml", "-o", "b", "--set", "x=1"}, "unknown_key", "--set x=1"}}) {
    nlohmann::json const errors = run_with_errors(wrong, 2);
    ASSERT_FALSE(errors.empty()) << wrong.front();
    EXPECT_EQ(errors[0]["code"], code) << errors;
    EXPECT_EQ(errors[0]["place"], place) << errors;
    EXPECT_FALSE(errors[0].contains("file") || errors[0].contains("line")) << errors;
  }
}

TEST_F(JsonErrors, NameTheFileWhateverTheCode) {
  succeed({"render", "setup.toml", "-o", "case", "--quiet"});
  write("v.csv", "x,y,u,v\n10,10,nan,nan\n");
  nlohmann::json const errors = run_with_errors({"compare", "case", "--vectors", "v.csv"}, 1);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0]["code"], "no_valid_vector");
  EXPECT_THAT(errors[0].value("file", ""), testing::EndsWith("v.csv"));
}

TEST_F(JsonErrors, CoverTheCommandLine) {
  using Arguments = std::vector<std::string>;
  for (auto const& [wrong, place] : {std::pair{Arguments{"rendre"}, "rendre"},
                                     {Arguments{"render"}, "setup"},
                                     {Arguments{"render", "a.toml", "-o", "b", "--thread", "1"}, "--thread"},
                                     {Arguments{"render", "a.toml", "-o", "b", "--threads", "many"}, "--threads"},
                                     {Arguments{"render", "a.toml", "-o", "b", "--threads", "-1"}, "--threads"},
                                     {Arguments{"correlate", "a.tif", "b.tif", "--pairing", "all"}, "--pairing"},
                                     {Arguments{"info", "image", "a.tif", "--figure", "a.png"}, "--figure"}}) {
    nlohmann::json const errors = run_with_errors(wrong, 2);
    ASSERT_EQ(errors.size(), 1u) << wrong.front();
    EXPECT_EQ(errors[0]["code"], "arguments");
    EXPECT_EQ(errors[0]["place"], place) << errors;
    EXPECT_FALSE(errors[0].contains("file"));
    EXPECT_FALSE(errors[0]["message"].get<std::string>().empty());
  }
}

}  // namespace
}  // namespace gladstone::end_to_end
