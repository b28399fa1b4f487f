#include "render/files/content_hash.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "render/base/error.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

// Test vectors of the algorithm with seed 0.
TEST(ContentHash, IsXxh64) {
  EXPECT_EQ(content_hash(""), "ef46db3751d8e999");
  EXPECT_EQ(content_hash("abc"), "44bc2cf5ad770999");
}

TEST(ContentHash, OfAFileIsThatOfItsBytesAndSeesEveryByteOfALongOne) {
  std::string const path = (std::filesystem::path(testing::TempDir()) / "gladstone_content_hash").string();
  std::ofstream(path, std::ios::binary) << "abc";
  EXPECT_EQ(file_hash(path), content_hash("abc"));
  std::ofstream(path, std::ios::binary) << "";
  EXPECT_EQ(file_hash(path), content_hash(""));
  std::string bytes((std::size_t{16} << 20) + 5, 'a');  // longer than one block
  std::ofstream(path, std::ios::binary) << bytes;
  std::string const before = file_hash(path);
  EXPECT_EQ(file_hash(path), before);
  for (std::size_t at : {std::size_t{0}, std::size_t{16} << 20, bytes.size() - 1}) {
    bytes[at] = 'b';
    std::ofstream(path, std::ios::binary) << bytes;
    EXPECT_NE(file_hash(path), before);
    bytes[at] = 'a';
  }
  std::filesystem::remove(path);
  EXPECT_THAT([&] { file_hash(path); }, ThrowsDataError(ErrorCode::missing_file, path));
  EXPECT_THAT([&] { file_hash(testing::TempDir()); }, ThrowsDataError(ErrorCode::unreadable_file, testing::TempDir()));
}

}  // namespace
}  // namespace gladstone
