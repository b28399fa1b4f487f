#include "render/files/sha256.h"

#include <gtest/gtest.h>

#include <string>

namespace gladstone {
namespace {

std::string sha256(std::string const& bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.finish();
}

// Examples of FIPS 180-4 (NIST, "SHA256.pdf" and the long message of its test vectors).
TEST(Sha256Test, IsThatOfTheStandard) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256Test, PiecesAreAsGoodAsTheWhole) {
  Sha256 hash;
  for (char const* piece : {"a", "", "bc"}) hash.add(piece);
  EXPECT_EQ(hash.finish(), sha256("abc"));
}

}  // namespace
}  // namespace gladstone
