#include "relumbre/base/content_hash.h"

#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

std::uint64_t hash_of(std::string_view text) {
  return content_hash(std::as_bytes(std::span(text)));
}

TEST(ContentHash, MatchesPublishedDigests) {
  EXPECT_EQ(hash_of(""), 0xEF46DB3751D8E999U);
  EXPECT_EQ(hash_of("a"), 0xD24EC4F1A98C6E5BU);
  EXPECT_EQ(hash_of("abc"), 0x44BC2CF5AD770999U);
  EXPECT_EQ(hash_of("Nobody inspects the spammish repetition"), 0xFBCEA83C8A378BF1U);
}

TEST(ContentHash, DoesNotDependOnHowTheBytesAreCut) {
  std::vector<std::uint8_t> bytes(131);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 37);
  const std::uint64_t whole = content_hash(std::as_bytes(std::span(bytes)));
  for (std::size_t piece = 1; piece < 70; ++piece) {
    ContentHash hash;
    for (std::size_t i = 0; i < bytes.size(); i += piece) {
      hash.add_values(
          std::span<const std::uint8_t>(bytes).subspan(i).first(std::min(piece, bytes.size() - i)));
    }
    EXPECT_EQ(hash.digest(), whole) << piece;
  }
}

TEST(ContentHash, EveryBitCounts) {
  std::vector<std::uint8_t> bytes(77);
  const std::uint64_t before = content_hash(std::as_bytes(std::span(bytes)));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << bit % 8));
    EXPECT_NE(content_hash(std::as_bytes(std::span(bytes))), before) << bit;
    bytes[bit / 8] = 0;
  }
}

}  // namespace
}  // namespace relumbre
