#include "relumbre/base/progress.h"

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

class Interrupted : public Progress {
 public:
  [[nodiscard]] bool cancelled() const override { return true; }
};

TEST(Progress, CheckThrowsWhenCancelled) { EXPECT_THROW(Interrupted().check(), Cancelled); }

TEST(Progress, TheDefaultNeverStopsWork) {
  no_progress().begin("stage", 10);
  no_progress().advance(11);
  EXPECT_NO_THROW(no_progress().check());
}

TEST(Error, MessagesNameFileLineAndReason) {
  EXPECT_STREQ(FileError("a.obj", "is empty").what(), "a.obj: is empty");
  EXPECT_STREQ(FileError("a.obj", 7, "has no x").what(), "a.obj:7: has no x");
}

}  // namespace
}  // namespace relumbre
