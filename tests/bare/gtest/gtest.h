/// Stands in for GoogleTest on machines without it: as much as the tests of the GPU side use, TEST,
/// EXPECT_ and ASSERT_ comparisons with messages, GTEST_SKIP. Only the GPU check is built with it.
/// The output is laid out like GoogleTest's.
#pragma once

#include <cmath>
#include <cstring>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace testing {

struct Test {
  const char* suite;
  const char* name;
  void (*run)();
};

struct Run {
  std::vector<Test> tests;
  bool failed = false, skipped = false;
  static Run& instance() {
    static Run run;
    return run;
  }
};

inline bool add_test(const char* suite, const char* name, void (*run)()) {
  Run::instance().tests.push_back({suite, name, run});
  return true;
}

/// Collects what is streamed into a failure or a skip.
class Message {
 public:
  template <class T>
  Message& operator<<(const T& value) {
    text_ << value;
    return *this;
  }
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

/// `record = Message() << ...` prints it when the expression ends.
struct Failure {
  const char* file;
  int line;
  std::string what;
  void operator=(const Message& message) const {
    Run::instance().failed = true;
    std::cout << file << ':' << line << ": Failure\n" << what << '\n' << message.text() << '\n';
  }
};
struct Skip {
  void operator=(const Message& message) const {
    Run::instance().skipped = true;
    std::cout << "Skipped: " << message.text() << '\n';
  }
};

template <class T>
void show(std::ostream& to, const T& value) {
  if constexpr (requires { to << value; })
    to << value;
  else
    to << "a value of " << sizeof(T) << " bytes";
}

template <class A, class B, class Compare>
std::string compared(const A& a, const B& b, const char* text, const Compare& compare) {
  if (compare(a, b)) return {};
  std::ostringstream out;
  out << "Expected: " << text << ", actual: ";
  show(out, a);
  out << " vs ";
  show(out, b);
  return out.str();
}

template <class Body>
std::string thrown(const Body& body, const char* wanted) {
  try {
    return body() ? std::string() : std::string("Expected: throws ") + wanted + ", but nothing was";
  } catch (const std::exception& error) {
    return std::string("Expected: throws ") + wanted + ", but something else was: " + error.what();
  }
}

inline bool matches(const Test& test, const std::string& filter) {
  const std::string name = std::string(test.suite) + "." + test.name;
  if (filter.empty() || filter == "*") return true;
  const bool open = filter.back() == '*';
  const std::string start = open ? filter.substr(0, filter.size() - 1) : filter;
  return open ? name.compare(0, start.size(), start) == 0 : name == filter;
}

inline int run_all(int argc, char** argv) {
  constexpr const char* kFilter = "--gtest_filter=";
  std::string filter;
  bool list = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strncmp(argv[i], kFilter, std::strlen(kFilter)) == 0)
      filter = argv[i] + std::strlen(kFilter);
    list = list || std::strcmp(argv[i], "--gtest_list_tests") == 0;
  }
  std::vector<std::string> failed;
  std::size_t passed = 0, skipped = 0;
  for (const Test& test : Run::instance().tests) {
    const std::string name = std::string(test.suite) + "." + test.name;
    if (!matches(test, filter)) continue;
    if (list) {
      std::cout << name << '\n';
      continue;
    }
    std::cout << "[ RUN      ] " << name << std::endl;
    Run::instance().failed = Run::instance().skipped = false;
    try {
      test.run();
    } catch (const std::exception& error) {
      Run::instance().failed = true;
      std::cout << "Failure: threw " << error.what() << '\n';
    }
    if (Run::instance().failed)
      failed.push_back(name);
    else
      ++(Run::instance().skipped ? skipped : passed);
    std::cout << (Run::instance().failed    ? "[  FAILED  ] "
                  : Run::instance().skipped ? "[  SKIPPED ] "
                                            : "[       OK ] ")
              << name << std::endl;
  }
  if (list) return 0;
  std::cout << "[  PASSED  ] " << passed << " tests, " << skipped << " skipped.\n";
  for (const std::string& name : failed) std::cout << "[  FAILED  ] " << name << '\n';
  return failed.empty() ? 0 : 1;
}

}  // namespace testing

#define TEST(suite, name)                                      \
  static void suite##_##name##_test();                         \
  [[maybe_unused]] static const bool suite##_##name##_added =  \
      testing::add_test(#suite, #name, suite##_##name##_test); \
  static void suite##_##name##_test()

#define RELUMBRE_BARE_CHECK(problem, on_failure)                                \
  if (const std::string relumbre_problem = (problem); relumbre_problem.empty()) \
    ;                                                                           \
  else                                                                          \
    on_failure testing::Failure{__FILE__, __LINE__, relumbre_problem} = testing::Message()

#define RELUMBRE_BARE_COMPARE(a, b, op, on_failure)                                           \
  RELUMBRE_BARE_CHECK(testing::compared((a), (b), "(" #a ") " #op " (" #b ")",                \
                                        [](const auto& x, const auto& y) { return x op y; }), \
                      on_failure)
#define RELUMBRE_BARE_TRUE(condition, wanted, on_failure)         \
  RELUMBRE_BARE_CHECK(static_cast<bool>(condition) == (wanted)    \
                          ? std::string()                         \
                          : std::string("Value of: " #condition), \
                      on_failure)

#define EXPECT_EQ(a, b) RELUMBRE_BARE_COMPARE(a, b, ==, )
#define EXPECT_NE(a, b) RELUMBRE_BARE_COMPARE(a, b, !=, )
#define EXPECT_LT(a, b) RELUMBRE_BARE_COMPARE(a, b, <, )
#define EXPECT_LE(a, b) RELUMBRE_BARE_COMPARE(a, b, <=, )
#define EXPECT_GT(a, b) RELUMBRE_BARE_COMPARE(a, b, >, )
#define EXPECT_GE(a, b) RELUMBRE_BARE_COMPARE(a, b, >=, )
#define EXPECT_TRUE(condition) RELUMBRE_BARE_TRUE(condition, true, )
#define EXPECT_FALSE(condition) RELUMBRE_BARE_TRUE(condition, false, )
#define RELUMBRE_BARE_NEAR(a, b, most, on_failure)                                                \
  RELUMBRE_BARE_CHECK(                                                                            \
      testing::compared((a), (b), #a " near " #b,                                                 \
                        [&](const auto& x, const auto& y) { return std::abs(x - y) <= (most); }), \
      on_failure)
#define EXPECT_NEAR(a, b, most) RELUMBRE_BARE_NEAR(a, b, most, )
#define ASSERT_NEAR(a, b, most) RELUMBRE_BARE_NEAR(a, b, most, return )
#define EXPECT_FLOAT_EQ(a, b) EXPECT_NEAR(a, b, 4 * 1.2e-7F * std::abs(b))
#define EXPECT_DOUBLE_EQ(a, b) EXPECT_NEAR(a, b, 4 * 2.3e-16 * std::abs(b))
#define EXPECT_THROW(statement, type)               \
  RELUMBRE_BARE_CHECK(testing::thrown(              \
                          [&] {                     \
                            try {                   \
                              statement;            \
                            } catch (const type&) { \
                              return true;          \
                            }                       \
                            return false;           \
                          },                        \
                          #type), )
#define EXPECT_NO_THROW(statement)       \
  RELUMBRE_BARE_CHECK(testing::thrown(   \
                          [&] {          \
                            statement;   \
                            return true; \
                          },             \
                          "nothing"), )
#define ASSERT_EQ(a, b) RELUMBRE_BARE_COMPARE(a, b, ==, return )
#define ASSERT_NE(a, b) RELUMBRE_BARE_COMPARE(a, b, !=, return )
#define ASSERT_LT(a, b) RELUMBRE_BARE_COMPARE(a, b, <, return )
#define ASSERT_LE(a, b) RELUMBRE_BARE_COMPARE(a, b, <=, return )
#define ASSERT_GT(a, b) RELUMBRE_BARE_COMPARE(a, b, >, return )
#define ASSERT_GE(a, b) RELUMBRE_BARE_COMPARE(a, b, >=, return )
#define ASSERT_TRUE(condition) RELUMBRE_BARE_TRUE(condition, true, return )
#define ASSERT_FALSE(condition) RELUMBRE_BARE_TRUE(condition, false, return )
#define ASSERT_NO_THROW(statement)       \
  RELUMBRE_BARE_CHECK(testing::thrown(   \
                          [&] {          \
                            statement;   \
                            return true; \
                          },             \
                          "nothing"),    \
                      return )
#define ADD_FAILURE() testing::Failure{__FILE__, __LINE__, "Failed"} = testing::Message()
#define FAIL() return ADD_FAILURE()
#define SUCCEED() testing::Message()
#define GTEST_SKIP() return testing::Skip{} = testing::Message()
