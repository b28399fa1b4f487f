#include "render/files/input_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "render/base/error.h"
#include "render/files/text_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

using InputFiles = FolderFixture;

// Opening a pipe without a writer blocks for ever, and a device has no end.
TEST_F(InputFiles, PipesAndDevicesAreRefusedBeforeTheyAreOpened) {
  ASSERT_EQ(::mkfifo(in_folder("pipe").c_str(), 0600), 0);
  EXPECT_THAT([&] { InputFile file(in_folder("pipe"), "a setup file"); },
              ThrowsDataError(ErrorCode::unreadable_file, in_folder("pipe")));
  fs::create_symlink("pipe", in_folder("link"));
  EXPECT_THAT([&] { InputFile file(in_folder("link")); }, ThrowsDataError(ErrorCode::unreadable_file, "link"));
  EXPECT_THAT([&] { InputFile file(folder_.string(), "a picture"); },
              ThrowsDataError(ErrorCode::unreadable_file, folder_.string()));
  EXPECT_THAT([&] { InputFile file("/dev/zero"); }, ThrowsDataError(ErrorCode::unreadable_file, "/dev/zero"));
  EXPECT_THAT([&] { InputFile file(in_folder("nothing")); }, ThrowsDataError(ErrorCode::missing_file, "nothing"));
  EXPECT_THAT([&] { InputFile file(in_folder(std::string(5000, 'a'))); },
              ThrowsDataError(ErrorCode::unreadable_file, "aaa"));

  int const listener = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  fs::path const before = fs::current_path();
  fs::current_path(folder_);  // the name of a socket has at most 107 characters
  std::string const place = "socket";
  std::memcpy(address.sun_path, place.c_str(), place.size() + 1);
  ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr const*>(&address), sizeof address), 0);
  EXPECT_THAT([&] { InputFile file(place); }, ThrowsDataError(ErrorCode::unreadable_file, "socket"));
  ::close(listener);
  fs::current_path(before);
}

TEST_F(InputFiles, AreReadFromAnyPlaceUpToTheirEnd) {
  InputFile const file(write("text", "0123456789"));
  EXPECT_EQ(file.size(), 10u);
  char bytes[8] = {};
  EXPECT_EQ(file.read(2, bytes, 3), 3u);
  EXPECT_EQ(std::string(bytes, 3), "234");
  EXPECT_EQ(file.read(7, bytes, 8), 3u);
  EXPECT_EQ(std::string(bytes, 3), "789");
  EXPECT_EQ(file.read(20, bytes, 8), 0u);
}

TEST_F(InputFiles, ATextThatIsLongerThanAllowedIsRefusedUnread) {
  std::string const path = write("long", "");
  fs::resize_file(path, std::uintmax_t{1} << 40);  // a sparse file: the disk does not have this much space
  EXPECT_THAT([&] { read_text_file(path, "a setup file", std::uint64_t{32} << 20); },
              ThrowsDataError(ErrorCode::out_of_range, "long", HasSubstr("32 MiB")));
  EXPECT_EQ(read_text_file(write("short", std::string(100, 'x')), "a setup file", 100), std::string(100, 'x'));
}

// Files of the kernel report a size of zero.
TEST_F(InputFiles, FilesThatReportNoSizeAreReadToTheirEnd) {
  EXPECT_THAT(read_text_file("/proc/self/status"), HasSubstr("VmRSS:"));
}

TEST_F(InputFiles, LinesComeWithoutTheirEnds) {
  LineReader lines(write("lines", "one\r\ntwo\n\nlast"));
  EXPECT_EQ(lines.next(), "one");
  EXPECT_EQ(lines.offset(), 5u);
  EXPECT_EQ(lines.next(), "two");
  EXPECT_EQ(lines.next(), "");
  EXPECT_EQ(lines.place(), in_folder("lines") + ":3");
  EXPECT_EQ(lines.next(), "last");
  EXPECT_EQ(lines.number(), 4u);
  EXPECT_EQ(lines.next(), std::nullopt);
  EXPECT_EQ(lines.next(), std::nullopt);
  EXPECT_EQ(lines.offset(), 14u);
  EXPECT_EQ(LineReader(write("empty", "")).next(), std::nullopt);
}

// Lines of 0 to 999 characters cross the ends of the read buffer at all positions. Spreadsheets put U+FEFF in front of
// a text in UTF-8. Offsets include it, and it is removed from the first line only.
TEST_F(InputFiles, AByteOrderMarkBelongsToNoLine) {
  LineReader lines(write("marked.csv",
                         "\xEF\xBB\xBFx_mm,y_mm\n\xEF\xBB\xBF"
                         "1,2\n"));
  EXPECT_EQ(lines.next(), "x_mm,y_mm");
  EXPECT_EQ(lines.offset(), 13u);
  EXPECT_EQ(lines.next(),
            "\xEF\xBB\xBF"
            "1,2");
}

TEST_F(InputFiles, LinesOfALongFileAreWhole) {
  std::string text;
  for (std::size_t i = 0; i < 5000; ++i) text += std::string(i * 7 % 1000, static_cast<char>('a' + i % 26)) + '\n';
  LineReader lines(write("many", text));
  for (std::size_t i = 0; i < 5000; ++i) {
    auto const line = lines.next();
    ASSERT_TRUE(line.has_value());
    ASSERT_EQ(*line, std::string(i * 7 % 1000, static_cast<char>('a' + i % 26))) << i;
  }
  EXPECT_EQ(lines.next(), std::nullopt);
  EXPECT_EQ(lines.offset(), text.size());
}

TEST_F(InputFiles, ALineWithoutEndIsRefusedByItsNumber) {
  LineReader lines(write("endless", "x,y\n" + std::string(3 << 20, '1')));
  EXPECT_EQ(lines.next(), "x,y");
  EXPECT_THAT([&] { lines.next(); }, ThrowsDataError(ErrorCode::out_of_range, "endless:2", HasSubstr("1 MiB")));
}

TEST(Excerpt, CutsBetweenCharacters) {
  EXPECT_EQ(excerpt("short"), "short");
  EXPECT_EQ(excerpt(std::string(60, 'a')), std::string(60, 'a'));
  EXPECT_EQ(excerpt(std::string(61, 'a')), std::string(57, 'a') + "...");
  std::string const umlauts = "\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4";  // three bytes are one and a half of these characters
  EXPECT_EQ(excerpt(umlauts, 6), "\xc3\xa4...");
}

}  // namespace
}  // namespace gladstone
