#include "relumbre/store/bake.h"

#include <atomic>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/parallel.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/radiosity/form_factors.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/store/bake_journal.h"
#include "relumbre/store/store.h"
#include "relumbre/store/test_support.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

BakeConfig small_config() {
  return {.patches = 37, .elements = 331, .rays = 2048, .row_block = 8, .scene_name = "cornell"};
}

/// Asks to stop once so many units of "form factors", or of another stage, are done.
class StopAfter : public Progress {
 public:
  explicit StopAfter(std::uint64_t units, std::string_view stage = "form factors")
      : units_(units), stage_(stage) {}
  void begin(std::string_view stage, std::uint64_t) override { counting_ = stage == stage_; }
  void advance(std::uint64_t units) override {
    if (counting_) done_ += units;
  }
  [[nodiscard]] bool cancelled() const override { return counting_ && done_ >= units_; }

 private:
  std::uint64_t units_;
  std::string_view stage_;
  std::atomic<bool> counting_ = false;
  std::atomic<std::uint64_t> done_ = 0;
};

class Bake : public testing::Test {
 protected:
  /// The bytes of the store that an uninterrupted bake writes.
  std::string uninterrupted() {
    const fs::path other = folder_ / "uninterrupted.h5";
    bake(scene_, small_config(), other);
    return bytes_of(other);
  }
  /// Bakes until about `rows` rows are in the journal.
  void interrupt_after(std::uint64_t rows) {
    const ThreadLimit one(1);
    StopAfter stop(rows);
    EXPECT_THROW(bake(scene_, small_config(), store_, stop), Cancelled);
    EXPECT_FALSE(fs::exists(store_));
    EXPECT_TRUE(fs::exists(journal_));
  }
  BakeResult resume(BakeConfig config = small_config()) {
    config.resume = true;
    return bake(scene_, config, store_);
  }

  TemporaryFolder folder_;
  // Rows are traced in waves that grow with the threads, and interrupted between waves.
  ThreadLimit two_threads_{2};
  fs::path store_ = folder_ / "scene.h5", journal_ = folder_ / "scene.h5.partial";
  Scene scene_ = make_cornell_scene();
};

TEST_F(Bake, StoresTheFormFactorsOfTheScene) {
  const BakeResult result = bake(scene_, small_config(), store_);
  EXPECT_FALSE(fs::exists(journal_));
  const BakedScene baked = read_store(store_);
  const FormFactors expected = trace_form_factors(baked.tessellation, RayScene(scene_.mesh),
                                                  {.rays = 2048}, Binning::kPatches);
  EXPECT_EQ(baked.counts.row_offsets, expected.counts.row_offsets);
  EXPECT_EQ(baked.counts.column, expected.counts.column);
  EXPECT_EQ(baked.counts.count, expected.counts.count);
  EXPECT_EQ(baked.settings, result.settings);
  EXPECT_EQ(baked.settings.scene, "cornell");
  EXPECT_EQ(result.settings.elements, 331U);
  EXPECT_EQ(result.settings.patches, 37U);
  EXPECT_EQ(result.nonzeros, expected.counts.nonzeros());
  EXPECT_EQ(result.file_bytes, fs::file_size(store_));
  EXPECT_EQ(baked.energy.rays, 331U * 2048U);
  EXPECT_EQ(baked.energy.reciprocity_error, result.energy.reciprocity_error);
  EXPECT_EQ(baked.scene.geometry_hash(), scene_.geometry_hash());
}

TEST_F(Bake, FurnaceLosesNoRay) {
  const BakeResult result =
      bake(make_furnace_cube_scene(), {.patches = 24, .elements = 384, .rays = 64}, store_);
  EXPECT_EQ(result.energy.escaped, 0.0);
  EXPECT_EQ(result.energy.back_face, 0.0);
  EXPECT_EQ(result.energy.row_sum_min, 1.0);
}

TEST_F(Bake, ThreadsAndBlocksDoNotChangeAByte) {
  const std::string expected = uninterrupted();
  BakeConfig config = small_config();
  config.row_block = 97;
  const ThreadLimit one(1);
  bake(scene_, config, store_);
  EXPECT_EQ(bytes_of(store_), expected);
}

TEST_F(Bake, AnotherTracerContinuesTheSameJournal) {
  const std::string expected = uninterrupted();
  interrupt_after(100);
  std::size_t from = 0;
  BakeConfig config = small_config();
  config.resume = true;
  config.tracer = [&from](const TriangleMesh& mesh, const Tessellation& tessellation,
                          const FormFactorConfig& rays, Binning binning, std::size_t first_row,
                          const RowSink& sink, Progress& progress) {
    from = first_row;
    trace_form_factors(tessellation, RayScene(mesh), rays, binning, first_row, sink, progress);
  };
  const BakeResult result = bake(scene_, config, store_);
  EXPECT_GE(from, 96U);
  EXPECT_EQ(from, result.resumed_rows);
  EXPECT_EQ(bytes_of(store_), expected);
}

TEST_F(Bake, InterruptedAndResumedEndsWithTheSameBytes) {
  const std::string expected = uninterrupted();
  for (const std::uint64_t rows : {1U, 70U, 150U}) {
    interrupt_after(rows);
    const BakeResult result = resume();
    EXPECT_GE(result.resumed_rows, rows);
    EXPECT_LT(result.resumed_rows, 331U);
    EXPECT_EQ(bytes_of(store_), expected) << rows;
    EXPECT_FALSE(fs::exists(journal_));
    fs::remove(store_);
  }
}

TEST_F(Bake, InterruptedTwiceEndsWithTheSameBytes) {
  const std::string expected = uninterrupted();
  interrupt_after(100);
  BakeConfig config = small_config();
  config.resume = true;
  {
    const ThreadLimit one(1);
    StopAfter stop(1);
    EXPECT_THROW(bake(scene_, config, store_, stop), Cancelled);
  }
  resume();
  EXPECT_EQ(bytes_of(store_), expected);
}

TEST_F(Bake, JournalCutInABlockEndsWithTheSameBytes) {
  const std::string expected = uninterrupted();
  interrupt_after(120);
  const std::string whole = bytes_of(journal_);
  for (const std::size_t lost : {std::size_t{1}, std::size_t{100}, whole.size() / 2}) {
    put_bytes(journal_, whole.substr(0, whole.size() - lost));
    resume();
    EXPECT_EQ(bytes_of(store_), expected) << lost;
    fs::remove(store_);
  }
}

TEST_F(Bake, KilledWhileTheStoreIsWrittenTracesNothingAgain) {
  const std::string expected = uninterrupted();
  StopAfter stop(0, "write");
  EXPECT_THROW(bake(scene_, small_config(), store_, stop), Cancelled);
  EXPECT_EQ(files_in(folder_.path()), 2U);  // the journal and the uninterrupted store
  EXPECT_EQ(resume().resumed_rows, 331U);
  EXPECT_EQ(bytes_of(store_), expected);
}

TEST_F(Bake, ResumeWithoutAJournalIsABake) {
  EXPECT_EQ(resume().resumed_rows, 0U);
  EXPECT_EQ(bytes_of(store_), uninterrupted());
}

TEST_F(Bake, ResumeRefusesAnotherSceneOrOtherSettings) {
  interrupt_after(100);
  BakeConfig other = small_config();
  other.seed = 2;
  EXPECT_THAT(file_error([&] { resume(other); }), HasSubstr("another scene or other settings"));
  other = small_config();
  other.elements = 332;
  EXPECT_THAT(file_error([&] { resume(other); }), HasSubstr("another scene or other settings"));
  scene_.mesh.positions[0].x += 0.01F;
  EXPECT_THAT(file_error([&] { resume(); }), HasSubstr("another scene or other settings"));
}

TEST_F(Bake, ResumeKeepsRowsWhenOnlyColoursChange) {
  interrupt_after(100);
  scene_.materials[0].reflectance = Rgb(0.1F, 0.2F, 0.3F);
  EXPECT_GE(resume().resumed_rows, 100U);
  EXPECT_EQ(read_store(store_).scene.materials[0].reflectance, Rgb(0.1F, 0.2F, 0.3F));
}

TEST_F(Bake, StartsAnewUnlessAskedToResume) {
  interrupt_after(100);
  EXPECT_EQ(bake(scene_, small_config(), store_).resumed_rows, 0U);
  EXPECT_EQ(bytes_of(store_), uninterrupted());
}

TEST_F(Bake, FullDiskKeepsTheFinishedRows) {
  const std::string expected = uninterrupted();
  {
    const FullDisk disk(5000);
    EXPECT_THAT(file_error([&] { bake(scene_, small_config(), store_); }),
                HasSubstr("rows are kept and can be resumed"));
  }
  EXPECT_GT(resume().resumed_rows, 0U);
  EXPECT_EQ(bytes_of(store_), expected);
}

TEST_F(Bake, RefusesBadTargetsBeforeItWorks) {
  const fs::path nowhere = folder_ / "nowhere" / "scene.h5";
  EXPECT_THAT(file_error([&] { bake(scene_, small_config(), nowhere); }),
              HasSubstr("the folder does not exist"));
  EXPECT_THAT(file_error([&] { bake(scene_, small_config(), folder_.path()); }),
              HasSubstr("is a folder"));
}

TEST_F(Bake, MorePatchesThanElementsIsAValueError) {
  BakeConfig config = small_config();
  config.patches = 332;
  EXPECT_THROW(bake(scene_, config, store_), ValueError);
  EXPECT_EQ(files_in(folder_.path()), 0U);
}

TEST(EmissiveLabels, NumberEmittersByObject) {
  const Scene scene = hand_made_scene().scene;
  EXPECT_EQ(emissive_labels(scene), (std::vector<std::uint32_t>{0, 1}));
}

}  // namespace
}  // namespace relumbre
