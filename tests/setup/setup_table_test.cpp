#include "render/setup/setup_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/setup/setup_node.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SetupDocument document(std::string_view text) { return SetupDocument::from_text(text, "case.toml", "/data/cases"); }

/// Returns the problems of a document after finish().
std::vector<SetupProblem> find_problems(SetupDocument& setup) {
  try {
    setup.finish();
  } catch (SetupError const& error) {
    return error.problems();
  }
  return {};
}

/// Returns code and place of the problems: "out_of_range at case.toml:3:1".
std::vector<std::string> problems(SetupDocument& setup) {
  std::vector<std::string> lines;
  for (SetupProblem const& problem : find_problems(setup)) lines.push_back(code_and_place(problem));
  return lines;
}

/// Returns the messages of the problems, for tests of the keys that they suggest.
std::vector<std::string> messages(SetupDocument& setup) {
  std::vector<std::string> lines;
  for (SetupProblem const& problem : find_problems(setup)) lines.push_back(problem.message);
  return lines;
}

TEST(SetupTable, ValuesAreReturnedAsWritten) {
  auto setup = document(R"(
schema = 1
[lens]
f_number = 11
focal_length_mm = 105.5
psf = "airy"
shot_noise = true
pixels = [512, 256]
spacing_mm = [0.5, 1, 2e-3]
periodic = [true, false, true]
)");
  EXPECT_EQ(setup.root().required_integer("schema", 1, 1), 1);
  auto lens = setup.root().table("lens");
  EXPECT_TRUE(lens.present());
  EXPECT_EQ(lens.number("f_number", 8.0), 11.0);
  EXPECT_EQ(lens.required_number("focal_length_mm"), 105.5);
  EXPECT_EQ(lens.word("psf", "gaussian", {"airy", "gaussian"}), "airy");
  EXPECT_TRUE(lens.boolean("shot_noise", false));
  EXPECT_THAT(lens.integers("pixels", {}, 2, 2, 1, 4096), ElementsAre(512, 256));
  EXPECT_THAT(lens.numbers("spacing_mm", {}, 3), ElementsAre(0.5, 1.0, 2e-3));
  EXPECT_THAT(lens.booleans("periodic", {}, 3), ElementsAre(true, false, true));
  EXPECT_NO_THROW(setup.finish());
}

// 10e-6 / 1e-6 and 532e-9 / 1e-9 are not exactly 10 and 532 in binary arithmetic; the resolved setup must still contain
// these numbers.
TEST(SetupTable, QuantitiesAreInSiAndTheirDefaultsInTheKeysUnit) {
  auto setup = document("given_mm = 2.5\n");
  SetupTable root = setup.root();
  EXPECT_EQ(root.quantity("given_mm", 1.0, 1e-3), 2.5 * 1e-3);
  EXPECT_EQ(root.quantity("pitch_um", 10e-6, 1e-6), 10 * 1e-6);
  EXPECT_EQ(root.quantity("wavelength_nm", 532e-9, 1e-9), 532 * 1e-9);
  EXPECT_EQ(root.quantity("tilt_deg", 0.0, 0.017), 0.0);
  EXPECT_EQ(root.quantity("distance_mm", 123456.789, 1e-3), 123456789 * 1e-3);
  EXPECT_EQ(root.quantities("place_mm", Vec3d{0.75, -1e-9, 0}, 1e-3), (Vec3d{750 * 1e-3, -1e-6 * 1e-3, 0}));
  std::string const resolved = setup.resolved();
  for (char const* line : {"pitch_um = 10.0\n", "wavelength_nm = 532.0\n", "tilt_deg = 0.0\n",
                           "distance_mm = 123456789.0\n", "place_mm = [750.0, -1e-06, 0.0]\n"}) {
    EXPECT_THAT(resolved, HasSubstr(line));
  }
}

TEST(SetupTable, ChoicesReturnTheValuesOfTheirWords) {
  auto setup = document("given = \"two\"\nwrong = \"three\"\n");
  SetupTable root = setup.root();
  std::vector<std::pair<std::string, int>> const numbers{{"one", 1}, {"two", 2}};
  EXPECT_EQ(root.choice("given", 1, numbers), 2);
  EXPECT_EQ(root.choice("absent", 1, numbers), 1);
  EXPECT_EQ(root.choice("wrong", 1, numbers), 1);
  EXPECT_THAT(setup.resolved(), HasSubstr("absent = \"one\"\n"));
  EXPECT_THAT(problems(setup), ElementsAre("unknown_choice at case.toml:2:1"));
}

TEST(SetupTable, AbsentTableGivesDefaults) {
  auto setup = document("");
  auto lens = setup.root().table("lens");
  EXPECT_FALSE(lens.present());
  EXPECT_EQ(lens.number("f_number", 8.0), 8.0);
  EXPECT_EQ(lens.optional_number("focus_distance_mm"), std::nullopt);
  EXPECT_EQ(lens.number_or_auto("step_mm"), std::nullopt);
  EXPECT_NO_THROW(setup.finish());
  EXPECT_EQ(setup.resolved(), "[lens]\nf_number = 8.0\nstep_mm = \"auto\"\n");
}

TEST(SetupTable, EveryProblemIsReportedAtItsLineInOrder) {
  auto setup = document(R"(schema = 2
[lens]
f_number = -3
psf = "gausian"
  focal_length_mm = "105"
[camera]
pixels = [512, 0]
)");
  auto camera = setup.root().table("camera");
  camera.integers("pixels", {512, 512}, 2, 2, 1, 65536);
  camera.required_number("pixel_pitch_um");
  auto lens = setup.root().table("lens");
  lens.number("f_number", 11.0, Range::positive());
  lens.word("psf", "gaussian", {"airy", "gaussian"});
  lens.required_number("focal_length_mm");
  setup.root().integer("schema", 1, 1, 1);
  EXPECT_THAT(problems(setup), ElementsAre("out_of_range at case.toml:1:1", "out_of_range at case.toml:3:1",
                                           "unknown_choice at case.toml:4:1", "wrong_type at case.toml:5:3",
                                           "missing_key at case.toml:6:2", "out_of_range at case.toml:7:1"));
}

TEST(SetupTable, ProblemOfAnAbsentTableStandsAtTheFilesStart) {
  auto setup = document("# nothing\n");
  setup.root().table("lens").required_number("focal_length_mm");
  EXPECT_THAT(problems(setup), ElementsAre("missing_key at case.toml:1:1"));
}

TEST(SetupTable, AWrongValueGivesTheFallbackSoThatReadingGoesOn) {
  auto setup = document("a = nan\nb = -1\nc = 'x'\nd = 1.5\ne = [1]");
  auto root = setup.root();
  EXPECT_EQ(root.number("a", 7.0), 7.0);
  EXPECT_EQ(root.number("b", 7.0, Range::positive()), 7.0);
  EXPECT_TRUE(root.boolean("c", true));
  EXPECT_EQ(root.integer("d", 3, 0, 9), 3);
  EXPECT_THAT(root.numbers("e", {1.0, 2.0}, 2), ElementsAre(1.0, 2.0));
  EXPECT_EQ(root.required_number("f", {2.0, 4.0}), 2.0);
  EXPECT_EQ(problems(setup).size(), 6u);
}

TEST(SetupTable, NanIsAlwaysRefusedAndInfinityUnlessAllowed) {
  auto setup = document("a = nan\nb = inf\nc = inf\nd = [1.0, nan]");
  Range unbounded = Range::positive();
  unbounded.allow_inf = true;
  EXPECT_EQ(setup.root().number("a", 1.0, unbounded), 1.0);
  EXPECT_EQ(setup.root().number("b", 1.0, Range::positive()), 1.0);
  EXPECT_TRUE(std::isinf(setup.root().number("c", 1.0, unbounded)));
  setup.root().numbers("d", {0.0, 0.0}, 2);
  EXPECT_THAT(problems(setup), ElementsAre("out_of_range at case.toml:1:1", "out_of_range at case.toml:2:1",
                                           "out_of_range at case.toml:4:1"));
}

TEST(SetupTable, EndsOfARangeAreIncludedUnlessOpen) {
  auto setup = document("a = 0.0\nb = 1.0\nc = 0.0\nd = 1.5\ne = -0.5");
  auto root = setup.root();
  root.number("a", 0.5, Range::at_least(0.0, 1.0));
  root.number("b", 0.5, Range::at_least(0.0, 1.0));
  root.number("c", 0.5, Range::positive(1.0));
  root.number("d", 0.5, Range::at_least(0.0, 1.0));
  root.number("e", 0.5, Range::at_least(0.0));
  EXPECT_THAT(problems(setup), ElementsAre("out_of_range at case.toml:3:1", "out_of_range at case.toml:4:1",
                                           "out_of_range at case.toml:5:1"));
}

TEST(SetupTable, WholeNumbersAreAskedForByWord) {
  auto setup = document("a = 3.0\nb = 3.5\nc = '3'");
  for (auto const* key : {"a", "b", "c"}) setup.root().integer(key, 1, 0, 9);
  EXPECT_THAT(problems(setup),
              ElementsAre("wrong_type at case.toml:1:1", "wrong_type at case.toml:2:1", "wrong_type at case.toml:3:1"));
}

TEST(SetupTable, NumberOrWordGivesExactlyOne) {
  auto setup = document("a = 2.5\nb = 'ciddor'\nd = 'cidor'\ne = true");
  auto const read = [&](std::string const& key) {
    return setup.root().number_or_word(key, {2.26e-4, ""}, {"ciddor", "merzkirch"}, Range::positive());
  };
  EXPECT_EQ(read("a").number, 2.5);
  EXPECT_EQ(read("b").word, "ciddor");
  EXPECT_EQ(read("b").number, std::nullopt);
  EXPECT_EQ(read("c").number, 2.26e-4);
  EXPECT_EQ(read("d").number, 2.26e-4);
  read("e");
  EXPECT_THAT(problems(setup), ElementsAre("unknown_choice at case.toml:3:1", "wrong_type at case.toml:4:1"));
}

TEST(SetupTable, UnreadKeysNameTheNearestKeyOfTheirTable) {
  auto setup = document(R"([lens]
f_nuber = 8
focal_length = 105
z_a_mm = 1
unheard_of = 1
[cmaera]
pixels = [1, 1]
[geometry]
)");
  auto lens = setup.root().table("lens");
  lens.number("f_number", 11.0);
  lens.number("focal_length_mm", 105.0);
  setup.root().table("camera").number("pixel_pitch_um", 10.0);
  setup.root().table("geometry").number("z_a_mm", 750.0);
  EXPECT_THAT(messages(setup),
              ElementsAre(HasSubstr("\"f_number\""), HasSubstr("\"focal_length_mm\""), HasSubstr("[geometry]"),
                          HasSubstr("\"f_number\" or \"focal_length_mm\""), HasSubstr("[camera]")));
}

TEST(SetupTable, UnreadKeysAreFoundInInlineTablesAndArraysOfTables) {
  auto setup =
      document("lens = { f_number = 8, fnumber = 8 }\n[[field]]\nkind = 'a'\n[[field]]\nkind = 'b'\nknd = 'c'\n");
  setup.root().table("lens").number("f_number", 8.0);
  for (auto& field : setup.root().tables("field")) field.text("kind", "");
  EXPECT_THAT(problems(setup), ElementsAre("unknown_key at case.toml:1:24", "unknown_key at case.toml:6:1"));
}

TEST(SetupTable, AKeyThatOtherSettingsMakeUselessIsSaidToHaveNoEffect) {
  auto setup = document("model = 'thin'\nfile = 'a.toml'\n");
  setup.root().word("model", "thin", {"thin", "prescription"});
  EXPECT_TRUE(setup.root().has("file"));
  EXPECT_THAT(problems(setup), ElementsAre("unknown_key at case.toml:2:1"));
}

TEST(SetupTable, RefusedKeyIsReportedOnceAndByName) {
  auto setup = document("[lens]\nfile = 'a.toml'\n[particles]\ncount = 1\n");
  setup.root().table("lens").refuse("file", "is not available yet: thin lenses only");
  setup.root().table("lens").refuse("absent", "never said");
  setup.root().refuse("particles", "is not available yet");
  EXPECT_THAT(problems(setup), ElementsAre("invalid_value at case.toml:2:1", "invalid_value at case.toml:3:2"));
}

TEST(SetupTable, TableOfTheWrongKindIsAProblem) {
  auto setup = document("lens = 5\n[[camera]]\npixels = 1\n");
  setup.root().table("lens").number("f_number", 8.0);
  setup.root().table("camera").number("pixels", 8.0);
  auto const found = problems(setup);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0], "wrong_type at case.toml:1:1");
  EXPECT_THAT(found[1], testing::StartsWith("wrong_type at case.toml:2:"));
}

TEST(SetupTable, SingleTableIsAnArrayOfOne) {
  auto setup = document("[medium.field]\nkind = 'none'\n");
  auto fields = setup.root().table("medium").tables("field");
  ASSERT_EQ(fields.size(), 1u);
  EXPECT_EQ(fields[0].text("kind", ""), "none");
  EXPECT_TRUE(setup.root().table("medium").tables("other").empty());
  EXPECT_NO_THROW(setup.finish());
}

TEST(SetupTable, DuplicateProblemsAreSaidOnce) {
  auto setup = document("a = 'x'");
  setup.root().number("a", 1.0);
  setup.root().number("a", 1.0);
  EXPECT_EQ(problems(setup).size(), 1u);
}

TEST(SetupTable, ProblemOfADefaultSaysSo) {
  auto setup = document("[lens]\n");
  auto lens = setup.root().table("lens");
  lens.number("f_number", 8.0);
  lens.problem("f_number", "is too small for this medium");
  EXPECT_THAT(problems(setup), ElementsAre("invalid_value at case.toml:1:2"));
}

TEST(SetupOverride, SameDocumentAsTheKeyInTheFile) {
  auto const read = [](SetupDocument& setup) {
    auto lens = setup.root().table("lens");
    lens.number("f_number", 11.0);
    lens.word("focus", "target", {"target", "medium"});
    lens.table("deep").table("er").integers("list", {}, 1, 9, 0, 9);
    setup.finish();
    return setup.resolved();
  };
  auto written = document("[lens]\nf_number = 8\nfocus = \"medium\"\n[lens.deep.er]\nlist = [1, 2]\n");
  auto given = document("[lens]\nf_number = 22\n");
  given.override_key("lens.f_number=16");
  given.override_key("lens.f_number = 8");
  given.override_key("lens.focus=medium");
  given.override_key("lens.deep.er.list=[1, 2]");
  EXPECT_EQ(read(given), read(written));
}

TEST(SetupOverride, ProblemsStandAtTheAssignmentAfterThoseOfTheFile) {
  auto setup = document("[lens]\nf_number = 1\nz = 1");
  setup.override_key("lens.f_number=-1");
  setup.override_key("lens.f_nuber=8");
  setup.override_key("lens.psf.deep=8");
  setup.override_key("nonsense");
  setup.override_key("a..b=1");
  setup.override_key("lens.empty=");
  auto lens = setup.root().table("lens");
  lens.number("f_number", 8.0, Range::positive());
  auto const found = problems(setup);
  EXPECT_THAT(found, testing::UnorderedElementsAre(
                         "unknown_key at case.toml:3:1", "syntax at --set nonsense", "syntax at --set a..b=1",
                         "syntax at --set lens.empty=", "out_of_range at --set lens.f_number=-1",
                         "unknown_key at --set lens.f_nuber=8", "unknown_key at --set lens.psf.deep=8"));
  ASSERT_FALSE(found.empty());
  EXPECT_THAT(found.front(), HasSubstr("case.toml:3:1"));
}

TEST(SetupOverride, APathThroughAValueIsAProblem) {
  auto setup = document("a = 1\n[[field]]\nkind = 'x'");
  setup.override_key("a.b=1");
  setup.override_key("field.kind=none");
  setup.root().integer("a", 1, 0, 9);
  for (auto& field : setup.root().tables("field")) field.text("kind", "");
  EXPECT_THAT(problems(setup), ElementsAre("wrong_type at --set a.b=1", "wrong_type at --set field.kind=none"));
}

TEST(SetupOverride, AValueCannotSmuggleInOtherKeys) {
  auto setup = document("");
  setup.override_key("a=1\nb = 2");
  EXPECT_EQ(setup.root().text("a", ""), "1\nb = 2");
  EXPECT_NO_THROW(setup.finish());
}

TEST(SetupDocument, SyntaxErrorHasLineAndColumn) {
  try {
    document("a = 1\nb = [1, \n");
    FAIL() << "accepted";
  } catch (SetupError const& error) {
    ASSERT_EQ(error.problems().size(), 1u);
    EXPECT_THAT(error.problems()[0].where, testing::MatchesRegex("case.toml:[23]:[0-9]+"));
    EXPECT_EQ(error.problems()[0].code, ErrorCode::syntax);
  }
}

/// Returns a dotted key "a.a.a" with a given number of parts.
std::string dotted(std::size_t parts) {
  std::string key = "a";
  for (std::size_t i = 1; i < parts; ++i) key += ".a";
  return key;
}

std::string repeated(std::string const& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

// The parser and the functions that process its tree recurse once per part; a stack is exhausted at about ten thousand
// levels.
TEST(SetupDocument, KeysAndBracketsAreBoundedInDepth) {
  std::size_t const many = 100000;
  std::vector<std::pair<std::string, std::string>> const deep{
      {"x = 1\n" + dotted(many) + " = 1\n", "2:64"},
      {'[' + dotted(many) + "]\nx = 1\n", "1:65"},
      {"[[" + dotted(many) + "]]\n", "1:66"},
      {"x = { " + dotted(many) + " = 1 }\n", "1:70"},
      {"x = " + repeated("[", many) + repeated("]", many) + '\n', "1:37"},
      {"x = " + repeated("{ a = ", many) + '1' + repeated("}", many) + '\n', "1:197"},
      {repeated("\"a\" . 'a' .", many) + "a = 1\n", ""},
      // text that only looks like the inside of a string
      {"x = [ \"\"\"a\"\"\"\", { " + dotted(many) + " = 1 } ]\n", ""},
      {"x = '\\' # '\ny = { " + dotted(many) + " = '' }\n", "2:70"},
  };
  for (auto const& [text, place] : deep) {
    try {
      document(text);
      ADD_FAILURE() << "accepted " << text.substr(0, 40);
    } catch (SetupError const& error) {
      EXPECT_THAT(error.problems()[0].where, testing::StartsWith("case.toml:" + place)) << text.substr(0, 40);
      EXPECT_EQ(error.problems()[0].code, ErrorCode::syntax) << text.substr(0, 40);
    }
  }
  EXPECT_NO_THROW(document(dotted(most_setup_depth) + " = 1.5\n"));
  EXPECT_NO_THROW(document("x = " + repeated("[", most_setup_depth) + repeated("]", most_setup_depth)));
  std::string const dots(1000, '.');
  EXPECT_NO_THROW(document("a = \"" + dots + "\"\nb = '''\n" + dots + "'''\n# " + dots + '\n'));
}

TEST(SetupOverride, KeysAndValuesAreBoundedInDepth) {
  auto setup = document("b = 1\n");
  setup.override_key(dotted(100000) + "=1");
  setup.override_key("b=" + repeated("[", 100000) + repeated("]", 100000));
  setup.root().text("b", "");  // text that is not TOML is read as a string
  auto const found = messages(setup);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0], HasSubstr("100000"));
  EXPECT_LT(found[0].size(), 400u);
}

// Programs handle problems by key and code, independently of the wording.
TEST(SetupDocument, ProblemsNameTheirKeyAndCode) {
  auto setup = document(R"(
unit = "m"
[lens]
f_number = -1.0
focus = "far"
pixels = [1.0]
sensor.pitch = "wide"
)");
  SetupTable lens = setup.root().table("lens");
  lens.number("f_number", 8.0, Range::at_least(0.5));
  lens.word("focus", "medium", {"medium", "target"});
  lens.numbers("pixels", {1.0, 1.0}, 2, {});
  lens.table("sensor").number("pitch", 1.0);
  lens.required_number("focal_length_mm");
  lens.problem("focus", "conflicts with f_number");
  using enum ErrorCode;
  std::vector<std::pair<std::string, ErrorCode>> const expected{{"unit", unknown_key},
                                                                {"lens.focal_length_mm", missing_key},
                                                                {"lens.f_number", out_of_range},
                                                                {"lens.focus", unknown_choice},
                                                                {"lens.focus", invalid_value},
                                                                {"lens.pixels", wrong_type},
                                                                {"lens.sensor.pitch", wrong_type}};
  std::vector<std::pair<std::string, ErrorCode>> found;
  try {
    setup.finish();
  } catch (SetupError const& error) {
    for (auto const& problem : error.problems()) found.emplace_back(problem.key, problem.code);
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(error_code_name(ErrorCode::out_of_range), "out_of_range");
}

// Messages for all keys would need 47 MB for 200,000 unknown keys, and searching all messages for each key 214 s.
// Therefore only the first ones are formulated; the parser dominates the time and processes far more than 20,000 keys
// per second.
TEST(SetupDocument, ManyUnknownKeysAreCountedAndTheFirstTold) {
  std::string text;
  std::size_t const count = 100000;
  for (std::size_t i = 0; i < count; ++i) text += "key" + std::to_string(i) + " = 1\n";
  std::clock_t const start = std::clock();
  auto setup = document(text);
  setup.root().number("known", 1.0);
  try {
    setup.finish();
    FAIL() << "accepted";
  } catch (SetupError const& error) {
    ASSERT_EQ(error.problems().size(), max_reported_problems);
    EXPECT_EQ(error.more(), count - max_reported_problems);
    EXPECT_EQ(code_and_place(error.problems().front()), "unknown_key at case.toml:1:1");
    EXPECT_EQ(code_and_place(error.problems().back()), "unknown_key at case.toml:20:1");
  }
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5);
}

TEST(SetupDocument, ALongKeyIsCutInItsMessage) {
  std::string const name(3 << 20, 'k');
  auto setup = document(name + " = 1\n");
  setup.root().number("known", 1.0);
  auto const found = messages(setup);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(found[0].size(), 200u);
}

/// Reads every kind of key, and returns the resolved text, which must contain and reproduce all values.
std::string read_everything(SetupDocument& setup) {
  auto root = setup.root();
  auto medium = root.table("medium");
  medium.number("wavelength_nm", 532.0);
  medium.number_or_auto("step_mm");
  root.integer("schema", 1, 1, 1);
  root.text("note", "tab\t, quote \", backslash \\, newline\n, control \x01, umlaut \xc3\xa4");
  root.number("tiny", 5e-324);
  root.number("third", 1.0 / 3.0);
  root.number("big", 1e300);
  root.number("minus_zero", -0.0);
  Range range = Range::positive();
  range.allow_inf = true;
  root.number("f_number", std::numeric_limits<double>::infinity(), range);
  root.optional_number("absent");
  root.required_path("file");
  root.booleans("periodic", {true, false}, 2);
  root.number_list("list", {}, 0, 9);
  root.number_or_word("k", {std::nullopt, "ciddor"}, {"ciddor"});
  for (auto& field : medium.tables("field")) {
    field.table("inner").number("depth", 1.0);
    field.required_word("kind", {"none", "file"});
  }
  root.table("noise").present();
  root.table("unwritten");
  setup.finish();
  return setup.resolved();
}

/// Returns a value that was parsed from another file.
SetupNode value_of_study(std::string const& text) {
  SetupNode root = parse_toml("value = " + text, "study.toml");
  SetupNode value = *root.find("value");
  set_source(value, std::make_shared<SetupSource const>(SetupSource{"study.toml", "/data/studies"}));
  return value;
}

TEST(SetupDocument, ValuesOfAnotherFileKeepTheirPlaceAndTheirFolder) {
  auto setup = document("[target]\nfile = \"a.csv\"\nsize = 1\n[[camera]]\nbits = 8\n");
  setup.set({"target", "file"}, value_of_study("\"b.csv\""));
  setup.set({"target", "size"}, value_of_study("-1"));
  setup.set({"camera", "bits"}, value_of_study("12"));
  setup.set({"camera", "bits", "deep"}, value_of_study("12"));
  auto target = setup.root().table("target");
  EXPECT_EQ(target.required_path("file"), "/data/studies/b.csv");
  target.number("size", 1, Range::positive());
  EXPECT_EQ(setup.root().tables("camera").at(0).integer("bits", 8, 1, 16), 12);
  EXPECT_EQ(setup.file_names(), std::vector<std::string>{"/data/studies/b.csv"});
  EXPECT_THAT(problems(setup), ElementsAre("wrong_type at study.toml:1:1", "out_of_range at study.toml:1:1"));
}

TEST(SetupDocument, AListOfFilesIsRelativeToTheSetupToo) {
  auto setup = document("[lens]\nglasses = [\"a.agf\", \"/other/b.agf\"]\n");
  std::vector<std::string> const expected{"/data/cases/a.agf", "/other/b.agf"};
  EXPECT_EQ(setup.root().table("lens").path_list("glasses"), expected);
  EXPECT_EQ(setup.file_names(), expected);
  std::string const absolute = "[lens]\nglasses = [\"/data/cases/a.agf\", \"/other/b.agf\"]\n";
  EXPECT_EQ(setup.resolved(), absolute);
  EXPECT_EQ(setup.written(), absolute);
  auto other = document("[lens]\nglasses = [\"a.agf\", \"/other/b.agf\"]\n");
  other.name_files(setup.file_keys());
  EXPECT_EQ(other.file_names(), expected);
  EXPECT_EQ(other.written(), absolute);
  auto wrong = document("[lens]\none = \"a.agf\"\nnumber = [1]\nempty = [\"\"]\n");
  for (char const* key : {"one", "number", "empty", "absent"}) {
    EXPECT_TRUE(wrong.root().table("lens").path_list(key).empty()) << key;
  }
  EXPECT_THAT(problems(wrong), ElementsAre("wrong_type at case.toml:2:1", "wrong_type at case.toml:3:1",
                                           "invalid_value at case.toml:4:1"));
}

TEST(SetupDocument, ARemovedKeyIsUnknownToTheReader) {
  auto setup = document("[target]\nfile = \"a.csv\"\nsize = 2\n[[camera]]\nbits = 12\n");
  setup.remove({"target", "size"});
  setup.remove({"camera", "bits"});
  for (std::vector<std::string> const& absent : {std::vector<std::string>{"target", "colour"}, {"medium", "field"}}) {
    setup.remove(absent);
  }
  EXPECT_FALSE(setup.find({"target", "size"}));
  EXPECT_FALSE(setup.find({"camera", "bits"}));
  EXPECT_TRUE(setup.find({"target", "file"}));
  EXPECT_EQ(setup.root().table("target").number("size", 1), 1);
}

TEST(SetupDocument, UnreadIsTheParsedText) {
  auto setup = document("[target]\nsize = 2\nfile = \"a.csv\"\n[lens]\nf = 1\n");
  setup.root().table("target").required_path("file");
  setup.set({"lens", "apertures"}, setup_array({setup_number(1.0), setup_integer(2)}));
  setup.set({"camera", "bits"}, setup_integer(8));
  auto unread = setup.unread(), parsed = SetupDocument::from_text(setup.written(), "case.toml");
  EXPECT_EQ(unread.written(), parsed.written());
  EXPECT_NE(unread.written(), setup.written());  // which has the keys in the order in which they were set
  EXPECT_TRUE(unread.file_names().empty());
  EXPECT_EQ(unread.root().table("target").required_path("file"), "/data/cases/a.csv");
  for (char const* const table : {"lens", "camera"}) unread.root().mark_as_read(table);
  EXPECT_THAT(problems(unread), ElementsAre("unknown_key at case.toml:2:1"));
}

// Reading a changed table again gives the record that reading the changed setup once gives.
TEST(SetupDocument, ATableIsReadAgainAsIfForTheFirstTime) {
  auto const read = [](SetupTable target) {
    target.required_path("file");
    target.has("size_mm") ? target.number("size_mm", 0) : target.number("size_px", 3);
  };
  auto const change = [](SetupDocument& setup) { setup.set({"target", "size_mm"}, setup_number(0.5)); };
  char const* const text = "[lens]\nf = 1\n[target]\nfile = \"a.csv\"\n[light]\npower = 2\n";
  auto twice = document(text), once = document(text);
  change(once);
  for (SetupDocument* const setup : {&twice, &once}) {
    setup->root().table("lens").number("f", 0);
    read(setup->root().table("target"));
    setup->root().table("light").number("power", 0);
  }
  EXPECT_NE(twice.resolved(), once.resolved());
  change(twice);
  read(twice.reread("target"));
  EXPECT_EQ(twice.resolved(), once.resolved());
  EXPECT_EQ(twice.file_names(), once.file_names());
  twice.finish();
}

TEST(SetupDocument, WrittenIsTheTextWithFileNamesMadeAbsolute) {
  auto setup = document("schema = 1\n[target]\nfile = \"a.csv\"\n[medium.field]\nkind = \"none\"\n");
  setup.root().table("target").required_path("file");
  EXPECT_EQ(setup.written(),
            "schema = 1\n\n[medium]\n\n[medium.field]\nkind = \"none\"\n\n[target]\nfile = \"/data/cases/a.csv\"\n");
}

TEST(ResolvedSetup, ReadsBackToTheSame) {
  auto setup = document(
      "file = 'field.h5'\n[medium]\nwavelength_nm = 450\n[[medium.field]]\nkind = 'none'\n[[medium.field]]\n"
      "kind = 'file'\ninner = { depth = 0.1 }\n[noise]\n");
  std::string const once = read_everything(setup);
  auto again = SetupDocument::from_text(once, "resolved", "/elsewhere");
  EXPECT_EQ(read_everything(again), once);
  EXPECT_THAT(once, HasSubstr("file = \"/data/cases/field.h5\"\n"));
  EXPECT_THAT(once, HasSubstr("third = 0.3333333333333333\n"));
  EXPECT_THAT(once, HasSubstr("wavelength_nm = 450.0\nstep_mm = \"auto\"\n"));
  EXPECT_THAT(once, HasSubstr("[[medium.field]]\nkind = \"none\"\n\n[medium.field.inner]\ndepth = 1.0\n"));
  EXPECT_THAT(once, HasSubstr("[noise]\n"));
  EXPECT_THAT(once, testing::Not(HasSubstr("absent")));
  EXPECT_THAT(once, testing::Not(HasSubstr("unwritten")));
}

TEST(ResolvedSetup, ContainsTheValueChosenForAuto) {
  auto setup = document("[medium]\nstep_mm = 'auto'\n");
  auto medium = setup.root().table("medium");
  EXPECT_EQ(medium.number_or_auto("step_mm"), std::nullopt);
  medium.resolve("step_mm", 0.25);
  EXPECT_EQ(medium.number_or_auto("step_mm"), std::nullopt);
  EXPECT_EQ(setup.resolved(), "[medium]\nstep_mm = 0.25\n");
  auto again = document(setup.resolved());
  EXPECT_EQ(again.root().table("medium").number_or_auto("step_mm"), 0.25);
}

}  // namespace
}  // namespace gladstone
