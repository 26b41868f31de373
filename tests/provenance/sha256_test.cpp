// SPDX-License-Identifier: GPL-3.0-or-later
// Test vectors of FIPS 180-4 (NIST, "SHA256.pdf" of the cryptographic standards examples).
#include "provenance/sha256.hpp"

#include <gtest/gtest.h>

namespace shearcell {
namespace {

TEST(Sha256, MatchesTheVectorsOfTheStandard) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  Sha256 million;
  for (int i = 0; i < 1000; ++i) million.add(std::string(1000, 'a'));
  EXPECT_EQ(million.hex(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, NumbersAreHashedByTheirBits) {
  EXPECT_EQ(Sha256().add_u64(0x0807060504030201).hex(), sha256_hex("\1\2\3\4\5\6\7\10"));
  EXPECT_EQ(Sha256().add_f64(1.0).hex(), Sha256().add_u64(0x3ff0000000000000).hex());
  EXPECT_NE(Sha256().add_f64(0.0).hex(), Sha256().add_f64(-0.0).hex());
}

TEST(Sha256, RecognizesADigest) {
  EXPECT_TRUE(is_sha256_hex(sha256_hex("")));
  EXPECT_FALSE(is_sha256_hex("../../etc/passwd"));
  EXPECT_FALSE(is_sha256_hex(std::string(64, 'A')));
  EXPECT_FALSE(is_sha256_hex(std::string(63, 'a')));
}

}  // namespace
}  // namespace shearcell
