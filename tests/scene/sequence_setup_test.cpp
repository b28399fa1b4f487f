// Table [sequence] of a setup.
#include "render/scene/sequence_setup.h"

#include "tests/scene/read_setup_text.h"

namespace gladstone {
namespace {

std::string sequence_of_piv(std::string const& sequence, std::string const& more = "") {
  return "experiment = \"piv\"\n[sequence]\n" + sequence + more;
}

auto reading_sequence(std::string const& text) {
  return [text] { read_setup_text(text); };
}

TEST(SequenceSetup, OfPivHasFramesAndTheTimeBetweenThem) {
  gladstone::Setup const setup = read_setup_text(sequence_of_piv("frames = 10\ndt_us = 25.0\npair = 8\n")).setup;
  ASSERT_TRUE(setup.sequence);
  EXPECT_EQ(setup.sequence->frames, 10u);
  EXPECT_EQ(setup.sequence->pair, 8u);
  EXPECT_DOUBLE_EQ(setup.piv->flow.dt, 25e-6);
  EXPECT_EQ(*setup.camera.noise.frames, (std::array<std::uint64_t, 2>{8, 9}));
  EXPECT_FALSE(read_setup_text("experiment = \"piv\"\n").setup.sequence);
}

TEST(SequenceSetup, OfPivReportsWrongKeys) {
  EXPECT_THAT(reading_sequence(sequence_of_piv("frames = 1\ndt_us = 10.0\n")), refused(ErrorCode::out_of_range, "3:1"));
  EXPECT_THAT(reading_sequence(sequence_of_piv("frames = 2.5\ndt_us = 10.0\n")), refused(ErrorCode::wrong_type, "3:1"));
  EXPECT_THAT(reading_sequence(sequence_of_piv("frames = 10\n")), refused(ErrorCode::missing_key, "2:"));
  EXPECT_THAT(reading_sequence(sequence_of_piv("dt_us = 10.0\n")), refused(ErrorCode::missing_key, "2:"));
  EXPECT_THAT(reading_sequence(sequence_of_piv("frames = 10\ndt_us = 0.0\n")), refused(ErrorCode::out_of_range, "4:1"));
  EXPECT_THAT(reading_sequence(sequence_of_piv("frames = 10\ndt_us = 10.0\npair = 9\n")),
              refused(ErrorCode::invalid_value, "5:1", " 8"));
  EXPECT_THAT(reading_sequence(sequence_of_piv("frames = 10\ndt_us = 10.0\nfiles = [\"a.h5\"]\n")),
              refused(ErrorCode::invalid_value, "5:1"));
}

// Keys of other tables that contradict a sequence.
TEST(SequenceSetup, OfPivRefusesPulsesThatDiffer) {
  std::string const keys = "frames = 10\ndt_us = 10.0\n";
  EXPECT_THAT(reading_sequence(sequence_of_piv(keys, "[flow]\ndt_us = 10.0\n")),
              refused(ErrorCode::invalid_value, "6:1"));
  EXPECT_THAT(reading_sequence(sequence_of_piv(keys, "[laser]\noffset_mm = [0.0, 0.1]\n")),
              refused(ErrorCode::invalid_value, "6:1"));
  EXPECT_THAT(reading_sequence(sequence_of_piv(keys, "[laser]\ntilt_deg = [0.5, 0.0]\n")),
              refused(ErrorCode::invalid_value, "6:1"));
  EXPECT_NO_THROW(read_setup_text(sequence_of_piv(keys, "[laser]\noffset_mm = [0.1, 0.1]\n")));
  EXPECT_THAT(reading_sequence(sequence_of_piv(keys, "[medium.second_field]\nkind = \"uniform_gradient\"\n")),
              refused(ErrorCode::invalid_value, "5:"));
}

TEST(SequenceSetup, OfBosRequiresFiles) {
  EXPECT_THAT(reading_sequence("[sequence]\n"), refused(ErrorCode::missing_key, "1:"));
  EXPECT_THAT(reading_sequence("[sequence]\nfiles = \"rho.h5\"\n"), refused(ErrorCode::wrong_type, "2:1"));
  EXPECT_THAT(reading_sequence("[sequence]\nfiles = [\"rho.h5\"]\n"), refused(ErrorCode::invalid_value, "2:1"));
  EXPECT_THAT(reading_sequence("[sequence]\nfiles = [\"rho.h5\"]\nframes = 3\n"),
              refused(ErrorCode::invalid_value, "3:1"));
  EXPECT_THAT(reading_sequence("[sequence]\nfiles = [\"rho.h5\"]\npair = 0\n"),
              refused(ErrorCode::out_of_range, "3:1"));
}

TEST(SequenceSetup, DoesNotApplyToACalibration) {
  EXPECT_THAT(reading_sequence("experiment = \"calibration\"\n[sequence]\nframes = 3\n"),
              refused(ErrorCode::invalid_value, "2:"));
}

}  // namespace
}  // namespace gladstone
