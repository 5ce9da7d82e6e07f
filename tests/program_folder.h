/// A folder in which a test runs the program as a user would.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/image/image_io.h"

namespace relumbre {

struct Outcome {
  int status = -1;
  std::string out, err;
};

class ProgramFolder {
 public:
  /// `relumbre ARGUMENTS`.
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return shell(std::string(RELUMBRE_PROGRAM) + " " + arguments);
  }
  /// Any command. What it prints is in out.txt and err.txt, too.
  [[nodiscard]] Outcome shell(const std::string& command) const {
    const std::string line =
        "cd '" + folder_.path().string() + "' && { " + command + "; } >out.txt 2>err.txt";
    const int raw = std::system(line.c_str());
    return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, read("out.txt"), read("err.txt")};
  }

  /// `relumbre ARGUMENTS` where no file can grow beyond `bytes`: a disk that is full. (The signal
  /// that would come with it is one that a full disk does not send.)
  [[nodiscard]] Outcome run_on_full_disk(std::size_t bytes, const std::string& arguments) const {
    return shell("trap '' XFSZ; ulimit -f " + std::to_string(bytes / 512) + "; " +
                 RELUMBRE_PROGRAM + " " + arguments);
  }

  /// `relumbre ARGUMENTS`, and Ctrl-C after so many seconds.
  [[nodiscard]] Outcome run_and_interrupt(int seconds, const std::string& arguments) const {
    return shell("timeout --foreground --preserve-status -s INT " + std::to_string(seconds) + " " +
                 RELUMBRE_PROGRAM + " " + arguments);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return folder_ / name;
  }
  [[nodiscard]] bool exists(const std::string& name) const {
    return std::filesystem::exists(folder_ / name);
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    return read_file(folder_ / name);
  }
  [[nodiscard]] Image image(const std::string& name) const { return load_image(folder_ / name); }
  void write(const std::string& name, const std::string& text) const {
    write_file(folder_ / name, text);
  }
  /// How many files there are beside out.txt and err.txt.
  [[nodiscard]] std::size_t files() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      count += name != "out.txt" && name != "err.txt";
    }
    return count;
  }
  /// Expects bad input's outcome: this status, every one of the reasons on standard error, which
  /// for status 1 is one line, and no file more than before.
  void expect_refused(const std::string& arguments, const std::vector<std::string>& reasons,
                      int status = 1) const {
    const std::size_t before = files();
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.err;
    for (const std::string& reason : reasons)
      EXPECT_NE(outcome.err.find(reason), std::string::npos) << arguments << ": " << outcome.err;
    if (status == 1) {
      EXPECT_TRUE(outcome.err.starts_with("relumbre: ")) << outcome.err;
      EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    }
    EXPECT_EQ(files(), before) << arguments;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace relumbre
