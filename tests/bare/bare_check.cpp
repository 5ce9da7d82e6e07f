// The stand-ins for GoogleTest and {fmt} do what is expected of them: Passes.* pass, each of
// Fails.* fails.
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

TEST(Passes, Comparisons) {
  EXPECT_EQ(1, 1) << "not printed";
  EXPECT_NE(1, 2);
  EXPECT_LT(1, 2);
  EXPECT_LE(2, 2);
  EXPECT_GT(3, 2);
  EXPECT_GE(3, 3);
  EXPECT_TRUE(true);
  EXPECT_FALSE(false);
  EXPECT_NEAR(1.0, 1.1, 0.2);
  EXPECT_THROW(throw std::runtime_error("as wanted"), std::runtime_error);
  EXPECT_NO_THROW(void());
  ASSERT_EQ(1, 1);
}

TEST(Passes, Format) {
  EXPECT_EQ(fmt::format("{} of {}: {:.3f} and no more", 3, "seven", 1.5),
            std::string("3 of seven: 1.5 and no more"));
  EXPECT_EQ(fmt::format("nothing"), std::string("nothing"));
  const std::vector<int> values{1, 2, 3};
  EXPECT_EQ(fmt::format("{}", fmt::join(values, ", ")), std::string("1, 2, 3"));
}

TEST(Passes, Skips) {
  GTEST_SKIP() << "a reason";
  ADD_FAILURE() << "reached";
}

TEST(Fails, Equal) { EXPECT_EQ(1, 2) << "printed"; }
TEST(Fails, NotANumberIsNear) { EXPECT_NEAR(0.0, std::nan(""), 1.0); }
TEST(Fails, Less) { EXPECT_LT(2, 2); }
TEST(Fails, Condition) { EXPECT_TRUE(false); }
TEST(Fails, NothingThrown) { EXPECT_THROW(void(), std::runtime_error); }
TEST(Fails, SomethingElseThrown) { EXPECT_THROW(throw std::logic_error("x"), std::runtime_error); }
TEST(Fails, Thrown) { EXPECT_NO_THROW(throw std::logic_error("x")); }
TEST(Fails, LeftByAnException) { throw std::logic_error("x"); }
TEST(Fails, AssertsEnd) { ASSERT_EQ(1, 2); }
TEST(Fails, Asked) { FAIL() << "asked to"; }
