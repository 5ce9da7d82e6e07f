/// Runs `relumbre dof` in a folder that the tests of a suite share.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "program_folder.h"
#include "relumbre/base/sampling.h"
#include "relumbre/image/exr.h"

namespace relumbre {

class DofFixture : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ProgramFolder;
    save("small.exr", noise(37, 23));
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static int run(const std::string& arguments) { return folder_->run(arguments).status; }
  static int interrupt_after(int seconds, const std::string& arguments) {
    return folder_->run_and_interrupt(seconds, arguments).status;
  }
  static int dof(const std::string& arguments) { return run("dof " + arguments); }
  static std::string read(const std::string& name) { return folder_->read(name); }
  static Image image(const std::string& name) { return folder_->image(name); }
  static bool exists(const std::string& name) { return folder_->exists(name); }
  static std::filesystem::path path(const std::string& name) { return *folder_ / name; }
  static void save(const std::string& name, const Image& image) { write_exr(path(name), image); }
  static std::size_t files() { return folder_->files(); }

  /// One line on standard error with every one of the reasons; nothing is written.
  static void expect_refused(const std::string& arguments, int status,
                             const std::vector<std::string>& reasons,
                             const std::string& output = "-o refused.exr") {
    folder_->expect_refused("dof " + arguments + " " + output, reasons, status);
  }

  /// Colours and depths at random.
  static Image noise(std::size_t width, std::size_t height) {
    const std::vector<std::string> names{"R", "G", "B", "A", "Z"};
    Image result(width, height, names);
    RandomStream random(width);
    for (const char* name : {"R", "G", "B"})
      for (float& v : result.channel(name)) v = random.uniform();
    std::ranges::fill(result.channel("A"), 1.0F);
    for (float& z : result.channel("Z")) z = 1 + 8 * random.uniform();
    return result;
  }
  /// The same planes by other names.
  static Image renamed(const Image& image, const std::vector<std::string>& names) {
    Image result(image.width(), image.height(), names);
    for (std::size_t i = 0; i < names.size(); ++i)
      std::ranges::copy(image.channels()[i].values, result.channel(names[i]).begin());
    return result;
  }

 private:
  inline static ProgramFolder* folder_ = nullptr;
};

}  // namespace relumbre
