#include <sys/resource.h>

#include <algorithm>

#include "render/files/image_file.h"
#include "tests/end_to_end/support/program_fixture.h"
#include "tests/support/sanitizer.h"

namespace gladstone::end_to_end {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// A machine with little memory, closed or full streams, and an unusual environment.
class Limits : public ProgramFixture {
 protected:
  /// Writes a PNG of 8 bits from a TIFF of 12 bits.
  void write_png(std::string const& name, std::string const& tiff) const {
    Image<double> const levels = read_image(in(tiff).string());
    Image<std::uint8_t> bytes(levels.columns(), levels.rows());
    std::transform(levels.begin(), levels.end(), bytes.begin(),
                   [](double level) { return static_cast<std::uint8_t>(level / 16); });
    write(name, encode_png(bytes));
  }
};

// Images other than plain TIFFs are read by some 250 libraries, which abort or hang if they lack address space when
// they start. Whatever the limit, the program ends by itself, with vectors or with a message.
TEST_F(Limits, LittleAddressSpaceIsAMessageAndNoCrash) {
  if (test::address_sanitizer) GTEST_SKIP() << "AddressSanitizer takes more address space than any limit leaves";
  render("case");
  write_png("reference.png", "case/reference.tif");
  write_png("flow.png", "case/flow.tif");
  int refused = 0;
  for (rlim_t megabytes = 440; megabytes <= 900; megabytes += 40) {
    std::filesystem::remove(in("v.h5"));
    auto const limited = [megabytes] {
      rlimit const limit{megabytes << 20, megabytes << 20}, no_core{0, 0};
      return ::setrlimit(RLIMIT_AS, &limit) == 0 && ::setrlimit(RLIMIT_CORE, &no_core) == 0;
    };
    Outcome const outcome =
        run({"correlate", "reference.png", "flow.png", "-o", "v.h5", "--threads", "1", "--json"}, folder_, limited);
    if (outcome.exit_code == 127) continue;  // the program itself could not be loaded
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 2)
        << megabytes << " MiB: signal " << outcome.signal << ' ' << outcome.err;
    EXPECT_EQ(outcome.exit_code == 0, std::filesystem::exists(in("v.h5"))) << megabytes;
    if (outcome.exit_code != 2) continue;
    ++refused;
    EXPECT_THAT(errors_in(outcome.out), testing::ElementsAre(testing::StartsWith("memory at "))) << megabytes;
  }
  EXPECT_GT(refused, 0);
}

TEST_F(Limits, ClosedStreamsAreNoCrash) {
  auto const closed = [](std::vector<int> streams) {
    return [streams] {
      for (int const stream : streams) ::close(stream);
      return true;
    };
  };
  std::vector<std::string> const mie{"info", "mie", "--x", "5", "--m", "1.5"};
  EXPECT_EQ(run(mie, folder_, closed({1, 2})).exit_code, 2) << "the result cannot be printed";
  Outcome const no_stdout = run(mie, folder_, closed({1}));
  EXPECT_EQ(no_stdout.exit_code, 2);
  EXPECT_THAT(no_stdout.err, HasSubstr("standard output"));
  Outcome const no_stderr = run(mie, folder_, closed({2}));
  EXPECT_EQ(no_stderr.exit_code, 0);
  EXPECT_THAT(no_stderr.out, HasSubstr("extinction"));
  // and no file receives the descriptor of a closed stream, and thereby its messages
  Outcome const render = run({"render", "setup.toml", "-o", "case"}, folder_, closed({0, 1, 2}));
  EXPECT_EQ(render.exit_code, 2);
  succeed({"correlate", "case"});
  EXPECT_EQ(run({"no-such-command"}, folder_, closed({1, 2})).exit_code, 2);
}

TEST_F(Limits, AFullStandardOutputIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  auto const full = [] {
    int const file = ::open("/dev/full", O_WRONLY);
    return ::dup2(file, STDOUT_FILENO) == STDOUT_FILENO;
  };
  render("case");
  succeed({"correlate", "case"});
  for (std::vector<std::string> const& command :
       std::vector<std::vector<std::string>>{{"design", "setup.toml"},
                                             {"compare", "case", "--json", "--no-figures"},
                                             {"info", "mie", "--x", "5", "--m", "1.5"},
                                             {"info", "mie", "--x", "500", "--m", "1.5", "--json"},
                                             {"--help"},
                                             {"render", "--help"},
                                             {"render", "none.toml", "-o", "x", "--json"},
                                             {"--version"}}) {
    Outcome const outcome = run(command, folder_, full);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(command);
    EXPECT_THAT(outcome.err, HasSubstr("standard output")) << testing::PrintToString(command);
  }
}

// gnuplot starts the terminal of GNUTERM before the script names another; gnuplot-nox has no x11.
TEST_F(Limits, TheUsersTerminalOfGnuplotDoesNotMatter) {
  auto const with_terminal = [] { return ::setenv("GNUTERM", "x11", 1) == 0; };
  Outcome const outcome = run({"info", "mie", "--x", "5", "--m", "1.5", "--figure", "mie.png"}, folder_, with_terminal);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  if (outcome.err.find("gnuplot not found") != std::string::npos) GTEST_SKIP() << "no gnuplot here";
  EXPECT_THAT(read("mie.png"), HasSubstr("PNG"));
}

}  // namespace
}  // namespace gladstone::end_to_end
